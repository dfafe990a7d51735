//! Figures in running text stay on one line with their signs and units.

/// A blank at which no line ends.
const NO_BREAK: &str = "\u{a0}";

/// What stands behind a figure and belongs to it.
const UNITS: [&str; 9] = ["%", "°", "cm", "cm²", "h", "L", "mL", "ml", "mm"];

/// What may stand behind a unit.
const BEHIND: [char; 6] = ['.', ',', ';', ':', ')', '?'];

/// The parts of a text between which a line may end: at its blanks, but not beside `±` and not between a figure and its
/// unit.
pub(super) fn parts(text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut from = 0;
    for (at, blank) in text.match_indices(' ') {
        let before = text[from..at].rsplit(' ').next().unwrap_or_default();
        let after = text[at + blank.len()..].split(' ').next().unwrap_or_default();
        if !are_held(before, after) {
            parts.push(&text[from..at]);
            from = at + blank.len();
        }
    }
    parts.push(&text[from..]);
    parts
}

/// A text with blanks at which no line ends where none may.
pub(super) fn held(text: &str) -> String {
    let parts: Vec<String> =
        parts(text).into_iter().map(|part| part.replace(' ', NO_BREAK)).collect();
    parts.join(" ")
}

/// Whether two words stay on one line.
fn are_held(before: &str, after: &str) -> bool {
    let is_beside_sign = [before, after].contains(&"±");
    let is_figure = before.ends_with(|last: char| last.is_ascii_digit());
    is_beside_sign || is_figure && UNITS.contains(&after.trim_end_matches(BEHIND))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_its_uncertainty_and_its_unit_are_one_part() {
        assert_eq!(parts("5134 ± 21 mL, then"), ["5134 ± 21 mL,", "then"]);
        assert_eq!(parts("(+3,6 mL) bei 95 %."), ["(+3,6 mL)", "bei", "95 %."]);
        assert_eq!(parts("about ± ?"), ["about ± ?"]);
    }

    #[test]
    fn words_are_parts_of_their_own_also_those_that_begin_like_units() {
        assert_eq!(parts("in mL 3 here, 4 mmHg"), ["in", "mL", "3", "here,", "4", "mmHg"]);
        assert_eq!(parts(""), [""]);
    }

    #[test]
    fn a_held_text_differs_only_in_its_blanks() {
        assert_eq!(held("a 12.5 cm  b"), "a 12.5\u{a0}cm  b");
    }
}
