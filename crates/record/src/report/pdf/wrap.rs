//! Breaks text into lines that fit a width.

use crate::picture::font::Font;
use crate::report::held;

/// A font size and weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Type {
    /// Font size, pt.
    pub size: f64,
    pub is_bold: bool,
}

impl Type {
    /// Width of writable text, pt.
    pub(super) fn width(self, words: &str) -> f64 {
        Font::with_weight(self.is_bold).width(words, self.size)
    }

    /// Distance of baselines, pt.
    pub(super) fn leading(self) -> f64 {
        self.size * 1.32
    }
}

/// Sums of widths in a different order differ by less than this, pt.
const ROUNDING: f64 = 1e-6;

/// Breaks writable text into lines at blanks, if it can be not between a figure and its unit. A word that is wider than a
/// line, such as a long id, is broken between letters.
pub(super) fn lines(words: &str, width: f64, letters: Type) -> Vec<String> {
    let fits = |words: &str| letters.width(words) <= width + ROUNDING;
    let parts = held::parts(words).into_iter().flat_map(|part| match fits(part) {
        true => vec![part],
        false => part.split(' ').collect(),
    });
    let mut lines: Vec<String> = Vec::new();
    for word in parts.filter(|word| !word.is_empty()) {
        let longer = lines.last().map(|line| format!("{line} {word}"));
        match longer.filter(|line| fits(line)) {
            Some(longer) => {
                lines.pop();
                lines.push(longer);
            }
            None => lines.extend(pieces(word, width, letters)),
        }
    }
    match lines.is_empty() {
        true => vec![String::new()],
        false => lines,
    }
}

/// Pieces of a word, each as long as fits and at least one letter.
fn pieces(word: &str, width: f64, letters: Type) -> Vec<String> {
    let (mut pieces, mut piece, mut wide) = (Vec::new(), String::new(), 0.0);
    for letter in word.chars() {
        let letter_width = letters.width(letter.encode_utf8(&mut [0; 4]));
        if wide + letter_width > width + ROUNDING && !piece.is_empty() {
            pieces.push(std::mem::take(&mut piece));
            wide = 0.0;
        }
        piece.push(letter);
        wide += letter_width;
    }
    pieces.push(piece);
    pieces
}

/// As many letters as fit, followed by `end` if something is left out.
pub(super) fn cut(words: &str, width: f64, letters: Type, end: &str) -> String {
    if letters.width(words) <= width {
        return words.to_owned();
    }
    let first = pieces(words, width - letters.width(end), letters).into_iter().next();
    first.unwrap_or_default() + end
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const PLAIN: Type = Type { size: 10.0, is_bold: false };

    #[test]
    fn lines_break_at_blanks_and_long_words_between_letters() {
        // A digit is 5.72 pt wide, a blank 2.6.
        assert_eq!(lines("11 22 33", 30.0, PLAIN), ["11 22", "33"]);
        assert_eq!(lines("1 22222222 3", 12.0, PLAIN), ["1", "22", "22", "22", "22", "3"]);
        assert_eq!(lines("", 30.0, PLAIN), [""]);
    }

    #[test]
    fn a_figure_and_its_unit_are_on_one_line_if_that_is_wide_enough() {
        assert_eq!(lines("a 11 22 mm", 34.0, PLAIN), ["a 11", "22 mm"]);
        assert_eq!(lines("1 ± 2 mL", 20.0, PLAIN), ["1 ±", "2", "mL"]);
    }

    proptest! {
        #[test]
        fn no_line_is_too_wide_and_no_letter_is_lost(words in "[ -~]{0,300}", width in 10.0..300.0) {
            let lines = lines(&words, width, PLAIN);
            for line in &lines {
                prop_assert!(PLAIN.width(line) <= width + 1e-5 || line.chars().count() == 1, "{line}");
            }
            let letters = |text: &str| text.replace(' ', "");
            prop_assert_eq!(letters(&lines.concat()), letters(&words));
        }

        #[test]
        fn what_is_cut_fits_and_says_so(words in "[0-9]{1,300}", width in 40.0..300.0) {
            let short = cut(&words, width, PLAIN, "…");
            prop_assert!(PLAIN.width(&short) <= width + 1e-5);
            prop_assert_eq!(short.ends_with('…'), PLAIN.width(&words) > width);
        }
    }
}
