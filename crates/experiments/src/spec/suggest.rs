//! Suggestions for misspelt words.

/// "; did you mean `x`? " for the word of `known` that is close to `word`, or else ". ": what follows is a sentence.
pub(crate) fn did_you_mean<S: AsRef<str>>(word: &str, known: &[S]) -> String {
    closest(word, known).map_or(". ".into(), |close| format!("; did you mean `{close}`? "))
}

/// The word of `known` that `word` may be a misspelling of.
pub(crate) fn closest<'k, S: AsRef<str>>(word: &str, known: &'k [S]) -> Option<&'k str> {
    let lower = word.to_lowercase();
    let score = |other: &str| strsim::jaro_winkler(&lower, &other.to_lowercase());
    let scored = known.iter().map(|other| (score(other.as_ref()), other.as_ref()));
    let best = scored.filter(|(score, _)| *score > 0.75).max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, close)| close)
}

/// The words as a list for people: "`a`, `b`".
pub(crate) fn list<S: AsRef<str>>(words: &[S]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("`{}`", word.as_ref())).collect();
    quoted.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_recognised_and_a_stranger_is_not() {
        let known = ["gamma", "n_step", "target"];
        assert_eq!(did_you_mean("gama", &known), "; did you mean `gamma`? ");
        assert_eq!(did_you_mean("Gamma", &known), "; did you mean `gamma`? ");
        assert_eq!(did_you_mean("zzz", &known), ". ");
        assert_eq!(did_you_mean("x", &[] as &[&str]), ". ");
    }
}
