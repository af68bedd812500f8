//! Charts of a study as SVG: they stand alone as files, and a page that holds them recolours them for the dark.

mod intervals;
mod lines;
mod palette;
mod panels;
mod scatter;

pub(super) use intervals::{Bar, Column, IntervalChart};
pub(super) use lines::{LineChart, Shape, XRange};
pub(super) use panels::{Facet, Series};
pub(super) use scatter::{ScatterChart, Spot};

use crate::plot::scale::Scale;
use crate::plot::svg::{Anchor, Frame, GRID, INK, Svg};

/// What is written small beside the axes.
const MUTED: &str = "#6b7280";
/// Attributes of titles.
const BOLD: &str = r#"font-weight="bold""#;

/// How wide what shows a chart is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Breadth {
    /// A sheet of paper, or a window: frames stand beside each other.
    Wide,
    /// A phone: they stand below each other.
    Narrow,
}

/// Width of a narrow chart, pixels: little more than a phone's, so that its words stay readable there.
const NARROW_WIDTH: f64 = 400.0;

/// Draws the frame's axes: a grid with labelled round values on the left and below.
fn axes(svg: &mut Svg, frame: Frame, x: &Scale, y: &Scale) {
    let grid = format!(r#"stroke="{GRID}""#);
    for (value, label) in x.ticks((frame.width / 70.0).max(2.0) as usize) {
        let at = x.pixel(value);
        svg.line([at, frame.y], [at, frame.bottom()], &grid);
        svg.text([at, frame.bottom() + 16.0], Anchor::Middle, "", &short(value, &label));
    }
    for (value, label) in y.ticks((frame.height / 38.0).max(2.0) as usize) {
        let at = y.pixel(value);
        svg.line([frame.x, at], [frame.right(), at], &grid);
        svg.text([frame.x - 7.0, at + 4.0], Anchor::End, "", &short(value, &label));
    }
    let style = format!(r#"stroke="{INK}" stroke-width="1.2""#);
    svg.line([frame.x, frame.y], [frame.x, frame.bottom()], &style);
    svg.line([frame.x, frame.bottom()], [frame.right(), frame.bottom()], &style);
}

/// A label, with thousands and millions as `k` and `M`.
fn short(value: f64, label: &str) -> String {
    let in_units = |unit: f64, name: &str| {
        let text = format!("{:.1}", value / unit);
        text.trim_end_matches('0').trim_end_matches('.').to_owned() + name
    };
    match value.abs() {
        size if size >= 1e6 => in_units(1e6, "M"),
        size if size >= 1e4 => in_units(1e3, "k"),
        _ => label.to_owned(),
    }
}

/// The ends of an axis that holds values from `low` to `high`, with a little room; from 0 to 1 where there are none.
fn padded(low: f64, high: f64) -> [f64; 2] {
    let span = high - low;
    if span > 0.0 {
        [low - 0.05 * span, high + 0.05 * span]
    } else if low.is_finite() {
        [low - 0.5, high + 0.5]
    } else {
        [0.0, 1.0]
    }
}

/// The ends of an axis fitted to values from `low` to `high`, which all lie within the bounds: at least a hundredth of the bounds
/// apart, so that what hardly differs does not look far apart, or a tenth of the greatest value where they have no upper end.
fn fitted(low: f64, high: f64, bounds: [f64; 2]) -> [f64; 2] {
    if low > high {
        return [bounds[0], if bounds[1].is_finite() { bounds[1] } else { bounds[0] + 1.0 }];
    }
    let least = match bounds[1] - bounds[0] {
        whole if whole.is_finite() => 0.01 * whole,
        _ if high > 0.0 => 0.1 * high,
        _ => 1.0,
    };
    let span = (high - low).max(least);
    let low = (high - (span + high - low) / 2.0).clamp(bounds[0], (bounds[1] - span).max(bounds[0]));
    [low, low + span]
}

/// The width of a text in the widest of the fonts that charts ask for, roughly, pixels.
fn text_width(text: &str) -> f64 {
    8.0 * text.chars().count() as f64
}

/// Opens a group with attributes and, if there is one, a tip that browsers show beside it.
fn open(svg: &mut Svg, attributes: &str, tip: &str) {
    svg.raw(&format!("<g {attributes}>"));
    if !tip.is_empty() {
        svg.raw(&format!("<title>{}</title>", crate::plot::svg::escaped(tip)));
    }
}

fn close(svg: &mut Svg) {
    svg.raw("</g>");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_an_extent() {
        assert_eq!([padded(0.0, 2.0), padded(3.0, 3.0)], [[-0.1, 2.1], [2.5, 3.5]]);
        assert_eq!(padded(f64::INFINITY, f64::NEG_INFINITY), [0.0, 1.0]);
    }

    #[test]
    fn fitted_axes_hold_their_values_within_bounds() {
        let percent = |low: f64, high: f64| fitted(low, high, [0.0, 100.0]);
        assert_eq!([percent(0.0, 100.0), percent(0.25, 3.0)], [[0.0, 100.0], [0.25, 3.0]]);
        assert_eq!(
            [percent(100.0, 100.0), percent(0.0, 0.5), percent(50.0, 50.0)],
            [[99.0, 100.0], [0.0, 1.0], [49.5, 50.5]]
        );
        let open = |low: f64, high: f64| fitted(low, high, [0.0, f64::INFINITY]);
        assert_eq!([open(0.5, 1.5), open(2.0, 2.0), open(0.0, 0.0)], [[0.5, 1.5], [1.9, 2.1], [0.0, 1.0]]);
        let nothing = (f64::INFINITY, f64::NEG_INFINITY);
        assert_eq!([percent(nothing.0, nothing.1), open(nothing.0, nothing.1)], [[0.0, 100.0], [0.0, 1.0]]);
    }

    #[test]
    fn large_numbers_are_short() {
        assert_eq!([100_000.0, 20_000.0, 1_500_000.0].map(|value| short(value, "")), ["100k", "20k", "1.5M"]);
        assert_eq!([short(0.0, "0"), short(2000.0, "2000"), short(0.5, "0.5")], ["0", "2000", "0.5"]);
    }
}
