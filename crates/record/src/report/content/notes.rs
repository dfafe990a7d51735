//! Doubts and findings in plain words.

use std::cmp::Reverse;

use gaiter_leg::finding::Severity;

use super::super::{grouped, in_words, title};
use super::{Note, Report, Section};
use crate::schema::FindingNote;
use crate::shown;

impl Report<'_> {
    pub(super) fn notes(&self) -> Section<Note> {
        let found = self.record.findings.iter().map(|finding| self.note(finding));
        let doubts = self.unfound_doubts();
        let doubts = doubts.iter().map(|doubt| self.note(doubt));
        let by_code = found.chain(doubts).map(|note| ((note.code.clone(), note.weight), note));
        let mut entries: Vec<Note> =
            grouped(by_code).into_iter().filter_map(|(_, group)| one_of(group)).collect();
        // Notes of one weight keep the order of the stages.
        entries.sort_by_key(|note| Reverse(note.weight));
        Section { title: self.text("report.notes.title"), entries }
    }

    pub(super) fn summary(&self, notes: &[Note]) -> String {
        let of = |weight: Severity| notes.iter().filter(|note| note.weight == weight).count();
        let words = |weight: Severity| match of(weight) {
            0 => None,
            count => Some(format!("{}: {count}", self.weight_words(weight))),
        };
        let words: Vec<String> = Severity::ALL.into_iter().rev().filter_map(words).collect();
        if words.is_empty() {
            return self.text("report.notes.none");
        }
        words.join(" · ")
    }

    fn note(&self, finding: &FindingNote) -> Note {
        let weight = Severity::of_word(&finding.severity).unwrap_or(Severity::Warning);
        let statement = finding.says.as_ref();
        let (message, is_in_language) = in_words(statement, &finding.message, self.language);
        let word = |part: &str| self.language.find(&format!("finding.{}.{part}", finding.code));
        Note {
            code: finding.code.clone(),
            weight,
            weight_words: self.weight_words(weight).to_owned(),
            place: self.place(finding),
            title: title(&finding.code, self.language).to_owned(),
            message: sentence(&shown::id(&message)),
            is_message_english: !is_in_language,
            meaning: word("meaning").map(str::to_owned),
            action: word("action").map(str::to_owned),
        }
    }

    fn weight_words(&self, weight: Severity) -> &'static str {
        self.language.word("report.notes", weight.word())
    }

    /// The leg and level of a finding.
    fn place(&self, finding: &FindingNote) -> String {
        let leg = finding.side().map(|side| self.leg(side).to_owned());
        [leg, finding.level.as_deref().map(shown::id)]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(", ")
    }

    /// Doubts at a level without a finding of their own, such as those of estimated levels.
    fn unfound_doubts(&self) -> Vec<FindingNote> {
        let legs = self.record.legs.iter();
        let levels = legs.flat_map(|leg| {
            let (warning, info) = (Severity::Warning, Severity::Info);
            let found = leg.landmarks.iter().map(move |(level, of)| (level, &of.doubts, warning));
            // Estimates are already marked as such.
            let estimated = leg.estimates.iter();
            let estimated = estimated.map(move |(level, of)| (level, &of.doubts, info));
            let codes = found.chain(estimated);
            codes.flat_map(move |(level, codes, severity)| {
                codes.iter().map(move |code| FindingNote {
                    code: code.clone(),
                    severity: severity.word().to_owned(),
                    leg: Some(leg.side.clone()),
                    level: Some(level.clone()),
                    message: String::new(),
                    says: None,
                })
            })
        });
        let is_new = |doubt: &FindingNote| !self.record.findings.iter().any(|of| of.is_like(doubt));
        levels.filter(is_new).collect()
    }
}

/// Notes of the same code as one, with all their places and messages.
fn one_of(group: Vec<Note>) -> Option<Note> {
    let first = group.first()?.clone();
    let places: Vec<&str> =
        group.iter().map(|note| note.place.as_str()).filter(|place| !place.is_empty()).collect();
    let message = if group.iter().all(|note| note.message == first.message) {
        first.message.clone()
    } else {
        let text = |note: &Note| match note.place.as_str() {
            "" => note.message.clone(),
            place => format!("{place}: {}", note.message),
        };
        group.iter().map(text).collect::<Vec<_>>().join(" ")
    };
    Some(Note {
        place: places.join(" · "),
        message,
        is_message_english: group.iter().any(|note| note.is_message_english),
        ..first
    })
}

/// Makes a message a sentence: a capital, unless it begins with a file name, and a full stop.
fn sentence(message: &str) -> String {
    let first = message.split(' ').next().unwrap_or_default();
    let mut letters = message.chars();
    let mut text = match letters.next() {
        Some(letter) if !first.contains('.') => {
            letter.to_uppercase().collect::<String>() + letters.as_str()
        }
        _ => message.to_owned(),
    };
    if text.ends_with(|end: char| end.is_alphanumeric() || matches!(end, ')' | '°' | '%' | ']')) {
        text.push('.');
    }
    text
}
