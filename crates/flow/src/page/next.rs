//! Who is next: the named patients, and the expected exports.

use gaiter_language::Language;
use serde::Serialize;

use super::light::{Situation, in_doubt};
use super::sentence::{Sentence, Text};
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
        said: Sentence::new(
            sentence_on_next(booth, &who, language),
            anonymous(booth, &who, language),
        ),
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
fn sentence_on_next(booth: &Situation<'_>, who: &[PatientShown], language: Language) -> Text {
    let [or, and] = ["page.next.or", "page.next.and"].map(|key| language.text(key));
    let text = match who {
        [_, ..] if is_asked_later(booth) => {
            Text::new().sentence(language.text("page.next.next"), who, or)
        }
        [_, _, ..] => Text::new().sentence(language.text("page.next.who"), who, or),
        [_] if booth.is_asked => Text::new().sentence(language.text("page.next.is_it"), who, or),
        [_] if booth.has_button => Text::new().sentence(language.text("page.next.next"), who, or),
        _ => Text::new(),
    };
    let is_stated = !booth.has_button && (who.len() > 1 || booth.is_asked);
    let awaited_for = if is_stated { Vec::new() } else { distinct(booth.awaited_for) };
    let text = match awaited_for.len() {
        0 => text,
        1 => text.sentence(language.text("page.next.export_of"), &awaited_for, and),
        // Of each it is not certain that theirs is still to come.
        patients if patients > booth.awaited => match booth.awaited {
            1 => text.sentence(language.text("page.next.export_of"), &awaited_for, or),
            count => {
                let words = language.filled("page.next.exports_of_some", &[("count", &count)]);
                text.sentence(&words, &awaited_for, or)
            }
        },
        _ => text.sentence(language.text("page.next.exports_of"), &awaited_for, and),
    };
    let text = match counted(unnamed(booth), language) {
        Some(count) => text.sentence(&count, &[], and),
        None => text,
    };
    if text.is_empty() { text.words(language.text("page.next.nobody")) } else { text }
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
    let sentences: Vec<String> = named.into_iter().chain(counted(awaited, language)).collect();
    if sentences.is_empty() {
        language.text("page.next.nobody").to_owned()
    } else {
        sentences.join(" ")
    }
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
