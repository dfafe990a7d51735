//! A fault of a file: where it is, what is wrong, and what to write instead.

use std::fmt;

use serde::ser::{Serialize, SerializeStruct, Serializer};

/// One fault in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault<W> {
    /// The name of the file; empty for bare text.
    pub file: String,
    /// 1-based line.
    pub line: usize,
    /// 1-based column in characters.
    pub column: usize,
    /// The key with its sections, such as `scanner.quiet`; empty for a syntax fault.
    pub key: String,
    /// The line of the file that holds the fault.
    pub source_line: String,
    /// How many characters are marked, starting at `column`; at least 1.
    pub width: usize,
    pub what: W,
}

/// What can be wrong with a kind of file: what with any, and more of its own.
pub trait Hint: fmt::Display + From<What> + PartialEq {
    /// What to write instead, if there is a suggestion.
    fn hint(&self) -> Option<String>;
}

/// What can be wrong with any file. The message follows the key: `station.id: must be set`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum What {
    /// The file holds bytes that are not UTF-8.
    #[error("this is not UTF-8 text")]
    NotUtf8,
    /// The file is longer than any of its kind.
    #[error("the file has {found} bytes; a file of this kind has at most {most}")]
    TooLong {
        /// Its length, bytes.
        found: usize,
        /// The greatest length that is read, bytes.
        most: usize,
    },
    /// The text is not valid TOML.
    #[error("{problem}")]
    Notation {
        /// What is wrong, as far as it is known in the parser's words.
        problem: String,
        /// What to do, if known.
        hint: Option<String>,
    },
    /// The key does not exist, or is in the wrong section.
    #[error("unknown key")]
    Unknown {
        /// The key that was probably meant.
        similar: Option<String>,
        /// The keys that are valid here.
        known: Vec<String>,
    },
    /// A key that earlier versions had.
    #[error("is no longer a key")]
    Removed {
        /// What to do.
        instead: &'static str,
    },
    /// A key without a default is missing.
    #[error("must be set")]
    Missing {
        /// The lines that set it.
        example: String,
    },
    /// A value where a section is required.
    #[error("must be a section, not {found}")]
    NotASection {
        /// The kind of value found.
        found: &'static str,
        /// The section's name.
        name: String,
    },
    /// A value of the wrong kind.
    #[error("must be {expected}, not {found}")]
    Kind {
        /// The required kind.
        expected: &'static str,
        found: String,
        /// What to write.
        example: String,
    },
    /// Not one of the words of a choice.
    #[error("\"{text}\" is not one of {}", quoted(words))]
    NotAWord {
        /// As written.
        text: String,
        /// The words of the choice.
        words: Vec<String>,
        /// The word that was probably meant.
        similar: Option<String>,
    },
    /// A text that is empty, too long, or holds control characters.
    #[error("must be a text of 1 to {most} characters in a line")]
    Text {
        /// The greatest length, characters.
        most: usize,
    },
    /// A list that must have entries has none.
    #[error("is empty")]
    Empty,
    /// The same folder, name or word twice.
    #[error("\"{0}\" stands twice")]
    Twice(String),
    /// What a kind of file does not allow, in its own words.
    #[error("{message}")]
    Own {
        message: String,
        /// What to write.
        hint: String,
    },
}

impl What {
    /// What a kind of file does not allow, and what to write.
    pub fn own(message: impl Into<String>, hint: impl Into<String>) -> What {
        What::Own { message: message.into(), hint: hint.into() }
    }

    /// The fault of a text that is not what it should be, and what to write.
    pub fn not_a(text: &str, what: &str, hint: impl Into<String>) -> What {
        What::own(format!("\"{text}\" is not {what}"), hint)
    }
}

impl Hint for What {
    fn hint(&self) -> Option<String> {
        let hint = match self {
            What::TooLong { .. } => return None,
            What::Notation { hint, .. } => return hint.clone(),
            What::NotUtf8 => "save the file as UTF-8".into(),
            What::Unknown { similar: Some(similar), .. } => format!("did you mean {similar}?"),
            What::Unknown { known, .. } => format!("known here: {}", known.join(", ")),
            What::Removed { instead } => (*instead).into(),
            What::Missing { example } | What::Kind { example, .. } => format!("write {example}"),
            What::NotASection { name, .. } => {
                format!("write [{name}] on a line of its own and the keys below it")
            }
            What::NotAWord { similar, .. } => {
                return similar.as_ref().map(|word| format!("did you mean \"{word}\"?"));
            }
            What::Text { .. } => "shorten it, without line ends".into(),
            What::Empty => "write at least one entry".into(),
            What::Twice(_) => "remove or rename one of the two".into(),
            What::Own { hint, .. } => hint.clone(),
        };
        Some(hint)
    }
}

/// For programs.
impl<W: Hint> Serialize for Fault<W> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fault = serializer.serialize_struct("Fault", 6)?;
        fault.serialize_field("line", &self.line)?;
        fault.serialize_field("column", &self.column)?;
        fault.serialize_field("key", &self.key)?;
        fault.serialize_field("message", &self.what.to_string())?;
        fault.serialize_field("hint", &self.what.hint())?;
        fault.serialize_field("source", &self.source_line)?;
        fault.end()
    }
}

/// In a line; with `{:#}` with the line of the file, on which the place is marked.
impl<W: Hint> fmt::Display for Fault<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Fault { file, line, column, key, source_line, width, what } = self;
        if !file.is_empty() {
            write!(f, "{file}:")?;
        }
        write!(f, "{line}:{column}: ")?;
        if !key.is_empty() {
            write!(f, "{}: ", printable(key))?;
        }
        write!(f, "{}", printable(&what.to_string()))?;
        let hint = what.hint().map(|hint| printable(&hint));
        if !f.alternate() {
            return hint.map_or(Ok(()), |hint| write!(f, "; {hint}"));
        }
        // A tab is kept as a tab, so that the caret lines up at any tab width.
        let before: String = source_line
            .chars()
            .take(column - 1)
            .map(|c| if c == '\t' { '\t' } else { ' ' })
            .collect();
        let margin = " ".repeat(line.to_string().len());
        writeln!(f, "\n{}", format!("  {line} | {source_line}").trim_end())?;
        write!(f, "  {margin} | {before}{}", "^".repeat(*width))?;
        hint.map_or(Ok(()), |hint| write!(f, "\n  {margin} hint: {hint}"))
    }
}

impl<W: Hint + fmt::Debug> std::error::Error for Fault<W> {}

/// A text from outside on one line: what would break or turn the line is escaped, so that it can neither forge a line nor
/// move the cursor of a terminal.
pub fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if is_hidden(c) { shown.extend(c.escape_default()) } else { shown.push(c) }
    }
    shown
}

/// Whether a character would break, end or turn a line of a terminal.
pub(crate) fn is_hidden(c: char) -> bool {
    // Line separators and marks that change the direction of writing.
    let turns = matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || c.is_control()
}

fn quoted(words: &[String]) -> String {
    words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
}
