//! What an operator decides at a running station.

mod amend;

use gaiter_flow::round::NamedNext;
use gaiter_flow::{DeliveryState, ScanId};
use gaiter_language::Language;
use gaiter_record::SourceKind;
use gaiter_record::measure::amendment::AmendFault;
use jiff::Timestamp;
use tracing::{info, warn};

use crate::station::booth::{Booth, NameFault};
use crate::station::core::Core;
use crate::station::custody::{Acted, CustodyFault};
use crate::station::event::short;
use crate::station::journal::{JournalError, ScanRow};
use crate::station::runtime::causes::chain;
use crate::store::revision::amend as amend_record;
use crate::store::{StoreFault, StoredScan};
pub use amend::{Measured, Setting};

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

/// Why a decision was not carried out; nothing was changed.
#[derive(Debug, thiserror::Error)]
pub enum ActFault {
    /// The verb needs a scan.
    #[error("this needs the id of a scan")]
    NoScan,
    /// No scan has this id.
    #[error("no scan has this id")]
    Unknown,
    /// The scan's state does not allow the decision.
    #[error("scan {} {why}", scan.short())]
    NoOccasion {
        /// The scan.
        scan: ScanId,
        /// Its state, and what there is not to be done.
        why: &'static str,
    },
    /// It could belong to more than one patient, and the decision does not say to which.
    #[error(
        "scan {} could belong to more than one patient: name the patient with gaiter assign {}",
        .0.short(), .0.short()
    )]
    Several(ScanId),
    /// The bytes are gone.
    #[error(
        "the bytes of scan {} are no longer at the station: export it again from the scanner",
        .0.short()
    )]
    NoBytes(ScanId),
    /// The id does not match `patient.pattern`.
    #[error("this is not a patient id that patient.pattern and patient.check_digit allow")]
    NotAnId,
    /// Another patient is named and must not be replaced.
    #[error("another patient is named and not scanned yet; nothing was changed")]
    AnotherNamed,
    /// What is to be set is not possible.
    #[error("nothing was set: {0}")]
    NotSet(AmendFault),
    /// The record cannot be amended now.
    #[error("nothing was set: {}", chain(.0))]
    NotAmended(amend_record::Fault),
    /// The scan already belongs to a patient.
    #[error("the scan already belongs to a patient; nothing was changed")]
    Somebodys,
    /// Custody failed.
    #[error(transparent)]
    Custody(#[from] CustodyFault),
    /// The journal failed.
    #[error("the journal could not be read or written")]
    Journal(#[from] JournalError),
    /// The store is out of reach, and only it has the bytes.
    #[error("the store that has the scan's bytes is out of reach: {0}")]
    Store(String),
}

impl ActFault {
    /// The stable code.
    pub fn code(&self) -> &'static str {
        match self {
            ActFault::NoScan => "no-scan-named",
            ActFault::Unknown => "unknown-scan",
            ActFault::NoOccasion { .. } => "no-occasion",
            ActFault::Several(_) => "scan-of-several",
            ActFault::NoBytes(_) => "bytes-gone",
            ActFault::NotAnId => "patient-id-not-allowed",
            ActFault::AnotherNamed => "another-is-named",
            ActFault::NotSet(fault) if fault.is_far_off() => "measure-far-off",
            ActFault::NotSet(_) => "measure-not-possible",
            ActFault::NotAmended(_) => "record-not-amended",
            ActFault::Somebodys => "scan-of-a-patient",
            ActFault::Custody(_) => "custody-failed",
            ActFault::Journal(_) => "journal-failed",
            ActFault::Store(_) => "store-unavailable",
        }
    }
}

impl ActFault {
    /// The fault in a language, if it names figures; others are told by their code.
    pub fn in_words(&self, language: Language) -> Option<String> {
        match self {
            ActFault::NotSet(fault) => Some(fault.in_words(language)),
            _ => None,
        }
    }
}

/// Carries out a decision. Returns a sentence that says what was done. Blocks.
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
        Act::NameNext { id, by, replaces } => return name_next(booth, id, *by, *replaces),
        Act::CallOff => return call_off(booth),
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
            Ok(format!("scan {scan} is measured again; {} to be made", deliveries(count)))
        }
        Acted::NoBytes => Err(ActFault::NoBytes(row.scan)),
        Acted::Nothing | Acted::Several | Acted::Somebodys => {
            let journal = core.custody.journal();
            let is_any = |state| journal.deliveries_in(&row.scan, state).map(|due| !due.is_empty());
            if !is_any(DeliveryState::Pending)? && !is_any(DeliveryState::Withdrawing)? {
                let why =
                    "was not refused, and no delivery of it waits: there is nothing to try again";
                return Err(ActFault::NoOccasion { scan: row.scan, why });
            }
            core.retry_now(&row.scan);
            Ok(format!("scan {scan} is tried again now"))
        }
    }
}

fn release(core: &Core, row: ScanRow) -> Result<String, ActFault> {
    let scan = short(&row.scan);
    match core.custody.release(&row.scan)? {
        Acted::Done(count) => {
            info!(event = "scan-released", scan);
            Ok(format!("scan {scan} is released; {} to be made", deliveries(count)))
        }
        Acted::NoBytes => Err(ActFault::NoBytes(row.scan)),
        Acted::Several => Err(ActFault::Several(row.scan)),
        Acted::Nothing | Acted::Somebodys => {
            let why = "is not held: there is nothing to release";
            Err(ActFault::NoOccasion { scan: row.scan, why })
        }
    }
}

fn give_up(core: &Core, row: ScanRow) -> Result<String, ActFault> {
    let scan = short(&row.scan);
    match core.custody.give_up(&row.scan)? {
        Acted::Done(_) => {
            info!(event = "scan-given-up", scan);
            Ok(format!("scan {scan} is given up: it needs no decision any more"))
        }
        Acted::Nothing | Acted::NoBytes | Acted::Several | Acted::Somebodys => {
            let why = "waits for no decision, or was given up before: there is nothing to give up";
            Err(ActFault::NoOccasion { scan: row.scan, why })
        }
    }
}

fn assign(core: &Core, row: ScanRow, id: &str) -> Result<String, ActFault> {
    let patient = core.identity.patient(id, SourceKind::Operator).ok_or(ActFault::NotAnId)?;
    if !core.custody.journal().owners(&row.scan)?.is_empty() {
        // Reported before its bytes are searched for.
        return Err(ActFault::Somebodys);
    }
    let scan = short(&row.scan);
    let assign = |stored| core.custody.assign(&row, &patient, stored);
    match with_bytes(core, &row.scan, None, assign)? {
        Acted::Done(count) => {
            info!(event = "scan-assigned", scan);
            Ok(format!("scan {scan} is assigned; {} to be made", deliveries(count)))
        }
        Acted::Somebodys => Err(ActFault::Somebodys),
        Acted::NoBytes | Acted::Nothing | Acted::Several => Err(ActFault::NoBytes(row.scan)),
    }
}

fn unassign(core: &Core, row: ScanRow, from: Option<&str>) -> Result<String, ActFault> {
    let owners = core.custody.journal().owners(&row.scan)?;
    let no_occasion = |why| ActFault::NoOccasion { scan: row.scan.clone(), why };
    let owner = match (owners.as_slice(), from) {
        ([], _) => {
            return Err(no_occasion("is unassigned: there is nothing to take back"));
        }
        ([owner], None) => owner,
        (owners, Some(from)) => owners
            .iter()
            .find(|owner| *owner == from)
            .ok_or_else(|| no_occasion("does not belong to this patient; nothing was changed"))?,
        (_, None) => {
            let why = "belongs to more than one patient: say from whom it is taken back (gaiter \
                       unassign --from)";
            return Err(no_occasion(why));
        }
    };
    let stays = owners.len() > 1;
    let scan = short(&row.scan);
    let unassign = |stored| core.custody.unassign(&row, owner, stored);
    match with_bytes(core, &row.scan, Some(owner), unassign)? {
        Acted::Done(_) => {
            info!(event = "scan-unassigned", scan);
            let said = match stays {
                true => {
                    format!("scan {scan} is taken back from this patient and stays with the other")
                }
                false => format!("scan {scan} is unassigned again; its record goes to _unassigned"),
            };
            let of_practice = core.stores.iter().any(|store| !store.gives_back());
            Ok(match of_practice {
                true => format!("{said}; delete what was given to the practice software there"),
                false => said,
            })
        }
        Acted::Nothing | Acted::Several | Acted::Somebodys => {
            let why = "was just given to a patient, or taken back, by another operator";
            Err(ActFault::NoOccasion { scan: row.scan, why })
        }
        Acted::NoBytes => Err(ActFault::NoBytes(row.scan)),
    }
}

fn name_next(booth: &Booth, id: &str, by: SourceKind, replaces: bool) -> Result<String, ActFault> {
    let next = booth.name_patient(id, by, replaces).map_err(|fault| match fault {
        NameFault::NotAnId => ActFault::NotAnId,
        NameFault::AnotherNamed => ActFault::AnotherNamed,
        NameFault::Journal(error) => ActFault::Journal(error),
    })?;
    Ok(match next {
        NamedNext::Waits { in_doubt: true, .. } => {
            "it is not certain whose press is next, so the next scan will be held: read the card at the \
             booth, or name the patient on the page or by gaiter patient set"
        }
        NamedNext::Waits { replaced: false, .. } => {
            "the next press of the button belongs to this patient"
        }
        NamedNext::Paired(_) => "the press that is open belongs to this patient",
        NamedNext::Waits { replaced: true, .. } => {
            "the next press of the button belongs to this patient, not to the patient named before"
        }
        NamedNext::Opened(_, given_up) if given_up.is_empty() => {
            "the next export belongs to this patient"
        }
        NamedNext::Opened(..) => {
            "the next export belongs to this patient, not to the patient named before"
        }
        NamedNext::Prolonged(_) => {
            "the next export already belongs to this patient; the wait was extended"
        }
    }
    .to_owned())
}

fn call_off(booth: &Booth) -> Result<String, ActFault> {
    let any = booth.call_off()?;
    let said = if any { "called off: no export is expected" } else { "nothing was expected" };
    Ok(said.to_owned())
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
            Err(StoreFault::Transient { source, .. }) => away = Some(source.to_string()),
            Err(fault) => away = Some(chain(&fault)),
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
    Ok(match (paused, changed) {
        (true, true) => "paused: scans stay at the scanner until you resume".to_owned(),
        (true, false) => "the station is paused already".to_owned(),
        (false, true) => "resumed: scans are taken in again".to_owned(),
        (false, false) => "the station was not paused".to_owned(),
    })
}

fn deliveries(count: usize) -> String {
    if count == 1 { "1 delivery is".to_owned() } else { format!("{count} deliveries are") }
}
