//! "Did you mean": the known word nearest to an unknown one.

/// The nearest known word, if it is near enough to be the intended one; case does not count.
///
/// Near enough means at most one edit per three letters (one is always allowed), or that the word begins
/// with the known word of two letters or more: `quite` is `quiet` and `inch` is `in`, but `up` is not
/// `mm`.
pub fn nearest<'w>(word: &str, known: impl IntoIterator<Item = &'w str>) -> Option<&'w str> {
    let limit = (word.chars().count() / 3).max(1);
    let edits = |known: &str| strsim::osa_distance(&word.to_lowercase(), &known.to_lowercase());
    known
        .into_iter()
        .map(|candidate| (edits(candidate), candidate))
        .filter(|(distance, candidate)| {
            let begins = candidate.len() > 1 && word.starts_with(candidate);
            begins || *distance <= limit && *distance < candidate.chars().count()
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn only_a_near_word_is_suggested() {
        let known = ["quiet", "rescan", "up"];
        assert_eq!(nearest("re_scan", known), Some("rescan"));
        assert_eq!(nearest("QUITE", known), Some("quiet"));
        assert_eq!(nearest("uo", known), Some("up"));
        assert_eq!(nearest("inch", ["m", "in"]), Some("in"));
        assert_eq!(nearest("colour", known), None);
        assert_eq!(nearest("x", ["y", "z"]), None);
    }
}
