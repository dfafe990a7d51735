//! The journal: what the station knows of each scan, delivery and sighting, in SQLite.
//!
//! It uses a write-ahead log and `synchronous = FULL`: with this pair no acknowledged commit was lost in
//! the power cuts we measured. Both are set and read back, because a file system or an old file may keep
//! another mode. One connection behind a lock writes. A second one, read-only, serves page, status and
//! monitors, which a slow sync of the disk would otherwise keep waiting. Every call blocks, so callers
//! run it on a blocking thread, and fails with [`JournalError`] if the journal cannot do it. Text columns hold words, RFC 3339 times and JSON, readable in `sqlite3`.

mod acts;
mod captures;
mod decided;
mod deliveries;
mod delivery_row;
mod disposition;
mod erasure;
mod error;
mod found;
mod history;
pub(in crate::station) mod integrity;
mod listing;
mod lock;
mod looks;
mod meta;
mod orders;
mod prune;
mod row;
mod scans;
mod schema;
mod sightings;
mod withdrawal;

use std::fs::{File, OpenOptions, Permissions};
use std::io;
use std::os::unix::fs::{OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use gaiter_flow::orders::FolderId;
use rusqlite::{Connection, OpenFlags, Transaction, TransactionBehavior};
use tracing::warn;

use super::share::file_system::folder_id;
use crate::store::durable;
pub use captures::{BoothChange, CaptureRow};
pub use deliveries::GivenRevision;
pub use delivery_row::{Due, Task};
pub use erasure::{Erasing, ScanOfPerson};
pub use error::JournalError;
pub use found::FoundThere;
pub use history::Event;
use history::HeadFile;
pub use listing::Tally;
pub use lock::{LockError, StateLock};
pub use scans::{Entry, ScanRow};
pub use withdrawal::KEPT;

/// How long a statement waits for another process that reads the journal.
const BUSY: Duration = Duration::from_secs(5);

/// `PRAGMA synchronous` as SQLite counts it.
const FULL: i64 = 2;

/// The station's durable state.
#[derive(Debug)]
pub struct Journal {
    /// Read-only. Dropped before the writing connection, which as the last one checkpoints the log.
    viewer: Mutex<Connection>,
    connection: Mutex<Connection>,
    head: HeadFile,
    path: PathBuf,
    /// The file that was opened: a journal that is removed stays usable, unseen, while it is open.
    file: FolderId,
}

/// The mode of a file that only this user may use.
const PRIVATE: u32 = 0o600;

/// Opens a file that only this user may use, or creates it.
fn open_private(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false).mode(PRIVATE).open(path)
}

/// Makes the journal a file that only this user may read, whatever the folder allows, because it holds
/// patients' ids. SQLite gives its write-ahead log the same mode.
///
/// # Errors
/// If others may still read it. A file that cannot be opened is no error here: SQLite reports it next.
fn make_private(path: &Path) -> io::Result<()> {
    let Ok(file) = open_private(path) else { return Ok(()) };
    let mode = file.metadata()?.permissions().mode();
    let is_open = mode & 0o077 != 0;
    if is_open { file.set_permissions(Permissions::from_mode(PRIVATE)) } else { Ok(()) }
}

impl Journal {
    /// Opens the journal, or creates it, and checks all of it: its pages, the seals of its rows, the
    /// chain of its history, and that it is not an older copy of itself.
    ///
    /// # Errors
    /// See [`JournalError`]; [`JournalError::is_ruin`]: which ones a rebuild repairs.
    pub fn open(path: &Path) -> Result<Journal, JournalError> {
        Journal::open_or_create(path, false)
    }

    /// As [`Journal::open`]; a journal that is created replaces one that was lost, and is to be filled.
    ///
    /// # Errors
    /// As of [`Journal::open`].
    pub fn open_anew(path: &Path) -> Result<Journal, JournalError> {
        Journal::open_or_create(path, true)
    }

    fn open_or_create(path: &Path, is_anew: bool) -> Result<Journal, JournalError> {
        if let Err(error) = make_private(path) {
            warn!(event = "journal-not-private", %error);
        }
        let mut connection = Connection::open(path)?;
        connection.busy_timeout(BUSY)?;
        set_durable(&connection)?;
        connection.pragma_update(None, "foreign_keys", true)?;
        integrity::pages(&connection)?;
        let head = HeadFile::open(path).map_err(JournalError::Head)?;
        schema::establish(&mut connection, is_anew)?;
        connection.execute_batch(disposition::NOTED)?;
        connection.execute_batch(withdrawal::SERVERS)?;
        integrity::rows(&connection)?;
        // An erasure may have been cut off before it could write the head.
        erasure::renew_own_head(&connection, &head)?;
        integrity::head(&connection, &head)?;
        // Syncs the names of the journal and of its write-ahead log, which exists since the first read.
        let folder = |source| JournalError::Folder { path: path.to_owned(), source };
        durable::sync_folder(path.parent().unwrap_or(Path::new("."))).map_err(folder)?;
        let file = folder_id(path).map_err(folder)?;
        let viewer = Mutex::new(open_viewer(path)?);
        let path = path.to_owned();
        Ok(Journal { viewer, connection: Mutex::new(connection), head, path, file })
    }

    /// Checks all of the open journal, as [`Journal::open`] does.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn check(&self) -> Result<(), JournalError> {
        let connection = self.connection();
        integrity::pages(&connection)?;
        schema::check(&connection)?;
        integrity::rows(&connection)?;
        integrity::head(&connection, &self.head)
    }

    /// Checks that the journal's name still leads to the open file.
    ///
    /// # Errors
    /// [`JournalError::Gone`] if it does not.
    pub fn is_in_place(&self) -> Result<(), JournalError> {
        let found = folder_id(&self.path).ok();
        if found == Some(self.file) { Ok(()) } else { Err(JournalError::Gone) }
    }

    /// Closes the journal's files, which are about to be set aside. SQLite removes a write-ahead log by
    /// name when it closes the last connection: a step that still hangs must not do that to the next
    /// journal. From now on every request to this journal fails.
    ///
    /// # Errors
    /// If not even an empty journal in memory can be opened.
    pub fn let_go(&self) -> Result<(), JournalError> {
        *self.viewer() = Connection::open_in_memory()?;
        *self.connection() = Connection::open_in_memory()?;
        Ok(())
    }

    /// The connection for readers: it sees what was committed, and never waits for a writer.
    fn viewer(&self) -> MutexGuard<'_, Connection> {
        self.viewer.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The connection. A panic while it was held rolled its transaction back, so a poisoned lock guards
    /// an intact connection.
    fn connection(&self) -> MutexGuard<'_, Connection> {
        self.connection.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes a change completely or not at all; durable on return.
    fn change<T>(
        &self,
        change: impl FnOnce(&Transaction<'_>) -> Result<T, JournalError>,
    ) -> Result<T, JournalError> {
        let mut connection = self.connection();
        // Immediate: a transaction that reads first and then writes would not wait if another process
        // used the journal in between, but fail at once.
        let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let before = history::newest(&transaction)?;
        let done = change(&transaction)?;
        disposition::decide_touched(&transaction)?;
        let after = history::newest(&transaction)?;
        transaction.commit()?;
        if let Some(head) = after.filter(|after| before.as_ref() != Some(after)) {
            // The change is made; an outdated head only makes the check a little weaker.
            let _ = self.head.write(&head);
        }
        Ok(done)
    }
}

fn open_viewer(path: &Path) -> Result<Connection, JournalError> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let viewer = Connection::open_with_flags(path, flags)?;
    viewer.busy_timeout(BUSY)?;
    Ok(viewer)
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

#[cfg(test)]
mod tests;
