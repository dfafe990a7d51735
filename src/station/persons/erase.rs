//! Carries erasures on: at each start in the station's own folder, and in each store once it is in reach.

use std::path::Path;

use gaiter_flow::ScanId;
use gaiter_flow::complaint::Figures;
use gaiter_flow::facts::{Alarm, Facts};
use gaiter_flow::patient::erasure::{ErasedScan, Erasure, Next};
use jiff::Timestamp;
use tracing::{info, warn};

use crate::station::core::Core;
use crate::station::custody::{Custody, CustodyFault};
use crate::station::runtime::causes::chain;
use crate::station::stores::Stores;
use crate::store::{RecordStore, StoreFault};

/// Alarm: an erasure waits, for a store or for the disk.
pub(in crate::station) const PENDING: &str = "erasure-pending";

/// Why a store was not cleared.
#[derive(Debug, thiserror::Error)]
pub(in crate::station) enum ClearFault {
    /// The store is out of reach, or must be cleared before it is searched.
    #[error("the store could not be cleared")]
    Store(#[source] StoreFault),
    /// The erasure could not be noted.
    #[error(transparent)]
    Custody(#[from] CustodyFault),
}

/// Clears the station's own folder of persons whose erasure was asked for. No worker may run. What fails is
/// tried again at the next start, and does not keep the station from starting.
pub(in crate::station) fn clear_own(custody: &Custody, stores: &Stores, state_dir: &Path) {
    for (whose, erasure) in custody.erasures().pending() {
        let Next::Own { patient } = erasure.next() else { continue };
        let patient = patient.to_owned();
        let cleared = forget_given(custody, stores, &patient)
            .and_then(|()| Ok(custody.clear_own(&whose, erasure, &patient, state_dir)?));
        let error = match cleared {
            Ok(()) => {
                info!(event = "person-erased-here", person = whose);
                continue;
            }
            Err(ClearFault::Store(fault)) => fault.cause().to_string(),
            Err(ClearFault::Custody(fault)) => chain(&fault),
        };
        warn!(event = "erasure-failed", person = whose, error);
    }
}

/// Removes what the station notes of records that servers were given of a person, while the journal still knows
/// the scans. From the servers themselves nothing is removed.
fn forget_given(custody: &Custody, stores: &Stores, patient: &str) -> Result<(), ClearFault> {
    let scans = custody.journal().scans_of_person(patient).map_err(CustodyFault::from)?;
    let scans: Vec<ScanId> = scans.into_iter().map(|theirs| theirs.scan).collect();
    let (now, mut stores) = (Timestamp::now(), stores.iter());
    let erased = stores.try_for_each(|store| match store.is_server() {
        true => store.erase(patient, now, &scans),
        false => Ok(()),
    });
    erased.map_err(ClearFault::Store)
}

/// Notes on the board that an erasure waits, or that none does.
pub(in crate::station) fn note(custody: &Custody, facts: &mut Facts) {
    let pending = custody.erasures().pending();
    let since = pending.iter().map(|(_, erasure)| erasure.at).min();
    let Some(since) = since else {
        facts.alarms.remove(PENDING);
        return;
    };
    let figures = waits_for(pending.iter().map(|(_, erasure)| erasure));
    facts.alarms.insert(PENDING, Alarm { figures, since });
}

fn waits_for<'a>(pending: impl Iterator<Item = &'a Erasure>) -> Figures {
    let (mut own, mut stores) = (false, Vec::new());
    for erasure in pending {
        own |= erasure.cleared.is_none();
        stores.extend(erasure.stores.iter().map(|store| format!("\"{store}\"")));
    }
    stores.sort();
    stores.dedup();
    match own {
        true => Figures::default().words("case", "own"),
        false => Figures::default().words("case", "stores").words("stores", stores.join(", ")),
    }
}

/// Clears a store of persons whose erasure waits for it. Returns for how many. Where something in a person's
/// own folder stops it, that erasure waits alone, and its alarm stays.
///
/// # Errors
/// See [`ClearFault`]: the store is out of reach. It is then cleared at the next attempt.
pub(in crate::station) fn clear_store(
    custody: &Custody,
    store: &dyn RecordStore,
) -> Result<usize, ClearFault> {
    let mut cleared = 0;
    let searched = custody.journal().is_to_be_searched(store.name());
    let is_to_be_searched = searched.map_err(CustodyFault::from)?;
    for (whose, erasure) in custody.erasures().pending() {
        let Next::Stores { patient, before } = erasure.next() else { continue };
        if !erasure.stores.iter().any(|name| name == store.name()) {
            continue;
        }
        match store.erase(patient, before, &whole(&erasure)) {
            Ok(()) => {}
            // A store that is still to be searched would bring the person back.
            Err(StoreFault::Permanent(misfit)) if !is_to_be_searched => {
                let (store, error) = (store.name(), misfit.to_string());
                warn!(event = "erasure-failed", person = whose, store, error);
                continue;
            }
            Err(fault) => return Err(ClearFault::Store(fault)),
        }
        custody.store_cleared(&whose, store.name())?;
        info!(event = "person-erased-in-store", person = whose, store = store.name());
        cleared += 1;
    }
    Ok(cleared)
}

/// The scans of an erased person that no one else has.
fn whole(erasure: &Erasure) -> Vec<ScanId> {
    let whole = erasure.scans.iter().filter(|scan| scan.is_whole);
    whole.filter_map(|ErasedScan { sha256, .. }| ScanId::parse(sha256).ok()).collect()
}

/// As [`clear_store`], for a running station: notes what has become of it on the board.
pub(in crate::station) fn clear_store_of(
    core: &Core,
    store: &dyn RecordStore,
) -> Result<(), ClearFault> {
    let cleared = clear_store(&core.custody, store)?;
    if cleared > 0 {
        core.board.note(|facts| note(&core.custody, facts));
    }
    Ok(())
}

/// Asks for an erasure. The running station carries it on in a new generation of its workers.
pub(in crate::station) fn ask(core: &Core, patient: &str, by: &str) -> Result<(), CustodyFault> {
    core.custody.ask_for_erasure(patient, by)?;
    info!(event = "erasure-asked", at = %Timestamp::now());
    core.anew.notify_one();
    Ok(())
}
