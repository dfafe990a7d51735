//! Keys → texts, in each [`Language`].
//!
#![doc = include_str!("../README.md")]

mod places;

use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

pub use places::{Piece, fill, pieces};

/// Texts by their keys, such as `page.done.retry`.
type Texts = BTreeMap<String, String>;

/// The language of a report, of the operator's page and of the terminal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Language {
    #[default]
    En,
    De,
}

/// A language without its texts.
struct Row {
    tag: &'static str,
    decimal_sign: &'static str,
    list_separator: char,
    file: &'static str,
}

impl Language {
    pub const ALL: [Language; 2] = [Language::En, Language::De];

    /// Its tag in the configuration and on pages (BCP 47).
    pub const fn tag(self) -> &'static str {
        self.row().tag
    }

    /// The sign before the decimals of a figure. It is no text of the file, because figures alone should
    /// not cost the reading of it.
    pub const fn decimal_sign(self) -> &'static str {
        self.row().decimal_sign
    }

    /// The sign between the cells of a table, as spreadsheets set to the language expect it. Never the decimal
    /// sign.
    pub const fn list_separator(self) -> char {
        self.row().list_separator
    }

    /// All that is not in its file: a new language is a file and a row here.
    const fn row(self) -> Row {
        match self {
            Language::En => Row {
                tag: "en",
                decimal_sign: ".",
                list_separator: ',',
                file: include_str!("en.toml"),
            },
            Language::De => Row {
                tag: "de",
                decimal_sign: ",",
                list_separator: ';',
                file: include_str!("de.toml"),
            },
        }
    }

    /// The text of a key, or the key itself if there is none.
    pub fn text(self, key: &'static str) -> &'static str {
        self.find(key).unwrap_or(key)
    }

    /// The text of a key that is made up of a code; `None` if there is none.
    pub fn find(self, key: &str) -> Option<&'static str> {
        self.texts().get(key).map(String::as_str)
    }

    /// The text of a code in a table, or the code itself if there is none.
    pub fn word<'a>(self, table: &str, code: &'a str) -> &'a str {
        self.find(&format!("{table}.{code}")).unwrap_or(code)
    }

    /// The text of a key with words in its places. A place without words stays as it is.
    pub fn filled(self, key: &'static str, words: &[(&str, &dyn Display)]) -> String {
        filled(self.text(key), words)
    }

    /// The text of a code in a table with words in its places, or the code itself if there is none.
    pub fn filled_word(self, table: &str, code: &str, words: &[(&str, &dyn Display)]) -> String {
        filled(self.word(table, code), words)
    }

    /// All texts of a table by their keys in it.
    pub fn table(self, name: &str) -> impl Iterator<Item = (&'static str, &'static str)> + use<> {
        let before = format!("{name}.");
        let from = self.texts().range(before.clone()..);
        from.map_while(move |(key, text)| Some((key.strip_prefix(&before)?, text.as_str())))
    }

    /// The texts of the language. Its file is read when the first of them is asked for.
    fn texts(self) -> &'static Texts {
        static ALL: [OnceLock<Texts>; Language::ALL.len()] =
            [const { OnceLock::new() }; Language::ALL.len()];
        ALL[self as usize].get_or_init(|| read(self.row().file))
    }
}

/// A text with words in its places.
fn filled(text: &str, words: &[(&str, &dyn Display)]) -> String {
    let words = |place: &str, _: &str| {
        let word = words.iter().find(|(name, _)| *name == place);
        Some(word.map_or_else(|| format!("{{{place}}}"), |(_, word)| word.to_string()))
    };
    fill(text, words).unwrap_or_default()
}

/// The texts of a file. A file with faults has none, and its keys are shown.
fn read(file: &str) -> Texts {
    let file: Table = file.parse().unwrap_or_default();
    let mut texts = Texts::new();
    for (key, value) in &file {
        gather(&file, key, value, &mut texts);
    }
    texts
}

/// Adds the texts below a key. A text that only names another key has what is there.
fn gather(file: &Table, key: &str, value: &Value, texts: &mut Texts) {
    match value {
        Value::Table(table) => {
            for (name, value) in table {
                gather(file, &format!("{key}.{name}"), value, texts);
            }
        }
        Value::String(text) => match named(file, text) {
            Some(other) => gather(file, key, other, texts),
            None => {
                texts.insert(key.to_owned(), text.clone());
            }
        },
        _ => {}
    }
}

/// What is at the key that a text names, as `{page.do.retry}` does.
fn named<'a>(file: &'a Table, text: &str) -> Option<&'a Value> {
    let (table, rest) = text.strip_prefix('{')?.strip_suffix('}')?.split_once('.')?;
    rest.split('.').try_fold(file.get(table)?, |value, name| value.get(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_names_another_key_has_what_is_there() {
        let file =
            "[a]\nb = '{c.d}'\ne = '{c.t}'\nf = '{x.y}'\n[c]\nd = 'text'\n[c.t]\ng = '{c.d}'";
        let texts = read(file);
        let texts = texts.iter().map(|(key, text)| (key.as_str(), text.as_str()));
        let all = ["a.b", "a.e.g", "c.d", "c.t.g"].map(|key| (key, "text"));
        let all = all.into_iter().chain([("a.f", "{x.y}")]);
        assert_eq!(texts.collect::<BTreeMap<_, _>>(), all.collect());
    }

    #[test]
    fn what_has_no_text_is_shown_as_it_is() {
        for language in Language::ALL {
            assert_eq!(language.text("no.such.key"), "no.such.key");
            assert_eq!(language.find("page.held.new.what"), None);
            assert_eq!(language.word("page.part.store", "new"), "new");
        }
        assert!(read("not = [toml").is_empty());
    }

    #[test]
    fn a_place_without_words_stays() {
        let count: &dyn Display = &2;
        assert_eq!(Language::En.filled("report.page_number", &[]), "Page {page} of {count}");
        let german = Language::De.filled("report.page_number", &[("page", &1), ("count", count)]);
        assert_eq!(german, "Seite 1 von 2");
    }

    #[test]
    fn a_table_has_its_own_texts_and_no_others() {
        let own: Vec<_> = Language::De.table("leg").collect();
        let heading = ("heading.left", "Linkes Bein");
        assert_eq!(own[0], heading);
        assert_eq!(own.len(), 8);
        assert!(Language::De.table("le").next().is_none());
    }
}
