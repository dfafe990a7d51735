//! Cells of a table with a separator: headings, decimal signs, quotes, and texts that a spreadsheet would take for
//! something else.

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
    /// Whose decimal sign figures have, and in a spreadsheet the headings.
    pub language: Language,
    /// Whether a spreadsheet opens it for a person.
    is_spreadsheet: bool,
}

impl Notation {
    /// For programs: decimal points in every language.
    pub(crate) const fn exact(separator: char) -> Notation {
        Notation { begin: "", separator, language: Language::En, is_spreadsheet: false }
    }

    /// For spreadsheets set to this language, which open such a file without a question.
    pub(crate) const fn spreadsheet(language: Language) -> Notation {
        let separator = language.list_separator();
        Notation { begin: BYTE_ORDER_MARK, separator, language, is_spreadsheet: true }
    }

    /// The heading of a column: its name for programs, for people what this table of texts has for the name.
    pub(crate) fn heading(self, table: &str, column: &str) -> String {
        match self.is_spreadsheet {
            true => self.language.word(table, column).to_owned(),
            false => column.to_owned(),
        }
    }

    /// A reference, or a text from a person.
    pub(crate) fn words(self, text: &str) -> String {
        match self.is_spreadsheet {
            true => kept(text),
            false => guarded(text),
        }
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
    match is_formula(text) {
        true => format!("{GUARD}{text}"),
        false => text.to_owned(),
    }
}

fn is_formula(text: &str) -> bool {
    text.trim_start_matches(GUARD).starts_with(FORMULA)
}

/// The longest text in a formula, characters: Excel takes no longer one.
const LITERAL_MOST: usize = 255;

/// With what a text can begin that has a digit further on and is a day or a sum of money in English or German:
/// months, days of the week, currencies.
const BEFORE_DIGITS: [&str; 33] = [
    "jan", "jän", "feb", "mar", "mär", "mrz", "apr", "may", "mai", "jun", "jul", "aug", "sep",
    "oct", "okt", "nov", "dec", "dez", "su", "mo", "tu", "we", "th", "fr", "sa", "so", "di", "mi",
    "do", "eur", "usd", "chf", "gbp",
];

/// The words for true and false.
const TRUTHS: [&str; 4] = ["true", "false", "wahr", "falsch"];

/// A text from a person as a spreadsheet keeps it: as `="3-12"` where it would be taken for a number, a day or a
/// truth value, else [`guarded`]. Readers of the file take `="…"` away again, and halve the quotes in it.
pub(crate) fn kept(text: &str) -> String {
    match is_value(text) && !is_formula(text) {
        true => format!("=\"{}\"", text.replace('"', "\"\"")),
        false => guarded(text),
    }
}

/// Whether a spreadsheet may take a text for a value. One that begins with a digit, whatever stands before it,
/// always counts: which of them are numbers or days depends on the language.
fn is_value(text: &str) -> bool {
    let is_short = text.chars().count() <= LITERAL_MOST;
    let words = text.trim_matches(|of: char| !of.is_alphanumeric()).to_lowercase();
    let can_be = match words.chars().next() {
        Some(first) if first.is_alphabetic() => {
            let is_date = words.contains(char::is_numeric)
                && BEFORE_DIGITS.iter().any(|word| words.starts_with(word));
            is_date || TRUTHS.contains(&words.as_str())
        }
        first => first.is_some(),
    };
    is_short && can_be
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
    fn what_a_spreadsheet_would_take_for_a_value_stays_text_there_and_is_bare_for_programs() {
        let (programs, people) = (Notation::exact(';'), Notation::spreadsheet(Language::De));
        let numbers = ["0012", "1E5", "50 %", "€ 5", ".5", "(12)", "½", "EUR 12", "3\" 4", "1/4"];
        let days = ["3-12", "'3-12", "3.12.", "12:30", "Mai 5", "Mar-12", "märz 2026", "Mo 12.3."];
        let others = ["TRUE", "wahr", "01234567-r2", "２-3"];
        for text in [&numbers[..], &days, &others].concat() {
            let told = people.words(text);
            let inner = told.strip_prefix("=\"").and_then(|told| told.strip_suffix('"'));
            assert_eq!(inner.map(|of| of.replace("\"\"", "\"")).as_deref(), Some(text), "{told}");
            assert_eq!(programs.words(text), text);
        }
        for text in ["", "A-1042", "P4711", "swollen since 3 days", "May", "Wahrig", "–", "Müller"]
        {
            assert_eq!([people.words(text), programs.words(text)], [text; 2]);
        }
        // What would be a formula has its guard in both.
        for text in ["=1+1", "-5", "+49 30", "@x", "'-5", "=\"3-12\""] {
            let told = format!("'{text}");
            assert_eq!([people.words(text), programs.words(text)], [told.as_str(); 2]);
        }
        // Excel takes no longer text in a formula, and no spreadsheet reads a number so long.
        let long = "1".repeat(256);
        assert_eq!(people.words(&long), long);
    }

    #[test]
    fn a_heading_is_the_columns_name_for_programs_and_a_text_of_the_language_for_people() {
        let told = |of: Notation| of.heading("heading.order", "order_ref");
        assert_eq!(told(Notation::exact(';')), "order_ref");
        let people = Language::ALL.map(|language| told(Notation::spreadsheet(language)));
        assert_eq!(people, ["Order", "Auftrag"]);
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
