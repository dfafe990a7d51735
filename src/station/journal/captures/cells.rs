//! The words and numbers of captures, as the journal's columns hold them.

use std::time::Duration;

use gaiter_flow::round::{CaptureState, Opener};
use gaiter_record::SourceKind;
use serde::Serialize;

use crate::station::journal::JournalError;

pub(super) fn milliseconds(time: Duration) -> i64 {
    i64::try_from(time.as_millis()).unwrap_or(i64::MAX)
}

pub(super) const fn state_word(state: CaptureState) -> &'static str {
    match state {
        CaptureState::Open => "open",
        CaptureState::Expired => "expired",
        CaptureState::Taken => "answered",
        CaptureState::Held => "held",
    }
}

/// The state that a word stands for; `None` for one that ended.
pub(super) fn state_of(word: &str) -> Option<CaptureState> {
    let all = [CaptureState::Open, CaptureState::Expired, CaptureState::Taken, CaptureState::Held];
    all.into_iter().find(|state| state_word(*state) == word)
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
