//! What an operator decides at a running station. Each decision returns a sentence in the station's language
//! on what was done. All of them block.

mod amend;
mod fault;

use std::fmt::Display;
use std::sync::Mutex;

use gaiter_flow::cause::Cause;
use gaiter_flow::round::NamedNext;
use gaiter_flow::{DeliveryState, ScanId};
use gaiter_record::SourceKind;
use gaiter_visits::Affected;
use jiff::Timestamp;
use tracing::info;

use crate::station::booth::{Booth, NameFault};
use crate::station::core::Core;
use crate::station::custody::{Acted, CustodyFault};
use crate::station::event::short;
use crate::station::journal::ScanRow;
use crate::station::runtime::{chain, locked};
use crate::store::{RecordStore, StoreFault, StoredScan};
pub(super) use amend::set as amend;
pub use amend::{Measured, Setting};
pub use fault::ActFault;

/// Tries a refused scan again, and a waiting scan at once.
pub(super) fn retry(core: &Core, row: &ScanRow) -> Result<String, ActFault> {
    let scan = short(&row.scan);
    match core.custody.retry(&row.scan)? {
        Acted::Nothing => {
            let journal = core.custody.journal();
            journal.withdraw_here(&row.scan)?;
            let is_any = |state| journal.deliveries_in(&row.scan, state).map(|due| !due.is_empty());
            let is_owed = journal.owes_revision(&row.scan)?;
            if !is_owed && !is_any(DeliveryState::Pending)? && !is_any(DeliveryState::Withdrawing)?
            {
                return Err(no_occasion(row, "act.why.nothing_to_retry"));
            }
            core.retry_now(&row.scan);
            Ok(of_scan(core, "act.tried_now", &scan))
        }
        acted => {
            let count = done(acted, row, "act.why.nothing_to_retry")?;
            info!(event = "scan-retried", scan);
            Ok(delivers(core, "act.retried", &scan, count))
        }
    }
}

/// A held scan belongs to the patient for whom it was sighted.
pub(super) fn release(core: &Core, booth: &Booth, row: &ScanRow) -> Result<String, ActFault> {
    let count = done(core.custody.release(&row.scan)?, row, "act.why.nothing_to_release")?;
    let scan = short(&row.scan);
    info!(event = "scan-released", scan);
    // It ends the round of its scan. If that cannot be written down, the round ends by time.
    core.logged(booth.decided(&row.scan));
    Ok(delivers(core, "act.released", &scan, count))
}

/// A scan that was refused, is held, or is stored without a patient needs no decision any more.
pub(super) fn give_up(core: &Core, booth: &Booth, row: &ScanRow) -> Result<String, ActFault> {
    done(core.custody.give_up(&row.scan)?, row, "act.why.nothing_to_give_up")?;
    let scan = short(&row.scan);
    info!(event = "scan-given-up", scan);
    core.logged(booth.given_up(&row.scan));
    Ok(of_scan(core, "act.given_up", &scan))
}

/// How many deliveries a decision leaves to be made; `nothing` is the key of why it does not apply.
fn done(acted: Acted, row: &ScanRow, nothing: &'static str) -> Result<usize, ActFault> {
    match acted {
        Acted::Done(count) => Ok(count),
        Acted::Nothing => Err(no_occasion(row, nothing)),
        Acted::Several => Err(ActFault::Several(row.scan.clone())),
        Acted::HasPatient => Err(ActFault::HasPatient),
        Acted::NoBytes => Err(ActFault::NoBytes(row.scan.clone())),
    }
}

fn no_occasion(row: &ScanRow, why: &'static str) -> ActFault {
    ActFault::NoOccasion { scan: row.scan.clone(), why }
}

/// A scan that came in without a patient, or is held, belongs to the patient with this id.
pub(super) fn assign(
    core: &Core,
    booth: &Booth,
    row: &ScanRow,
    id: &str,
) -> Result<String, ActFault> {
    let patient = core.identity.patient(id, SourceKind::Operator).ok_or(ActFault::NotAnId)?;
    if !core.custody.journal().owners(&row.scan)?.is_empty() {
        // Reported before its bytes are searched for.
        return Err(ActFault::HasPatient);
    }
    let assign = |stored| core.custody.assign(row, &patient, stored);
    let acted = with_bytes(core, &row.scan, None, assign)?;
    let count = done(acted, row, "act.why.just_changed")?;
    let scan = short(&row.scan);
    info!(event = "scan-assigned", scan);
    core.logged(booth.decided(&row.scan));
    Ok(delivers(core, "act.assigned", &scan, count))
}

/// A scan does not belong to the patient of this id, or to its only patient: it stays with the others or
/// becomes unassigned again.
pub(super) fn unassign(core: &Core, row: &ScanRow, from: Option<&str>) -> Result<String, ActFault> {
    let owners = core.custody.journal().owners(&row.scan)?;
    let owner = match (owners.as_slice(), from) {
        ([], _) => return Err(no_occasion(row, "act.why.unassigned")),
        ([owner], None) => owner,
        (owners, Some(from)) => owners
            .iter()
            .find(|owner| *owner == from)
            .ok_or_else(|| no_occasion(row, "act.why.not_this_patient"))?,
        (_, None) => return Err(no_occasion(row, "act.why.unassign_several")),
    };
    let unassign = |stored| core.custody.unassign(row, owner, stored);
    let acted = with_bytes(core, &row.scan, Some(owner), unassign)?;
    done(acted, row, "act.why.just_changed")?;
    let scan = short(&row.scan);
    info!(event = "scan-unassigned", scan);
    let key = if owners.len() > 1 { "act.taken_back" } else { "act.unassigned" };
    let sentence = of_scan(core, key, &scan);
    Ok(elsewhere(core, sentence))
}

/// The sentence about a scan that was taken back, with what follows outside the folders.
fn elsewhere(core: &Core, sentence: String) -> String {
    let filled = |key, sentence: String| core.config.language.filled(key, &[("said", &sentence)]);
    let is_any = |holds: fn(&dyn RecordStore) -> bool| core.stores.iter().any(holds);
    let sentence =
        if is_any(|of| of.is_server()) { filled("act.of_servers", sentence) } else { sentence };
    if is_any(|of| !of.gives_back()) { filled("act.of_practice", sentence) } else { sentence }
}

/// A person names the affected leg of the patient with this id; `None` takes it back.
pub(super) fn name_affected(
    core: &Core,
    id: &str,
    affected: Option<Affected>,
) -> Result<String, ActFault> {
    let patient = core.identity.patient(id, SourceKind::Operator).ok_or(ActFault::NotAnId)?;
    core.custody.name_affected(&patient, affected.map(Affected::word))?;
    info!(event = "affected-leg-named", at = %Timestamp::now());
    let word = affected.map_or(Affected::NOT_NAMED, Affected::word);
    Ok(core.config.language.word("act.affected", word).to_owned())
}

/// The next scan belongs to the patient with this id. `replaces` allows replacing another patient who is named
/// and not scanned yet.
pub(super) fn name_next(
    core: &Core,
    booth: &Booth,
    id: &str,
    by: SourceKind,
    replaces: bool,
) -> Result<String, ActFault> {
    named_next(core, booth.name_patient(id, by, replaces))
}

/// The next scan belongs to the patient of the worklist's entry with this key. `replaces` as of a name.
pub(super) fn name_listed(
    core: &Core,
    booth: &Booth,
    entry: &str,
    replaces: bool,
) -> Result<String, ActFault> {
    named_next(core, booth.name_listed(entry, replaces))
}

/// What naming the next patient has led to.
fn named_next(core: &Core, named: Result<NamedNext, NameFault>) -> Result<String, ActFault> {
    let next = named.map_err(|fault| match fault {
        NameFault::NotAnId => ActFault::NotAnId,
        NameFault::EntryGone => ActFault::EntryGone,
        NameFault::AnotherNamed => ActFault::AnotherNamed,
        NameFault::Journal(error) => ActFault::Journal(error),
    })?;
    let key = match next {
        NamedNext::Waits { in_doubt: true, .. } => "act.next.in_doubt",
        NamedNext::Waits { replaced: false, .. } => "act.next.press",
        NamedNext::Paired(_) => "act.next.open_press",
        NamedNext::Waits { replaced: true, .. } => "act.next.press_replaced",
        NamedNext::Opened(_, given_up) if given_up.is_empty() => "act.next.export",
        NamedNext::Opened(..) => "act.next.export_replaced",
        NamedNext::Prolonged(_) => "act.next.prolonged",
    };
    Ok(core.config.language.text(key).to_owned())
}

/// No patient is named for the next scan any more, and no press waits for its export.
pub(super) fn call_off(core: &Core, booth: &Booth) -> Result<String, ActFault> {
    let key = if booth.call_off()? { "page.done.call_off" } else { "act.nothing_expected" };
    Ok(core.config.language.text(key).to_owned())
}

/// Acts on a scan whose bytes the station has, or else its record for this patient or without one.
fn with_bytes(
    core: &Core,
    scan: &ScanId,
    patient: Option<&str>,
    act: impl Fn(Option<StoredScan>) -> Result<Acted, CustodyFault>,
) -> Result<Acted, ActFault> {
    if core.custody.holds(scan) {
        match act(None)? {
            // They have just been given up because the record has reached its store.
            Acted::NoBytes => {}
            acted => return Ok(acted),
        }
    }
    Ok(act(from_a_store(core, scan, patient)?)?)
}

/// Reads a scan from its record for this patient, or from its unassigned record.
fn from_a_store(
    core: &Core,
    scan: &ScanId,
    patient: Option<&str>,
) -> Result<Option<StoredScan>, ActFault> {
    let mut away = None;
    for store in core.stores.iter() {
        match store.stored_scan(scan, patient) {
            Ok(Some(stored)) => return Ok(Some(stored)),
            Ok(None) => {}
            // The path only holds the folder of unassigned scans here; the cause is enough.
            Err(StoreFault::Transient { source, .. }) => away = Some(Cause::of_system(&source)),
            Err(fault) => away = Some(Cause::verbatim(chain(&fault))),
        }
    }
    away.map_or(Ok(None), |why| Err(ActFault::Store(why)))
}

/// Held while the journal and then the board are changed: of two acts at once, both show the same one in the end.
static PAUSING: Mutex<()> = Mutex::new(());

/// No scan is taken in or delivered until an operator resumes; or the pause ends.
pub(super) fn pause(core: &Core, paused: bool) -> Result<String, ActFault> {
    let _alone = locked(&PAUSING);
    let changed = core.custody.journal().pause(paused)?;
    if changed {
        core.set_paused(paused);
        let event = if paused { "station-paused" } else { "station-resumed" };
        info!(event, at = %Timestamp::now());
    }
    let key = match (paused, changed) {
        (true, true) => "page.done.pause",
        (true, false) => "act.paused_already",
        (false, true) => "page.done.resume",
        (false, false) => "act.not_paused",
    };
    Ok(core.config.language.text(key).to_owned())
}

/// What was done with a scan.
fn of_scan(core: &Core, key: &'static str, scan: &str) -> String {
    core.config.language.filled(key, &[("scan", &scan)])
}

/// The same, with how many deliveries are to be made.
fn delivers(core: &Core, key: &'static str, scan: &str, count: usize) -> String {
    let language = core.config.language;
    let deliveries = match count {
        1 => language.text("act.delivery").to_owned(),
        count => language.filled("act.deliveries", &[("count", &count)]),
    };
    let words: [(&str, &dyn Display); 2] = [("scan", &scan), ("deliveries", &deliveries)];
    language.filled(key, &words)
}
