//! The times by which the archive orders what the station says: those of the machine's clock, but each later than the one
//! before. A clock that was wrong and is set back must not make a take-back older than what it takes back.

use std::io;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::store::json_folder::JsonFolder;
use crate::store::{StoreFault, tried};

/// The note of the last time, in the state folder.
const NOTE: &str = "archive-clock";

/// The versions of the note.
#[derive(Serialize, Deserialize)]
#[serde(tag = "schema")]
enum Versioned {
    #[serde(rename = "gaiter.archive-clock/1")]
    V1 {
        /// Milliseconds since 1970.
        last_ms: i64,
    },
}

/// A clock that never goes back, also over restarts and after a loss of the journal.
#[derive(Debug)]
pub(super) struct MonotonicClock {
    state: JsonFolder,
    lock: Mutex<()>,
}

impl MonotonicClock {
    pub fn in_state(state_dir: &Path) -> MonotonicClock {
        MonotonicClock { state: JsonFolder::new(state_dir.to_owned()), lock: Mutex::default() }
    }

    /// The next time, in whole milliseconds. It is noted before it is used, durably: what nobody hears of is skipped.
    ///
    /// # Errors
    /// A transient fault if the note cannot be read or written.
    pub fn tick(&self) -> Result<Timestamp, StoreFault> {
        let _held = self.lock.lock().unwrap_or_else(PoisonError::into_inner);
        let tick = || -> io::Result<Timestamp> {
            let mut at_ms = Timestamp::now().as_millisecond();
            if let Some(Versioned::V1 { last_ms }) = self.state.read(NOTE)? {
                at_ms = at_ms.max(last_ms.saturating_add(1));
            }
            let at = Timestamp::from_millisecond(at_ms).map_err(io::Error::other)?;
            let note = serde_json::to_vec(&Versioned::V1 { last_ms: at_ms })?;
            self.state.keep(NOTE, &note)?;
            Ok(at)
        };
        let path = self.state.file(NOTE);
        tried("noting the time of the last message to the archive", &path, tick())
    }
}
