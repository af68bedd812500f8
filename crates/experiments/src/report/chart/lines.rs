//! Lines with bands, in one frame or in several beside each other.

use super::panels::{self, Facet, Look, Series};
use super::{Breadth, close, fitted, open, padded, palette};
use crate::plot::scale::Scale;
use crate::plot::svg::Svg;
use crate::report::study::Point;

/// Lines over a common x, in frames with a common y.
#[derive(Debug)]
pub(crate) struct LineChart {
    pub(crate) x_label: String,
    pub(crate) y_label: String,
    pub(crate) x_range: XRange,
    /// The ends of the y axis; from the data if not given.
    pub(crate) y_range: Option<[f64; 2]>,
    pub(crate) shape: Shape,
    pub(crate) facets: Vec<Facet<Vec<Point>>>,
}

/// What the x axes show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum XRange {
    /// From zero to the greatest x of any frame, the same in all.
    FromZero,
    /// What a frame's points take, frame by frame, and a little more at both ends; no x lies beyond these bounds.
    OfFrame([f64; 2]),
}

/// How points are joined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Shape {
    /// By straight lines.
    Straight,
    /// By steps from end to end of the frame: each value holds from its x to the next.
    Steps {
        /// The value before the first point, which no seed can change.
        before: f64,
    },
}

/// Most points of a line whose points are marked.
const MAX_MARKS: usize = 40;

impl LineChart {
    /// The chart as SVG.
    pub(crate) fn svg(&self, breadth: Breadth) -> String {
        panels::svg(&self.facets, [&self.x_label, &self.y_label], self, breadth)
    }

    fn points(&self) -> impl Iterator<Item = &Point> {
        self.facets.iter().flat_map(Facet::points)
    }

    fn x_range(&self, facet: &Facet<Vec<Point>>) -> [f64; 2] {
        let greatest =
            |points: &mut dyn Iterator<Item = &Point>| points.map(|point| point.x).fold(f64::NEG_INFINITY, f64::max);
        match self.x_range {
            XRange::FromZero => match greatest(&mut self.points()) {
                high if high > 0.0 => [0.0, high],
                _ => [0.0, 1.0],
            },
            XRange::OfFrame(bounds) => {
                let low = facet.points().map(|point| point.x).fold(f64::INFINITY, f64::min);
                let [low, high] = fitted(low, greatest(&mut facet.points()), bounds);
                padded(low, high)
            }
        }
    }

    /// The corners of a line through points, all in pixels.
    fn corners(&self, points: &[[f64; 2]], x: &Scale, y: &Scale) -> Vec<[f64; 2]> {
        match self.shape {
            Shape::Straight => points.to_vec(),
            Shape::Steps { before } => {
                let [left, right] = x.ends();
                let starts = std::iter::once([left, y.pixel(before)]).chain(points.iter().copied());
                let ends = points.iter().map(|[x, _]| *x).chain([right]);
                starts.zip(ends).flat_map(|([from, y], to)| [[from, y], [to, y]]).collect()
            }
        }
    }

    fn y_range_of_data(&self) -> [f64; 2] {
        let ends = |point: &Point| point.band.unwrap_or((point.y, point.y));
        let low = self.points().map(|point| ends(point).0).fold(f64::INFINITY, f64::min);
        let high = self.points().map(|point| ends(point).1).fold(f64::NEG_INFINITY, f64::max);
        padded(low, high)
    }
}

impl Facet<Vec<Point>> {
    pub(crate) fn points(&self) -> impl Iterator<Item = &Point> {
        self.series.iter().flat_map(|series| &series.data)
    }
}

impl Look<Vec<Point>> for LineChart {
    fn ranges(&self, facet: &Facet<Vec<Point>>) -> [[f64; 2]; 2] {
        [self.x_range(facet), self.y_range.unwrap_or_else(|| self.y_range_of_data())]
    }

    fn draw(&self, svg: &mut Svg, Series { key, data }: &Series<Vec<Point>>, k: usize, x: &Scale, y: &Scale) {
        if data.is_empty() {
            return;
        }
        let at = |point: &Point, value: f64| [x.pixel(point.x), y.pixel(value)];
        let banded = || data.iter().filter_map(|point| Some((point, point.band?)));
        let upper: Vec<_> = banded().map(|(point, (_, high))| at(point, high)).collect();
        let lower: Vec<_> = banded().map(|(point, (low, _))| at(point, low)).collect();
        let mut band = self.corners(&upper, x, y);
        band.extend(self.corners(&lower, x, y).into_iter().rev());
        if !upper.is_empty() && band.len() > 2 {
            svg.polygon(&band, &format!(r#"fill="{}" fill-opacity="0.16""#, palette::colour(k)));
        }
        let points: Vec<_> = data.iter().map(|point| at(point, point.y)).collect();
        svg.polyline(&self.corners(&points, x, y), &palette::stroke(k));
        if points.len() > MAX_MARKS {
            return;
        }
        for (point, place) in data.iter().zip(points) {
            let band =
                point.band.map_or_else(String::new, |(low, high)| format!(" ({} to {})", digits(low), digits(high)));
            let tip = format!("{key}: {}{band} at {}, n = {}", digits(point.y), trimmed(point.x), point.n);
            open(svg, r#"class="mark""#, &tip);
            svg.circle(place, 8.0, r#"fill="transparent" stroke="none""#);
            svg.circle(place, 2.2, &format!(r#"fill="{}""#, palette::colour(k)));
            close(svg);
        }
    }

    fn sample(&self, svg: &mut Svg, [x, y]: [f64; 2], k: usize) {
        svg.line([x, y], [x + 26.0, y], &palette::stroke(k));
    }
}

/// A number with some three digits.
fn digits(value: f64) -> String {
    in_digits(value, 3)
}

/// One with some five digits, without idle zeros: 0.9995 is not 1.
fn trimmed(value: f64) -> String {
    let text = in_digits(value, 5);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

fn in_digits(value: f64, n: i32) -> String {
    let first = if value == 0.0 { n } else { 1 + value.abs().log10().floor() as i32 };
    format!("{value:.decimals$}", decimals = (n - first).clamp(0, n + 1) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(facets: Vec<Facet<Vec<Point>>>) -> LineChart {
        let (x_range, shape) = (XRange::FromZero, Shape::Straight);
        LineChart {
            x_label: "env steps".into(),
            y_label: "share".into(),
            x_range,
            y_range: Some([0.0, 1.0]),
            shape,
            facets,
        }
    }

    fn line(key: &str, ys: &[f64]) -> Series<Vec<Point>> {
        let point = |(x, y): (u32, &f64)| Point { x: f64::from(x), y: *y, band: Some((y - 0.1, y + 0.1)), n: 3 };
        Series { key: key.into(), data: (0..).zip(ys).map(point).collect() }
    }

    #[test]
    fn equal_keys_look_the_same_in_every_frame() {
        let facet =
            |title: &str| Facet { title: title.into(), series: vec![line("b", &[0.1, 0.2]), line("a", &[0.3, 0.4])] };
        let svg = chart(vec![facet("one"), facet("<two>")]).svg(Breadth::Wide);
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
        assert_eq!([0.9995, 1234.5, 0.15000000000000002].map(trimmed), ["0.9995", "1234.5", "0.15"]);
    }

    #[test]
    fn frames_may_have_their_own_x() {
        let facet = |from: f64| {
            let mut line = line("a", &[0.1, 0.2]);
            line.data.iter_mut().for_each(|point| point.x += from);
            Facet { title: String::new(), series: vec![line] }
        };
        let mut chart = chart(vec![facet(0.0), facet(5.0)]);
        let ranges = |chart: &LineChart| [0, 1].map(|k: usize| chart.x_range(&chart.facets[k]));
        assert_eq!(ranges(&chart), [[0.0, 6.0], [0.0, 6.0]]);
        chart.x_range = XRange::OfFrame([0.0, 10.0]);
        assert_eq!(ranges(&chart), [[-0.05, 1.05], [4.95, 6.05]]);
    }

    #[test]
    fn steps_are_level_until_the_next_score() {
        let point = |x: f64, y: f64, band| Point { x, y, band: Some(band), n: 4 };
        let data = vec![point(0.5, 0.75, (0.5, 1.0)), point(1.0, 0.0, (0.0, 0.0))];
        let facet = Facet { title: String::new(), series: vec![Series { key: String::new(), data }] };
        let steps = LineChart {
            shape: Shape::Steps { before: 1.0 },
            x_range: XRange::OfFrame([0.0, 1.0]),
            ..chart(vec![facet])
        };
        let svg = steps.svg(Breadth::Wide);
        // x: 64 to 604 for 0.475 to 1.025; y: 30 to 280 for 1 to 0. From the left at 1, down to 0.75 at 0.5, down to 0 at 1.
        let line = "64,30 88.55,30 88.55,92.5 579.45,92.5 579.45,280 604,280";
        assert!(svg.contains(&format!(r#"<polyline points="{line}""#)), "{svg}");
        let band = "64,30 88.55,30 88.55,30 579.45,30 579.45,280 604,280 604,280 579.45,280 579.45,155 88.55,155 88.55,30 64,30";
        assert!(svg.contains(&format!(r#"<polygon points="{band}""#)), "{svg}");
    }

    #[test]
    fn frames_stand_below_each_other_where_there_is_little_room() {
        let facets = || {
            ["one", "two", "three"].map(|title| Facet { title: title.into(), series: vec![line(title, &[0.1, 0.2])] })
        };
        let [wide, narrow] = [Breadth::Wide, Breadth::Narrow].map(|breadth| chart(facets().into()).svg(breadth));
        let titles = |svg: &str| -> Vec<(String, String)> {
            let bold = svg.lines().filter(|line| line.contains("bold"));
            let value = |line: &str, of: &str| line.split_once(of).unwrap().1.split('"').next().unwrap().to_owned();
            bold.map(|line| (value(line, "x=\""), value(line, "y=\""))).collect()
        };
        let (wide, narrow) = (titles(&wide), titles(&narrow));
        assert!(wide.iter().all(|(_, y)| *y == wide[0].1) && wide[0].0 != wide[1].0, "{wide:?}");
        assert!(narrow.iter().all(|(x, _)| *x == narrow[0].0) && narrow[0].1 != narrow[1].1, "{narrow:?}");
    }

    #[test]
    fn nothing_and_constants_are_drawn_too() {
        let mut empty = chart(vec![]);
        empty.y_range = None;
        let mut constant = chart(vec![Facet { title: String::new(), series: vec![line("", &[0.0])] }]);
        constant.y_range = None;
        for svg in [empty.svg(Breadth::Wide), constant.svg(Breadth::Narrow)] {
            assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.ends_with("</svg>\n"), "{svg}");
        }
    }
}
