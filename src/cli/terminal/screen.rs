//! The terminal on standard output, and text that fits it.

use std::env;
use std::io::{self, IsTerminal};

use rustix::termios::tcgetwinsize;

/// The assumed width of a terminal that does not report one, characters.
const USUAL: usize = 80;

/// The width of the terminal on standard output, characters. `None` if it is not a terminal.
pub fn terminal_columns() -> Option<usize> {
    let out = io::stdout();
    if !out.is_terminal() {
        return None;
    }
    let size = tcgetwinsize(&out).ok().filter(|size| size.ws_col > 0);
    Some(size.map_or(USUAL, |size| usize::from(size.ws_col)))
}

/// The width of what standard output shows: that of the terminal, else `COLUMNS`, else the usual one.
pub fn columns() -> usize {
    let from_environment = || env::var("COLUMNS").ok()?.parse().ok().filter(|columns| *columns > 0);
    terminal_columns().or_else(from_environment).unwrap_or(USUAL)
}

/// Wraps a text into lines of at most this many characters, at spaces only. A longer word, such as an
/// id, stays whole. Without a width the text is one line.
pub fn wrapped(text: &str, columns: Option<usize>) -> Vec<String> {
    let Some(columns) = columns else { return vec![text.to_owned()] };
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= columns => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The width of a column with these texts, at least this many characters.
pub fn width<'a>(texts: impl Iterator<Item = &'a str>, least: usize) -> usize {
    texts.map(|text| text.chars().count()).fold(least, usize::max)
}

/// A text in lines of at most this many characters, each with this before it and a line end after it; see
/// [`wrapped`].
pub fn indented(text: &str, before: &str, columns: usize) -> String {
    let lines = wrapped(text, Some(columns.saturating_sub(before.chars().count())));
    lines.iter().map(|line| format!("{before}{line}\n")).collect()
}

/// A name in at most this many characters: its middle gives way to an ellipsis.
pub fn shortened(name: &str, most: usize) -> String {
    let letters: Vec<char> = name.chars().collect();
    if letters.len() <= most {
        return name.to_owned();
    }
    let kept = most.saturating_sub(1);
    let (head, tail) = (kept.div_ceil(2), kept / 2);
    let part = |letters: &[char]| letters.iter().collect::<String>();
    format!("{}…{}", part(&letters[..head]), part(&letters[letters.len() - tail..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_parted_at_spaces_and_words_stay_whole() {
        let text = "abcd1234 has waited 3 minutes for its record";
        let lines = wrapped(text, Some(20));
        assert_eq!(lines, ["abcd1234 has waited", "3 minutes for its", "record"]);
        assert_eq!(lines.join(" "), text, "nothing is lost");
        assert_eq!(wrapped("one 0123456789", Some(5)), ["one", "0123456789"]);
        assert_eq!(wrapped(text, None), [text]);
        assert_eq!(wrapped("", Some(5)), [""]);
        assert_eq!(indented("one two", "  ", 5), "  one\n  two\n");
    }

    #[test]
    fn a_long_name_keeps_its_beginning_and_its_end() {
        assert_eq!(shortened("4711_a.obj", 10), "4711_a.obj");
        assert_eq!(shortened("4711_first.obj", 10), "4711_….obj");
        assert_eq!(shortened("扫描扫描.obj", 5), "扫描…bj");
        assert_eq!(shortened("abc", 1), "…");
    }
}
