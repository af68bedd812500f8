//! The room as seen from above.

use std::f64::consts::PI;

use super::colour::coloured_line;
use super::scale::Scale;
use super::svg::{Anchor, Frame, INK, Svg};
use super::{Outline, PathSample, Track, Trajectory};
use crate::episode::Outcome;

const GOAL: &str = "#2a7f3f";
const HIT: &str = "#c1272d";
const STILL: &str = r##"fill="#c9ccd1" stroke="#7d828a" stroke-width="1""##;
/// An orange that no speed has.
const MOVER: &str = "#d9730d";

/// Whether the room's sides are labelled in metres.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Labels {
    Metres,
    None,
}

/// From metres in the room to pixels in the frame.
#[derive(Debug, Clone, Copy)]
struct View {
    x: Scale,
    y: Scale,
    pixels_per_metre: f64,
}

impl View {
    fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.pixel(x), self.y.pixel(y)]
    }
}

/// The largest frame of the room's proportions within the given size.
pub(super) fn fit(trajectory: &Trajectory, max_width: f64, max_height: f64) -> [f64; 2] {
    let scale = (max_width / trajectory.width).min(max_height / trajectory.height);
    [scale * trajectory.width, scale * trajectory.height]
}

/// Draws the room, its obstacles, the goal and the drive into a frame of the room's proportions.
pub(super) fn draw(svg: &mut Svg, frame: Frame, trajectory: &Trajectory, top_speed: f64, labels: Labels) {
    let view = View {
        x: Scale::new([trajectory.x, trajectory.x + trajectory.width], [frame.x, frame.right()]),
        y: Scale::new([trajectory.y, trajectory.y + trajectory.height], [frame.bottom(), frame.y]),
        pixels_per_metre: frame.width / trajectory.width,
    };
    // An inner picture cuts off what reaches beyond the walls.
    let Frame { x, y, width, height } = frame;
    svg.raw(&format!(r#"<svg x="{x}" y="{y}" width="{width}" height="{height}" viewBox="{x} {y} {width} {height}">"#));
    svg.rect(frame, r##"fill="#fbfbfb""##);
    for obstacle in &trajectory.obstacles {
        draw_outline(svg, &view, obstacle, STILL);
    }
    for mover in &trajectory.movers {
        draw_mover(svg, &view, mover);
    }
    draw_goal(svg, &view, trajectory);
    draw_drive(svg, &view, trajectory, top_speed);
    svg.raw("</svg>");
    svg.rect(frame, &format!(r#"fill="none" stroke="{INK}" stroke-width="1.6""#));
    if labels == Labels::Metres {
        draw_labels(svg, frame, &view);
    }
}

/// Its way, where it was when the drive began, dashed, and where it was when it ended.
fn draw_mover(svg: &mut Svg, view: &View, Track { first, last, places }: &Track) {
    let way: Vec<_> = places.iter().map(|place| view.point(*place)).collect();
    svg.polyline(&way, &format!(r#"fill="none" stroke="{MOVER}" stroke-opacity="0.6" stroke-width="1.6""#));
    draw_outline(svg, view, first, &format!(r#"fill="none" stroke="{MOVER}" stroke-width="1" stroke-dasharray="2 2""#));
    draw_outline(svg, view, last, &format!(r#"fill="{MOVER}" fill-opacity="0.45" stroke="{MOVER}" stroke-width="1""#));
}

fn draw_outline(svg: &mut Svg, view: &View, outline: &Outline, style: &str) {
    match outline {
        Outline::Disc { x, y, radius } => {
            svg.circle(view.point([*x, *y]), radius * view.pixels_per_metre, style);
        }
        Outline::Polygon { points } => {
            let points: Vec<_> = points.iter().map(|point| view.point(*point)).collect();
            svg.polygon(&points, style);
        }
    }
}

fn draw_goal(svg: &mut Svg, view: &View, trajectory: &Trajectory) {
    let centre = view.point(trajectory.goal);
    let style =
        format!(r#"fill="{GOAL}" fill-opacity="0.15" stroke="{GOAL}" stroke-width="1.4" stroke-dasharray="4 3""#);
    svg.circle(centre, trajectory.reach_radius * view.pixels_per_metre, &style);
    svg.polygon(&star(centre, 6.0), &format!(r#"fill="{GOAL}""#));
}

/// A star of five points.
fn star([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let point = |k: u32| {
        let (radius, angle) = (if k.is_multiple_of(2) { radius } else { 0.4 * radius }, f64::from(k) * PI / 5.0);
        [x + radius * angle.sin(), y - radius * angle.cos()]
    };
    (0..10).map(point).collect()
}

fn draw_drive(svg: &mut Svg, view: &View, trajectory: &Trajectory, top_speed: f64) {
    let samples = &trajectory.samples;
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return;
    };
    draw_vehicle(svg, view, last, trajectory.footprint_radius, "white");
    draw_vehicle(svg, view, first, trajectory.footprint_radius, "#f4b942");
    let points: Vec<_> = samples.iter().map(|sample| view.point([sample.x, sample.y])).collect();
    let speeds: Vec<_> = samples.iter().map(|sample| sample.speed).collect();
    coloured_line(svg, &points, &speeds, top_speed);
    if trajectory.outcome == Outcome::Collision {
        let ([x, y], style) = (view.point([last.x, last.y]), format!(r#"stroke="{HIT}" stroke-width="2.6""#));
        svg.line([x - 6.0, y - 6.0], [x + 6.0, y + 6.0], &style);
        svg.line([x - 6.0, y + 6.0], [x + 6.0, y - 6.0], &style);
    }
}

/// The footprint's disc and the radius that points ahead.
fn draw_vehicle(svg: &mut Svg, view: &View, sample: &PathSample, radius: f64, fill: &str) {
    let nose = [sample.x + radius * sample.yaw.cos(), sample.y + radius * sample.yaw.sin()];
    let centre = view.point([sample.x, sample.y]);
    let style = format!(r#"fill="{fill}" stroke="{INK}" stroke-width="1.3""#);
    svg.circle(centre, radius * view.pixels_per_metre, &style);
    svg.line(centre, view.point(nose), &style);
}

fn draw_labels(svg: &mut Svg, frame: Frame, view: &View) {
    let style = format!(r#"stroke="{INK}""#);
    for (value, label) in view.x.ticks((frame.width / 60.0) as usize) {
        let x = view.x.pixel(value);
        svg.line([x, frame.bottom()], [x, frame.bottom() + 4.0], &style);
        svg.text([x, frame.bottom() + 17.0], Anchor::Middle, "", &label);
    }
    for (value, label) in view.y.ticks((frame.height / 60.0) as usize) {
        let y = view.y.pixel(value);
        svg.line([frame.x - 4.0, y], [frame.x, y], &style);
        svg.text([frame.x - 7.0, y + 4.0], Anchor::End, "", &label);
    }
    svg.text([frame.x + frame.width / 2.0, frame.bottom() + 36.0], Anchor::Middle, "", "x (m)");
    svg.text_upwards([frame.x - 32.0, frame.y + frame.height / 2.0], "y (m)");
}
