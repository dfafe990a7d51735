//! Who is next: the named patients, and the expected exports.

use gaiter_language::Language;
use serde::Serialize;

use super::light::{Situation, in_doubt};
use super::sentence::Sentence;
use super::{PatientShown, distinct};
use crate::booth::Signal;

/// The next patient on the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NextShown {
    /// Who is next, in a sentence or two.
    #[serde(flatten)]
    pub said: Sentence,
    /// The patients who may be next: one if it is certain, several if it is in doubt.
    pub who: Vec<PatientShown>,
    /// It is asked who is in the booth.
    pub is_asked: bool,
    /// It will be asked who is in the booth: an export is expected first, and an answer would be of the next press.
    pub is_asked_later: bool,
    /// There is something to call off.
    pub can_be_called_off: bool,
    /// The warning that a press may have been missed.
    pub doubt: Option<String>,
}

impl NextShown {
    /// Removes the ids.
    pub(super) fn hide_ids(&mut self) {
        self.said.hide_ids();
        self.who.clear();
    }
}

pub fn next_shown(booth: &Situation<'_>, language: Language) -> NextShown {
    let who = next(booth);
    NextShown {
        said: Sentence {
            anonymous: anonymous(booth, &who, language),
            ..sentence_on_next(booth, &who, language)
        },
        can_be_called_off: !who.is_empty() || booth.awaited > 0,
        who,
        is_asked: booth.is_asked && !is_asked_later(booth),
        is_asked_later: is_asked_later(booth),
        doubt: booth.is_in_doubt.then(|| in_doubt(booth.doubt_left, language)),
    }
}

/// Whether the light waits for the export of a press that is made already: two questions at once would be for two
/// patients.
fn is_asked_later(booth: &Situation<'_>) -> bool {
    booth.has_button && booth.is_asked && booth.signal == Signal::Armed
}

/// The patients who may be next. Without a button there is no press to come, so they are those whose
/// export is expected.
fn next(booth: &Situation<'_>) -> Vec<PatientShown> {
    let awaited = if booth.has_button { &[] } else { booth.awaited_for };
    distinct(booth.next.iter().chain(awaited))
}

/// Who is next and whose exports are expected.
fn sentence_on_next(booth: &Situation<'_>, who: &[PatientShown], language: Language) -> Sentence {
    let [or, and] = ["page.next.or", "page.next.and"].map(|key| language.text(key));
    let next = match who {
        [_, ..] if is_asked_later(booth) => Some("page.next.next"),
        [_, _, ..] => Some("page.next.who"),
        [_] if booth.is_asked => Some("page.next.is_it"),
        [_] if booth.has_button => Some("page.next.next"),
        _ => None,
    };
    let next = next.map(|key| Sentence::naming(language.text(key), who, or));
    let is_stated = !booth.has_button && (who.len() > 1 || booth.is_asked);
    let awaited_for = if is_stated { Vec::new() } else { distinct(booth.awaited_for) };
    let awaited = |key, before_last| {
        let words = language.filled(key, &[("count", &booth.awaited)]);
        Sentence::naming(&words, &awaited_for, before_last)
    };
    let awaited = match (awaited_for.len(), booth.awaited) {
        (0, _) => None,
        (1, _) => Some(awaited("page.next.export_of", and)),
        // Of each it is not certain that theirs is still to come.
        (2.., 1) => Some(awaited("page.next.export_of", or)),
        (patients, count) if patients > count => Some(awaited("page.next.exports_of_some", or)),
        _ => Some(awaited("page.next.exports_of", and)),
    };
    let count = counted(unnamed(booth), language).map(|count| Sentence::new(&count));
    let said = [next, awaited, count].into_iter().flatten().reduce(Sentence::then);
    said.unwrap_or_else(|| Sentence::new(language.text("page.next.nobody")))
}

/// The same without ids.
fn anonymous(booth: &Situation<'_>, who: &[PatientShown], language: Language) -> String {
    let named = match who.len() {
        0 => None,
        2.. if is_asked_later(booth) => Some("page.next.some"),
        1 if booth.is_asked && !is_asked_later(booth) => Some("page.next.asked"),
        1 => Some("page.next.one"),
        _ => Some("page.next.several"),
    };
    let named = named.map(|key| language.text(key).to_owned());
    // Without a button, the expected export is that of the named patient.
    let awaited = if booth.has_button { booth.awaited } else { unnamed(booth) };
    let sentences = named.into_iter().chain(counted(awaited, language));
    let said = sentences.reduce(|said, more| format!("{said} {more}"));
    said.unwrap_or_else(|| language.text("page.next.nobody").to_owned())
}

/// How many exports are expected without a known patient.
fn unnamed(booth: &Situation<'_>) -> usize {
    booth.awaited.saturating_sub(booth.awaited_for.len())
}

/// A sentence on how many exports are expected.
fn counted(count: usize, language: Language) -> Option<String> {
    match count {
        0 => None,
        1 => Some(language.text("page.next.one_export").to_owned()),
        _ => Some(language.filled("page.next.exports", &[("count", &count)])),
    }
}
