//! Whether a field can be passed at all, without a world of it.

use super::{FIELD, FIRST, Field, N_COLUMNS, N_ROWS, PITCH};
use crate::scenario::lattice::Lattice;

/// What of a field is free for a vehicle, at the nodes of the lattice on which paths are searched: between the side walls, row
/// by row from the field's lowest posts to its highest.
///
/// Every path from the start to the goal leads up through all these rows between the walls, whose posts leave no gap; so a
/// field through which no chain of free neighbours leads is blocked for the path search, too. The reverse need not hold.
pub(super) struct Passage {
    /// Coordinates of the columns and rows of nodes, in units of the posts' distance from the post of least x and y.
    columns: Vec<f64>,
    rows: Vec<f64>,
    /// Nodes are free from this distance to a post's centre on, in the same unit.
    reach: f64,
}

/// Free nodes of a row, from the lowest bit on.
type Row = u128;

impl Passage {
    /// The nodes of a lattice, which are free at a distance `free` from a post's centre, metres.
    pub(super) fn new(lattice: &Lattice, free: f64) -> Self {
        let [x, y] = lattice.coordinates();
        let between = |along: Vec<f64>, axis: usize, low: usize, high: usize| {
            let along = along.into_iter().map(|at| (at - FIRST[axis]) / PITCH);
            along.filter(|at| (low as f64..=high as f64).contains(at)).collect()
        };
        // Rounding must not make a free node a blocked one.
        let reach = free / PITCH - 1e-9;
        Self { columns: between(x, 0, 0, N_COLUMNS - 1), rows: between(y, 1, FIELD, N_ROWS - 1), reach }
    }

    /// Whether a chain of free neighbours leads from the lowest row to the highest.
    pub(super) fn is_open(&self, field: &Field) -> bool {
        let free = self.free(field);
        let mut reached = vec![0; free.len()];
        reached[0] = free[0];
        let mut open = vec![0];
        while let Some(row) = open.pop() {
            if row + 1 == free.len() {
                return true;
            }
            for next in [row.wrapping_sub(1), row + 1] {
                let Some(free) = free.get(next) else { continue };
                let more = spread(reached[row] & free, *free) & !reached[next];
                if more != 0 {
                    reached[next] |= more;
                    open.push(next);
                }
            }
        }
        false
    }

    /// The free nodes of each row.
    fn free(&self, field: &Field) -> Vec<Row> {
        let all = Row::MAX.checked_shr(Row::BITS - self.columns.len() as u32).unwrap_or(0);
        let mut free = vec![all; self.rows.len()];
        let walls = (FIELD..N_ROWS).flat_map(|row| [(0, row), (N_COLUMNS - 1, row)]);
        for (column, row) in walls.chain(super::posts(field)) {
            let (x, y) = (column as f64, row as f64);
            let first = self.rows.partition_point(|at| *at <= y - self.reach);
            for (free, at) in free[first..].iter_mut().zip(&self.rows[first..]) {
                let half_chord_squared = self.reach * self.reach - (at - y) * (at - y);
                if half_chord_squared <= 0.0 {
                    break;
                }
                let half_chord = half_chord_squared.sqrt();
                *free &= !self.nodes(x - half_chord, x + half_chord);
            }
        }
        free
    }

    /// The nodes of a row that lie between two places.
    fn nodes(&self, low: f64, high: f64) -> Row {
        let below = |place: f64| {
            let n = self.columns.partition_point(|at| *at <= place) as u32;
            Row::MAX.checked_shr(Row::BITS - n).unwrap_or(0)
        };
        below(high) & !below(low)
    }
}

/// All free nodes that neighbours join to some free ones.
fn spread(mut from: Row, free: Row) -> Row {
    loop {
        let wider = (from | from << 1 | from >> 1) & free;
        if wider == from {
            return from;
        }
        from = wider;
    }
}
