//! Converts byte offsets of a text to line, column and the line itself.

use std::ops::Range;

use super::fault::{ConfigFault, What};

/// A fault with its place in bytes, as the readers find it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Finding {
    /// The bytes that are wrong; may be empty where something is missing.
    pub at: Range<usize>,
    /// The key with its sections.
    pub key: String,
    /// What is wrong.
    pub what: What,
}

/// The 0-based line of a byte offset.
pub(super) fn line_of(text: &str, at: usize) -> usize {
    let end = floor(text, at);
    text[..end].matches('\n').count()
}

/// The finding with line and column; the file's name is not known here.
pub(super) fn fault(text: &str, finding: Finding) -> ConfigFault {
    let Finding { at, key, what } = finding;
    let start = floor(text, at.start);
    let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
    let line_end = text[start..].find('\n').map_or(text.len(), |newline| start + newline);
    // A byte-order mark comes before the first column; no editor shows or counts it.
    let marked = line_start == 0 && text.starts_with(BOM);
    let line_start = if marked { BOM.len_utf8() } else { line_start };
    let line = &text[line_start..line_end];
    let line_end = line_start + line.strip_suffix('\r').unwrap_or(line).len();
    let start = start.clamp(line_start, line_end);
    let end = floor(text, at.end).clamp(start, line_end);
    ConfigFault {
        file: "station.toml".into(),
        line: line_of(text, start) + 1,
        column: text[line_start..start].chars().count() + 1,
        key,
        source_line: shown(&text[line_start..line_end]),
        width: text[start..end].trim_end().chars().count().max(1),
        what,
    }
}

/// The line in a form that is safe for a terminal: a visible sign replaces invisible characters except
/// tabs.
fn shown(line: &str) -> String {
    let hidden = |c: char| c == BOM || (c.is_control() && c != '\t');
    line.chars().map(|c| if hidden(c) { '\u{fffd}' } else { c }).collect()
}

/// The fault of a file that is not UTF-8, at its first wrong byte.
pub(super) fn not_utf8(bytes: &[u8], wrong: usize) -> ConfigFault {
    // Nothing before the wrong byte changes, so its place is the same in the repaired text.
    let mended = String::from_utf8_lossy(bytes);
    let at = wrong..wrong + '\u{fffd}'.len_utf8();
    fault(&mended, Finding { at, key: String::new(), what: What::NotUtf8 })
}

const BOM: char = '\u{feff}';

/// The offset itself, or the last character boundary before it.
fn floor(text: &str, at: usize) -> usize {
    text.floor_char_boundary(at)
}

#[cfg(test)]
mod tests {
    use super::{Finding, fault};
    use crate::config::fault::What;

    fn placed(text: &str, part: &str) -> (usize, usize, String, usize) {
        let start = text.find(part).unwrap();
        let at = start..start + part.len();
        let fault = fault(text, Finding { at, key: String::new(), what: What::EmptyList });
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
        let at = 4..4;
        let fault = fault("a=1\n", Finding { at, key: String::new(), what: What::EmptyList });
        assert_eq!((fault.line, fault.column, fault.width), (2, 1, 1));
    }
}
