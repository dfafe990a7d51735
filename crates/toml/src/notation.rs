//! Syntax faults, in words for readers who do not know TOML.

use toml::de::Error;

use crate::fault::What;
use crate::place::{Finding, line_at, line_of};

/// What a faulty line was probably meant to be, and what to do: of files with values of their own.
pub type Guess = fn(&str) -> Option<(&'static str, &'static str)>;

/// The parser's errors, without those that only follow from earlier ones.
///
/// The parser continues after a fault and then often fails on the rest of the line; after an unclosed
/// list or section it misreads everything. So only the first fault of each line counts, and the first
/// one that is not known to end with its line is the last. Also returns up to which byte the text was
/// read correctly, apart from the lines with faults.
pub(crate) fn findings(text: &str, errors: &[Error], guess: Guess) -> (Vec<Finding<What>>, usize) {
    let mut found: Vec<Finding<What>> = Vec::new();
    for error in errors {
        let at = error.span().unwrap_or(text.len()..text.len());
        let line = line_of(text, at.start);
        if found.iter().any(|earlier| line_of(text, earlier.at.start) == line) {
            continue;
        }
        let guessed = match error.message().starts_with(TWICE) {
            true => None,
            false => guess(&text[line_at(text, at.start)]),
        };
        let (what, ends_with_its_line) = match guessed {
            Some((problem, hint)) => (notation(problem, hint), true),
            None => in_words(error.message(), text.get(at.clone()).unwrap_or_default()),
        };
        let start = at.start;
        found.push(Finding { at, key: String::new(), what });
        if !ends_with_its_line {
            return (found, start);
        }
    }
    (found, text.len())
}

fn notation(problem: &str, hint: &str) -> What {
    What::Notation { problem: problem.into(), hint: Some(hint.into()) }
}

/// How a key and its value are written.
const VALUE: &str = r#"write: name = "value""#;

/// The parser's message for a key that stands twice.
const TWICE: &str = "duplicate key";

/// The parser's message in plainer words, with a hint, and whether the lines below are still read
/// correctly. Covers the messages of toml 1.2; an unknown message is passed on unchanged.
fn in_words(message: &str, found: &str) -> (What, bool) {
    let quoted = "end the text with the quote it began with";
    let single = r"write the text in single quotes: 'C:\scans'";
    let line = "begin a new line for a new key, and a comment with #";
    let [name, names] =
        ["write the section's name as [name]", "write the section's name as [[name]]"];
    let list = r#"write a list as ["one", "two"]; is its closing ] there?"#;
    let known = [
        ("missing escaped value", "\\ begins a special character here", single, true),
        ("too few unicode value digits", "\\ begins a special character here", single, true),
        ("invalid basic string", "the text has no closing quote", quoted, true),
        ("invalid literal string", "the text has no closing quote", quoted, true),
        (TWICE, "this name is used twice", "remove one of the two", true),
        ("key with no value", "a key must be followed by = and its value", VALUE, true),
        ("unexpected key or value", "unexpected text after the value", line, true),
        ("unclosed array table", "the section's name has no closing brackets", names, true),
        ("unclosed table", "the section's name has no closing bracket", name, true),
        ("missing comma between array elements", "the list goes on without a comma", list, false),
        ("unclosed array", "the list has no closing ]", list, false),
    ];
    if message.starts_with("string values must be quoted") {
        return unquoted(found);
    }
    match known.iter().find(|(start, ..)| message.starts_with(start)) {
        Some((_, problem, hint, ends)) => (notation(problem, hint), *ends),
        None => (What::Notation { problem: message.into(), hint: None }, false),
    }
}

fn unquoted(found: &str) -> (What, bool) {
    let bare = found.trim_matches(['“', '”', '„', '‘', '’', '«', '»']);
    let (problem, hint) = if bare.is_empty() {
        ("a value is missing after the =".to_owned(), VALUE.to_owned())
    } else {
        (format!("{bare} must be in straight quotes"), format!("write \"{bare}\""))
    };
    (notation(&problem, &hint), true)
}
