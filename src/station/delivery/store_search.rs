//! Searches a store for records that a rebuilt journal does not know.

use std::path::Path;

use tracing::info;

use crate::station::custody::{Custody, CustodyFault};
use crate::station::journal::JournalError;
use crate::store::revision::stored::Stored;
use crate::store::{FoundRecord, RecordStore, StoreFault, revision};

/// Why a store was not searched completely.
#[derive(Debug, thiserror::Error)]
pub enum SearchFault {
    /// The store is out of reach.
    #[error("searching the store failed")]
    Store(#[source] StoreFault),
    /// A record that was found could not be entered.
    #[error(transparent)]
    Custody(#[from] CustodyFault),
    #[error(transparent)]
    Journal(#[from] JournalError),
}

/// Enters every record that a store holds into the journal. Records that must not stay there because of
/// an operator's decision come last, when all others are known.
///
/// # Errors
/// See [`SearchFault`]; what was entered stays, and the store is searched again.
pub fn search(custody: &Custody, store: &dyn RecordStore) -> Result<(), SearchFault> {
    let records = store.records().map_err(SearchFault::Store)?;
    let mut against = Vec::new();
    for record in &records {
        match custody.contradicts(record)? {
            true => against.push(record),
            false => custody.found(record, store.name())?,
        }
        note_amended(custody, record)?;
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
    // First the head: a store that keeps another journal's head would have this one rebuilt, too.
    if let Some(head) = custody.journal().head_line()? {
        store.keep_head(&head).map_err(SearchFault::Store)?;
    }
    custody.journal().searched(store.name())?;
    info!(event = "store-searched", store = store.name(), records = records.len());
    Ok(())
}

/// Notes that a record was amended: whether other stores were given the latest revision is not known any
/// more.
fn note_amended(custody: &Custody, record: &FoundRecord) -> Result<(), JournalError> {
    let patient = record.patient.as_deref().unwrap_or_default();
    let Some(folder) = custody.journal().record_folder(&record.scan, patient)? else {
        return Ok(());
    };
    let folder = Path::new(&folder);
    let latest = revision::latest(folder);
    let is_amended = latest != folder
        && Stored::in_folder(&latest).is_ok_and(|stored| !stored.record.amendments.is_empty());
    if is_amended { custody.journal().found_amended(&record.scan, patient) } else { Ok(()) }
}
