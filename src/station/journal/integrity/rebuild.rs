//! Healing the journal: one that cannot be relied upon is set aside, never used and never deleted,
//! and a new one is filled from the spool, the quarantine and the stores.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use tracing::info;

use crate::station::custody::{Custody, CustodyFault};
use crate::station::error::{StationError, chain};
use crate::station::journal::{Journal, JournalError};
use crate::store::{RecordStore, StoreFault, durable};

/// The files of a journal: the database, its write-ahead log and index, the head of its history.
const FILES: [&str; 4] = ["journal.db", "journal.db-wal", "journal.db-shm", "history.head"];

/// An open journal.
#[derive(Debug)]
pub struct Opened {
    /// The journal.
    pub journal: Journal,
    /// Why it was begun anew, if so.
    pub rebuilt: Option<String>,
}

/// Why a store was not searched to its end.
#[derive(Debug, thiserror::Error)]
pub enum SearchFault {
    /// The store is out of reach.
    #[error("searching the store failed")]
    Store(#[source] StoreFault),
    /// What was found could not be entered.
    #[error(transparent)]
    Custody(#[from] CustodyFault),
    /// The journal failed.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

/// Why a journal is rebuilt that is not there: removed from outside, or set aside in use.
const MISSING: &str = "there was none, or it had been set aside in use";

/// Opens the journal. A ruined one is set aside and begun anew; so is one that is missing although
/// a station ran here before.
///
/// # Errors
/// Where neither is possible: a full disk, another version's journal.
pub fn open(path: &Path, stores: &[&str], first_start: bool) -> Result<Opened, StationError> {
    let fault = |source| StationError::Journal { path: path.to_owned(), source };
    let missing = !first_start && !path.exists();
    let why = match Journal::open(path) {
        Ok(journal) if !missing => return Ok(Opened { journal, rebuilt: None }),
        Ok(_) | Err(JournalError::Behind { .. }) if missing => MISSING.to_owned(),
        Err(error) if error.is_ruin() => chain(&error),
        Err(error) => return Err(fault(error)),
        Ok(journal) => return Ok(Opened { journal, rebuilt: None }),
    };
    let aside = set_aside(path).map_err(|source| StationError::SetAside { source })?;
    info!(event = "journal-set-aside", files = aside.len());
    let journal = Journal::open(path).map_err(fault)?;
    journal.begin_anew(stores, &why).map_err(fault)?;
    Ok(Opened { journal, rebuilt: Some(why) })
}

/// Whether an error shows that the journal is ruined.
pub fn is_ruin(error: &(dyn std::error::Error + 'static)) -> bool {
    of_journal(error).is_some_and(JournalError::is_ruin)
}

/// Whether an error leaves open whether the journal is damaged.
pub fn is_suspicious(error: &(dyn std::error::Error + 'static)) -> bool {
    of_journal(error).is_some_and(JournalError::is_suspicious)
}

/// The journal's own error among the causes of an error.
fn of_journal<'a>(error: &'a (dyn std::error::Error + 'static)) -> Option<&'a JournalError> {
    let mut cause = Some(error);
    while let Some(error) = cause {
        if let Some(found) = error.downcast_ref::<JournalError>() {
            return Some(found);
        }
        cause = error.source();
    }
    None
}

/// Sets an open journal aside whose ruin shows only in its use: the next start finds it
/// missing and begins it anew, instead of ending by the same fault for ever.
///
/// # Errors
/// Where its files cannot be renamed.
pub fn give_up(path: &Path, journal: &Journal) -> Result<(), StationError> {
    let fault = |source| StationError::Journal { path: path.to_owned(), source };
    journal.let_go().map_err(fault)?;
    let aside = set_aside(path).map_err(|source| StationError::SetAside { source })?;
    info!(event = "journal-set-aside", files = aside.len());
    Ok(())
}

/// Renames the journal's files to `journal.ruined-<time>-<name>`.
fn set_aside(path: &Path) -> io::Result<Vec<PathBuf>> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let time = Timestamp::now().strftime("%Y%m%dT%H%M%SZ").to_string();
    let mut aside = Vec::new();
    for name in FILES {
        let from = folder.join(name);
        let free = (0..).map(|n| folder.join(format!("journal.ruined-{time}-{n}-{name}")));
        let Some(to) = free.into_iter().find(|to| !to.exists()) else { continue };
        match fs::rename(from, &to) {
            Ok(()) => aside.push(to),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(error),
        }
    }
    durable::sync_folder(folder)?;
    Ok(aside)
}

/// Enters every record that a store holds into the journal; those that must not stay there, by a
/// person's word, when all others are known.
///
/// # Errors
/// See [`SearchFault`]; what was entered stays, and the store is searched again.
pub fn search(custody: &Custody, store: &RecordStore) -> Result<(), SearchFault> {
    let records = store.records().map_err(SearchFault::Store)?;
    let mut against = Vec::new();
    for record in &records {
        match custody.contradicts(record)? {
            true => against.push(record),
            false => custody.found(record, store.name())?,
        }
    }
    for record in against {
        let stored = match custody.holds(&record.scan) {
            true => None,
            false => store
                .stored_scan(&record.scan, record.patient.as_deref())
                .map_err(SearchFault::Store)?,
        };
        custody.found_against(record, store.name(), stored)?;
    }
    custody.journal().searched(store.name())?;
    info!(event = "store-searched", store = store.name(), records = records.len());
    Ok(())
}
