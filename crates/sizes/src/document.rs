//! Reads a TOML file strictly: every fault with its place, all of them at once.

mod notation;

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use self::notation::slip;
use super::fault::{Fault, Form, What};
use super::point::Point;

/// The faults of one text, as they are found.
pub(super) struct Faults<'t> {
    text: &'t str,
    found: Vec<(Range<usize>, String, What)>,
}

/// A value and its place in the text, bytes.
pub(super) type Value<'t> = Spanned<DeValue<'t>>;

/// A table of the text.
#[derive(Clone, Copy)]
pub(super) struct Section<'s, 't> {
    table: &'s DeTable<'t>,
    /// Its place: that of a key that is missing in it.
    at: &'s Range<usize>,
    /// Its name for people; empty for the whole file.
    name: &'s str,
}

impl<'t> Faults<'t> {
    /// No faults so far.
    pub fn new(text: &'t str) -> Faults<'t> {
        Faults { text, found: Vec::new() }
    }

    /// Notes a fault at these bytes.
    pub fn note(&mut self, at: &Range<usize>, key: impl Into<String>, what: What) {
        self.found.push((at.clone(), key.into(), what));
    }

    /// Notes the parser's own faults, the first of each line: the others follow from it.
    pub fn note_notation(&mut self, errors: &[toml::de::Error]) {
        let mut lines = Vec::new();
        for error in errors {
            let at = error.span().unwrap_or(self.text.len()..self.text.len());
            let (start, line) = self.line_at(at.start);
            if !lines.contains(&start) {
                lines.push(start);
                let what =
                    What::Notation { slip: slip(line, error.message()), written: shortened(line) };
                self.note(&at, "", what);
            }
        }
    }

    /// Notes a value that is not of the required form.
    pub fn note_form(&mut self, value: &Value<'_>, key: impl Into<String>, form: Form) {
        let written = self.written(value);
        let found = kind(value.get_ref());
        self.note(&value.span(), key, What::Kind { form, found, written });
    }

    /// A value as it stands in the text, its first line.
    pub fn written(&self, value: &Value<'_>) -> String {
        shortened(self.text.get(value.span()).unwrap_or_default())
    }

    /// The line around a byte, and where it begins.
    fn line_at(&self, byte: usize) -> (usize, &'t str) {
        let text = self.text;
        let (before, after) = text.split_at(text.floor_char_boundary(byte));
        let start = before.rfind('\n').map_or(0, |end| end + 1);
        let end = after.find('\n').map_or(text.len(), |end| before.len() + end);
        (start, &text[start..end])
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// All faults in the order of the text.
    pub fn in_order(mut self) -> Vec<Fault> {
        self.found.sort_by_key(|(at, _, _)| at.start);
        let place = |at: usize| {
            let (start, _) = self.line_at(at);
            let at = self.text.floor_char_boundary(at);
            let before = self.text[start..at].chars().filter(|letter| *letter != BOM);
            (self.text[..start].matches('\n').count() + 1, before.count() + 1)
        };
        let places: Vec<(usize, usize)> =
            self.found.iter().map(|(at, _, _)| place(at.start)).collect();
        let fault = |((_, key, what), (line, column))| Fault { line, column, key, what };
        self.found.into_iter().zip(places).map(fault).collect()
    }
}

/// A byte-order mark, which no editor counts.
const BOM: char = '\u{feff}';

/// How much of a faulty line or value is shown, characters.
const SHOWN_MAX: usize = 60;

/// The longest text of a value, characters: it is printed in a line or two.
const TEXT_MAX: usize = 500;

/// The first line of a text, as far as it is shown.
fn shortened(text: &str) -> String {
    let line = text.trim().lines().next().unwrap_or_default().trim_end();
    match line.char_indices().nth(SHOWN_MAX) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

/// The keys of a section.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    /// Those of this section.
    pub here: &'static str,
    /// Those of the whole file, which stand above the first section; empty for the whole file.
    pub above: &'static str,
}

impl Known {
    /// The keys of a section without others above it.
    pub fn here(here: &'static str) -> Known {
        Known { here, above: "" }
    }

    /// What an unknown key was probably meant to be, as advice.
    fn advice(self, name: &str, is_known: impl Fn(&str) -> bool) -> Option<String> {
        let upper = name.to_uppercase();
        let points = [format!("c{upper}"), format!("l{upper}")];
        let cased = name.get(1..).map(|rest| name[..1].to_lowercase() + &rest.to_uppercase());
        let point =
            cased.into_iter().chain(points).find(|of| Point::of(of).is_some() && is_known(of));
        let mut words = self.here.split_whitespace();
        let word = words.find(|word| word.eq_ignore_ascii_case(name) && is_known(word));
        if let Some(meant) = point.or(word.map(str::to_owned)) {
            return Some(format!("did you mean {meant}?"));
        }
        let is_above = self.above.split_whitespace().any(|word| word == name);
        is_above.then(|| "write it above the first [[…]]: it is of the whole file".to_owned())
    }
}

/// The kind of a value, in words.
pub(super) fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a single section",
    }
}

/// A number as written, and its value; `None` for anything else.
pub(super) fn number(value: &DeValue<'_>) -> Option<(String, f64)> {
    let written = match value {
        DeValue::Integer(number) => number.to_string(),
        DeValue::Float(number) => number.as_str().to_owned(),
        _ => return None,
    };
    let value = written.parse::<f64>().ok().filter(|value| value.is_finite())?;
    Some((written, value))
}

/// A text in a line; anything else is noted.
pub(super) fn line(value: &Value<'_>, key: &str, faults: &mut Faults<'_>) -> Option<String> {
    let Some(text) = value.get_ref().as_str() else {
        faults.note_form(value, key, Form::TEXT);
        return None;
    };
    let text = text.trim();
    let is_line = !text.is_empty()
        && text.chars().count() <= TEXT_MAX
        && !text.chars().any(|letter| letter.is_control() || is_direction(letter));
    if !is_line {
        faults.note(&value.span(), key, What::Text { most: TEXT_MAX });
    }
    is_line.then(|| text.to_owned())
}

/// Marks that end a line or change the direction of writing.
fn is_direction(letter: char) -> bool {
    matches!(letter, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The entries of a list; anything else is noted.
fn entries<'s, 't>(
    value: &'s Value<'t>,
    key: &str,
    form: Form,
    faults: &mut Faults<'_>,
) -> &'s [Value<'t>] {
    match value.get_ref() {
        DeValue::Array(entries) => entries,
        _ => {
            faults.note_form(value, key, form);
            &[]
        }
    }
}

/// The texts of a list.
pub(super) fn lines(value: &Value<'_>, key: &str, faults: &mut Faults<'_>) -> Vec<String> {
    entries(value, key, Form::LIST, faults)
        .iter()
        .filter_map(|entry| line(entry, key, faults))
        .collect()
}

impl<'s, 't> Section<'s, 't> {
    /// The whole file.
    pub fn whole(table: &'s DeTable<'t>, at: &'s Range<usize>) -> Section<'s, 't> {
        Section { table, at, name: "" }
    }

    /// A table within it.
    pub fn within(table: &'s DeTable<'t>, at: &'s Range<usize>, name: &'s str) -> Section<'s, 't> {
        Section { table, at, name }
    }

    /// Its place, bytes.
    pub fn at(&self) -> &'s Range<usize> {
        self.at
    }

    /// Its name.
    pub fn name(&self) -> &'s str {
        self.name
    }

    /// A key with the section's name before it.
    pub fn key(&self, name: &str) -> String {
        if self.name.is_empty() { name.to_owned() } else { format!("{}.{name}", self.name) }
    }

    /// A value, if it is there.
    pub fn get(&self, name: &str) -> Option<&'s Value<'t>> {
        self.table.get(name)
    }

    /// All keys with their values.
    pub fn pairs(
        &self,
    ) -> impl Iterator<Item = (&'s Spanned<std::borrow::Cow<'t, str>>, &'s Value<'t>)> {
        let table = self.table;
        table.iter()
    }

    /// Notes that a key must be set.
    pub fn miss(&self, name: &str, example: &'static str, faults: &mut Faults<'_>) {
        faults.note(self.at, self.key(name), What::Missing { example });
    }

    /// A text, if it is there.
    pub fn text(&self, name: &str, faults: &mut Faults<'_>) -> Option<String> {
        line(self.get(name)?, &self.key(name), faults)
    }

    /// A text that must be there.
    pub fn required_text(
        &self,
        name: &str,
        example: &'static str,
        faults: &mut Faults<'_>,
    ) -> Option<String> {
        if self.get(name).is_none() {
            self.miss(name, example, faults);
        }
        self.text(name, faults)
    }

    /// The texts of a list; none if it is not there.
    pub fn list(&self, name: &str, faults: &mut Faults<'_>) -> Vec<String> {
        let value = self.get(name);
        value.map_or(Vec::new(), |value| lines(value, &self.key(name), faults))
    }

    /// One of the words of a choice, if it is there.
    pub fn choice<T: Copy>(
        &self,
        name: &str,
        words: &[(&str, T)],
        shown: &'static str,
        faults: &mut Faults<'_>,
    ) -> Option<T> {
        let found = self.text(name, faults)?;
        let meaning = words.iter().find(|(word, _)| *word == found).map(|(_, meaning)| *meaning);
        if let (None, Some(value)) = (meaning, self.get(name)) {
            faults.note(&value.span(), self.key(name), What::Word { found, words: shown });
        }
        meaning
    }

    /// The tables of `[[name]]`.
    pub fn tables(
        &self,
        name: &str,
        faults: &mut Faults<'_>,
    ) -> Vec<(&'s DeTable<'t>, Range<usize>)> {
        let Some(value) = self.get(name) else { return Vec::new() };
        let key = self.key(name);
        let mut tables = Vec::new();
        for entry in entries(value, &key, Form::SECTIONS, faults) {
            match entry.get_ref() {
                DeValue::Table(table) => tables.push((table, entry.span())),
                _ => faults.note_form(entry, key.clone(), Form::SECTIONS),
            }
        }
        tables
    }

    /// Notes every key for which `is_known` is false.
    pub fn only(&self, known: Known, is_known: impl Fn(&str) -> bool, faults: &mut Faults<'_>) {
        for (name, _) in self.pairs().filter(|(name, _)| !is_known(name.get_ref())) {
            let advice = known.advice(name.get_ref(), &is_known);
            let what = What::Unknown { known: known.here, advice };
            faults.note(&name.span(), self.key(name.get_ref()), what);
        }
    }
}
