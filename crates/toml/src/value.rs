//! Single values: their kinds, numbers, the words of a choice, and which of them was probably meant.

use toml::de::DeValue;

use crate::fault::{Hint, What};

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

/// An empty text means `None`.
pub fn or_none<T, W>(
    parse: impl Fn(&str) -> Result<T, W>,
) -> impl Fn(&str) -> Result<Option<T>, W> {
    move |text| if text.is_empty() { Ok(None) } else { parse(text).map(Some) }
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

/// The nearest known word, if it is near enough to be the intended one; case does not count.
///
/// Near enough means at most one edit per three letters (one is always allowed), or that the word begins
/// with the known word of two letters or more: `quite` is `quiet` and `inch` is `in`, but `up` is not
/// `mm`.
pub fn nearest<'w>(word: &str, known: impl IntoIterator<Item = &'w str>) -> Option<&'w str> {
    let limit = (word.chars().count() / 3).max(1);
    let edits = |known: &str| strsim::osa_distance(&word.to_lowercase(), &known.to_lowercase());
    known
        .into_iter()
        .map(|candidate| (edits(candidate), candidate))
        .filter(|(distance, candidate)| {
            let begins = candidate.len() > 1 && word.starts_with(candidate);
            begins || *distance <= limit && *distance < candidate.chars().count()
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn only_a_near_word_is_suggested() {
        let known = ["quiet", "rescan", "up"];
        assert_eq!(nearest("re_scan", known), Some("rescan"));
        assert_eq!(nearest("QUITE", known), Some("quiet"));
        assert_eq!(nearest("uo", known), Some("up"));
        assert_eq!(nearest("inch", ["m", "in"]), Some("in"));
        assert_eq!(nearest("colour", known), None);
        assert_eq!(nearest("x", ["y", "z"]), None);
    }
}
