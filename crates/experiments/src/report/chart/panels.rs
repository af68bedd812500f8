//! Frames beside each other, whose series share their keys, and the legend below.

use super::{BOLD, Breadth, NARROW_WIDTH, axes, close, open, text_width};
use crate::plot::scale::Scale;
use crate::plot::svg::{Anchor, Frame, INK, Svg};

/// One frame.
#[derive(Debug)]
pub(crate) struct Facet<T> {
    /// What stands above it, if anything.
    pub(crate) title: String,
    pub(crate) series: Vec<Series<T>>,
}

/// What is drawn of one cell. Series with equal keys look the same in all frames.
#[derive(Debug)]
pub(crate) struct Series<T> {
    pub(crate) key: String,
    pub(crate) data: T,
}

/// How series look.
pub(super) trait Look<T> {
    /// The ends of the axes of a frame, x and y.
    fn ranges(&self, facet: &Facet<T>) -> [[f64; 2]; 2];
    /// Draws series number `k`.
    fn draw(&self, svg: &mut Svg, series: &Series<T>, k: usize, x: &Scale, y: &Scale);
    /// Draws a sample of series number `k`, 26 pixels wide from a place.
    fn sample(&self, svg: &mut Svg, from: [f64; 2], k: usize);
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

/// The frames with the labels of their axes, as SVG.
pub(super) fn svg<T>(
    facets: &[Facet<T>],
    [x_label, y_label]: [&str; 2],
    look: &impl Look<T>,
    breadth: Breadth,
) -> String {
    let mut svg = Svg::default();
    let (n_columns, width) = match (breadth, facets.len()) {
        (Breadth::Narrow, _) => (1, NARROW_WIDTH),
        (Breadth::Wide, 1) => (1, LONE_WIDTH),
        (Breadth::Wide, n) => (n_columns(n), WIDTH),
    };
    let column = (width - 16.0) / n_columns as f64;
    let row = TOP + FRAME_HEIGHT + BOTTOM;
    let keys = keys(facets);
    for (place, facet) in facets.iter().enumerate() {
        let (x, y) = ((place % n_columns) as f64 * column + LEFT, (place / n_columns) as f64 * row + TOP);
        let frame = Frame { x, y, width: column - LEFT, height: FRAME_HEIGHT };
        let [x, y] = look.ranges(facet);
        let (x, y) = (Scale::new(x, [frame.x, frame.right()]), Scale::new(y, [frame.bottom(), frame.y]));
        axes(&mut svg, frame, &x, &y);
        svg.text([frame.x + frame.width / 2.0, frame.y - 10.0], Anchor::Middle, BOLD, &facet.title);
        svg.text([frame.x + frame.width / 2.0, frame.bottom() + 36.0], Anchor::Middle, "", x_label);
        svg.text_upwards([frame.x - 46.0, frame.y + frame.height / 2.0], y_label);
        for series in &facet.series {
            let k = keys.iter().position(|key| *key == series.key).unwrap_or(0);
            open(&mut svg, &format!(r#"class="series" data-key="{k}""#), "");
            look.draw(&mut svg, series, k, &x, &y);
            close(&mut svg);
        }
    }
    let legend = facets.len().div_ceil(n_columns).max(1) as f64 * row;
    let height = draw_legend(&mut svg, &keys, look, legend, width);
    svg.document(width, height)
}

/// The keys of all series, each once, in the order in which they come.
fn keys<T>(facets: &[Facet<T>]) -> Vec<&str> {
    let mut keys = Vec::new();
    for series in facets.iter().flat_map(|facet| &facet.series) {
        if !keys.contains(&series.key.as_str()) {
            keys.push(&series.key);
        }
    }
    keys
}

/// How many frames of `n` stand beside each other: as many as leave the fewest places empty.
fn n_columns(n: usize) -> usize {
    let n_empty = |columns: &usize| n.next_multiple_of(*columns) - n;
    (1..=MAX_COLUMNS.min(n.max(1))).rev().filter(|columns| *columns > 1 || n < 2).min_by_key(n_empty).unwrap_or(1)
}

/// Draws a sample of each series with its key, below the frames; where the picture ends.
fn draw_legend<T>(svg: &mut Svg, keys: &[&str], look: &impl Look<T>, top: f64, width: f64) -> f64 {
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
        look.sample(svg, [x, y], k);
        svg.text([x + 33.0, y + 4.0], Anchor::Start, &format!(r#"fill="{INK}""#), key);
        close(svg);
        x += wanted;
    }
    y + KEY_HEIGHT
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_fill_their_rows() {
        assert_eq!([0, 1, 2, 3, 4, 5, 6, 8].map(n_columns), [1, 1, 2, 3, 2, 3, 3, 2]);
    }
}
