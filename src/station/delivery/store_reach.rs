//! Whether a store can be reached, and what is reported about it.

use gaiter_flow::cause::Cause;
use gaiter_flow::facts::{StoreAttempt, StoreFacts, StoreRefusal};
use jiff::Timestamp;
use tracing::{info, warn};

use super::store_search;
use crate::station::core::Core;
use crate::station::journal::JournalError;
use crate::station::persons::erase::{self, ClearFault};
use crate::station::persons::stopped::renew_head;
use crate::store::{RecordStore, StoreFault};

/// Checks whether a store is in reach, and notes it on the board. A store that a rebuilt journal has
/// not searched yet is searched first, because its records must not be delivered again. The first look
/// of a run finds a journal that is older than the store's records. Blocks.
pub fn ask(core: &Core, name: &str) -> bool {
    let Some(store) = core.stores.named(name) else {
        let fault = StoreRefusal::Fault(Cause::known("not-configured", []));
        note(core, name, StoreAttempt::Look(Some(fault)));
        return false;
    };
    let asked = begin(core, store)
        .map_err(StoreRefusal::Fault)
        .and_then(|()| store.reach().map_err(|fault| refusal(&fault)))
        .and_then(|()| clear(core, store).map_err(StoreRefusal::Fault))
        .and_then(|()| know(core, store).map_err(StoreRefusal::Fault))
        .and_then(|()| core.stores.open(store).map_err(|fault| refusal(&fault)));
    let in_reach = asked.is_ok();
    note(core, name, StoreAttempt::Look(asked.err()));
    in_reach
}

/// Removes from the store what an erasure wants removed, before a search could find it; and gives it the head
/// of the history as it is since.
fn clear(core: &Core, store: &dyn RecordStore) -> Result<(), Cause> {
    erase::clear_store_of(core, store).map_err(|fault| match fault {
        ClearFault::Store(fault) => fault.cause(),
        ClearFault::Custody(fault) => core.checked(&fault),
    })?;
    let renewed = renew_head(&core.custody, store).map_err(|fault| core.checked(&fault))?;
    renewed.map_err(|fault| fault.cause())
}

/// Makes sure that the journal knows the store's records. One that is older than they are is set aside and
/// rebuilt, which searches the store. Only the first look of a run checks that: two stations that were
/// given the same id by mistake would otherwise rebuild their journals in turns.
fn know(core: &Core, store: &dyn RecordStore) -> Result<(), Cause> {
    let journal = core.custody.journal();
    let of_journal = |error: JournalError| core.checked(&error);
    if journal.is_to_be_searched(store.name()).map_err(of_journal)? {
        let searched = store_search::search(&core.custody, store);
        return searched.map_err(|fault| core.checked(&fault));
    }
    if core.stores.is_open(store) {
        return Ok(());
    }
    match store.kept_head().map_err(|fault| fault.cause())? {
        Some(head) => journal.holds_head(&head).map_err(of_journal),
        None => Ok(()),
    }
}

/// Begins a store that the journal does not know at its place. A store that it knows must be found
/// marked, so that the empty mount point of a share is not mistaken for it.
fn begin(core: &Core, store: &dyn RecordStore) -> Result<(), Cause> {
    let (journal, place) = (core.custody.journal(), store.place());
    let of_journal = |error: JournalError| core.checked(&error);
    let begun = journal.begun_at(store.name()).map_err(of_journal)?;
    if begun.as_ref() == Some(&place) {
        return Ok(());
    }
    // Created only if the station never had it: otherwise a missing folder is an unmounted share.
    store.begin(begun.is_none()).map_err(|fault| fault.cause())?;
    journal.begun(store.name(), &place).map_err(of_journal)?;
    if begun.is_some() && store.is_server() {
        let moved = journal.tally().map_err(of_journal)?.moved;
        let to_withdraw = moved.get(store.name()).copied().unwrap_or_default();
        info!(event = "store-moved", store = store.name(), to_withdraw);
    }
    Ok(())
}

/// Notes what an attempt at a store came to. Logs a change.
pub fn note(core: &Core, name: &str, attempt: StoreAttempt) {
    let Some(store) = core.stores.named(name).map(|store| store.name()) else { return };
    let is_awaited = attempt == StoreAttempt::Look(None) && awaits(core, store);
    let (before, after) = core.board.note(|facts| {
        let known = facts.stores.get(store);
        let next = StoreFacts::after(known, attempt, is_awaited, Timestamp::now());
        let after = next.refusal.clone();
        (facts.stores.insert(store, next).and_then(|known| known.refusal), after)
    });
    match (before, after) {
        (Some(StoreRefusal::Fault(_)), Some(StoreRefusal::Fault(_)))
        | (Some(StoreRefusal::NotFetched), Some(StoreRefusal::NotFetched))
        | (None, None) => {}
        (_, Some(StoreRefusal::Fault(fault))) => {
            warn!(event = "store-unavailable", store, fault = fault.to_string());
        }
        (_, Some(StoreRefusal::NotFetched)) => info!(event = "result-not-fetched", store),
        (Some(_), None) => info!(event = "store-in-reach", store),
    }
}

/// Whether a record waits for the store; if the journal fails, one does. Blocks.
fn awaits(core: &Core, store: &str) -> bool {
    let pending = core.custody.journal().pending();
    pending.map_or(true, |due| due.iter().any(|due| due.store == store))
}

/// Notes that a step at a store does not return. Logs it if that is new.
pub fn note_stalled(core: &Core, name: &str) {
    let stalled = Cause::known("no-answer", []);
    let is_known = core.board.note(|facts| {
        let refusal = facts.stores.get(name).and_then(|facts| facts.refusal.as_ref());
        refusal.and_then(StoreRefusal::fault) == Some(&stalled)
    });
    if !is_known {
        note(core, name, StoreAttempt::Look(Some(StoreRefusal::Fault(stalled))));
        info!(event = "store-stalled", store = name);
    }
}

/// Why a store takes no record, without its path.
fn refusal(fault: &StoreFault) -> StoreRefusal {
    match fault {
        StoreFault::NotFetched => StoreRefusal::NotFetched,
        _ => StoreRefusal::Fault(fault.cause()),
    }
}
