//! What an operator decides at a running station.

mod amend;
mod fault;

use std::fmt::Display;

use gaiter_flow::cause::Cause;
use gaiter_flow::round::NamedNext;
use gaiter_flow::{DeliveryState, ScanId};
use gaiter_record::SourceKind;
use gaiter_visits::Affected;
use jiff::Timestamp;
use tracing::{info, warn};

use crate::station::booth::{Booth, NameFault};
use crate::station::core::Core;
use crate::station::custody::{Acted, CustodyFault};
use crate::station::event::short;
use crate::station::journal::{JournalError, ScanRow};
use crate::station::runtime::causes::chain;
use crate::store::{RecordStore, StoreFault, StoredScan};
pub use amend::{Measured, Setting};
pub use fault::ActFault;

/// A decision.
#[derive(Debug, Clone, PartialEq)]
pub enum Act {
    /// Try a refused scan again, and a waiting scan at once.
    Retry,
    /// A held scan belongs to the patient for whom it was sighted.
    Release,
    /// A scan that came in without a patient, or is held, belongs to the patient with this id.
    Assign(String),
    /// A scan does not belong to the patient of this id, or to its only patient: it stays with the others
    /// or becomes unassigned again.
    Unassign(Option<String>),
    /// A scan that was refused, is held, or is stored without a patient needs no decision any more.
    GiveUp,
    /// A person sets measures of the record of the patient with this id, or of the only one.
    Amend(Option<String>, Setting),
    /// A person names the affected leg of the patient with this id; `None` takes it back.
    NameAffected(String, Option<Affected>),
    /// The next scan belongs to this patient.
    NameNext {
        /// The id.
        id: String,
        /// Where the name comes from.
        by: SourceKind,
        /// Replace another patient who is named and not scanned yet.
        replaces: bool,
    },
    /// No patient is named for the next scan any more, and no press waits for its export.
    CallOff,
    /// No scan is taken in or delivered until an operator resumes.
    Pause,
    /// End the pause.
    Resume,
}

/// Carries out a decision. Returns a sentence in the station's language that says what was done. Blocks.
///
/// # Errors
/// See [`ActFault`].
pub fn act(
    core: &Core,
    booth: &Booth,
    scan: Option<&ScanId>,
    act: &Act,
) -> Result<String, ActFault> {
    let said = match act {
        Act::Pause => return pause(core, true),
        Act::Resume => return pause(core, false),
        Act::Retry => retry(core, known(core, scan)?),
        Act::Release => {
            ends_round(scan, release(core, known(core, scan)?), |scan| booth.decided(scan))
        }
        Act::Assign(id) => {
            ends_round(scan, assign(core, known(core, scan)?, id), |scan| booth.decided(scan))
        }
        Act::Unassign(from) => unassign(core, known(core, scan)?, from.as_deref()),
        Act::GiveUp => {
            ends_round(scan, give_up(core, known(core, scan)?), |scan| booth.given_up(scan))
        }
        Act::Amend(patient, setting) => {
            amend::set(core, booth, &known(core, scan)?, patient.as_deref(), setting)
        }
        Act::NameAffected(id, affected) => name_affected(core, id, *affected),
        Act::NameNext { id, by, replaces } => {
            return name_next(core, booth, (id, *by, *replaces));
        }
        Act::CallOff => return call_off(core, booth),
    };
    if let Err(ActFault::Custody(fault)) = &said {
        core.check_corruption(fault);
    }
    core.work.notify_one();
    said
}

/// A decision ends the round of its scan. If that cannot be written down, the round ends by time.
fn ends_round(
    scan: Option<&ScanId>,
    said: Result<String, ActFault>,
    end: impl Fn(&ScanId) -> Result<(), JournalError>,
) -> Result<String, ActFault> {
    if let (Ok(_), Some(scan)) = (&said, scan)
        && let Err(error) = end(scan)
    {
        warn!(event = "journal-failed", error = chain(&error));
    }
    said
}

fn known(core: &Core, scan: Option<&ScanId>) -> Result<ScanRow, ActFault> {
    let scan = scan.ok_or(ActFault::NoScan)?;
    core.custody.journal().scan(scan)?.ok_or(ActFault::Unknown)
}

fn retry(core: &Core, row: ScanRow) -> Result<String, ActFault> {
    let scan = short(&row.scan);
    match core.custody.retry(&row.scan)? {
        Acted::Done(count) => {
            info!(event = "scan-retried", scan);
            Ok(delivers(core, "act.retried", &scan, count))
        }
        Acted::NoBytes => Err(ActFault::NoBytes(row.scan)),
        Acted::Nothing | Acted::Several | Acted::HasPatient => {
            let journal = core.custody.journal();
            journal.withdraw_here(&row.scan)?;
            let is_any = |state| journal.deliveries_in(&row.scan, state).map(|due| !due.is_empty());
            let is_owed = journal.owes_revision(&row.scan)?;
            if !is_owed && !is_any(DeliveryState::Pending)? && !is_any(DeliveryState::Withdrawing)?
            {
                let why = "act.why.nothing_to_retry";
                return Err(ActFault::NoOccasion { scan: row.scan, why });
            }
            core.retry_now(&row.scan);
            Ok(of_scan(core, "act.tried_now", &scan))
        }
    }
}

fn release(core: &Core, row: ScanRow) -> Result<String, ActFault> {
    let scan = short(&row.scan);
    match core.custody.release(&row.scan)? {
        Acted::Done(count) => {
            info!(event = "scan-released", scan);
            Ok(delivers(core, "act.released", &scan, count))
        }
        Acted::NoBytes => Err(ActFault::NoBytes(row.scan)),
        Acted::Several => Err(ActFault::Several(row.scan)),
        Acted::Nothing | Acted::HasPatient => {
            let why = "act.why.nothing_to_release";
            Err(ActFault::NoOccasion { scan: row.scan, why })
        }
    }
}

fn give_up(core: &Core, row: ScanRow) -> Result<String, ActFault> {
    let scan = short(&row.scan);
    match core.custody.give_up(&row.scan)? {
        Acted::Done(_) => {
            info!(event = "scan-given-up", scan);
            Ok(of_scan(core, "act.given_up", &scan))
        }
        Acted::Nothing | Acted::NoBytes | Acted::Several | Acted::HasPatient => {
            let why = "act.why.nothing_to_give_up";
            Err(ActFault::NoOccasion { scan: row.scan, why })
        }
    }
}

fn assign(core: &Core, row: ScanRow, id: &str) -> Result<String, ActFault> {
    let patient = core.identity.patient(id, SourceKind::Operator).ok_or(ActFault::NotAnId)?;
    if !core.custody.journal().owners(&row.scan)?.is_empty() {
        // Reported before its bytes are searched for.
        return Err(ActFault::HasPatient);
    }
    let scan = short(&row.scan);
    let assign = |stored| core.custody.assign(&row, &patient, stored);
    match with_bytes(core, &row.scan, None, assign)? {
        Acted::Done(count) => {
            info!(event = "scan-assigned", scan);
            Ok(delivers(core, "act.assigned", &scan, count))
        }
        Acted::HasPatient => Err(ActFault::HasPatient),
        Acted::NoBytes | Acted::Nothing | Acted::Several => Err(ActFault::NoBytes(row.scan)),
    }
}

fn unassign(core: &Core, row: ScanRow, from: Option<&str>) -> Result<String, ActFault> {
    let owners = core.custody.journal().owners(&row.scan)?;
    let no_occasion = |why| ActFault::NoOccasion { scan: row.scan.clone(), why };
    let owner = match (owners.as_slice(), from) {
        ([], _) => {
            return Err(no_occasion("act.why.unassigned"));
        }
        ([owner], None) => owner,
        (owners, Some(from)) => owners
            .iter()
            .find(|owner| *owner == from)
            .ok_or_else(|| no_occasion("act.why.not_this_patient"))?,
        (_, None) => return Err(no_occasion("act.why.unassign_several")),
    };
    let stays = owners.len() > 1;
    let scan = short(&row.scan);
    let unassign = |stored| core.custody.unassign(&row, owner, stored);
    match with_bytes(core, &row.scan, Some(owner), unassign)? {
        Acted::Done(_) => {
            info!(event = "scan-unassigned", scan);
            let key = if stays { "act.taken_back" } else { "act.unassigned" };
            let said = of_scan(core, key, &scan);
            Ok(elsewhere(core, said))
        }
        Acted::Nothing | Acted::Several | Acted::HasPatient => {
            let why = "act.why.just_changed";
            Err(ActFault::NoOccasion { scan: row.scan, why })
        }
        Acted::NoBytes => Err(ActFault::NoBytes(row.scan)),
    }
}

/// What was said of a scan that was taken back, with what comes of it outside the folders.
fn elsewhere(core: &Core, said: String) -> String {
    let filled = |key, said: String| core.config.language.filled(key, &[("said", &said)]);
    let is_any = |holds: fn(&dyn RecordStore) -> bool| core.stores.iter().any(holds);
    let said = if is_any(|of| of.is_server()) { filled("act.of_servers", said) } else { said };
    if is_any(|of| !of.gives_back()) { filled("act.of_practice", said) } else { said }
}

fn name_affected(core: &Core, id: &str, affected: Option<Affected>) -> Result<String, ActFault> {
    let patient = core.identity.patient(id, SourceKind::Operator).ok_or(ActFault::NotAnId)?;
    core.custody.name_affected(&patient, affected.map(Affected::word))?;
    info!(event = "affected-leg-named", at = %Timestamp::now());
    let word = affected.map_or(Affected::NOT_NAMED, Affected::word);
    Ok(core.config.language.word("act.affected", word).to_owned())
}

fn name_next(
    core: &Core,
    booth: &Booth,
    (id, by, replaces): (&str, SourceKind, bool),
) -> Result<String, ActFault> {
    let next = booth.name_patient(id, by, replaces).map_err(|fault| match fault {
        NameFault::NotAnId => ActFault::NotAnId,
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

fn call_off(core: &Core, booth: &Booth) -> Result<String, ActFault> {
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
            Err(fault) => away = Some(Cause::said(chain(&fault))),
        }
    }
    away.map_or(Ok(None), |why| Err(ActFault::Store(why)))
}

fn pause(core: &Core, paused: bool) -> Result<String, ActFault> {
    let changed = core.custody.journal().pause(paused)?;
    core.set_paused(paused);
    if changed {
        let event = if paused { "station-paused" } else { "station-resumed" };
        info!(event, at = %Timestamp::now());
        core.intake_gate(0);
    }
    core.work.notify_one();
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
