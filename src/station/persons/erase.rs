//! Carries erasures on: at each start in the station's own folder, once servers have what they are owed, and in each
//! store once it is in reach.

use std::collections::BTreeSet;
use std::path::Path;

use gaiter_flow::ScanId;
use gaiter_flow::complaint::ComplaintFigures;
use gaiter_flow::facts::{Alarm, Facts};
use gaiter_flow::patient::erasure::{Erasure, Next};
use jiff::Timestamp;
use tracing::{info, warn};

use crate::station::core::Core;
use crate::station::custody::{Custody, CustodyFault, whole_scans};
use crate::station::runtime::chain;
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
        let error = match clear_own_of(custody, stores, state_dir, &whose, erasure) {
            Ok(()) => continue,
            Err(ClearFault::Store(fault)) => fault.cause().to_string(),
            Err(ClearFault::Custody(fault)) => chain(&fault),
        };
        warn!(event = "erasure-failed", person = whose, error);
    }
}

/// Clears the station's own folder of one person, unless a server is still owed something: the workers try that at
/// once when they start, and [`go_on`] continues here once it is done.
fn clear_own_of(
    custody: &Custody,
    stores: &Stores,
    state_dir: &Path,
    whose: &str,
    mut erasure: Erasure,
) -> Result<(), ClearFault> {
    let Next::Own { patient } = erasure.next() else { return Ok(()) };
    let patient = patient.to_owned();
    if custody.waits_for_servers(whose, &mut erasure, &patient)? {
        info!(event = "erasure-waits", person = whose, owed = erasure.owed.len());
        return Ok(());
    }
    forget_given(custody, stores, &patient)?;
    custody.clear_own(whose, erasure, &patient, state_dir)?;
    info!(event = "person-erased-here", person = whose);
    Ok(())
}

/// Lets erasures that waited for servers continue, in a new generation of the workers.
///
/// # Errors
/// See [`CustodyFault`]; the next call tries again.
pub(in crate::station) fn go_on(core: &Core) -> Result<(), CustodyFault> {
    if !core.custody.strike_owed()? {
        return Ok(());
    }
    let pending = core.custody.erasures().pending();
    match pending.iter().any(|(_, erasure)| erasure.cleared.is_none() && erasure.owed.is_empty()) {
        true => core.anew.notify_one(),
        false => core.board.note(|facts| note(&core.custody, facts)),
    }
    Ok(())
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

fn waits_for<'a>(pending: impl Iterator<Item = &'a Erasure>) -> ComplaintFigures {
    let (mut own, mut servers, mut stores) = (false, BTreeSet::new(), BTreeSet::new());
    for erasure in pending {
        own |= erasure.cleared.is_none() && erasure.owed.is_empty();
        servers.extend(erasure.owed.iter().map(|owed| format!("\"{}\"", owed.store)));
        if erasure.cleared.is_some() {
            stores.extend(erasure.stores.iter().map(|store| format!("\"{store}\"")));
        }
    }
    let case = |case: &str, names: BTreeSet<String>| {
        let names: Vec<String> = names.into_iter().collect();
        ComplaintFigures::default().words("case", case).words("stores", names.join(", "))
    };
    match own {
        true => ComplaintFigures::default().words("case", "own"),
        false if !servers.is_empty() => case("servers", servers),
        false => case("stores", stores),
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
        match store.erase(patient, before, &whole_scans(&erasure)) {
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
pub(in crate::station) fn ask(
    core: &Core,
    patient: &str,
    by: &str,
    leaves_owed: bool,
) -> Result<(), CustodyFault> {
    core.custody.ask_for_erasure(patient, by, leaves_owed)?;
    info!(event = "erasure-asked", at = %Timestamp::now());
    core.anew.notify_one();
    Ok(())
}
