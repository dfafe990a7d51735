//! The words and numbers of captures, as the journal's columns hold them.

use std::time::Duration;

use gaiter_flow::capture::{CaptureState, Opener};
use gaiter_record::SourceKind;
use serde::Serialize;

use crate::station::journal::JournalError;

pub(super) fn milliseconds(time: Duration) -> i64 {
    i64::try_from(time.as_millis()).unwrap_or(i64::MAX)
}

const STATES: [(&str, CaptureState); 2] =
    [("open", CaptureState::Open), ("expired", CaptureState::Expired)];

pub(super) fn state_word(state: CaptureState) -> &'static str {
    STATES.iter().find(|(_, known)| *known == state).map_or("open", |(word, _)| word)
}

/// The state that a word stands for. A finished capture counts as one that was open.
pub(super) fn state_of(word: &str) -> Option<CaptureState> {
    let known = STATES.iter().find(|(known, _)| *known == word).map(|(_, state)| *state);
    known.or_else(|| matches!(word, "answered" | "held" | "over").then_some(CaptureState::Open))
}

pub(super) fn opener_word(opener: Opener) -> &'static str {
    match opener {
        Opener::Press => "press",
        Opener::Name => "name",
    }
}

pub(super) fn opener_of(word: &str) -> Option<Opener> {
    [Opener::Press, Opener::Name].into_iter().find(|opener| opener_word(*opener) == word)
}

/// The word for a source, as records write it.
pub(super) fn word_of(kind: SourceKind) -> Result<String, JournalError> {
    Ok(json_text(&kind)?.trim_matches('"').to_owned())
}

pub(super) fn json_text(value: &impl Serialize) -> Result<String, JournalError> {
    serde_json::to_string(value)
        .map_err(|error| rusqlite::Error::ToSqlConversionFailure(error.into()).into())
}
