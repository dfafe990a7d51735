//! Repairs the journal: a corrupt one is set aside, never used and never deleted, and a new one is
//! filled from the spool, the quarantine and the stores.

use std::fs;
use std::io;
use std::path::Path;

use jiff::Timestamp;
use tracing::info;

use super::error::StationError;
use super::journal::{Journal, JournalError};
use super::runtime::chain;
use crate::store::durable;

/// The files of a journal: the database, its write-ahead log and index, the head of its history.
const FILES: [&str; 4] = ["journal.db", "journal.db-wal", "journal.db-shm", "history.head"];

/// Why a missing journal is rebuilt: it was removed from outside, or set aside in use.
const MISSING: &str = "it was missing or had been set aside while in use";

/// Opens the journal. Begins a new one if it is corrupt, in which case it is set aside, or if it is
/// missing although a station ran here before. One that an earlier start began and did not fill is filled.
/// Returns also why it was rebuilt, if it was.
///
/// # Errors
/// If neither is possible: a full disk, another version's journal.
pub fn open(
    path: &Path,
    stores: &[&str],
    first_start: bool,
) -> Result<(Journal, Option<String>), StationError> {
    let fault = |source| StationError::Journal { path: path.to_owned(), source };
    let missing = !first_start && !path.exists();
    let opened = if missing { Journal::open_anew(path) } else { Journal::open(path) };
    let why = match opened {
        Ok(journal) if !missing => {
            // One that an earlier start began, and did not come to fill.
            let why = journal.to_fill().map_err(fault)?;
            let why = why.map(|why| if why.is_empty() { MISSING.to_owned() } else { why });
            if let Some(why) = &why {
                journal.begin_anew(stores, why).map_err(fault)?;
            }
            return Ok((journal, why));
        }
        Ok(_) => MISSING.to_owned(),
        Err(JournalError::Behind { .. }) if missing => MISSING.to_owned(),
        Err(error) if error.is_ruin() => chain(&error),
        Err(error) => return Err(fault(error)),
    };
    set_aside(path).map_err(|source| StationError::SetAside { source })?;
    let journal = Journal::open_anew(path).map_err(fault)?;
    journal.begin_anew(stores, &why).map_err(fault)?;
    Ok((journal, Some(why)))
}

/// Sets an open journal aside that proved corrupt only in use: the next start finds it missing and
/// begins a new one, instead of ending with the same fault for ever.
///
/// # Errors
/// If its files cannot be renamed.
pub fn give_up(path: &Path, journal: &Journal) -> Result<(), StationError> {
    let fault = |source| StationError::Journal { path: path.to_owned(), source };
    journal.let_go().map_err(fault)?;
    set_aside(path).map_err(|source| StationError::SetAside { source })
}

/// Renames the journal's files to `journal.ruined-<time>-<name>`.
fn set_aside(path: &Path) -> io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let time = Timestamp::now().strftime("%Y%m%dT%H%M%SZ").to_string();
    let mut files = 0;
    for name in FILES {
        let from = folder.join(name);
        let free = (0..).map(|n| folder.join(format!("journal.ruined-{time}-{n}-{name}")));
        let Some(to) = free.into_iter().find(|to| !to.exists()) else { continue };
        files += usize::from(durable::if_there(fs::rename(from, &to))?.is_some());
    }
    durable::sync_folder(folder)?;
    info!(event = "journal-set-aside", files);
    Ok(())
}
