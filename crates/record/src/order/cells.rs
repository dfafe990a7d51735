//! Cells of a table with a separator: quotes, and texts that a spreadsheet would take for formulas.

/// The signs with which a spreadsheet begins a formula; a tab or line end before them does not stop it.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// What is put before such a text: spreadsheets then show it as text.
const GUARD: char = '\'';

/// A text from a person that no spreadsheet takes for a formula: with `'` before it if it begins, after any
/// `'` of its own, with `=`, `+`, `-`, `@`, a tab or a line end. Readers of the file take `'` away again.
pub(super) fn guarded(text: &str) -> String {
    match text.trim_start_matches(GUARD).starts_with(FORMULA) {
        true => format!("{GUARD}{text}"),
        false => text.to_owned(),
    }
}

/// A text as a cell (RFC 4180): in quotes if it needs them, or if all cells have them.
pub(super) fn cell(text: &str, separator: char, quotes_all: bool) -> String {
    let needs_quotes = text.contains([separator, '"', '\r', '\n']) || text.trim() != text;
    match quotes_all || needs_quotes {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

/// A line of cells.
pub(super) fn line(cells: &[String], separator: char, quotes_all: bool, end: &str) -> String {
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
    fn a_cell_is_in_quotes_where_it_must_be() {
        let cells = ["a", "b;c", "d\"e", " f", ""].map(str::to_owned);
        assert_eq!(line(&cells, ';', false, "\n"), "a;\"b;c\";\"d\"\"e\";\" f\";\n");
        assert_eq!(line(&cells[..2], ',', true, "\r\n"), "\"a\",\"b;c\"\r\n");
    }
}
