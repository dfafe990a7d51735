//! A typed TOML reader that continues after a fault, so that all faults are reported at once.
//!
//! It knows the keys that it was asked for; there is no second list to keep up to date.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue, Error};

use crate::fault::{Fault, Hint, What};
use crate::faults::Faults;
use crate::notation;
use crate::place::{Finding, line_of};
use crate::value::{kind, nearest};

/// What stands between the defaults of a list, as in the shipped file.
const BETWEEN_DEFAULTS: &str = "\", \"";

/// What applies if a key is not in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Absent {
    /// The key is required; the text is an example value.
    Required(&'static str),
    /// No value applies; the text is an example value.
    Nothing(&'static str),
    /// This value applies, as written in the file.
    Default(&'static str),
}

impl Absent {
    fn example(self) -> &'static str {
        let (Absent::Required(text) | Absent::Nothing(text) | Absent::Default(text)) = self;
        text
    }
}

/// A key the reader was asked for.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// The key with its sections.
    pub path: &'static str,
    /// What applies if it is absent.
    pub absent: Absent,
    pub list: bool,
}

impl Key {
    /// The section and the name within it.
    fn split(&self) -> (&'static str, &'static str) {
        self.path.rsplit_once('.').unwrap_or(("", self.path))
    }

    /// A line that sets it to its example value.
    pub fn line(&self) -> String {
        let example = self.absent.example();
        let quote = if example.contains('\\') { '\'' } else { '"' };
        let value = format!("{quote}{example}{quote}");
        let value = if self.list { format!("[{value}]") } else { value };
        format!("{} = {value}", self.split().1)
    }
}

/// A value and its place.
#[derive(Debug, Clone)]
pub struct Found<T> {
    pub value: T,
    /// Its byte range; for a default, the range of its section.
    pub at: Range<usize>,
}

/// What stands at a key that was asked for.
enum Seen<'t> {
    Value(&'t Spanned<DeValue<'t>>),
    /// Nothing; the place of its section.
    Absent(Range<usize>),
    /// A parent section is a value; this is a fault of the section, reported once.
    Blocked,
}

/// Reads keys of one document and collects the faults.
pub struct Reader<'t, W> {
    root: &'t DeTable<'t>,
    /// The path of the root; empty for that of the document.
    before: &'static str,
    end: usize,
    /// The keys asked for so far.
    pub keys: Vec<Key>,
    errors: &'t [Error],
    removed: Removed,
    faults: Faults<'t, W>,
    missing: Vec<Finding<What>>,
}

/// Keys that earlier versions had, each with what to do about it.
pub type Removed = &'static [(&'static str, &'static str)];

impl<'t, W: Hint> Reader<'t, W> {
    /// A reader of a text as it was parsed.
    pub fn new(
        text: &'t str,
        root: &'t DeTable<'t>,
        errors: &'t [Error],
        removed: Removed,
    ) -> Self {
        let (before, end, keys) = ("", text.len(), Vec::new());
        let (faults, missing) = (Faults::new(text), Vec::new());
        Reader { root, before, end, keys, errors, removed, faults, missing }
    }

    /// Notes a fault, once.
    pub fn note(&mut self, at: Range<usize>, key: &str, what: impl Into<W>) {
        self.faults.note(&at, key, what);
    }

    /// Notes which of these texts, for which it was asked, are set to something else than their default though nothing
    /// reads them.
    pub fn note_unread(&mut self, paths: &[&'static str], what: impl Fn() -> W) {
        for path in paths {
            let key = self.keys.iter().find(|key| key.path == *path).copied();
            let (Some(key), Seen::Value(value)) = (key, self.find(path)) else { continue };
            if value.get_ref().as_str() != Some(key.absent.example()) {
                self.note(value.span(), path, what());
            }
        }
    }

    /// A text, parsed; `None` if it is wrong, or absent without a default.
    pub fn text<T>(
        &mut self,
        path: &'static str,
        absent: Absent,
        parse: impl Fn(&str) -> Result<T, W>,
    ) -> Option<Found<T>> {
        let key = Key { path, absent, list: false };
        match (self.ask(key), absent) {
            (Seen::Value(value), _) => self.entry(key, value, &parse),
            (Seen::Absent(at), Absent::Default(text)) => self.judge(path, at, parse(text)),
            _ => None,
        }
    }

    /// The value of a text that has a default. Where it is wrong, which is noted, its default stands in, so that the keys
    /// below it are read, too; `None` only if the default is no value either.
    pub fn value<T>(
        &mut self,
        path: &'static str,
        default: &'static str,
        parse: impl Fn(&str) -> Result<T, W>,
    ) -> Option<T> {
        let found = self.text(path, Absent::Default(default), &parse);
        found.map(|found| found.value).or_else(|| parse(default).ok())
    }

    /// A list of texts, parsed, without the wrong entries. A required list must have an entry; the
    /// default of any other list is one entry, or none if it is "".
    pub fn list<T>(
        &mut self,
        path: &'static str,
        absent: Absent,
        parse: impl Fn(&str) -> Result<T, W>,
    ) -> Vec<Found<T>> {
        let key = Key { path, absent, list: true };
        let value = match (self.ask(key), absent) {
            (Seen::Value(value), _) => value,
            (Seen::Absent(at), Absent::Default(text)) if !text.is_empty() => {
                let entries = text.split(BETWEEN_DEFAULTS);
                let entry = |text| self.judge(path, at.clone(), parse(text));
                return entries.filter_map(entry).collect();
            }
            _ => return Vec::new(),
        };
        let DeValue::Array(entries) = value.get_ref() else {
            self.wrong_kind(path, value, "a list of texts in [ ]", key.line());
            return Vec::new();
        };
        if entries.is_empty() && matches!(absent, Absent::Required(_)) {
            self.note(value.span(), path, What::Empty);
        }
        entries.iter().filter_map(|entry| self.entry(key, entry, &parse)).collect()
    }

    /// A boolean. Where it is wrong, which is noted, its default stands in.
    pub fn flag(&mut self, path: &'static str, default: &'static str) -> bool {
        let key = Key { path, absent: Absent::Default(default), list: false };
        if let Seen::Value(value) = self.ask(key) {
            if let DeValue::Boolean(value) = value.get_ref() {
                return *value;
            }
            let example = format!("{} = {default}", key.split().1);
            self.wrong_kind(path, value, "true or false", example);
        }
        default == "true"
    }

    /// A list of numbers, parsed, without the wrong entries; empty if absent.
    pub fn numbers<T>(
        &mut self,
        path: &'static str,
        example: &'static str,
        parse: impl Fn(&str) -> Result<T, W>,
    ) -> Vec<Found<T>> {
        let key = Key { path, absent: Absent::Default(""), list: true };
        let Seen::Value(value) = self.ask(key) else { return Vec::new() };
        let line = format!("{} = [{example}]", key.split().1);
        let wrong = |expected, value: &Spanned<DeValue>| What::Kind {
            expected,
            found: kind(value.get_ref()).to_owned(),
            example: line.clone(),
        };
        let DeValue::Array(entries) = value.get_ref() else {
            self.note(value.span(), path, wrong("a list of numbers in [ ]", value));
            return Vec::new();
        };
        let number = |entry: &Spanned<DeValue>| match entry.get_ref() {
            DeValue::Integer(number) => parse(&number.to_string()),
            DeValue::Float(number) => parse(number.as_str()),
            _ => Err(wrong("a number", entry).into()),
        };
        entries.iter().filter_map(|entry| self.judge(path, entry.span(), number(entry))).collect()
    }

    /// A list of tables, each read by `read` from a reader of its own, without the wrong ones; empty if
    /// absent. The keys that `read` asks for begin with the path.
    pub fn tables<T>(
        &mut self,
        path: &'static str,
        read: impl Fn(&mut Reader<'t, W>) -> Option<T>,
    ) -> Vec<T> {
        let key = Key { path, absent: Absent::Default(""), list: true };
        let Seen::Value(value) = self.ask(key) else { return Vec::new() };
        let (expected, example) =
            ("a section in double brackets", format!("[[{path}]] above each"));
        let DeValue::Array(entries) = value.get_ref() else {
            self.wrong_kind(path, value, expected, example);
            return Vec::new();
        };
        let mut tables = Vec::new();
        for entry in entries {
            let DeValue::Table(root) = entry.get_ref() else {
                self.wrong_kind(path, entry, expected, example.clone());
                continue;
            };
            let mut inner = Reader::new(self.faults.text, root, self.errors, self.removed);
            (inner.before, inner.end) = (path, entry.span().start);
            tables.extend(read(&mut inner));
            self.faults.found.get_mut().extend(inner.close().found.into_inner());
        }
        tables
    }

    fn entry<T>(
        &mut self,
        key: Key,
        value: &Spanned<DeValue<'t>>,
        parse: &impl Fn(&str) -> Result<T, W>,
    ) -> Option<Found<T>> {
        match value.get_ref().as_str() {
            Some(text) => self.judge(key.path, value.span(), parse(text)),
            None => {
                self.wrong_kind(key.path, value, "text in quotes", key.line());
                None
            }
        }
    }

    fn judge<T>(&mut self, path: &str, at: Range<usize>, parsed: Result<T, W>) -> Option<Found<T>> {
        parsed
            .map_err(|what| self.note(at.clone(), path, what))
            .ok()
            .map(|value| Found { value, at })
    }

    /// Looks a key up. A required one that is absent is missing.
    fn ask(&mut self, key: Key) -> Seen<'t> {
        self.keys.push(key);
        let seen = self.find(key.path);
        if let (Seen::Absent(at), Absent::Required(_)) = (&seen, key.absent) {
            let example = format!("{} under [{}]", key.line(), key.split().0);
            let what = What::Missing { example };
            self.missing.push(Finding { at: at.clone(), key: key.path.into(), what });
        }
        seen
    }

    fn wrong_kind(
        &mut self,
        path: &str,
        value: &Spanned<DeValue>,
        expected: &'static str,
        example: String,
    ) {
        let found = kind(value.get_ref()).to_owned();
        self.note(value.span(), path, What::Kind { expected, found, example });
    }

    fn find(&self, path: &str) -> Seen<'t> {
        let path = path.strip_prefix(self.before).unwrap_or(path);
        let (sections, name) = path.rsplit_once('.').unwrap_or(("", path));
        let mut table = self.root;
        let mut at = self.end..self.end;
        for section in sections.split('.').filter(|section| !section.is_empty()) {
            match table.get(section).map(|value| (value.get_ref(), value.span())) {
                Some((DeValue::Table(inner), span)) => (table, at) = (inner, span),
                Some(_) => return Seen::Blocked,
                None => return Seen::Absent(self.end..self.end),
            }
        }
        table.get(name).map_or(Seen::Absent(at), Seen::Value)
    }

    /// All faults, in the order of the file. Call it after all keys were asked for: a key in the file
    /// that was not asked for is unknown.
    pub fn finish(self) -> Vec<Fault<W>> {
        let errors = self.errors;
        let mut faults = self.close();
        if !errors.is_empty() {
            // A fault of a value is reliable on lines without syntax faults.
            let text = faults.text;
            let (notation, sound_until) = notation::findings(text, errors, |_| None);
            let line = |at: &Range<usize>| line_of(text, at.start);
            faults.found.get_mut().retain(|Finding { at, .. }| {
                at.start < sound_until && notation.iter().all(|fault| line(&fault.at) != line(at))
            });
            notation.into_iter().for_each(|of| faults.note(&of.at, of.key, of.what));
        }
        faults.in_order()
    }

    /// The faults of the values; also those of the keys, unless the notation has faults: a key that
    /// seems missing or unknown may only have lost its section.
    fn close(mut self) -> Faults<'t, W> {
        if self.errors.is_empty() {
            let mut strange = Vec::new();
            self.walk(self.root, self.before, &mut strange);
            // A misspelt key is also missing under its right name; that is one fault, not two.
            let is_meant = |finding: &Finding<What>, missing: &str| match &finding.what {
                What::Unknown { similar: Some(path), .. } => is_within(missing, path),
                _ => false,
            };
            let mut all = std::mem::take(&mut self.missing);
            all.retain(|missing| !strange.iter().any(|of| is_meant(of, &missing.key)));
            for Finding { at, key, what } in all.into_iter().chain(strange) {
                self.faults.note(&at, key, what);
            }
        }
        self.faults
    }

    fn walk(&self, table: &'t DeTable<'t>, prefix: &str, strange: &mut Vec<Finding<What>>) {
        for (name, value) in table {
            let path = join(prefix, name.get_ref());
            if self.keys.iter().any(|key| key.path == path) {
                continue;
            }
            if !self.keys.iter().any(|key| is_within(key.path, &path)) {
                let what = match self.removed.iter().find(|(key, _)| *key == path) {
                    Some(&(_, instead)) => What::Removed { instead },
                    None => self.unknown(prefix, name.get_ref()),
                };
                strange.push(Finding { at: name.span(), key: path, what });
            } else if let DeValue::Table(inner) = value.get_ref() {
                self.walk(inner, &path, strange);
            } else {
                let what = What::NotASection { found: kind(value.get_ref()), name: path.clone() };
                strange.push(Finding { at: value.span(), key: path, what });
            }
        }
    }

    fn unknown(&self, prefix: &str, name: &str) -> What {
        let mut known: Vec<&str> = Vec::new();
        for key in &self.keys {
            let here = key.path.strip_prefix(prefix).map(|rest| rest.trim_start_matches('.'));
            let here = here.filter(|_| prefix.is_empty() || is_within(key.path, prefix));
            let child = here.and_then(|rest| rest.split('.').next());
            known.extend(child.filter(|child| known.last() != Some(child)));
        }
        let similar = nearest(name, known.iter().copied()).map(|near| join(prefix, near));
        // Right name, wrong section: a key under the wrong header, or an incomplete header.
        let mut all = self.keys.iter().flat_map(|key| ancestry(key.path));
        let similar = similar
            .or_else(|| all.find(|path| path.rsplit('.').next() == Some(name)).map(String::from));
        What::Unknown { similar, known: known.into_iter().map(String::from).collect() }
    }
}

/// Whether a path is the section itself or something in it.
fn is_within(path: &str, section: &str) -> bool {
    path.strip_prefix(section).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// The sections of a path, outermost first, followed by the path itself.
fn ancestry(path: &str) -> impl Iterator<Item = &str> {
    path.match_indices('.').map(|(dot, _)| &path[..dot]).chain([path])
}

fn join(prefix: &str, name: &str) -> String {
    if prefix.is_empty() { name.into() } else { format!("{prefix}.{name}") }
}
