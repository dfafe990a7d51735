//! Sections whose keys are not all known beforehand: the points of a size, the languages of a title.

use std::borrow::Cow;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::fault::{Fault, Hint, What, is_hidden};
use crate::faults::{Faults, utf8};
use crate::notation::{self, Guess};
use crate::place::{Finding, line_at};
use crate::value::{kind, meaning};

/// A value and its place in the text, bytes.
pub type Value<'t> = Spanned<DeValue<'t>>;

/// How much of a faulty line or value is shown, characters.
const SHOWN_MAX: usize = 60;

/// The longest text of a value, characters: it is printed in a line or two.
const TEXT_MAX: usize = 500;

/// A table of the text.
pub struct Section<'s, 't, W> {
    table: &'s DeTable<'t>,
    /// Its place, bytes: that of a key that is missing in it.
    start: usize,
    end: usize,
    /// Its name for people; empty for the whole file.
    name: &'s str,
    faults: &'s Faults<'t, W>,
}

impl<W> Clone for Section<'_, '_, W> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<W> Copy for Section<'_, '_, W> {}

/// Reads a file of at most `most` bytes; `guess` knows its slips of notation.
///
/// # Errors
/// Every fault of the file, in the order of its lines; at least one.
pub fn read<'t, T, W: Hint>(
    bytes: &'t [u8],
    most: usize,
    guess: Guess,
    read: impl FnOnce(Section<'_, 't, W>) -> Option<T>,
) -> Result<T, Vec<Fault<W>>> {
    if bytes.len() > most {
        let faults = Faults::new("");
        faults.note(&(0..0), "", What::TooLong { found: bytes.len(), most });
        return Err(faults.in_order());
    }
    let text = utf8::<W>(bytes).map_err(|fault| vec![fault])?;
    let (root, errors) = DeTable::parse_recoverable(text);
    let faults = Faults::new(text);
    for Finding { at, key, what } in notation::findings(text, &errors, guess).0 {
        let what = match what {
            What::Notation { problem, hint } => {
                let line = shortened(&text[line_at(text, at.start)]);
                What::Notation { problem: format!("{problem}: {line}"), hint }
            }
            what => what,
        };
        faults.note(&at, key, what);
    }
    if !faults.is_empty() {
        return Err(faults.in_order());
    }
    let whole = Section { table: root.get_ref(), start: 0, end: 0, name: "", faults: &faults };
    match (read(whole), faults.is_empty()) {
        (Some(value), true) => Ok(value),
        _ => Err(faults.in_order()),
    }
}

/// The first line of a text, as far as it is shown.
fn shortened(text: &str) -> String {
    let line = text.trim().lines().next().unwrap_or_default().trim_end();
    match line.char_indices().nth(SHOWN_MAX) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

/// The name of a key without its sections.
fn bare(key: &str) -> &str {
    key.rsplit_once('.').map_or(key, |(_, name)| name)
}

impl<'s, 't, W: Hint> Section<'s, 't, W> {
    /// The table at a key, with its name for people; `None` if there is none. Anything else is noted.
    pub fn section(
        self,
        key: &str,
        name: &'s str,
        expected: &'static str,
        example: &str,
    ) -> Option<Self> {
        let value = self.get(key)?;
        let DeValue::Table(table) = value.get_ref() else {
            self.note_kind(value, name, expected, example);
            return None;
        };
        let Range { start, end } = value.span();
        Some(Section { table, start, end, name, faults: self.faults })
    }

    /// It with a name for people.
    pub fn named(self, name: &'s str) -> Self {
        Section { name, ..self }
    }

    /// Notes a fault at these bytes of the text, once.
    pub fn note(self, at: &Range<usize>, key: impl Into<String>, what: impl Into<W>) {
        self.faults.note(at, key, what);
    }

    /// Notes a value that is not of the required kind.
    pub fn note_kind(
        self,
        value: &Value<'_>,
        key: &str,
        expected: &'static str,
        example: impl Into<String>,
    ) {
        let found = format!("{}: {}", kind(value.get_ref()), self.written(value));
        self.note(&value.span(), key, What::Kind { expected, found, example: example.into() });
    }

    /// Whether the text has no fault so far.
    pub fn is_sound(self) -> bool {
        self.faults.is_empty()
    }

    /// A value as it stands in the text, its first line as far as it is shown.
    pub fn written(self, value: &Value<'_>) -> String {
        shortened(self.faults.text.get(value.span()).unwrap_or_default())
    }

    /// Its place, bytes.
    pub fn at(self) -> Range<usize> {
        self.start..self.end
    }

    pub fn name(self) -> &'s str {
        self.name
    }

    /// A key with the section's name before it.
    pub fn key(self, name: &str) -> String {
        if self.name.is_empty() { name.to_owned() } else { format!("{}.{name}", self.name) }
    }

    /// A value, if it is there.
    pub fn get(self, name: &str) -> Option<&'s Value<'t>> {
        self.table.get(name)
    }

    /// All keys with their values.
    pub fn pairs(self) -> impl Iterator<Item = (&'s Spanned<Cow<'t, str>>, &'s Value<'t>)> {
        self.table.iter()
    }

    /// Notes that a key must be set, if it is not.
    pub fn must_have(self, name: &str, example: &str) {
        if self.get(name).is_none() {
            self.note(&self.at(), self.key(name), What::Missing { example: example.into() });
        }
    }

    /// A value as a text in a line; anything else is noted.
    pub fn line(self, value: &Value<'_>, key: &str) -> Option<String> {
        let Some(text) = value.get_ref().as_str() else {
            self.note_kind(value, key, "text in quotes", format!("{} = \"…\"", bare(key)));
            return None;
        };
        let text = text.trim();
        let is_line =
            !text.is_empty() && text.chars().count() <= TEXT_MAX && !text.chars().any(is_hidden);
        if !is_line {
            self.note(&value.span(), key, What::Text { most: TEXT_MAX });
        }
        is_line.then(|| text.to_owned())
    }

    /// A value as a list of texts.
    pub fn lines(self, value: &Value<'_>, key: &str) -> Vec<String> {
        let DeValue::Array(entries) = value.get_ref() else {
            let example = format!("{} = [\"…\", \"…\"]", bare(key));
            self.note_kind(value, key, "a list of texts in [ ]", example);
            return Vec::new();
        };
        entries.iter().filter_map(|entry| self.line(entry, key)).collect()
    }

    /// A text, if it is there.
    pub fn text(self, name: &str) -> Option<String> {
        self.line(self.get(name)?, &self.key(name))
    }

    /// A text that must be there.
    pub fn required_text(self, name: &str, example: &str) -> Option<String> {
        self.must_have(name, example);
        self.text(name)
    }

    /// The texts of a list; none if it is not there.
    pub fn list(self, name: &str) -> Vec<String> {
        self.get(name).map_or(Vec::new(), |value| self.lines(value, &self.key(name)))
    }

    /// One of the words of a choice, if it is there.
    pub fn choice<T: Copy>(self, name: &str, words: &[(&str, T)]) -> Option<T> {
        let (value, found) = (self.get(name)?, self.text(name)?);
        let noted = |what| self.note(&value.span(), self.key(name), what);
        meaning(words, &found).map_err(noted).ok()
    }

    /// One of the words of a choice that must be made; the first one is the example.
    pub fn required_choice<T: Copy>(self, name: &str, words: &[(&str, T)]) -> Option<T> {
        if let Some((word, _)) = words.first() {
            self.must_have(name, &format!("{name} = \"{word}\""));
        }
        self.choice(name, words)
    }

    /// The tables of `[[name]]`.
    pub fn tables(self, name: &'s str) -> Vec<Section<'s, 't, W>> {
        let Some(value) = self.get(name) else { return Vec::new() };
        let wrong = |value: &Value<'t>| {
            let example = format!("[[{name}]] above each");
            self.note_kind(value, &self.key(name), "a section in double brackets", example);
        };
        let DeValue::Array(entries) = value.get_ref() else {
            wrong(value);
            return Vec::new();
        };
        let mut tables = Vec::new();
        for entry in entries {
            match entry.get_ref() {
                DeValue::Table(table) => {
                    let Range { start, end } = entry.span();
                    tables.push(Section { table, start, end, name, faults: self.faults });
                }
                _ => wrong(entry),
            }
        }
        tables
    }
}
