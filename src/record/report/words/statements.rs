//! Statements of records in words.

use super::german;
use crate::record::Language;
use crate::record::rounding;
use crate::record::statement::{Figure, Statement};

/// A statement of a record in this language, and whether it is available in it. If not, as for a later
/// version or a record without statements, the English text is used.
pub(in crate::record::report) fn told(
    statement: Option<&Statement>,
    english: &str,
    language: Language,
) -> (String, bool) {
    let words = match language {
        Language::En => return (english.to_owned(), true),
        Language::De => german::WORDS,
    };
    match statement.and_then(|statement| filled(words, statement, language)) {
        Some(told) => (told, true),
        None => (english.to_owned(), english.is_empty()),
    }
}

/// The text of a statement with its figures. `None` if it, a nested statement or a figure is unknown.
fn filled(words: &[(&str, &str)], statement: &Statement, language: Language) -> Option<String> {
    let (_, template) = words.iter().find(|(key, _)| *key == statement.is)?;
    let mut told = String::new();
    let mut rest = *template;
    while let Some((before, after)) = rest.split_once('{') {
        let (place, after) = after.split_once('}')?;
        let (name, places) = place.split_once(':').unwrap_or((place, "0"));
        told.push_str(before);
        match statement.figures.get(name)? {
            Figure::Number(value) => {
                told.push_str(&match places {
                    "*" => rounding::shortest(*value, language),
                    places => rounding::number(*value, places.parse().ok()?, language),
                });
            }
            Figure::Name(name) => told.push_str(name),
            Figure::Statement(within) => told.push_str(&filled(words, within, language)?),
        }
        rest = after;
    }
    told.push_str(rest);
    Some(told)
}
