//! Converts byte offsets of a text to line, column and the line itself.

use std::ops::Range;

use crate::fault::{Fault, is_hidden};

/// A fault with its place in bytes, as the readers find it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Finding<W> {
    /// The bytes that are wrong; may be empty where something is missing.
    pub at: Range<usize>,
    /// The key with its sections.
    pub key: String,
    pub what: W,
}

/// The 0-based line of a byte offset.
pub(crate) fn line_of(text: &str, at: usize) -> usize {
    text[..text.floor_char_boundary(at)].matches('\n').count()
}

/// The line around a byte offset, without its end and without a byte-order mark: no editor shows or
/// counts that.
pub(crate) fn line_at(text: &str, at: usize) -> Range<usize> {
    let at = text.floor_char_boundary(at);
    let start = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let end = text[at..].find('\n').map_or(text.len(), |newline| at + newline);
    let marked = start == 0 && text.starts_with(BOM);
    let start = if marked { BOM.len_utf8() } else { start };
    let line = &text[start..end];
    start..start + line.strip_suffix('\r').unwrap_or(line).len()
}

/// The finding with line and column.
pub(crate) fn fault<W>(text: &str, finding: Finding<W>) -> Fault<W> {
    let Finding { at, key, what } = finding;
    let line = line_at(text, at.start);
    let start = text.floor_char_boundary(at.start).clamp(line.start, line.end);
    let end = text.floor_char_boundary(at.end).clamp(start, line.end);
    Fault {
        file: String::new(),
        line: line_of(text, start) + 1,
        column: text[line.start..start].chars().count() + 1,
        key,
        source_line: shown(&text[line]),
        width: text[start..end].trim_end().chars().count().max(1),
        what,
    }
}

/// The line in a form that is safe for a terminal: a visible sign replaces invisible characters except
/// tabs.
fn shown(line: &str) -> String {
    let hidden = |c: char| c == BOM || (is_hidden(c) && c != '\t');
    line.chars().map(|c| if hidden(c) { '\u{fffd}' } else { c }).collect()
}

const BOM: char = '\u{feff}';

#[cfg(test)]
mod tests {
    use super::{Finding, fault};

    fn placed(text: &str, part: &str) -> (usize, usize, String, usize) {
        let start = text.find(part).unwrap();
        let at = start..start + part.len();
        let fault = fault(text, Finding { at, key: String::new(), what: () });
        (fault.line, fault.column, fault.source_line, fault.width)
    }

    #[test]
    fn columns_count_characters_and_neither_bytes_nor_a_byte_order_mark() {
        assert_eq!(placed("a\nü = x\n", "x"), (2, 5, "ü = x".into(), 1));
        assert_eq!(placed("\u{feff}key = 1\n", "key"), (1, 1, "key = 1".into(), 3));
        assert_eq!(placed("\u{feff}key = 1\n", "1"), (1, 7, "key = 1".into(), 1));
    }

    #[test]
    fn a_place_over_several_lines_is_shown_by_its_first() {
        assert_eq!(placed("a = [\r\n  1,\r\n]\r\n", "[\r\n  1,\r\n]"), (1, 5, "a = [".into(), 1));
    }

    #[test]
    fn the_end_of_the_text_has_a_place_too() {
        let fault = fault("a=1\n", Finding { at: 4..4, key: String::new(), what: () });
        assert_eq!((fault.line, fault.column, fault.width), (2, 1, 1));
    }
}
