//! Findings and statements of a record in words.

use gaiter_language::Language;

use crate::statement::Statement;

/// The short name of a finding or doubt, or the code itself if it is unknown, such as one of a later version.
pub(crate) fn title(code: &str, language: Language) -> &str {
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
