//! Lines with bands, in one frame or in several beside each other.

use super::{BOLD, axes, close, open, padded, palette, text_width};
use crate::plot::scale::Scale;
use crate::plot::svg::{Anchor, Frame, INK, Svg};
use crate::report::study::Point;

/// Lines over a common x, in frames with common scales.
#[derive(Debug)]
pub(crate) struct LineChart {
    pub(crate) x_label: String,
    pub(crate) y_label: String,
    /// The ends of the y axis; from the data if not given.
    pub(crate) y_range: Option<[f64; 2]>,
    pub(crate) facets: Vec<Facet>,
}

/// One frame.
#[derive(Debug)]
pub(crate) struct Facet {
    /// What stands above it, if anything.
    pub(crate) title: String,
    pub(crate) lines: Vec<Line>,
}

/// One line. Lines with equal keys look the same in all frames.
#[derive(Debug)]
pub(crate) struct Line {
    pub(crate) key: String,
    pub(crate) points: Vec<Point>,
}

/// The whole width of a chart, pixels; a lone frame takes less.
const WIDTH: f64 = 960.0;
const LONE_WIDTH: f64 = 620.0;
const FRAME_HEIGHT: f64 = 250.0;
const LEFT: f64 = 64.0;
const BOTTOM: f64 = 52.0;
const TOP: f64 = 30.0;
/// Most frames beside each other.
const MAX_COLUMNS: usize = 3;
/// Height of a line of the legend.
const KEY_HEIGHT: f64 = 20.0;
/// Most points of a line whose points are marked.
const MAX_MARKS: usize = 40;

impl LineChart {
    /// The chart as SVG.
    pub(crate) fn svg(&self) -> String {
        let mut svg = Svg::default();
        let n_columns = n_columns(self.facets.len());
        let width = if self.facets.len() == 1 { LONE_WIDTH } else { WIDTH };
        let column = (width - 16.0) / n_columns as f64;
        let row = TOP + FRAME_HEIGHT + BOTTOM;
        let (x_range, y_range) = (self.x_range(), self.y_range.unwrap_or_else(|| self.y_range_of_data()));
        let keys = self.keys();
        for (k, facet) in self.facets.iter().enumerate() {
            let (x, y) = ((k % n_columns) as f64 * column + LEFT, (k / n_columns) as f64 * row + TOP);
            let frame = Frame { x, y, width: column - LEFT, height: FRAME_HEIGHT };
            self.draw(&mut svg, frame, facet, &keys, x_range, y_range);
        }
        let legend = self.facets.len().div_ceil(n_columns).max(1) as f64 * row;
        let height = draw_legend(&mut svg, &keys, legend, width);
        svg.document(width, height)
    }

    /// The keys of all lines, each once, in the order in which they come.
    fn keys(&self) -> Vec<&str> {
        let mut keys = Vec::new();
        for line in self.facets.iter().flat_map(|facet| &facet.lines) {
            if !keys.contains(&line.key.as_str()) {
                keys.push(&line.key);
            }
        }
        keys
    }

    fn points(&self) -> impl Iterator<Item = &Point> {
        self.facets.iter().flat_map(|facet| &facet.lines).flat_map(|line| &line.points)
    }

    fn x_range(&self) -> [f64; 2] {
        let high = self.points().map(|point| point.x).fold(f64::NEG_INFINITY, f64::max);
        [0.0, if high > 0.0 { high } else { 1.0 }]
    }

    fn y_range_of_data(&self) -> [f64; 2] {
        let ends = |point: &Point| point.band.unwrap_or((point.y, point.y));
        let low = self.points().map(|point| ends(point).0).fold(f64::INFINITY, f64::min);
        let high = self.points().map(|point| ends(point).1).fold(f64::NEG_INFINITY, f64::max);
        padded(low, high)
    }

    fn draw(&self, svg: &mut Svg, frame: Frame, facet: &Facet, keys: &[&str], x: [f64; 2], y: [f64; 2]) {
        let (x, y) = (Scale::new(x, [frame.x, frame.right()]), Scale::new(y, [frame.bottom(), frame.y]));
        axes(svg, frame, &x, &y);
        svg.text([frame.x + frame.width / 2.0, frame.y - 10.0], Anchor::Middle, BOLD, &facet.title);
        svg.text([frame.x + frame.width / 2.0, frame.bottom() + 36.0], Anchor::Middle, "", &self.x_label);
        svg.text_upwards([frame.x - 46.0, frame.y + frame.height / 2.0], &self.y_label);
        for line in facet.lines.iter().filter(|line| !line.points.is_empty()) {
            let k = keys.iter().position(|key| *key == line.key).unwrap_or(0);
            open(svg, &format!(r#"class="series" data-key="{k}""#), "");
            self.draw_line(svg, line, k, &x, &y);
            close(svg);
        }
    }

    fn draw_line(&self, svg: &mut Svg, line: &Line, k: usize, x: &Scale, y: &Scale) {
        let at = |point: &Point, value: f64| [x.pixel(point.x), y.pixel(value)];
        let banded = || line.points.iter().filter_map(|point| Some((point, point.band?)));
        let upper = banded().map(|(point, (_, high))| at(point, high));
        let lower = banded().rev().map(|(point, (low, _))| at(point, low));
        let band: Vec<_> = upper.chain(lower).collect();
        if band.len() > 2 {
            svg.polygon(&band, &format!(r#"fill="{}" fill-opacity="0.16""#, palette::colour(k)));
        }
        let points: Vec<_> = line.points.iter().map(|point| at(point, point.y)).collect();
        svg.polyline(&points, &palette::stroke(k));
        if points.len() > MAX_MARKS {
            return;
        }
        for (point, place) in line.points.iter().zip(points) {
            let band =
                point.band.map_or_else(String::new, |(low, high)| format!(" ({} to {})", digits(low), digits(high)));
            let tip = format!("{}: {}{band} at {}, n = {}", line.key, digits(point.y), trimmed(point.x), point.n);
            open(svg, r#"class="mark""#, &tip);
            svg.circle(place, 8.0, r#"fill="transparent" stroke="none""#);
            svg.circle(place, 2.2, &format!(r#"fill="{}""#, palette::colour(k)));
            close(svg);
        }
    }
}

/// How many frames of `n` stand beside each other: as many as leave the fewest places empty.
fn n_columns(n: usize) -> usize {
    let n_empty = |columns: &usize| n.next_multiple_of(*columns) - n;
    (1..=MAX_COLUMNS.min(n.max(1))).rev().filter(|columns| *columns > 1 || n < 2).min_by_key(n_empty).unwrap_or(1)
}

/// A number with some three digits.
fn digits(value: f64) -> String {
    let decimals = if value == 0.0 { 0.0 } else { (2.0 - value.abs().log10().floor()).clamp(0.0, 4.0) } as usize;
    format!("{value:.decimals$}")
}

/// The same without idle zeros.
fn trimmed(value: f64) -> String {
    let text = digits(value);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Draws a sample of each line with its key, below the frames; where the picture ends.
fn draw_legend(svg: &mut Svg, keys: &[&str], top: f64, width: f64) -> f64 {
    let (mut x, mut y) = (16.0, top + 10.0);
    if keys.len() < 2 && keys.first().is_none_or(|key| key.is_empty()) {
        return top;
    }
    for (k, key) in keys.iter().enumerate() {
        let wanted = 34.0 + text_width(key) + 18.0;
        if x > 16.0 && x + wanted > width {
            (x, y) = (16.0, y + KEY_HEIGHT);
        }
        open(svg, &format!(r#"class="key" data-key="{k}""#), "");
        svg.line([x, y], [x + 26.0, y], &palette::stroke(k));
        svg.text([x + 33.0, y + 4.0], Anchor::Start, &format!(r#"fill="{INK}""#), key);
        close(svg);
        x += wanted;
    }
    y + KEY_HEIGHT
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(facets: Vec<Facet>) -> LineChart {
        LineChart { x_label: "env steps".into(), y_label: "share".into(), y_range: Some([0.0, 1.0]), facets }
    }

    fn line(key: &str, ys: &[f64]) -> Line {
        let point = |(x, y): (u32, &f64)| Point { x: f64::from(x), y: *y, band: Some((y - 0.1, y + 0.1)), n: 3 };
        Line { key: key.into(), points: (0..).zip(ys).map(point).collect() }
    }

    #[test]
    fn equal_keys_look_the_same_in_every_frame() {
        let facet =
            |title: &str| Facet { title: title.into(), lines: vec![line("b", &[0.1, 0.2]), line("a", &[0.3, 0.4])] };
        let svg = chart(vec![facet("one"), facet("<two>")]).svg();
        assert!(svg.contains("&lt;two&gt;"));
        for (k, colour) in [(0, "#0072b2"), (1, "#d55e00")] {
            assert_eq!(svg.matches(&format!(r#"class="series" data-key="{k}""#)).count(), 2);
            assert_eq!(svg.matches(&format!(r#"class="key" data-key="{k}""#)).count(), 1);
            assert_eq!(svg.matches(&format!(r#"fill="none" stroke="{colour}""#)).count(), 3); // two lines and a key
        }
        assert!(svg.contains("<title>a: 0.300 (0.200 to 0.400) at 0, n = 3</title>"), "{svg}");
    }

    #[test]
    fn numbers_have_few_digits() {
        assert_eq!([0.0, 0.05, 0.5, 12.345, 100_000.0].map(digits), ["0", "0.0500", "0.500", "12.3", "100000"]);
        assert_eq!([0.0, 0.05, 0.5, 12.0, 100_000.0].map(trimmed), ["0", "0.05", "0.5", "12", "100000"]);
    }

    #[test]
    fn frames_fill_their_rows() {
        assert_eq!([0, 1, 2, 3, 4, 5, 6, 8].map(n_columns), [1, 1, 2, 3, 2, 3, 3, 2]);
    }

    #[test]
    fn nothing_and_constants_are_drawn_too() {
        let mut empty = chart(vec![]);
        empty.y_range = None;
        let mut constant = chart(vec![Facet { title: String::new(), lines: vec![line("", &[0.0])] }]);
        constant.y_range = None;
        for svg in [empty.svg(), constant.svg()] {
            assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.ends_with("</svg>\n"), "{svg}");
        }
    }
}
