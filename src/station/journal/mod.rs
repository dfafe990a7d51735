//! The journal: what the station knows of each scan, delivery and sighting, in SQLite.
//!
//! Write-ahead log and `synchronous = FULL`: the pair that lost no acknowledged commit in the
//! power cuts we measured. Both are set and read back, for a file system or an old file may keep
//! another mode. One connection behind a lock; every call blocks, so callers run it on a blocking
//! thread. Text columns hold words, RFC 3339 times and JSON, so that `sqlite3` shows them as is.

mod deliveries;
mod listing;
mod lock;
mod scans;
mod schema;
mod sightings;

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rusqlite::Connection;

use crate::flow::IllegalStep;
use crate::store::durable;
pub use deliveries::Due;
pub use listing::Tally;
pub use lock::{LockError, StateLock};
pub use scans::ScanRow;

/// How long a statement waits for another process that reads the journal.
const BUSY: Duration = Duration::from_secs(5);

/// `PRAGMA synchronous` as SQLite counts it.
const FULL: i64 = 2;

/// The station's durable state.
#[derive(Debug)]
pub struct Journal {
    connection: Mutex<Connection>,
}

/// Why the journal cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// SQLite failed.
    #[error("the journal failed")]
    Sqlite(#[from] rusqlite::Error),
    /// The journal's folder could not be synced.
    #[error("syncing the folder of the journal {path} failed")]
    Folder {
        /// The journal.
        path: PathBuf,
        /// How it failed.
        #[source]
        source: std::io::Error,
    },
    /// A setting that durability needs was not taken.
    #[error("the journal keeps {setting} = {found}, it must be {wanted}")]
    Setting {
        /// The pragma.
        setting: &'static str,
        /// What was read back.
        found: String,
        /// What was set.
        wanted: &'static str,
    },
    /// The journal was written by another version of gaiter.
    #[error("the journal has schema {found}, this gaiter knows {known}")]
    Schema {
        /// Schema of the file.
        found: i64,
        /// Ours.
        known: i64,
    },
    /// A cell holds what we never write.
    #[error("the journal's column {column} holds {found:?}")]
    Cell {
        /// Column.
        column: &'static str,
        /// Its content.
        found: String,
    },
    /// A step that a state does not allow.
    #[error(transparent)]
    Step(#[from] IllegalStep),
    /// A row that must be there is not.
    #[error("the journal does not know this {what}")]
    Unknown {
        /// What kind of row.
        what: &'static str,
    },
}

impl Journal {
    /// Opens the journal, made if there is none.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn open(path: &Path) -> Result<Journal, JournalError> {
        let mut connection = Connection::open(path)?;
        connection.busy_timeout(BUSY)?;
        set_durable(&connection)?;
        connection.pragma_update(None, "foreign_keys", true)?;
        schema::establish(&mut connection)?;
        // The names of the journal and of its write-ahead log, which exists since the first read.
        durable::sync_folder(path.parent().unwrap_or(Path::new(".")))
            .map_err(|source| JournalError::Folder { path: path.to_owned(), source })?;
        Ok(Journal { connection: Mutex::new(connection) })
    }

    /// The connection. A panic while it was held rolled its transaction back, so a poisoned lock
    /// guards a sound connection.
    fn connection(&self) -> MutexGuard<'_, Connection> {
        self.connection.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn set_durable(connection: &Connection) -> Result<(), JournalError> {
    let mode: String =
        connection.pragma_update_and_check(None, "journal_mode", "WAL", |row| row.get(0))?;
    if !mode.eq_ignore_ascii_case("wal") {
        return Err(JournalError::Setting { setting: "journal_mode", found: mode, wanted: "wal" });
    }
    connection.pragma_update(None, "synchronous", "FULL")?;
    let level: i64 = connection.pragma_query_value(None, "synchronous", |row| row.get(0))?;
    if level != FULL {
        let found = level.to_string();
        return Err(JournalError::Setting { setting: "synchronous", found, wanted: "2 (FULL)" });
    }
    Ok(())
}

/// Reads a cell's text as what we wrote there.
fn cell<T>(
    column: &'static str,
    text: String,
    read: impl FnOnce(&str) -> Option<T>,
) -> Result<T, JournalError> {
    read(&text).ok_or(JournalError::Cell { column, found: text })
}

#[cfg(test)]
mod tests;
