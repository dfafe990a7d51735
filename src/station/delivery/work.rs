//! The work on one scan: measure it in its own process, put its record into a store or take it back,
//! and update the journal. All of it blocks.

use std::path::Path;
use std::time::{Duration, Instant};

use gaiter_flow::complaint::ComplaintFigures;
use gaiter_flow::facts::{StoreAttempt, StoreRefusal};
use gaiter_flow::lifecycle::HANDED_OVER;
use gaiter_flow::outbox::Ended;
use gaiter_language::Language;
use gaiter_record::{FIRST_REVISION, RecordFile};
use jiff::{SignedDuration, Timestamp};
use tracing::{info, warn};

use super::measuring::{self, MeasureOutcome};
use super::{store_reach, stored_record};
use crate::station::booth::Booth;
use crate::station::core::Core;
use crate::station::custody::CustodyFault;
use crate::station::custody::quarantine::{Reason, Stage};
use crate::station::event::{StationEvent, short};
use crate::station::journal::{Due, JournalError, KEPT, ScanRow};
use crate::station::runtime::chain;
use crate::store::{Delivery, RecordStore, Rejection, ServerFault, StoreFault, TakeBack};

/// The code of a delivery that a server does not take now, while it may take others.
pub const NOT_TAKEN: &str = "not-taken-now";

/// What a server was sent appears there within so long, even if its answer was lost and it takes objects in overnight.
const APPEARS_WITHIN: SignedDuration = SignedDuration::from_hours(24);

/// A scan that has been measured for a patient, now or before.
#[derive(Debug)]
pub struct Ready {
    row: ScanRow,
    files: Vec<RecordFile>,
    /// What to do before the patient dresses; empty if nothing.
    to_do: Vec<String>,
}

/// Why work did not finish.
#[derive(Debug)]
pub(super) enum DeliveryFault {
    /// It never will finish.
    Refused(Reason),
    /// The record that was to be taken back was changed, or something is in its way; the rejection states
    /// what. It stays where it is until an operator has checked it.
    Kept(Rejection),
    /// It may finish later.
    PutOff { code: &'static str, error: String },
    /// It may finish later; the store may have something against this record alone.
    NotTaken { error: String },
    /// It may finish when the store is in reach.
    StoreFailed { code: &'static str, refusal: StoreRefusal },
    /// It may finish when custody works again.
    Custody(CustodyFault),
}

/// Measures the scan of a delivery on `threads` threads; or takes its record from the first store, if that may have it
/// and has it. If there is nothing to put into a store, returns how the work ended.
pub fn prepare(
    booth: &Booth,
    due: &Due,
    threads: usize,
    may_be_stored: bool,
) -> Result<Ready, Ended> {
    let stored = if may_be_stored { stored(booth, due).transpose() } else { None };
    let ready = stored.unwrap_or_else(|| measured(booth, due, threads));
    ready.map_err(|fault| note_fault(booth, due, fault))
}

fn stored(booth: &Booth, due: &Due) -> Result<Option<Ready>, DeliveryFault> {
    let Some(files) = stored_record::first(booth.core(), due)? else { return Ok(None) };
    let row = row(booth.core(), due)?;
    Ok(Some(Ready { row, files, to_do: booth.to_do(&due.scan) }))
}

fn measured(booth: &Booth, due: &Due, threads: usize) -> Result<Ready, DeliveryFault> {
    let core = booth.core();
    let row = row(core, due)?;
    let began = Instant::now();
    let count_try = || core.custody.journal().crashed(&row.scan);
    let outcome = measuring::measured(core, &row, due.patient.clone(), threads, count_try)?;
    let refused = |code: &str, message: String, stage| {
        Err(DeliveryFault::Refused(Reason::new(code, message, stage, row.first_seen)))
    };
    match outcome {
        MeasureOutcome::Files { files, to_do } => {
            note_measured(core, began.elapsed());
            core.custody.journal().measured(&row.scan)?;
            booth.scan_measured(&row.scan)?;
            if !to_do.is_empty() {
                core.custody.journal().lacks_measures(due)?;
            }
            Ok(Ready { row, files, to_do })
        }
        MeasureOutcome::Refused { code, message } => {
            note_measured(core, began.elapsed());
            refused(&code, message, Stage::Measure)
        }
        MeasureOutcome::Lost => {
            let message = "its bytes were removed from the spool by another program".to_owned();
            refused("spool-lost", message, Stage::Intake)
        }
        MeasureOutcome::Waits { code, error } => Err(DeliveryFault::PutOff { code, error }),
    }
}

pub(super) fn row(core: &Core, due: &Due) -> Result<ScanRow, DeliveryFault> {
    let row = core.custody.journal().scan(&due.scan)?;
    Ok(row.ok_or(JournalError::Unknown { what: "scan" })?)
}

fn note_measured(core: &Core, took: Duration) {
    core.board.note(|facts| {
        facts.measured += 1;
        facts.last_measurement_s = Some(took.as_secs_f64());
    });
}

/// Puts the record of a measured scan into the delivery's store.
pub fn put(booth: &Booth, due: &Due, ready: &Ready) -> Ended {
    let core = booth.core();
    let put = || -> Result<(), DeliveryFault> {
        let Ready { row, files, .. } = ready;
        if !core.custody.journal().is_to_be_made(due)? {
            // The decision changed during the measurement: no patient gets another's record.
            return Ok(());
        }
        let store = core.stores.named(&due.store).ok_or_else(|| no_store(due))?;
        if let Some(head) = core.custody.journal().head_line()? {
            store.keep_head(&head).map_err(|fault| of_store(fault, row))?;
        }
        // Noted before: if the answer is lost, the server may have it.
        note_place(core, due, store, None)?;
        let person = due.patient.as_ref().and_then(|patient| booth.listed_person(patient));
        let receipt = store
            .put(&Delivery {
                scan: &due.scan,
                patient: due.patient.as_ref().map(|patient| patient.id.as_str()),
                person: person.as_ref(),
                first_seen: row.first_seen,
                revision: FIRST_REVISION,
                turn: turn(core, due, store)?,
                files,
                scan_file: &core.custody.spool().scan_file(&row.scan, &row.format),
                ending: &row.format,
            })
            .map_err(|fault| of_store(fault, row))?;
        store_reach::note(core, &due.store, StoreAttempt::Delivery(None));
        note_place(core, due, store, Some(&receipt.folder))?;
        core.custody.delivered(due, &receipt.folder)?;
        let (scan, store) = (short(&due.scan), &due.store);
        info!(event = "scan-delivered", scan, store, already_there = receipt.already_there);
        core.observer.notify(StationEvent::Delivered { scan, folder: receipt.folder });
        Ok(())
    };
    let ended = match put() {
        Ok(()) => Ended::ForGood,
        Err(fault) => note_fault(booth, due, fault),
    };
    booth.ended(&due.scan, &ready.to_do);
    ended
}

/// Notes where a server has the record of a delivery, or may have it: its address may be changed since.
pub(super) fn note_place(
    core: &Core,
    due: &Due,
    store: &dyn RecordStore,
    receipt: Option<&Path>,
) -> Result<(), DeliveryFault> {
    if store.is_server() {
        core.custody.journal().put_at(due, &store.place(), receipt)?;
    }
    Ok(())
}

/// How often the scan was taken from its patient and given back, for a server.
pub(super) fn turn(core: &Core, due: &Due, store: &dyn RecordStore) -> Result<u32, DeliveryFault> {
    match &due.patient {
        Some(patient) if store.is_server() => Ok(core.custody.turn(&due.scan, &patient.id)?),
        _ => Ok(0),
    }
}

/// The receipt of a server for the record that is to be withdrawn from it, '' if it gave none; `None` if the journal
/// does not know whether it was sent.
fn receipt_here(
    core: &Core,
    due: &Due,
    store: &dyn RecordStore,
) -> Result<Option<String>, DeliveryFault> {
    let places = core.custody.journal().places(due)?;
    match places.get(&store.place()) {
        Some(receipt) => Ok(Some(receipt.clone())),
        None if places.is_empty() => Ok(None),
        None => Err(moved()),
    }
}

/// The record is, or may be, at an earlier address of the store.
fn moved() -> DeliveryFault {
    let error = "the record is to be withdrawn at an earlier address of the store".to_owned();
    DeliveryFault::PutOff { code: "store-moved", error }
}

/// Whether what a server was sent may still appear there; `since` is when its take-back was decided, `None` if it was
/// not. A clock that was set back prolongs the wait.
fn may_still_appear(since: Option<Timestamp>, now: Timestamp) -> bool {
    since.is_some_and(|since| now.duration_since(since) < APPEARS_WITHIN)
}

/// Waits for what a server does not show, for as long as it may still appear.
fn may_appear(core: &Core, due: &Due) -> Result<(), DeliveryFault> {
    if !may_still_appear(core.custody.journal().withdrawing_since(due)?, Timestamp::now()) {
        return Ok(());
    }
    let error = ServerFault::NotShown.to_string();
    Err(DeliveryFault::PutOff { code: "not-shown-yet", error })
}

/// Who keeps the record of a scan that is withdrawn from a folder.
fn keeper(core: &Core, due: &Due, from: Option<&str>) -> Result<Option<String>, DeliveryFault> {
    let keeper = core.custody.journal().keeper(&due.scan, &due.store)?;
    let early = || {
        let error = "nobody else has the record yet".to_owned();
        DeliveryFault::PutOff { code: "withdrawal-early", error }
    };
    keeper.filter(|keeper| keeper.as_deref() != from).ok_or_else(early)
}

/// Takes back the record of a scan that now belongs to another patient.
pub fn withdraw(booth: &Booth, due: &Due) -> Ended {
    let core = booth.core();
    let withdraw = || -> Result<(), DeliveryFault> {
        let row = row(core, due)?;
        let journal = core.custody.journal();
        let store = core.stores.named(&due.store).ok_or_else(|| no_store(due))?;
        let from = due.patient.as_ref().map(|patient| patient.id.as_str());
        // From all deliveries: where the journal was lost, another store may have told it.
        let request = from.map(|from| journal.request_of(&due.scan, from)).transpose()?.flatten();
        let (keeper, receipt) = match store.is_server() {
            true => (None, receipt_here(core, due, store)?),
            false => (keeper(core, due, from)?, None),
        };
        let scan = short(&due.scan);
        let turn = turn(core, due, store)?;
        let taken = measuring::acquired_at(&row).local();
        let record = TakeBack {
            scan: &due.scan,
            from,
            keeper: keeper.as_deref(),
            receipt: receipt.as_deref(),
            request: request.as_ref(),
            turn,
            taken: Some(&taken),
        };
        match store.withdraw(&record) {
            Err(StoreFault::Permanent(Rejection::HandedOver)) => {
                warn!(event = "withdrawn-record-kept", scan, code = HANDED_OVER);
                journal.left_there(due)?;
                return Ok(());
            }
            Err(StoreFault::Permanent(rejection)) => return Err(DeliveryFault::Kept(rejection)),
            Err(StoreFault::Server(ServerFault::NotShown)) => may_appear(core, due)?,
            other => other.map_err(|fault| of_store(fault, &row))?,
        }
        if store.is_server() && journal.gone_from(due, &store.place())? {
            return Err(moved());
        }
        journal.withdrawn(due)?;
        // A fault that an earlier attempt met there is over.
        store_reach::note(core, &due.store, StoreAttempt::Look(None));
        info!(event = "record-withdrawn", scan, store = due.store);
        if !journal.keeps_changed_records()? {
            core.board.clear(KEPT);
        }
        Ok(())
    };
    match withdraw() {
        Ok(()) => Ended::ForGood,
        Err(fault) => note_fault(booth, due, fault),
    }
}

pub(super) fn no_store(due: &Due) -> DeliveryFault {
    let error = format!("the configuration no longer has a store \"{}\"", due.store);
    DeliveryFault::PutOff { code: "no-such-store", error }
}

/// Reports why work did not finish, and notes it.
pub(super) fn note_fault(booth: &Booth, due: &Due, fault: DeliveryFault) -> Ended {
    let core = booth.core();
    let scan = short(&due.scan);
    let custody_failed = |fault: CustodyFault| {
        core.check_corruption(&fault);
        ("custody-failed", chain(&fault), Ended::PutOff)
    };
    let (code, error, ended) = match fault {
        DeliveryFault::Refused(reason) => match core.custody.refuse_delivery(due, reason) {
            Ok(None) => return Ended::ForGood,
            Ok(Some(Reason { code, message, stage, .. })) => {
                if stage != Stage::Store {
                    core.logged(booth.reopen_capture(&due.scan));
                }
                warn!(event = "scan-refused", scan, code);
                booth.ended(&due.scan, &[]);
                core.observer.notify(StationEvent::Refused { code, message });
                return Ended::ForGood;
            }
            Err(fault) => custody_failed(fault),
        },
        DeliveryFault::Kept(rejection) => {
            core.board.raise(KEPT, ComplaintFigures::default());
            (KEPT, rejection.to_string(), Ended::Kept)
        }
        DeliveryFault::StoreFailed { code, refusal } => {
            let error = refusal.in_words(Language::En);
            store_reach::note(core, &due.store, StoreAttempt::Delivery(Some(refusal)));
            (code, error, Ended::StoreFailed)
        }
        DeliveryFault::NotTaken { error } => (NOT_TAKEN, error, Ended::NotTaken),
        DeliveryFault::PutOff { code, error } => (code, error, Ended::PutOff),
        DeliveryFault::Custody(fault) => custody_failed(fault),
    };
    warn!(event = "delivery-put-off", scan, store = due.store, code, error);
    core.observer.notify(StationEvent::PutOff { scan, code: code.to_owned() });
    ended
}

/// Converts a store's fault. Its path holds the patient's id and stays out of logs and journal.
pub(super) fn of_store(fault: StoreFault, row: &ScanRow) -> DeliveryFault {
    let code = fault.code();
    match fault {
        StoreFault::NotFetched => {
            DeliveryFault::StoreFailed { code, refusal: StoreRefusal::NotFetched }
        }
        StoreFault::Permanent(rejection) => {
            let message = rejection.to_string();
            DeliveryFault::Refused(Reason::new(code, message, Stage::Store, row.first_seen))
        }
        StoreFault::Server(fault) if fault.is_of_a_record() => {
            DeliveryFault::NotTaken { error: fault.to_string() }
        }
        StoreFault::NoCrop(_) => DeliveryFault::NotTaken { error: fault.to_string() },
        passing => {
            DeliveryFault::StoreFailed { code, refusal: StoreRefusal::Fault(passing.cause()) }
        }
    }
}

impl From<CustodyFault> for DeliveryFault {
    fn from(fault: CustodyFault) -> DeliveryFault {
        DeliveryFault::Custody(fault)
    }
}

impl From<JournalError> for DeliveryFault {
    fn from(error: JournalError) -> DeliveryFault {
        DeliveryFault::Custody(error.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_server_does_not_show_is_waited_for_until_a_day_after_its_take_back_was_decided() {
        let decided: Timestamp = "2026-11-29T08:00:00Z".parse().unwrap();
        let may = |now: &str| may_still_appear(Some(decided), now.parse().unwrap());
        assert!(may("2026-11-29T08:00:00Z") && may("2026-11-30T07:59:59Z"));
        assert!(!may("2026-11-30T08:00:00Z"));
        // The clock was set back.
        assert!(may("2026-11-29T07:00:00Z"));
        assert!(!may_still_appear(None, decided));
    }
}
