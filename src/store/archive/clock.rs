//! The times by which the archive orders what the station says: those of the machine's clock, but each later than the one
//! before. A clock that was wrong and is set back must not make a take-back older than what it takes back.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::store::{StoreFault, durable, tried};

/// The note of the last time, in the state folder.
const FILE: &str = "archive-clock.json";

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
    state_dir: PathBuf,
    lock: Mutex<()>,
}

impl MonotonicClock {
    pub fn in_state(state_dir: &Path) -> MonotonicClock {
        MonotonicClock { state_dir: state_dir.to_owned(), lock: Mutex::default() }
    }

    /// The next time, in whole milliseconds. It is noted before it is used, durably: what nobody hears of is skipped.
    ///
    /// # Errors
    /// A transient fault if the note cannot be read or written.
    pub fn tick(&self) -> Result<Timestamp, StoreFault> {
        let _held = self.lock.lock().unwrap_or_else(PoisonError::into_inner);
        let path = self.state_dir.join(FILE);
        let tick = || -> io::Result<Timestamp> {
            let mut at_ms = Timestamp::now().as_millisecond();
            if let Some(bytes) = durable::if_there(fs::read(&path))? {
                let Versioned::V1 { last_ms } = serde_json::from_slice(&bytes)?;
                at_ms = at_ms.max(last_ms.saturating_add(1));
            }
            let at = Timestamp::from_millisecond(at_ms).map_err(io::Error::other)?;
            let note = serde_json::to_vec(&Versioned::V1 { last_ms: at_ms })?;
            durable::replace_file(&self.state_dir, FILE, &note)?;
            Ok(at)
        };
        tried("noting the time of the last message to the archive", &path, tick())
    }
}
