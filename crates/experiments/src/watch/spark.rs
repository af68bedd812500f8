//! Curves in a line of text.

/// The heights that a character can show.
const LEVELS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// A curve as a line of at most `width` characters, from its least value to its greatest; each character stands for the mean of an
/// equal share of the values. What is not finite is left out.
///
/// ```
/// use headway_experiments::watch::sparkline;
/// assert_eq!(sparkline(&[0.0, 1.0, 2.0, 7.0], 8), "▁▂▃█");
/// assert_eq!(sparkline(&[0.0, 2.0, 6.0, 8.0], 2), "▁█");
/// ```
pub fn sparkline(values: &[f64], width: usize) -> String {
    let values: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let n = values.len().min(width);
    let share = |k: usize| &values[k * values.len() / n..(k + 1) * values.len() / n];
    let means: Vec<f64> = (0..n).map(share).map(|share| share.iter().sum::<f64>() / share.len() as f64).collect();
    let low = means.iter().copied().fold(f64::INFINITY, f64::min);
    let high = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    means.iter().map(|mean| level(*mean, low, high)).collect()
}

/// The middle one of what does not change.
fn level(value: f64, low: f64, high: f64) -> char {
    let top = LEVELS.len() - 1;
    let place = if high > low { (value - low) / (high - low) * top as f64 } else { (top / 2) as f64 };
    LEVELS[(place.round() as usize).min(top)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_any_length() {
        assert_eq!(sparkline(&[], 5), "");
        assert_eq!(sparkline(&[3.0, 3.0], 5), "▄▄");
        assert_eq!(sparkline(&[1.0, f64::NAN, 2.0], 5), "▁█");
        assert_eq!(sparkline(&[1.0, 2.0], 0), "");
        for n in 1..40 {
            let values: Vec<f64> = (0..n).map(f64::from).collect();
            let line = sparkline(&values, 7);
            assert_eq!(line.chars().count(), 7.min(values.len()));
            assert!(line.chars().is_sorted(), "{line}");
        }
    }
}
