//! Which line or mark is whose.

use crate::plot::svg::{Frame, Svg};

/// Colours that the colour-blind can tell apart (Okabe and Ito, 2008, "Color Universal Design"), without black and yellow,
/// which vanish on one of a page's two grounds.
const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
/// Dashes for lines beyond the colours.
const DASHES: [&str; 4] = ["", "7 3", "2 3", "9 3 2 3"];

/// Shapes of marks.
const N_SHAPES: usize = 6;

/// The colour of line number `k`.
pub(super) fn colour(k: usize) -> &'static str {
    COLOURS[k % COLOURS.len()]
}

/// The stroke of line number `k`: colour and dashes.
pub(super) fn stroke(k: usize) -> String {
    let dashes = DASHES[k / COLOURS.len() % DASHES.len()];
    let dashes = if dashes.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{dashes}""#) };
    format!(r#"fill="none" stroke="{}" stroke-width="2" stroke-linejoin="round"{dashes}"#, colour(k))
}

/// Draws the mark of series number `k`: colour, shape and size, hollow, so that what lies at the same place shows around it or
/// within.
pub(super) fn mark(svg: &mut Svg, [x, y]: [f64; 2], k: usize) {
    let style = format!(r#"fill="none" stroke="{}" stroke-width="1.5" stroke-linejoin="round""#, colour(k));
    let moved = |corners: &[[f64; 2]]| -> Vec<[f64; 2]> { corners.iter().map(|[dx, dy]| [x + dx, y + dy]).collect() };
    // Neighbours differ in shape too, and so do series of one colour.
    match (k + k / COLOURS.len()) % N_SHAPES {
        0 => svg.circle([x, y], 4.2, &style),
        1 => svg.rect(Frame { x: x - 5.0, y: y - 5.0, width: 10.0, height: 10.0 }, &style),
        2 => svg.polygon(&moved(&[[0.0, -8.0], [7.5, 4.8], [-7.5, 4.8]]), &style),
        3 => svg.polygon(&moved(&[[0.0, -8.8], [8.8, 0.0], [0.0, 8.8], [-8.8, 0.0]]), &style),
        4 => svg.polygon(&moved(&[[0.0, 8.0], [7.5, -4.8], [-7.5, -4.8]]), &style),
        _ => {
            let o = [0.0; 2];
            svg.polyline(&moved(&[[-4.5, -4.5], o, [4.5, -4.5], o, [4.5, 4.5], o, [-4.5, 4.5], o]), &style);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_dozen_series_differ() {
        let strokes: std::collections::BTreeSet<_> = (0..24).map(stroke).collect();
        assert_eq!(strokes.len(), 24);
        let marks: std::collections::BTreeSet<_> = (0..24)
            .map(|k| {
                let mut svg = Svg::default();
                mark(&mut svg, [0.0, 0.0], k);
                svg.document(1.0, 1.0)
            })
            .collect();
        assert_eq!(marks.len(), 24);
        assert!(marks.iter().all(|mark| mark.matches(r#"fill="none""#).count() == 1), "hollow");
    }
}
