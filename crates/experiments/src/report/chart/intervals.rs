//! Means with their intervals: a row per cell, a column per metric.

use super::{BOLD, Breadth, MUTED, NARROW_WIDTH, close, fitted, open, palette, text_width};
use crate::plot::scale::{Scale, round_step};
use crate::plot::svg::{Anchor, Frame, GRID, INK, Svg};

/// Means with their intervals side by side.
#[derive(Debug)]
pub(crate) struct IntervalChart {
    /// What each row is about.
    pub(crate) rows: Vec<String>,
    pub(crate) columns: Vec<Column>,
}

/// One metric in every row.
#[derive(Debug)]
pub(crate) struct Column {
    /// Its name, and the unit of its axis.
    pub(crate) title: String,
    pub(crate) unit: String,
    /// One per row; `None` where it is undefined.
    pub(crate) bars: Vec<Option<Bar>>,
    /// What no value of it lies beyond.
    pub(crate) bounds: [f64; 2],
}

/// A mean, in the axis's unit.
#[derive(Debug)]
pub(crate) struct Bar {
    pub(crate) mean: f64,
    pub(crate) interval: Option<(f64, f64)>,
    /// The values that it is a mean of.
    pub(crate) units: Vec<f64>,
    /// What a pointer is told.
    pub(crate) tip: String,
}

/// Where the parts of a chart stand, pixels.
struct Layout {
    width: f64,
    /// Most columns beside each other.
    n_columns: usize,
    /// Where the columns begin.
    left: f64,
    /// Height of a row.
    row: f64,
    /// Where a row's bars stand in it, and the foot of its label.
    middle: f64,
    label: f64,
    /// The label's place, and which of its ends is there.
    anchor: (f64, Anchor),
}

const WIDTH: f64 = 960.0;
const TOP: f64 = 44.0;
const BOTTOM: f64 = 26.0;
const GAP: f64 = 26.0;
/// Half the height of the tick at a mean, and how far below it its units stand.
const TICK: f64 = 6.0;
const UNITS: f64 = 8.5;
/// Least distance of an axis's labels.
const LABEL: f64 = 44.0;
/// Most steps between the round values of an axis, before its ends are rounded.
const MAX_STEPS: f64 = 6.0;

impl Layout {
    /// Labels stand beside their rows, or, where there is little room, above them.
    fn new(breadth: Breadth, rows: &[String], n_columns: usize) -> Self {
        let labels = rows.iter().map(|row| text_width(row)).fold(60.0, f64::max).min(380.0) + 14.0;
        let (beside, above) = ((labels - 12.0, Anchor::End), (12.0, Anchor::Start));
        match breadth {
            Breadth::Wide => {
                Self { width: WIDTH, n_columns, left: labels, row: 24.0, middle: 12.0, label: 16.0, anchor: beside }
            }
            Breadth::Narrow => Self {
                width: NARROW_WIDTH,
                n_columns: n_columns.min(3),
                left: 0.0,
                row: 40.0,
                middle: 24.0,
                label: 13.0,
                anchor: above,
            },
        }
    }
}

impl IntervalChart {
    /// The chart as SVG.
    pub(crate) fn svg(&self, breadth: Breadth) -> String {
        let mut svg = Svg::default();
        let layout = Layout::new(breadth, &self.rows, self.columns.len().max(1));
        let height = layout.row * self.rows.len() as f64;
        let block = TOP + height + BOTTOM;
        let mut top = 0.0;
        for columns in self.columns.chunks(layout.n_columns) {
            self.draw_guides(&mut svg, top + TOP, &layout);
            let width = (layout.width - layout.left - 12.0) / columns.len() as f64;
            for (k, column) in columns.iter().enumerate() {
                let x = layout.left + k as f64 * width + GAP / 2.0;
                column.draw(&mut svg, Frame { x, y: top + TOP, width: width - GAP, height }, &layout);
            }
            self.draw_names(&mut svg, top + TOP, &layout);
            top += block;
        }
        svg.document(layout.width, top.max(block))
    }

    fn draw_guides(&self, svg: &mut Svg, top: f64, layout: &Layout) {
        for k in 0..self.rows.len() {
            let y = top + k as f64 * layout.row + layout.middle;
            svg.line([layout.left, y], [layout.width - 12.0, y], &format!(r#"stroke="{GRID}" stroke-dasharray="1 3""#));
        }
    }

    /// What the rows are about, over the lines that cross it.
    fn draw_names(&self, svg: &mut Svg, top: f64, layout: &Layout) {
        let (x, anchor) = layout.anchor;
        for (k, row) in self.rows.iter().enumerate() {
            let y = top + k as f64 * layout.row + layout.label;
            svg.text([x, y], anchor, r#"stroke="white" stroke-width="4" paint-order="stroke""#, row);
        }
    }
}

impl Column {
    fn draw(&self, svg: &mut Svg, frame: Frame, layout: &Layout) {
        let (range, step) = self.range();
        let scale = Scale::new(range, [frame.x, frame.right()]);
        let middle = frame.x + frame.width / 2.0;
        svg.text([middle, frame.y - 26.0], Anchor::Middle, BOLD, &self.title);
        svg.text([middle, frame.y - 11.0], Anchor::Middle, &format!(r#"fill="{MUTED}" font-size="11""#), &self.unit);
        let n_steps = ((range[1] - range[0]) / step).round() as usize;
        for k in 0..=n_steps {
            let x = scale.pixel(range[0] + k as f64 * step);
            svg.line([x, frame.y], [x, frame.bottom()], &format!(r#"stroke="{GRID}""#));
        }
        draw_labels(svg, &scale, frame.bottom() + 16.0, range, step);
        svg.line([frame.x, frame.bottom()], [frame.right(), frame.bottom()], &format!(r#"stroke="{INK}""#));
        for (k, bar) in self.bars.iter().enumerate() {
            let y = frame.y + k as f64 * layout.row + layout.middle;
            match bar {
                Some(bar) => bar.draw(svg, y, &scale),
                None => svg.text([frame.x + 2.0, y + 4.0], Anchor::Start, &format!(r#"fill="{MUTED}""#), "\u{2013}"),
            }
        }
    }

    /// The ends of the axis, round values just beyond all that it shows, and the step between its round values.
    fn range(&self) -> ([f64; 2], f64) {
        let ends = |bar: &Bar| {
            let (low, high) = bar.interval.unwrap_or((bar.mean, bar.mean));
            bar.units.iter().fold((low, high), |(low, high), unit| (low.min(*unit), high.max(*unit)))
        };
        let ends: Vec<_> = self.bars.iter().flatten().map(ends).collect();
        let low = ends.iter().map(|(low, _)| *low).fold(f64::INFINITY, f64::min);
        let high = ends.iter().map(|(_, high)| *high).fold(f64::NEG_INFINITY, f64::max);
        let [low, high] = fitted(low, high, self.bounds);
        let step = round_step((high - low) / MAX_STEPS);
        ([(low / step + 1e-9).floor() * step, (high / step - 1e-9).ceil() * step], step)
    }
}

/// Labels both ends of an axis, within it, and as many of the round values between as there is room for at equal distances.
fn draw_labels(svg: &mut Svg, scale: &Scale, y: f64, [low, high]: [f64; 2], step: f64) {
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let n_steps = ((high - low) / step).round() as usize;
    let between = scale.pixel(low + step) - scale.pixel(low);
    let has_room = |stride: &usize| n_steps.is_multiple_of(*stride) && *stride as f64 * between >= LABEL;
    let stride = (1..=n_steps).find(has_room).unwrap_or(n_steps.max(1));
    for k in (0..=n_steps).step_by(stride) {
        let anchor = match k {
            0 => Anchor::Start,
            k if k == n_steps => Anchor::End,
            _ => Anchor::Middle,
        };
        let value = low + k as f64 * step;
        svg.text([scale.pixel(value), y], anchor, r#"font-size="11""#, &format!("{value:.decimals$}"));
    }
}

impl Bar {
    /// A tick at the mean, the interval as a bar that shows beneath it, and the units below both.
    fn draw(&self, svg: &mut Svg, y: f64, scale: &Scale) {
        let colour = palette::colour(0);
        open(svg, r#"class="mark interval""#, &self.tip);
        let all = self.units.iter().copied().chain(self.interval.into_iter().flat_map(|(low, high)| [low, high]));
        let (low, high) = all.fold((self.mean, self.mean), |(low, high), value| (low.min(value), high.max(value)));
        let (left, right) = (scale.pixel(low) - 8.0, scale.pixel(high) + 8.0);
        let area = Frame { x: left, y: y - 11.0, width: right - left, height: 22.0 };
        svg.rect(area, r#"fill="transparent" stroke="none""#);
        for unit in &self.units {
            svg.circle([scale.pixel(*unit), y + UNITS], 1.9, &format!(r#"fill="{MUTED}" fill-opacity="0.5""#));
        }
        if let Some((low, high)) = self.interval {
            let style = format!(r#"stroke="{colour}" stroke-width="6" stroke-opacity="0.4""#);
            svg.line([scale.pixel(low), y], [scale.pixel(high), y], &style);
        }
        let x = scale.pixel(self.mean);
        svg.line([x, y - TICK], [x, y + TICK], &format!(r#"stroke="{colour}" stroke-width="1.6""#));
        close(svg);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(means: &[f64], bounds: [f64; 2]) -> Column {
        let bar = |mean: &f64| Some(Bar { mean: *mean, interval: None, units: vec![], tip: String::new() });
        Column { title: "success".into(), unit: "%".into(), bars: means.iter().map(bar).collect(), bounds }
    }

    #[test]
    fn bars_stand_where_their_values_are() {
        let bar = Bar { mean: 50.0, interval: Some((25.0, 75.0)), units: vec![0.0, 100.0], tip: "a & b".into() };
        let column = Column { bars: vec![Some(bar), None], ..column(&[], [0.0, 100.0]) };
        let chart = IntervalChart { rows: vec!["one".into(), "<two>".into()], columns: vec![column] };
        let svg = chart.svg(Breadth::Wide);
        assert!(svg.contains("a &amp; b") && svg.contains("&lt;two&gt;"));
        // From 74 + 13 to 948 - 13: 848 pixels of 100 %.
        assert!(svg.contains(r##"<line x1="299" y1="56" x2="723" y2="56" stroke="#0072b2""##), "{svg}");
        assert!(svg.contains(r#"<line x1="511" y1="50" x2="511" y2="62""#), "{svg}");
        assert!(svg.contains(r#"<circle cx="935" cy="64.5" r="1.9""#), "{svg}");
        assert!(svg.contains(">\u{2013}</text>"), "undefined is said");
    }

    #[test]
    fn axes_fit_what_they_show_and_end_at_round_values() {
        let range = |means: &[f64], bounds| column(means, bounds).range();
        let (percent, open) = ([0.0, 100.0], [0.0, f64::INFINITY]);
        assert_eq!(range(&[0.1, 3.0], percent), ([0.0, 3.0], 0.5));
        assert_eq!(range(&[0.0, 99.8], percent), ([0.0, 100.0], 20.0));
        let ([low, high], step) = range(&[99.9, 100.0], percent);
        assert!((low - 99.0).abs() < 1e-9 && (high - 100.0).abs() < 1e-9 && step == 0.2);
        assert_eq!(range(&[0.5, 11.2], open), ([0.0, 12.0], 2.0));
        assert_eq!(range(&[], percent), ([0.0, 100.0], 20.0));
        let svg = IntervalChart { rows: vec!["a".into(), "b".into()], columns: vec![column(&[0.1, 3.0], percent)] }
            .svg(Breadth::Wide);
        let texts = svg.lines().filter(|line| line.contains(r#"y="108""#));
        let labels: Vec<_> =
            texts.map(|line| line.split_once('>').unwrap().1.strip_suffix("</text>").unwrap()).collect();
        assert_eq!(labels, ["0.0", "0.5", "1.0", "1.5", "2.0", "2.5", "3.0"]);
        let six = IntervalChart {
            rows: vec!["a".into(), "b".into()],
            columns: (0..6).map(|_| column(&[0.1, 3.0], percent)).collect(),
        };
        assert_eq!(six.svg(Breadth::Wide).matches(r#" y="108""#).count(), 18, "room for the ends and the middle");
    }

    #[test]
    fn narrow_charts_stack_what_wide_ones_have_side_by_side() {
        let columns = || (0..6).map(|_| column(&[0.0, 100.0], [0.0, 100.0])).collect();
        let chart = IntervalChart { rows: vec!["a name of many words".into(); 2], columns: columns() };
        let [wide, narrow] = [Breadth::Wide, Breadth::Narrow].map(|breadth| chart.svg(breadth));
        assert!(wide.contains(r#"width="960" height="118""#), "{wide}");
        assert!(narrow.contains(r#"width="400" height="300""#), "two blocks of three columns: {narrow}");
        assert_eq!([&wide, &narrow].map(|svg| svg.matches("a name of many words").count()), [2, 4]);
        assert_eq!([&wide, &narrow].map(|svg| svg.matches(r#"class="mark interval""#).count()), [12, 12]);
    }

    #[test]
    fn nothing_is_drawn_too() {
        for breadth in [Breadth::Wide, Breadth::Narrow] {
            let nothing = Column { bars: vec![None], ..column(&[], [0.0, f64::INFINITY]) };
            let svg = IntervalChart { rows: vec!["one".into()], columns: vec![nothing] }.svg(breadth);
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
            assert!(IntervalChart { rows: vec![], columns: vec![] }.svg(breadth).ends_with("</svg>\n"));
        }
    }
}
