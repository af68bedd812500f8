//! Worlds like those of the BARN challenge, from a cellular automaton.

mod passage;

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use super::lattice::Lattice;
use super::path_check::PathCheck;
use super::populate::{check_crowd, populate};
use super::{GoalRule, Interval, Scenario};
use crate::check::{fraction, within};
use crate::{CrowdSpec, FieldError, Footprint, Obstacle, Point, Pose, Room, Shape, SimError, World};
use passage::Passage;

/// A corridor with a field of posts as in the worlds of BARN (Perille, Truong, Xiao, Stone 2020, "Benchmarking Metric Ground
/// Navigation"), in their coordinates: the vehicle starts at (-2, 3), facing +y, and is to go 10 m ahead.
///
/// Posts of radius 0.075 m stand 0.15 m apart: three walls around x from -4.425 to -0.075 m and y from 0.075 m on, open above
/// 9.525 m, and between them, from y = 5.025 m on, a field of 28 x 31 cells. Each cell of the field is filled with some
/// probability; then, several times over, cells with five filled neighbours or more of eight are filled, and those with one
/// or none emptied, where what lies beyond the side walls counts as filled. Fields without a way of some clearance are
/// thrown away.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BarnSpec {
    /// Probability that a cell is filled at first, 0 to 1.
    pub fill: Interval,
    /// How many times the field is smoothed, 0 to 20, rounded.
    pub n_smoothings: Interval,
    /// Least clearance of a way from the start to the goal, metres, from 0.05 to 0.8: half the width of what must fit through.
    pub clearance: Interval,
    /// Least distance from the outermost posts, the start or the goal to the walls of the hall around them, metres, 1 to 50.
    pub margin: f64,
    /// What moves in the hall, in and around the corridor; nothing if not given. The way through the field leads round what
    /// stands still.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crowd: Option<CrowdSpec>,
}

impl Default for BarnSpec {
    fn default() -> Self {
        Self {
            fill: Interval::Range([0.15, 0.3]),
            n_smoothings: Interval::Range([2.0, 4.0]),
            clearance: Interval::Fixed(0.35),
            margin: 10.0,
            crowd: None,
        }
    }
}

/// Distance between posts, metres, and twice their radius.
const PITCH: f64 = 0.15;
/// The post of least x and y.
const FIRST: [f64; 2] = [-4.425, 0.075];
/// Posts from wall to wall, walls included.
const N_COLUMNS: usize = 30;
/// Posts of a side wall.
const N_ROWS: usize = 64;
/// The first row of the field.
const FIELD: usize = 33;
/// How many fields are drawn before one gives up.
const TRIES: usize = 300;
/// How many open fields are tried for a crowd.
const CROWD_TRIES: usize = 20;

const START: [f64; 2] = [-2.0, 3.0];
const GOAL: [f64; 2] = [-2.0, 13.0];

/// What is filled: rows of the field from wall to wall, walls excluded.
type Field = [[bool; N_COLUMNS - 2]; N_ROWS - FIELD];

impl BarnSpec {
    /// What starts and goals satisfy.
    #[must_use]
    pub fn goal_rule() -> GoalRule {
        GoalRule { distance: 10.0, clearance: 0.1 }
    }

    pub(super) fn check(&self) -> Result<(), FieldError> {
        self.fill.check("fill", fraction)?;
        self.n_smoothings.check("n_smoothings", |field, x| within(field, x, 0.0, 20.0))?;
        self.clearance.check("clearance", |field, x| within(field, x, 0.05, 0.8))?;
        within("margin", self.margin, 1.0, 50.0)?;
        check_crowd(self.crowd.as_ref())
    }

    /// A world with such a way; its fill and smoothing are drawn anew with each field.
    pub(super) fn scenario(
        &self,
        footprint: &Footprint,
        mut layout: impl RngExt,
        mut crowd: ChaCha8Rng,
    ) -> Result<Scenario, SimError> {
        let rng = &mut layout;
        let rule = Self::goal_rule();
        let clearance = self.clearance.sample(rng).max(footprint.inradius());
        let (start, goal) = (Point::from(START), Point::from(GOAL));
        let free = |lattice: Lattice| Passage::new(&lattice, clearance + lattice.step / 2.0 + PITCH / 2.0);
        let passage = Lattice::new(&self.room(), rule.clearance).map(free);
        let mut crowded_out = Vec::new();
        for _ in 0..TRIES {
            let field = self.draw_field(rng);
            // Most fields are blocked, and a world of one costs much more than to see it.
            if !passage.as_ref().is_some_and(|passage| passage.is_open(&field)) {
                continue;
            }
            let world = self.build_world(&field)?;
            if PathCheck::new(&world, &Footprint::disc(clearance), &rule).joins(&start, &goal) {
                let start = Pose::new(start.coords, FRAC_PI_2);
                let scenario = Scenario { world, start, goal, goal_rule: rule, crowd: None };
                match populate(scenario, self.crowd.as_ref(), footprint, &mut crowd) {
                    Err(error) if crowded_out.len() + 1 == CROWD_TRIES => return Err(error),
                    Err(error) => crowded_out.push(error),
                    made => return made,
                }
            }
        }
        let no_route = || rule.no_route(&self.room(), &Footprint::disc(clearance), TRIES);
        Err(crowded_out.pop().unwrap_or_else(no_route))
    }

    fn draw_field(&self, rng: &mut impl RngExt) -> Field {
        let fill = self.fill.sample(rng);
        let n_smoothings = self.n_smoothings.sample(rng).round() as usize;
        let mut field: Field = std::array::from_fn(|_| std::array::from_fn(|_| rng.random_bool(fill)));
        for _ in 0..n_smoothings {
            field = smooth(&field);
        }
        field
    }

    fn build_world(&self, field: &Field) -> Result<World, SimError> {
        let walls = (0..N_ROWS).flat_map(|row| [(0, row), (N_COLUMNS - 1, row)]);
        let bottom = (1..N_COLUMNS - 1).map(|column| (column, 0));
        let post = |(column, row): (usize, usize)| {
            let at = Vector2::from(FIRST) + Vector2::new(column as f64, row as f64) * PITCH;
            Obstacle { shape: Shape::Disc { radius: PITCH / 2.0 }, x: at.x, y: at.y, yaw: 0.0 }
        };
        World::of_checked(self.room(), walls.chain(bottom).chain(posts(field)).map(post).collect())
    }

    /// The hall around it all.
    fn room(&self) -> Room {
        let left = FIRST[0] - PITCH / 2.0 - self.margin;
        let right = FIRST[0] + PITCH * (N_COLUMNS as f64 - 0.5) + self.margin;
        let (below, above) = (FIRST[1] - PITCH / 2.0 - self.margin, GOAL[1] + self.margin);
        Room { x: left, y: below, width: right - left, height: above - below }
    }
}

/// The posts of a field, by column and row.
fn posts(field: &Field) -> impl Iterator<Item = (usize, usize)> {
    field.iter().enumerate().flat_map(|(row, cells)| {
        let filled = cells.iter().enumerate().filter(|(_, is_filled)| **is_filled);
        filled.map(move |(column, _)| (column + 1, row + FIELD))
    })
}

/// One step of the automaton.
fn smooth(field: &Field) -> Field {
    let is_filled = |row: Option<usize>, column: Option<usize>| {
        let Some(cells) = row.and_then(|row| field.get(row)) else { return false };
        column.is_none_or(|column| cells.get(column).copied().unwrap_or(true))
    };
    let n_filled = |row: usize, column: usize| {
        let offsets = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dy, dx))).filter(|offset| *offset != (0, 0));
        let near = |(dy, dx): (isize, isize)| is_filled(row.checked_add_signed(dy), column.checked_add_signed(dx));
        offsets.filter(|offset| near(*offset)).count()
    };
    std::array::from_fn(|row| {
        std::array::from_fn(|column| match n_filled(row, column) {
            0..=1 => false,
            5.. => true,
            _ => field[row][column],
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream;

    #[test]
    fn smoothing_by_hand() {
        let mut field: Field = [[false; N_COLUMNS - 2]; N_ROWS - FIELD];
        field[5][5] = true; // alone: gone
        for (row, column) in [(9, 9), (9, 10), (9, 11), (10, 9), (10, 11)] {
            field[row][column] = true; // five around (10, 10)
        }
        field[20][0] = true; // by the wall, of which three cells are beside it
        let next = smooth(&field);
        assert!(!next[5][5] && next[10][10] && next[20][0]);
        assert!(next[9][10] && next[9][9]); // between two and four neighbours stay
        assert!(!next[21][0] && !next[0][0]); // three of the wall and one below; two of the wall at the open edge
    }

    #[test]
    fn fields_keep_their_promises() {
        let footprint = Footprint::new(&Shape::Box { length: 0.458, width: 0.4156 }).unwrap();
        let spec = BarnSpec::default();
        let mut n_posts = Vec::new();
        for index in 0..50 {
            let scenario = spec.scenario(&footprint, stream(1, "layout", index), stream(1, "crowd", index)).unwrap();
            let again = spec.scenario(&footprint, stream(1, "layout", index), stream(1, "crowd", index)).unwrap();
            assert_eq!(scenario.world.obstacles(), again.world.obstacles());
            assert!(!scenario.world.collides(&footprint, &scenario.start));
            assert_eq!(scenario.goal, Point::new(-2.0, 13.0));
            n_posts.push(scenario.world.obstacles().len() - 2 * N_ROWS - (N_COLUMNS - 2));
        }
        n_posts.sort_unstable();
        assert!(n_posts[0] < 60 && n_posts[49] > 130, "sparse ones and dense ones: {n_posts:?}");
    }

    /// Fields of all densities: one that is not open never has a way, and most open ones have one.
    #[test]
    fn what_is_blocked_has_no_way() {
        let rule = BarnSpec::goal_rule();
        let spec = BarnSpec { fill: Interval::Range([0.05, 0.35]), margin: 1.0, ..BarnSpec::default() };
        let lattice = Lattice::new(&spec.room(), rule.clearance).unwrap();
        let (mut n_blocked, mut n_open, mut n_joined) = (0, 0, 0);
        for index in 0..600 {
            let rng = &mut stream(3, "layout", index);
            let clearance = rng.random_range(0.05..0.5);
            let field = spec.draw_field(rng);
            let is_open = Passage::new(&lattice, clearance + lattice.step / 2.0 + PITCH / 2.0).is_open(&field);
            let world = spec.build_world(&field).unwrap();
            let mut check = PathCheck::new(&world, &Footprint::disc(clearance), &rule);
            let is_joined = check.joins(&START.into(), &GOAL.into());
            assert!(is_open || !is_joined, "{index}");
            n_blocked += usize::from(!is_open);
            n_open += usize::from(is_open);
            n_joined += usize::from(is_joined);
        }
        assert!(n_blocked > 100 && n_joined > 100 && n_joined * 20 > n_open * 19, "{n_blocked} {n_open} {n_joined}");
    }

    #[test]
    fn refusals_name_the_field() {
        let spec = BarnSpec { fill: Interval::Fixed(1.5), ..BarnSpec::default() };
        assert_eq!(spec.check().unwrap_err().to_string(), "fill = 1.5: must be from 0 to 1");
        let full = BarnSpec { fill: Interval::Fixed(1.0), ..BarnSpec::default() };
        let error = full.scenario(&Footprint::disc(0.2), stream(0, "layout", 0), stream(0, "crowd", 0)).unwrap_err();
        assert!(error.to_string().contains("joined by a path 0.70 m wide"), "{error}");
    }
}
