//! "Did you mean": the known word nearest to an unknown one.

/// The nearest known word, if it is near enough to be the intended one.
///
/// Near enough means at most one edit per three letters (one is always allowed), or that the word begins
/// with the known word of two letters or more: `quite` is `quiet` and `inch` is `in`, but `up` is not
/// `mm`.
pub(super) fn nearest<'w>(word: &str, known: impl IntoIterator<Item = &'w str>) -> Option<&'w str> {
    let limit = (word.chars().count() / 3).max(1);
    known
        .into_iter()
        .map(|candidate| (edits(word, candidate), candidate))
        .filter(|(distance, candidate)| {
            let begins = candidate.len() > 1 && word.starts_with(candidate);
            begins || *distance <= limit && *distance < candidate.chars().count()
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// The number of insertions, deletions, changes and swaps of neighbours that turn one word into the
/// other (optimal string alignment), ignoring case.
fn edits(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.to_lowercase().chars().collect();
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut before_last = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let changed = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = changed.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before_last[j - 2] + 1);
            }
        }
        before_last = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::{edits, nearest};

    #[test]
    fn edits_are_counted_as_a_hand_would() {
        let cases =
            [("", "abc", 3), ("quiet", "quiet", 0), ("quite", "quiet", 1), ("Unit", "units", 1)];
        for (a, b, distance) in cases {
            assert_eq!(edits(a, b), distance, "{a} {b}");
            assert_eq!(edits(b, a), distance, "{b} {a}");
        }
        assert_eq!(edits("kitten", "sitting"), 3);
    }

    #[test]
    fn only_a_near_word_is_suggested() {
        let known = ["quiet", "rescan", "up"];
        assert_eq!(nearest("re_scan", known), Some("rescan"));
        assert_eq!(nearest("uo", known), Some("up"));
        assert_eq!(nearest("inch", ["m", "in"]), Some("in"));
        assert_eq!(nearest("colour", known), None);
        assert_eq!(nearest("x", ["y", "z"]), None);
    }
}
