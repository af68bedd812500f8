//! The speed over time.

use super::Trajectory;
use super::colour::coloured_line;
use super::scale::Scale;
use super::svg::{Anchor, Frame, GRID, INK, Svg};

/// Draws the speed over time into a frame, from 0 (or the fastest reversing) to `top_speed`.
pub(super) fn draw(svg: &mut Svg, frame: Frame, trajectory: &Trajectory, top_speed: f64) {
    let samples = &trajectory.samples;
    let start = samples.first().map_or(0.0, |sample| sample.t);
    let lowest = samples.iter().map(|sample| sample.speed).fold(0.0, f64::min);
    let duration = trajectory.duration();
    let time = Scale::new([0.0, if duration > 0.0 { duration } else { 1.0 }], [frame.x, frame.right()]);
    let speed = Scale::new([lowest, top_speed * 1.04], [frame.bottom(), frame.y]);
    draw_axes(svg, frame, &time, &speed);
    let points: Vec<_> = samples.iter().map(|s| [time.pixel(s.t - start), speed.pixel(s.speed)]).collect();
    let speeds: Vec<_> = samples.iter().map(|sample| sample.speed).collect();
    coloured_line(svg, &points, &speeds, top_speed);
}

fn draw_axes(svg: &mut Svg, frame: Frame, time: &Scale, speed: &Scale) {
    let grid = format!(r#"stroke="{GRID}""#);
    for (value, label) in time.ticks((frame.width / 55.0) as usize) {
        let x = time.pixel(value);
        svg.line([x, frame.y], [x, frame.bottom()], &grid);
        svg.text([x, frame.bottom() + 17.0], Anchor::Middle, "", &label);
    }
    for (value, label) in speed.ticks((frame.height / 70.0) as usize) {
        let y = speed.pixel(value);
        svg.line([frame.x, y], [frame.right(), y], &grid);
        svg.text([frame.x - 7.0, y + 4.0], Anchor::End, "", &label);
    }
    let style = format!(r#"stroke="{INK}" stroke-width="1.2""#);
    svg.line([frame.x, frame.y], [frame.x, frame.bottom()], &style);
    svg.line([frame.x, frame.bottom()], [frame.right(), frame.bottom()], &style);
    svg.text([frame.x + frame.width / 2.0, frame.bottom() + 36.0], Anchor::Middle, "", "time (s)");
    svg.text_upwards([frame.x - 38.0, frame.y + frame.height / 2.0], "speed (m/s)");
}
