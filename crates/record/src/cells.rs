//! Cells of a table with a separator: decimal signs, quotes, and texts that a spreadsheet would take for formulas.

use gaiter_language::Language;

use crate::rounding;

/// The mark by which a spreadsheet recognises UTF-8.
pub(crate) const BYTE_ORDER_MARK: &str = "\u{feff}";

/// How a table is written: for programs alike everywhere, for the spreadsheet of a person as its language has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Notation {
    /// What the file begins with.
    pub begin: &'static str,
    /// The sign between cells.
    pub separator: char,
    /// Whose decimal sign figures have.
    pub language: Language,
}

impl Notation {
    /// For programs: decimal points in every language.
    pub(crate) const fn exact(separator: char) -> Notation {
        Notation { begin: "", separator, language: Language::En }
    }

    /// For spreadsheets set to this language, which open such a file without a question.
    pub(crate) const fn spreadsheet(language: Language) -> Notation {
        Notation { begin: BYTE_ORDER_MARK, separator: language.list_separator(), language }
    }

    /// A figure with all its digits, or nothing if it is unknown.
    pub(crate) fn figure(self, figure: Option<f64>) -> String {
        figure.map_or(String::new(), |figure| rounding::shortest(figure, self.language))
    }
}

/// The signs with which a spreadsheet begins a formula; a tab or line end before them does not stop it.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// What is put before such a text: spreadsheets then show it as text.
const GUARD: char = '\'';

/// A text from a person that no spreadsheet takes for a formula: with `'` before it if it begins, after any
/// `'` of its own, with `=`, `+`, `-`, `@`, a tab or a line end. Readers of the file take `'` away again.
pub(crate) fn guarded(text: &str) -> String {
    match text.trim_start_matches(GUARD).starts_with(FORMULA) {
        true => format!("{GUARD}{text}"),
        false => text.to_owned(),
    }
}

/// A text as a cell (RFC 4180): in quotes if it needs them, or if all cells have them.
pub(crate) fn cell(text: &str, separator: char, quotes_all: bool) -> String {
    let needs_quotes = text.contains([separator, '"', '\r', '\n']) || text.trim() != text;
    match quotes_all || needs_quotes {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

/// A line of cells.
pub(crate) fn line(cells: &[String], separator: char, quotes_all: bool, end: &str) -> String {
    let cells: Vec<String> = cells.iter().map(|text| cell(text, separator, quotes_all)).collect();
    cells.join(&separator.to_string()) + end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_of_a_person_begins_like_a_formula_and_each_can_be_read_back() {
        for text in ["=1+1", "+49", "-", "@x", "\t=1", "'=1", "''-2"] {
            let told = guarded(text);
            assert_eq!(told.strip_prefix('\''), Some(text));
        }
        for text in ["", "4711", "'t Hooft", "a=b", "Müller"] {
            assert_eq!(guarded(text), text);
        }
    }

    #[test]
    fn a_figure_has_the_point_for_programs_and_the_sign_of_the_language_for_a_spreadsheet() {
        let told =
            |of: Notation| [Some(346.888), Some(29.3), Some(-5.0), None].map(|f| of.figure(f));
        assert_eq!(told(Notation::exact(';')), ["346.888", "29.3", "-5", ""]);
        let german = Notation::spreadsheet(Language::De);
        assert_eq!(told(german), ["346,888", "29,3", "-5", ""]);
        assert_eq!(german.separator, ';');
        let english = Notation::spreadsheet(Language::En);
        assert_eq!((told(english), english.separator), (told(Notation::exact(';')), ','));
    }

    #[test]
    fn a_cell_is_in_quotes_where_it_must_be() {
        let cells = ["a", "b;c", "d\"e", " f", ""].map(str::to_owned);
        assert_eq!(line(&cells, ';', false, "\n"), "a;\"b;c\";\"d\"\"e\";\" f\";\n");
        assert_eq!(line(&cells[..2], ',', true, "\r\n"), "\"a\",\"b;c\"\r\n");
    }
}
