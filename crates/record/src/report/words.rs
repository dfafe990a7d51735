//! Findings and statements of a record in words.

use gaiter_language::Language;

use crate::statement::Statement;

/// A finding or doubt in plain words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Plain {
    /// A short name.
    pub title: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// What to do.
    pub action: &'static str,
}

/// What a code means; `None` for an unknown code, such as one of a later version.
pub(super) fn plain(code: &str, language: Language) -> Option<Plain> {
    Some(Plain {
        title: language.find(&format!("finding.{code}.title"))?,
        meaning: language.find(&format!("finding.{code}.meaning"))?,
        action: language.find(&format!("finding.{code}.action"))?,
    })
}

/// The short name of a code, or the code itself if it is unknown.
pub(super) fn short(code: &str, language: Language) -> String {
    plain(code, language).map_or_else(|| code.to_owned(), |plain| plain.title.to_owned())
}

/// A statement of a record in this language, and whether it is available in it. If not, as for a later
/// version or a record without statements, the English text is used.
pub(super) fn told(
    statement: Option<&Statement>,
    english: &str,
    language: Language,
) -> (String, bool) {
    if language == Language::En {
        return (english.to_owned(), true);
    }
    match statement.and_then(|statement| statement.in_words(language)) {
        Some(told) => (told, true),
        None => (english.to_owned(), english.is_empty()),
    }
}
