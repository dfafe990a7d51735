//! The words and numbers of captures, as the journal's columns hold them.

use std::time::Duration;

use gaiter_record::SourceKind;
use serde::Serialize;

use crate::station::journal::JournalError;

pub(super) fn milliseconds(time: Duration) -> i64 {
    i64::try_from(time.as_millis()).unwrap_or(i64::MAX)
}

/// The word for a source, as records write it.
pub(super) fn word_of(kind: SourceKind) -> Result<String, JournalError> {
    Ok(json_text(&kind)?.trim_matches('"').to_owned())
}

pub(super) fn json_text(value: &impl Serialize) -> Result<String, JournalError> {
    serde_json::to_string(value)
        .map_err(|error| rusqlite::Error::ToSqlConversionFailure(error.into()).into())
}
