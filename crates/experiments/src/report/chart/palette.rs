//! Which line is whose.

/// Colours that the colour-blind can tell apart (Okabe and Ito, 2008, "Color Universal Design"), without black and yellow,
/// which vanish on one of a page's two grounds.
const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
/// Dashes for lines beyond the colours.
const DASHES: [&str; 4] = ["", "7 3", "2 3", "9 3 2 3"];

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_dozen_lines_differ() {
        let strokes: std::collections::BTreeSet<_> = (0..24).map(stroke).collect();
        assert_eq!(strokes.len(), 24);
    }
}
