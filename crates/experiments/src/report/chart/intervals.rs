//! Means with their intervals: a row per cell, a column per metric.

use super::{BOLD, MUTED, close, open, padded, palette, text_width};
use crate::plot::scale::Scale;
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
    /// Whether the axis runs from 0 to `Some` end whatever the values.
    pub(crate) top: Option<f64>,
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

const WIDTH: f64 = 960.0;
const ROW: f64 = 24.0;
const TOP: f64 = 44.0;
const BOTTOM: f64 = 26.0;
const GAP: f64 = 26.0;

impl IntervalChart {
    /// The chart as SVG.
    pub(crate) fn svg(&self) -> String {
        let mut svg = Svg::default();
        let labels = self.rows.iter().map(|row| text_width(row)).fold(60.0, f64::max).min(380.0) + 14.0;
        let height = ROW * self.rows.len() as f64;
        for (k, row) in self.rows.iter().enumerate() {
            let y = TOP + (k as f64 + 0.5) * ROW;
            svg.line([labels, y], [WIDTH - 12.0, y], &format!(r#"stroke="{GRID}" stroke-dasharray="1 3""#));
            svg.text([labels - 12.0, y + 4.0], Anchor::End, "", row);
        }
        let width = (WIDTH - labels - 12.0) / self.columns.len().max(1) as f64;
        for (k, column) in self.columns.iter().enumerate() {
            let x = labels + k as f64 * width + GAP / 2.0;
            column.draw(&mut svg, Frame { x, y: TOP, width: width - GAP, height });
        }
        svg.document(WIDTH, TOP + height + BOTTOM)
    }
}

impl Column {
    fn draw(&self, svg: &mut Svg, frame: Frame) {
        let scale = Scale::new(self.range(), [frame.x, frame.right()]);
        let middle = frame.x + frame.width / 2.0;
        svg.text([middle, frame.y - 26.0], Anchor::Middle, BOLD, &self.title);
        svg.text([middle, frame.y - 11.0], Anchor::Middle, &format!(r#"fill="{MUTED}" font-size="11""#), &self.unit);
        for (value, label) in scale.ticks((frame.width / 48.0).max(2.0) as usize) {
            let x = scale.pixel(value);
            svg.line([x, frame.y], [x, frame.bottom()], &format!(r#"stroke="{GRID}""#));
            svg.text([x, frame.bottom() + 16.0], Anchor::Middle, r#"font-size="11""#, &label);
        }
        svg.line([frame.x, frame.bottom()], [frame.right(), frame.bottom()], &format!(r#"stroke="{INK}""#));
        for (k, bar) in self.bars.iter().enumerate() {
            let y = frame.y + (k as f64 + 0.5) * ROW;
            match bar {
                Some(bar) => bar.draw(svg, y, &scale),
                None => svg.text([frame.x + 2.0, y + 4.0], Anchor::Start, &format!(r#"fill="{MUTED}""#), "\u{2013}"),
            }
        }
    }

    fn range(&self) -> [f64; 2] {
        if let Some(top) = self.top {
            return [0.0, top];
        }
        let ends = |bar: &Bar| {
            let (low, high) = bar.interval.unwrap_or((bar.mean, bar.mean));
            bar.units.iter().fold((low, high), |(low, high), unit| (low.min(*unit), high.max(*unit)))
        };
        let ends: Vec<_> = self.bars.iter().flatten().map(ends).collect();
        let low = ends.iter().map(|(low, _)| *low).fold(f64::INFINITY, f64::min);
        let high = ends.iter().map(|(_, high)| *high).fold(f64::NEG_INFINITY, f64::max);
        padded(low, high)
    }
}

impl Bar {
    fn draw(&self, svg: &mut Svg, y: f64, scale: &Scale) {
        let colour = palette::colour(0);
        open(svg, r#"class="mark""#, &self.tip);
        let all = self.units.iter().copied().chain(self.interval.into_iter().flat_map(|(low, high)| [low, high]));
        let (low, high) = all.fold((self.mean, self.mean), |(low, high), value| (low.min(value), high.max(value)));
        let (left, right) = (scale.pixel(low) - 8.0, scale.pixel(high) + 8.0);
        let area = Frame { x: left, y: y - 11.0, width: right - left, height: 22.0 };
        svg.rect(area, r#"fill="transparent" stroke="none""#);
        for unit in &self.units {
            svg.circle([scale.pixel(*unit), y], 2.6, &format!(r#"fill="{MUTED}" fill-opacity="0.45""#));
        }
        if let Some((low, high)) = self.interval {
            let style = format!(r#"stroke="{colour}" stroke-width="3" stroke-linecap="round""#);
            svg.line([scale.pixel(low), y], [scale.pixel(high), y], &style);
        }
        svg.circle([scale.pixel(self.mean), y], 4.6, &format!(r#"fill="{colour}" stroke="white" stroke-width="1.2""#));
        close(svg);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_stand_where_their_values_are() {
        let bar = Bar { mean: 50.0, interval: Some((25.0, 75.0)), units: vec![0.0, 100.0], tip: "a & b".into() };
        let column =
            Column { title: "success".into(), unit: "%".into(), bars: vec![Some(bar), None], top: Some(100.0) };
        let svg = IntervalChart { rows: vec!["one".into(), "<two>".into()], columns: vec![column] }.svg();
        assert!(svg.contains("a &amp; b") && svg.contains("&lt;two&gt;"));
        // From 74 + 13 to 948 - 13: 848 pixels of 100 %.
        assert!(svg.contains(r##"<line x1="299" y1="56" x2="723" y2="56" stroke="#0072b2""##), "{svg}");
        assert!(svg.contains(r#"<circle cx="511" cy="56" r="4.6""#), "{svg}");
        assert!(svg.contains(">\u{2013}</text>"), "undefined is said");
    }

    #[test]
    fn nothing_is_drawn_too() {
        let column = Column { title: "speed".into(), unit: "m/s".into(), bars: vec![None], top: None };
        let svg = IntervalChart { rows: vec!["one".into()], columns: vec![column] }.svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert!(IntervalChart { rows: vec![], columns: vec![] }.svg().ends_with("</svg>\n"));
    }
}
