//! One value against another: a mark per cell, with the intervals of both.

use super::panels::{self, Facet, Look, Series};
use super::{Breadth, close, open, palette};
use crate::plot::scale::Scale;
use crate::plot::svg::Svg;

/// Marks in frames with common scales.
#[derive(Debug)]
pub(crate) struct ScatterChart {
    pub(crate) x_label: String,
    pub(crate) y_label: String,
    /// The upper end of the y axis, which starts at 0.
    pub(crate) y_top: f64,
    /// `None` where a value is undefined.
    pub(crate) facets: Vec<Facet<Option<Spot>>>,
}

/// A mark.
#[derive(Debug)]
pub(crate) struct Spot {
    /// Where it is, x and y.
    pub(crate) at: [f64; 2],
    /// The intervals of both.
    pub(crate) bands: [Option<(f64, f64)>; 2],
    /// What a pointer is told.
    pub(crate) tip: String,
}

impl ScatterChart {
    /// The chart as SVG.
    pub(crate) fn svg(&self, breadth: Breadth) -> String {
        panels::svg(&self.facets, [&self.x_label, &self.y_label], self, breadth)
    }
}

impl Look<Option<Spot>> for ScatterChart {
    /// The same in all frames: x from 0, y a little beyond both ends, where many marks lie.
    fn ranges(&self, _: &Facet<Option<Spot>>) -> [[f64; 2]; 2] {
        let spots = self.facets.iter().flat_map(|facet| &facet.series).filter_map(|series| series.data.as_ref());
        let high = spots.map(|spot| spot.bands[0].map_or(spot.at[0], |(_, high)| high)).fold(0.0, f64::max);
        [[0.0, if high > 0.0 { 1.08 * high } else { 1.0 }], [-0.04 * self.y_top, 1.04 * self.y_top]]
    }

    fn draw(&self, svg: &mut Svg, series: &Series<Option<Spot>>, k: usize, x: &Scale, y: &Scale) {
        let Some(Spot { at, bands, tip }) = &series.data else { return };
        let place = [x.pixel(at[0]), y.pixel(at[1])];
        let style = format!(r#"stroke="{}" stroke-width="1.4" stroke-opacity="0.75""#, palette::colour(k));
        open(svg, r#"class="mark""#, tip);
        svg.circle(place, 9.0, r#"fill="transparent" stroke="none""#);
        if let Some((low, high)) = bands[0] {
            svg.line([x.pixel(low), place[1]], [x.pixel(high), place[1]], &style);
        }
        if let Some((low, high)) = bands[1] {
            svg.line([place[0], y.pixel(low)], [place[0], y.pixel(high)], &style);
        }
        palette::mark(svg, place, k);
        close(svg);
    }

    fn sample(&self, svg: &mut Svg, [x, y]: [f64; 2], k: usize) {
        palette::mark(svg, [x + 18.0, y], k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(facets: Vec<Facet<Option<Spot>>>) -> String {
        ScatterChart { x_label: "speed".into(), y_label: "success".into(), y_top: 100.0, facets }.svg(Breadth::Wide)
    }

    #[test]
    fn marks_stand_where_their_values_are() {
        let spot = |tip: &str| Spot { at: [1.0, 50.0], bands: [Some((0.5, 2.0)), None], tip: tip.into() };
        let series = |key: &str, data| Series { key: key.into(), data };
        let facet = Facet { title: "<P>".into(), series: vec![series("a", Some(spot("a & b"))), series("b", None)] };
        let svg = chart(vec![facet]);
        assert!(svg.contains("a &amp; b") && svg.contains("&lt;P&gt;"));
        // x: 64 to 604 for 0 to 2.16, so that 1 m/s is 250 pixels; y: 50 is the middle of 30 to 280.
        assert!(svg.contains(r#"<circle cx="314" cy="155" r="4.2""#), "{svg}");
        assert!(svg.contains(r##"<line x1="189" y1="155" x2="564" y2="155" stroke="#0072b2""##), "{svg}");
        assert_eq!(svg.matches(r#"class="mark""#).count(), 1);
        assert_eq!(svg.matches(r#"class="key""#).count(), 2, "what is undefined has its key all the same");
    }

    #[test]
    fn what_lies_at_one_place_is_seen_all_the_same() {
        let spot = || Some(Spot { at: [1.0, 50.0], bands: [None, None], tip: String::new() });
        let series = |key: &str| Series { key: key.into(), data: spot() };
        let svg = chart(vec![Facet { title: String::new(), series: vec![series("a"), series("b"), series("c")] }]);
        let (_, frame) = svg.split_once(r#"class="series""#).unwrap();
        let (frame, _) = frame.split_once(r#"class="key""#).unwrap();
        // A circle, a square and a triangle, and nothing that is filled but what takes the pointer.
        let marks: Vec<&str> = frame.lines().filter(|line| line.contains("stroke-width=\"1.5\"")).collect();
        assert!(
            ["<circle", "<rect", "<polygon"].iter().zip(&marks).all(|(shape, mark)| mark.starts_with(shape)),
            "{marks:?}"
        );
        let filled = frame.lines().filter(|line| line.contains("fill=") && !line.contains("fill=\"none\""));
        assert!(filled.clone().count() == 3 && filled.clone().all(|line| line.contains("transparent")), "{frame}");
    }

    #[test]
    fn nothing_is_drawn_too() {
        let none = Facet { title: String::new(), series: vec![Series { key: String::new(), data: None }] };
        for svg in [chart(vec![]), chart(vec![none])] {
            assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.ends_with("</svg>\n"), "{svg}");
        }
    }
}
