//! A little SVG, in pixels with y downwards.

use std::fmt::Write;

/// The colour of text and axes.
pub(crate) const INK: &str = "#222222";
/// The colour of grid lines.
pub(crate) const GRID: &str = "#e4e4e4";

/// Where a text stands relative to its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A rectangle in pixels; `x`, `y` is its upper left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Frame {
    pub(crate) fn right(&self) -> f64 {
        self.x + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.y + self.height
    }
}

/// The elements of a picture, in the order in which they cover each other.
#[derive(Debug, Default)]
pub(crate) struct Svg {
    body: String,
}

impl Svg {
    /// Adds an element, or the start or end of one.
    pub(crate) fn raw(&mut self, element: &str) {
        self.body.push_str(element);
        self.body.push('\n');
    }

    /// A straight line; `style` holds further attributes, as in all that follow.
    pub(crate) fn line(&mut self, from: [f64; 2], to: [f64; 2], style: &str) {
        let ([x1, y1], [x2, y2]) = (from.map(number), to.map(number));
        self.raw(&format!(r#"<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" {style}/>"#));
    }

    pub(crate) fn rect(&mut self, frame: Frame, style: &str) {
        let [x, y, width, height] = [frame.x, frame.y, frame.width, frame.height].map(number);
        self.raw(&format!(r#"<rect x="{x}" y="{y}" width="{width}" height="{height}" {style}/>"#));
    }

    pub(crate) fn circle(&mut self, centre: [f64; 2], radius: f64, style: &str) {
        let ([cx, cy], r) = (centre.map(number), number(radius));
        self.raw(&format!(r#"<circle cx="{cx}" cy="{cy}" r="{r}" {style}/>"#));
    }

    pub(crate) fn polygon(&mut self, points: &[[f64; 2]], style: &str) {
        self.raw(&format!(r#"<polygon points="{}" {style}/>"#, list(points)));
    }

    pub(crate) fn polyline(&mut self, points: &[[f64; 2]], style: &str) {
        self.raw(&format!(r#"<polyline points="{}" {style}/>"#, list(points)));
    }

    pub(crate) fn text(&mut self, [x, y]: [f64; 2], anchor: Anchor, style: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let ([x, y], text) = ([x, y].map(number), escaped(text));
        self.raw(&format!(r#"<text x="{x}" y="{y}" text-anchor="{anchor}" {style}>{text}</text>"#));
    }

    /// A text that reads upwards, centred at a position.
    pub(crate) fn text_upwards(&mut self, [x, y]: [f64; 2], text: &str) {
        let style = format!(r#"transform="rotate(-90 {} {})""#, number(x), number(y));
        self.text([x, y], Anchor::Middle, &style, text);
    }

    /// The whole document, on white.
    pub(crate) fn document(&self, width: f64, height: f64) -> String {
        let [width, height] = [width, height].map(number);
        format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif" font-size="12" fill="{INK}">
<rect width="100%" height="100%" fill="white"/>
{}</svg>
"#,
            self.body
        )
    }
}

/// A number in hundredths of a pixel, without idle zeros.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn list(points: &[[f64; 2]]) -> String {
    points.iter().fold(String::new(), |mut list, [x, y]| {
        let gap = if list.is_empty() { "" } else { " " };
        // Writing to a string cannot fail.
        let _ = write!(list, "{gap}{},{}", number(*x), number(*y));
        list
    })
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.0, -0.001, 1.0, 2.5, 3.456, -120.0].map(number), ["0", "0", "1", "2.5", "3.46", "-120"]);
    }

    #[test]
    fn text_is_escaped() {
        let mut svg = Svg::default();
        svg.text([1.0, 2.0], Anchor::End, "", "a < b & c");
        assert_eq!(svg.body, "<text x=\"1\" y=\"2\" text-anchor=\"end\" >a &lt; b &amp; c</text>\n");
    }
}
