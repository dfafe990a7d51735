//! What a person decides at a running station.

use jiff::Timestamp;
use tracing::info;

use crate::flow::capture::NamedNext;
use crate::flow::{DeliveryState, ScanId};
use crate::record::SourceKind;
use crate::station::assembly::Station;
use crate::station::booth::NameFault;
use crate::station::custody::{Acted, CustodyFault};
use crate::station::error::chain;
use crate::station::event::short;
use crate::station::journal::{JournalError, ScanRow};
use crate::store::{StoreFault, StoredScan};

/// A decision.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Act {
    /// A refused scan is to be tried again, and one that waits at once.
    Retry,
    /// A held scan is the patient's for whom it was sighted.
    Release,
    /// A scan that came in for nobody, or is held, is the patient's of this id.
    Assign(String),
    /// A scan is not its patient's: it is nobody's again.
    Unassign,
    /// A refused scan, or a held one that is somebody's already, needs no decision any more.
    GiveUp,
    /// The next scan is of this patient.
    NameNext {
        /// The id.
        id: String,
        /// Who says so.
        by: SourceKind,
        /// Another patient who is named and was not scanned is so no more.
        replaces: bool,
    },
    /// Nobody is named for the next scan any more, and no press awaits its export.
    CallOff,
    /// No scan is to be taken or delivered until somebody resumes.
    Pause,
    /// Go on.
    Resume,
}

/// Why a decision was not carried out; nothing was changed.
#[derive(Debug, thiserror::Error)]
pub enum ActFault {
    /// The verb needs a scan.
    #[error("this needs the id of a scan")]
    NoScan,
    /// Nobody knows this scan.
    #[error("no scan has this id")]
    Unknown,
    /// The scan's state gives no occasion.
    #[error("{0}")]
    NoOccasion(&'static str),
    /// It could be of more than one patient, and the decision says not of which.
    #[error("it could be of more than one patient: say whose it is with gaiter assign")]
    Several,
    /// The bytes are gone.
    #[error("its bytes are not at the station any more: let the scanner export it again")]
    NoBytes,
    /// The id is against `patient.pattern`.
    #[error("this is no patient id that patient.pattern and patient.check_digit allow")]
    NotAnId,
    /// Another patient is named, and is not to be replaced.
    #[error("another patient is named and was not scanned; nothing was changed")]
    AnotherNamed,
    /// The scan is somebody's.
    #[error("the scan is a named patient's already; nothing was changed")]
    Somebodys,
    /// Custody failed.
    #[error(transparent)]
    Custody(#[from] CustodyFault),
    /// The journal failed.
    #[error("the journal could not be read or written")]
    Journal(#[from] JournalError),
    /// The store is out of reach, and the bytes are there only.
    #[error("the store that has the scan's bytes is out of reach: {0}")]
    Store(String),
}

impl ActFault {
    /// The stable code.
    pub fn code(&self) -> &'static str {
        match self {
            ActFault::NoScan => "no-scan-named",
            ActFault::Unknown => "unknown-scan",
            ActFault::NoOccasion(_) => "no-occasion",
            ActFault::Several => "scan-of-several",
            ActFault::NoBytes => "bytes-gone",
            ActFault::NotAnId => "patient-id-not-allowed",
            ActFault::AnotherNamed => "another-is-named",
            ActFault::Somebodys => "scan-of-a-patient",
            ActFault::Custody(_) => "custody-failed",
            ActFault::Journal(_) => "journal-failed",
            ActFault::Store(_) => "store-unavailable",
        }
    }
}

/// Carries a decision out; says in a sentence what was done. Blocks.
///
/// # Errors
/// See [`ActFault`].
pub fn act(station: &Station, scan: Option<&ScanId>, act: &Act) -> Result<String, ActFault> {
    let said = match act {
        Act::Pause => return pause(station, true),
        Act::Resume => return pause(station, false),
        Act::Retry => retry(station, known(station, scan)?),
        Act::Release => release(station, known(station, scan)?),
        Act::Assign(id) => assign(station, known(station, scan)?, id),
        Act::Unassign => unassign(station, known(station, scan)?),
        Act::GiveUp => give_up(station, known(station, scan)?),
        Act::NameNext { id, by, replaces } => return name_next(station, id, *by, *replaces),
        Act::CallOff => return call_off(station),
    };
    if let Err(ActFault::Custody(fault)) = &said {
        station.check_corruption(fault);
    }
    station.work.notify_one();
    said
}

fn known(station: &Station, scan: Option<&ScanId>) -> Result<ScanRow, ActFault> {
    let scan = scan.ok_or(ActFault::NoScan)?;
    station.custody.journal().scan(scan)?.ok_or(ActFault::Unknown)
}

fn retry(station: &Station, row: ScanRow) -> Result<String, ActFault> {
    let scan = short(&row.scan);
    match station.custody.retry(&row.scan)? {
        Acted::Done(count) => {
            info!(event = "scan-retried", scan);
            Ok(format!("scan {scan} is measured again; {} to be made", deliveries(count)))
        }
        Acted::NoBytes => Err(ActFault::NoBytes),
        Acted::Nothing | Acted::Several | Acted::Somebodys => {
            let journal = station.custody.journal();
            let is_any = |state| journal.deliveries_in(&row.scan, state).map(|due| !due.is_empty());
            if !is_any(DeliveryState::Pending)? && !is_any(DeliveryState::Withdrawing)? {
                let why = "it was not refused and nothing of it waits; there is nothing to retry";
                return Err(ActFault::NoOccasion(why));
            }
            station.retry_now(&row.scan);
            Ok(format!("scan {scan} is tried again now"))
        }
    }
}

fn release(station: &Station, row: ScanRow) -> Result<String, ActFault> {
    let scan = short(&row.scan);
    match station.custody.release(&row.scan)? {
        Acted::Done(count) => {
            info!(event = "scan-released", scan);
            Ok(format!("scan {scan} is released; {} to be made", deliveries(count)))
        }
        Acted::NoBytes => Err(ActFault::NoBytes),
        Acted::Several => Err(ActFault::Several),
        Acted::Nothing | Acted::Somebodys => {
            Err(ActFault::NoOccasion("it is not held; there is nothing to release"))
        }
    }
}

fn give_up(station: &Station, row: ScanRow) -> Result<String, ActFault> {
    let scan = short(&row.scan);
    match station.custody.give_up(&row.scan)? {
        Acted::Done(_) => {
            info!(event = "scan-given-up", scan);
            Ok(format!("scan {scan} is given up: it needs no decision any more"))
        }
        Acted::Nothing | Acted::NoBytes | Acted::Several | Acted::Somebodys => {
            let why = "it was not refused, and it is not held beside somebody's record, or it was given \
                       up before; there is nothing to give up";
            Err(ActFault::NoOccasion(why))
        }
    }
}

fn assign(station: &Station, row: ScanRow, id: &str) -> Result<String, ActFault> {
    let patient = station.identity.patient(id, SourceKind::Operator).ok_or(ActFault::NotAnId)?;
    if !station.custody.journal().owners(&row.scan)?.is_empty() {
        // Said before its bytes are looked for.
        return Err(ActFault::Somebodys);
    }
    let scan = short(&row.scan);
    let assign = |stored| station.custody.assign(&row, &patient, stored);
    match with_bytes(station, &row.scan, None, assign)? {
        Acted::Done(count) => {
            info!(event = "scan-assigned", scan);
            Ok(format!("scan {scan} is assigned; {} to be made", deliveries(count)))
        }
        Acted::Somebodys => Err(ActFault::Somebodys),
        Acted::NoBytes | Acted::Nothing | Acted::Several => Err(ActFault::NoBytes),
    }
}

fn unassign(station: &Station, row: ScanRow) -> Result<String, ActFault> {
    let owners = station.custody.journal().owners(&row.scan)?;
    let owner = match owners.as_slice() {
        [] => return Err(ActFault::NoOccasion("it is nobody's; there is nothing to take back")),
        [owner] => owner,
        _ => {
            let why = "it is more than one patient's: take the wrong record away by hand";
            return Err(ActFault::NoOccasion(why));
        }
    };
    let scan = short(&row.scan);
    let unassign = |stored| station.custody.unassign(&row, owner, stored);
    match with_bytes(station, &row.scan, Some(owner), unassign)? {
        Acted::Done(_) => {
            info!(event = "scan-unassigned", scan);
            let said = format!("scan {scan} is nobody's again; its record goes to _unassigned");
            let of_practice = station.stores.iter().any(|store| !store.gives_back());
            Ok(match of_practice {
                true => format!("{said}; delete what the practice software was given there"),
                false => said,
            })
        }
        Acted::Nothing | Acted::Several | Acted::Somebodys => {
            Err(ActFault::NoOccasion("somebody else has just decided whose it is"))
        }
        Acted::NoBytes => Err(ActFault::NoBytes),
    }
}

fn name_next(
    station: &Station,
    id: &str,
    by: SourceKind,
    replaces: bool,
) -> Result<String, ActFault> {
    let next = station.name_patient(id, by, replaces).map_err(|fault| match fault {
        NameFault::NotAnId => ActFault::NotAnId,
        NameFault::AnotherNamed => ActFault::AnotherNamed,
        NameFault::Journal(error) => ActFault::Journal(error),
    })?;
    Ok(match next {
        NamedNext::Waits { in_doubt: true, .. } => {
            "it is not certain whose the next press is: its scan will be held; read the card at the \
             booth, or name the patient on the page or by gaiter patient set"
        }
        NamedNext::Waits { replaced: false, .. } => "the next press of the button is this patient's",
        NamedNext::Paired(_) => "the press that is open is this patient's",
        NamedNext::Waits { replaced: true, .. } => {
            "the next press of the button is this patient's, and not of the one who was named before"
        }
        NamedNext::Opened(_, given_up) if given_up.is_empty() => "the next export is this patient's",
        NamedNext::Opened(..) => {
            "the next export is this patient's, and not of the one who was named before"
        }
        NamedNext::Prolonged(_) => "the next export is this patient's already; it is awaited longer",
    }
    .to_owned())
}

fn call_off(station: &Station) -> Result<String, ActFault> {
    let any = station.call_off()?;
    let said = if any { "called off: nobody's export is awaited" } else { "nothing was awaited" };
    Ok(said.to_owned())
}

/// Acts on a scan whose bytes the station has, or its record for this patient or for nobody.
fn with_bytes(
    station: &Station,
    scan: &ScanId,
    patient: Option<&str>,
    act: impl Fn(Option<StoredScan>) -> Result<Acted, CustodyFault>,
) -> Result<Acted, ActFault> {
    if station.custody.holds(scan) {
        match act(None)? {
            // They have just been given up, for the record has reached its store.
            Acted::NoBytes => {}
            acted => return Ok(acted),
        }
    }
    Ok(act(from_a_store(station, scan, patient)?)?)
}

/// A scan from its record for this patient, or for nobody.
fn from_a_store(
    station: &Station,
    scan: &ScanId,
    patient: Option<&str>,
) -> Result<Option<StoredScan>, ActFault> {
    let mut away = None;
    for store in &station.stores {
        match store.stored_scan(scan, patient) {
            Ok(Some(stored)) => return Ok(Some(stored)),
            Ok(None) => {}
            // The path holds nothing here but the folder of scans for nobody; the cause is enough.
            Err(StoreFault::Transient { source, .. }) => away = Some(source.to_string()),
            Err(fault) => away = Some(chain(&fault)),
        }
    }
    away.map_or(Ok(None), |why| Err(ActFault::Store(why)))
}

fn pause(station: &Station, paused: bool) -> Result<String, ActFault> {
    let changed = station.custody.journal().pause(paused)?;
    station.set_paused(paused);
    if changed {
        let event = if paused { "station-paused" } else { "station-resumed" };
        info!(event, at = %Timestamp::now());
        station.intake_gate(0);
    }
    station.work.notify_one();
    Ok(match (paused, changed) {
        (true, true) => "paused: scans stay at the scanner until you resume".to_owned(),
        (true, false) => "it is paused already".to_owned(),
        (false, true) => "resumed".to_owned(),
        (false, false) => "it was not paused".to_owned(),
    })
}

fn deliveries(count: usize) -> String {
    if count == 1 { "1 delivery is".to_owned() } else { format!("{count} deliveries are") }
}
