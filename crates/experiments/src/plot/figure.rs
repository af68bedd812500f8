//! Panels put together.

use super::room::Labels;
use super::scale::round_top;
use super::svg::{Anchor, Frame, Svg};
use super::{Trajectory, colour, room, speed};

/// Height of the panels, pixels.
const HEIGHT: f64 = 360.0;
/// Greatest width of the room, pixels.
const MAX_ROOM_WIDTH: f64 = 480.0;
/// Width of the panel of speed over time, pixels.
const SPEED_WIDTH: f64 = 400.0;
/// Space above the panels, for titles.
const TOP: f64 = 34.0;
/// Space below the panels, for labels.
const BOTTOM: f64 = 48.0;
/// Space on the left of a panel with labels.
const LEFT: f64 = 54.0;
/// Space that the colour bar takes, with the gap before it.
const BAR: f64 = 74.0;
/// Most rooms beside each other.
const N_COLUMNS: usize = 5;
/// Space between rooms.
const GAP: f64 = 16.0;
/// Space for the two lines above each of several rooms.
const CAPTION: f64 = 38.0;

/// The picture of one drive as SVG: on the left the room with the path coloured by speed, on the right the speed over
/// time, under the outcome.
///
/// ```
/// use headway_experiments::episode::Outcome;
/// use headway_experiments::plot::{Outline, PathSample, Trajectory, figure};
///
/// let sample = |t: f64| PathSample { t, x: 2.0 + t, y: 2.0, yaw: 0.0, speed: 1.0 };
/// let svg = figure(&Trajectory {
///     title: "room 10 x 15 m".into(),
///     x: 0.0,
///     y: 0.0,
///     width: 10.0,
///     height: 15.0,
///     obstacles: vec![Outline::Disc { x: 5.0, y: 4.0, radius: 0.5 }],
///     movers: vec![],
///     goal: [8.0, 2.0],
///     reach_radius: 0.5,
///     footprint_radius: 0.25,
///     samples: (0..=6).map(|i| sample(i as f64)).collect(),
///     outcome: Outcome::Success,
/// });
/// assert!(svg.contains("success after 6.0 s"));
/// ```
pub fn figure(trajectory: &Trajectory) -> String {
    let mut svg = Svg::default();
    let top_speed = round_top(trajectory.top_speed());
    let [width, height] = room::fit(trajectory, MAX_ROOM_WIDTH, HEIGHT);
    let frame = Frame { x: LEFT, y: TOP, width, height };
    room::draw(&mut svg, frame, trajectory, top_speed, Labels::Metres);
    colour::colour_bar(&mut svg, Frame { x: frame.right() + 16.0, width: 12.0, ..frame }, top_speed);
    let right = Frame { x: frame.right() + BAR + LEFT + 22.0, width: SPEED_WIDTH, ..frame };
    speed::draw(&mut svg, right, trajectory, top_speed);
    title(&mut svg, frame, &trajectory.title);
    title(&mut svg, right, &summary(trajectory));
    svg.document(right.right() + 20.0, frame.bottom() + BOTTOM)
}

/// The picture of several drives as SVG: a room for each, with its outcome, in rows of five, coloured by one scale.
pub fn small_multiples(trajectories: &[Trajectory]) -> String {
    let mut svg = Svg::default();
    let top_speed = round_top(trajectories.iter().map(Trajectory::top_speed).fold(0.0, f64::max));
    let [width, height] = [180.0, 220.0];
    let n_columns = trajectories.len().clamp(1, N_COLUMNS);
    for (i, trajectory) in trajectories.iter().enumerate() {
        let (row, column) = ((i / n_columns) as f64, (i % n_columns) as f64);
        let [room_width, room_height] = room::fit(trajectory, width, height);
        let x = GAP + column * (width + GAP) + (width - room_width) / 2.0;
        let frame = Frame { x, y: CAPTION + row * (height + CAPTION + 8.0), width: room_width, height: room_height };
        room::draw(&mut svg, frame, trajectory, top_speed, Labels::None);
        let centre = frame.x + frame.width / 2.0;
        svg.text([centre, frame.y - 22.0], Anchor::Middle, BOLD, &trajectory.title);
        svg.text([centre, frame.y - 7.0], Anchor::Middle, "", &outcome(trajectory));
    }
    let right = GAP + n_columns as f64 * (width + GAP);
    colour::colour_bar(&mut svg, Frame { x: right, y: CAPTION, width: 12.0, height }, top_speed);
    let n_rows = trajectories.len().div_ceil(n_columns).max(1) as f64;
    svg.document(right + BAR, n_rows * (height + CAPTION + 8.0) + 8.0)
}

const BOLD: &str = r#"font-weight="bold""#;

fn title(svg: &mut Svg, frame: Frame, text: &str) {
    svg.text(
        [frame.x + frame.width / 2.0, frame.y - 12.0],
        Anchor::Middle,
        r#"font-weight="bold" font-size="13""#,
        text,
    );
}

fn outcome(trajectory: &Trajectory) -> String {
    format!("{} after {:.1} s", trajectory.outcome.name(), trajectory.duration())
}

fn summary(trajectory: &Trajectory) -> String {
    let (distance, duration) = (trajectory.distance(), trajectory.duration());
    let mean = if duration > 0.0 { format!(" at {:.2} m/s", distance / duration) } else { String::new() };
    format!("{}: {distance:.1} m{mean}", outcome(trajectory))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::Outcome;
    use crate::plot::{Outline, PathSample, Track};

    fn drive(outcome: Outcome, n: u32) -> Trajectory {
        let sample = |i| PathSample { t: 0.2 * i, x: 1.0 + 0.3 * i, y: 2.0 + 0.4 * i, yaw: 0.9, speed: 0.1 * i };
        Trajectory {
            title: "a <room>".into(),
            x: 0.0,
            y: 0.0,
            width: 10.0,
            height: 15.0,
            obstacles: vec![
                Outline::Disc { x: 5.0, y: 4.0, radius: 0.5 },
                Outline::Polygon { points: vec![[1.0, 8.0], [2.0, 8.0], [1.5, 9.0]] },
            ],
            movers: vec![],
            goal: [4.0, 6.0],
            reach_radius: 0.5,
            footprint_radius: 0.25,
            samples: (0..n).map(|i| sample(f64::from(i))).collect(),
            outcome,
        }
    }

    #[test]
    fn a_figure_shows_its_parts_true_to_scale() {
        let svg = figure(&drive(Outcome::Collision, 11));
        assert!(svg.contains("a &lt;room&gt;") && svg.contains("collision after 2.0 s: 5.0 m at 2.50 m/s"));
        // 360 pixels for 15 m: 24 per metre. The disc at (5, 4) is 11 m below the upper wall.
        assert!(svg.contains(r#"<circle cx="174" cy="298" r="12" "#), "{svg}");
        assert!(svg.contains(r#"<polygon points="78,202 102,202 90,178" "#));
        assert_eq!(svg.matches("#c1272d").count(), 2, "the cross of a collision");
    }

    #[test]
    fn movers_are_drawn_with_their_ways() {
        let at = |x: f64| Outline::Disc { x, y: 4.0, radius: 0.5 };
        let track = Track { last: at(7.0), places: vec![[5.0, 4.0], [6.0, 4.0], [7.0, 4.0]], ..Track::new(at(5.0)) };
        let svg = figure(&Trajectory { obstacles: vec![], movers: vec![track], ..drive(Outcome::Success, 5) });
        assert!(svg.contains(r##"<polyline points="174,298 198,298 222,298" fill="none" stroke="#d9730d""##), "{svg}");
        assert!(svg.contains(r#"<circle cx="174" cy="298" r="12" fill="none""#), "the start is an open outline: {svg}");
        assert!(svg.contains(r##"<circle cx="222" cy="298" r="12" fill="#d9730d""##), "{svg}");
    }

    #[test]
    fn a_drive_without_samples_or_motion_is_drawn_too() {
        for svg in [figure(&drive(Outcome::Timeout, 0)), figure(&drive(Outcome::Timeout, 1)), small_multiples(&[])] {
            assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.ends_with("</svg>\n"));
        }
    }

    #[test]
    fn small_multiples_share_their_colours() {
        let svg = small_multiples(&[drive(Outcome::Success, 4), drive(Outcome::Success, 16)]);
        assert_eq!(svg.matches("success after").count(), 2);
        assert!(svg.contains(">1.5</text>") && !svg.contains(">0.3</text>"), "the scale is that of the faster one");
    }
}
