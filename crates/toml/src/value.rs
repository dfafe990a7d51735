//! Single values: their kinds, numbers, and the words of a choice.

use toml::de::DeValue;

use crate::fault::{Hint, What};
use crate::nearest::nearest;

/// The kind of a value, in words.
pub(crate) fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a section",
    }
}

/// A number as written, and its value; `None` for anything else.
pub fn number(value: &DeValue<'_>) -> Option<(String, f64)> {
    let written = match value {
        DeValue::Integer(number) => number.to_string(),
        DeValue::Float(number) => number.as_str().to_owned(),
        _ => return None,
    };
    let value = written.parse::<f64>().ok().filter(|value| value.is_finite())?;
    Some((written, value))
}

/// One of the words of a choice.
pub fn word<T: Copy, W: Hint>(
    words: &'static [(&'static str, T)],
) -> impl Fn(&str) -> Result<T, W> {
    move |text| meaning(words, text).map_err(W::from)
}

/// What a word of a choice stands for.
pub(crate) fn meaning<T: Copy>(words: &[(&str, T)], text: &str) -> Result<T, What> {
    let found = words.iter().find(|(word, _)| *word == text);
    found.map(|(_, meaning)| *meaning).ok_or_else(|| What::NotAWord {
        text: text.into(),
        words: words.iter().map(|(word, _)| (*word).to_owned()).collect(),
        similar: nearest(text, words.iter().map(|(word, _)| *word)).map(str::to_owned),
    })
}
