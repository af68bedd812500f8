//! Lines with bands, in one frame or in several beside each other.

use super::panels::{self, Facet, Look, Series};
use super::{close, open, padded, palette};
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
    pub(crate) facets: Vec<Facet<Vec<Point>>>,
}

/// What the x axes show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum XRange {
    /// From zero to the greatest x of any frame, the same in all.
    FromZero,
    /// From the least x of a frame to its greatest, frame by frame.
    OfFrame,
}

/// Most points of a line whose points are marked.
const MAX_MARKS: usize = 40;

impl LineChart {
    /// The chart as SVG.
    pub(crate) fn svg(&self) -> String {
        panels::svg(&self.facets, [&self.x_label, &self.y_label], self)
    }

    fn points(&self) -> impl Iterator<Item = &Point> {
        self.facets.iter().flat_map(Facet::points)
    }

    fn x_range(&self, facet: &Facet<Vec<Point>>) -> [f64; 2] {
        let greatest =
            |points: &mut dyn Iterator<Item = &Point>| points.map(|point| point.x).fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = match self.x_range {
            XRange::FromZero => (0.0, greatest(&mut self.points())),
            XRange::OfFrame => {
                (facet.points().map(|point| point.x).fold(f64::INFINITY, f64::min), greatest(&mut facet.points()))
            }
        };
        if high > low { [low, high] } else { [0.0, 1.0] }
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
        let upper = banded().map(|(point, (_, high))| at(point, high));
        let lower = banded().rev().map(|(point, (low, _))| at(point, low));
        let band: Vec<_> = upper.chain(lower).collect();
        if band.len() > 2 {
            svg.polygon(&band, &format!(r#"fill="{}" fill-opacity="0.16""#, palette::colour(k)));
        }
        let points: Vec<_> = data.iter().map(|point| at(point, point.y)).collect();
        svg.polyline(&points, &palette::stroke(k));
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
    let decimals = if value == 0.0 { 0.0 } else { (2.0 - value.abs().log10().floor()).clamp(0.0, 4.0) } as usize;
    format!("{value:.decimals$}")
}

/// The same without idle zeros.
fn trimmed(value: f64) -> String {
    let text = digits(value);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(facets: Vec<Facet<Vec<Point>>>) -> LineChart {
        let x_range = XRange::FromZero;
        LineChart { x_label: "env steps".into(), y_label: "share".into(), x_range, y_range: Some([0.0, 1.0]), facets }
    }

    fn line(key: &str, ys: &[f64]) -> Series<Vec<Point>> {
        let point = |(x, y): (u32, &f64)| Point { x: f64::from(x), y: *y, band: Some((y - 0.1, y + 0.1)), n: 3 };
        Series { key: key.into(), data: (0..).zip(ys).map(point).collect() }
    }

    #[test]
    fn equal_keys_look_the_same_in_every_frame() {
        let facet =
            |title: &str| Facet { title: title.into(), series: vec![line("b", &[0.1, 0.2]), line("a", &[0.3, 0.4])] };
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
    fn frames_may_have_their_own_x() {
        let facet = |from: f64| {
            let mut line = line("a", &[0.1, 0.2]);
            line.data.iter_mut().for_each(|point| point.x += from);
            Facet { title: String::new(), series: vec![line] }
        };
        let mut chart = chart(vec![facet(0.0), facet(5.0)]);
        let ranges = |chart: &LineChart| [0, 1].map(|k: usize| chart.x_range(&chart.facets[k]));
        assert_eq!(ranges(&chart), [[0.0, 6.0], [0.0, 6.0]]);
        chart.x_range = XRange::OfFrame;
        assert_eq!(ranges(&chart), [[0.0, 1.0], [5.0, 6.0]]);
    }

    #[test]
    fn nothing_and_constants_are_drawn_too() {
        let mut empty = chart(vec![]);
        empty.y_range = None;
        let mut constant = chart(vec![Facet { title: String::new(), series: vec![line("", &[0.0])] }]);
        constant.y_range = None;
        for svg in [empty.svg(), constant.svg()] {
            assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.ends_with("</svg>\n"), "{svg}");
        }
    }
}
