//! Whether a store can be reached, and what is reported about it.

use jiff::Timestamp;
use tracing::{info, warn};

use super::store_search;
use crate::flow::facts::StoreFacts;
use crate::station::core::Core;
use crate::station::journal::JournalError;
use crate::store::{RecordStore, StoreFault};

/// Checks whether a store is in reach, and notes it on the board. A store that a rebuilt journal has
/// not searched yet is searched first, because its records must not be delivered again. Blocks.
pub fn ask(core: &Core, name: &str) -> bool {
    let Some(store) = core.stores.named(name) else {
        note(core, name, Some("it is no longer in the configuration".to_owned()));
        return false;
    };
    let reached = begin(core, store).and_then(|()| {
        let open = || core.stores.open(store);
        store.reach().and_then(|()| open()).map_err(|fault| without_path(&fault))
    });
    let asked = reached.and_then(|()| {
        let to_be_searched = core.custody.journal().is_to_be_searched(name);
        if !to_be_searched.map_err(|error| core.checked_text(&error))? {
            return Ok(());
        }
        store_search::search(&core.custody, store).map_err(|fault| core.checked_text(&fault))
    });
    let in_reach = asked.is_ok();
    note(core, name, asked.err());
    in_reach
}

/// Begins a store that the journal does not know at its place. A store that it knows must be found
/// marked, so that the empty mount point of a share is not mistaken for it.
fn begin(core: &Core, store: &RecordStore) -> Result<(), String> {
    let (journal, place) = (core.custody.journal(), store.place());
    let of_journal = |error: JournalError| core.checked_text(&error);
    let begun = journal.begun_at(store.name()).map_err(of_journal)?;
    if begun.as_ref() == Some(&place) {
        return Ok(());
    }
    // Created only if the station never had it: otherwise a missing folder is an unmounted share.
    store.begin(begun.is_none()).map_err(|fault| without_path(&fault))?;
    journal.begun(store.name(), &place).map_err(of_journal)
}

/// Notes the state of a store; without a fault it is in reach. Logs a change.
pub fn note(core: &Core, name: &str, fault: Option<String>) {
    let Some(store) = core.stores.named(name).map(RecordStore::name) else { return };
    let mut before = None;
    core.board.note(|facts| {
        let known = facts.stores.get(store);
        before = known.and_then(|known| known.fault.clone());
        if known.is_none_or(|known| known.fault.is_some() != fault.is_some()) {
            let since = Timestamp::now();
            facts.stores.insert(store, StoreFacts { fault: fault.clone(), since });
        } else if let Some(known) = facts.stores.get_mut(store) {
            known.fault.clone_from(&fault);
        }
    });
    match (before, fault) {
        (None, Some(fault)) => warn!(event = "store-unavailable", store, fault),
        (Some(_), None) => info!(event = "store-in-reach", store),
        _ => {}
    }
}

/// Notes that a step at a store does not return. Returns whether that is new.
pub fn note_stalled(core: &Core, name: &str) -> bool {
    const STALLED: &str = "it does not answer";
    let mut known = false;
    core.board.note(|facts| {
        let fault = facts.stores.get(name).and_then(|facts| facts.fault.as_deref());
        known = fault == Some(STALLED);
    });
    if known {
        return false;
    }
    note(core, name, Some(STALLED.to_owned()));
    true
}

/// A store's fault without its path.
fn without_path(fault: &StoreFault) -> String {
    match fault {
        StoreFault::Transient { what, source, .. } => format!("{what} failed: {source}"),
        StoreFault::NotFetched => fault.to_string(),
        StoreFault::Permanent(misfit) => misfit.to_string(),
    }
}
