//! Reports for people: their content as blocks, a page and a PDF.

pub mod age;
mod blocks;
pub mod content;
pub mod document;
mod figure;
mod held;
mod html;
mod pdf;

use gaiter_language::Language;

use crate::statement::Statement;
pub use age::AgeMax;
pub use content::ReportContent;
pub use document::{Document, Paper, Print};
pub use figure::{Reliability, ReportFigure};
pub use html::{VIEWER, page, viewer};
pub use pdf::{PdfFault, paper};

/// What is on every page of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Head {
    /// The language of the texts.
    pub language: Language,
    /// The kind of document; whether its figures can be trusted, if not.
    pub title: String,
    /// Whether something vouches for the figures.
    pub is_vouched: bool,
    /// The patient's id with nothing hidden in it, or that there is none.
    pub patient: String,
    /// When and where it was taken, in one line.
    pub taken: String,
}

/// The short name of a finding or doubt, or the code itself if it is unknown, such as one of a later version.
pub fn title(code: &str, language: Language) -> &str {
    language.find(&format!("finding.{code}.title")).unwrap_or(code)
}

/// What has the same key together, at the place of the first of it.
pub fn grouped<K: PartialEq, V>(all: impl IntoIterator<Item = (K, V)>) -> Vec<(K, Vec<V>)> {
    let mut groups: Vec<(K, Vec<V>)> = Vec::new();
    for (key, value) in all {
        match groups.iter_mut().find(|(known, _)| *known == key) {
            Some((_, values)) => values.push(value),
            None => groups.push((key, vec![value])),
        }
    }
    groups
}

/// A statement of a record in this language, and whether it is available in it. If not, as for a later
/// version or a record without statements, the English text is used.
fn in_words(statement: Option<&Statement>, english: &str, language: Language) -> (String, bool) {
    if language == Language::En {
        return (english.to_owned(), true);
    }
    match statement.and_then(|statement| statement.in_words(language)) {
        Some(text) => (text, true),
        None => (english.to_owned(), english.is_empty()),
    }
}
