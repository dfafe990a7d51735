//! The work on one scan: measured in a process of its own, its record put into a store or taken
//! back from it, the journal told. All of it blocks.

use std::time::{Duration, Instant};

use jiff::Timestamp;
use tracing::{info, warn};

use super::measuring::{self, Outcome};
use crate::flow::facts::Alarm;
use crate::flow::lifecycle::HANDED_OVER;
use crate::flow::outbox::Ended;
use crate::flow::{Facts, ScanState, light};
use crate::record::RecordFile;
use crate::station::assembly::Station;
use crate::station::custody::CustodyFault;
use crate::station::custody::quarantine::{Reason, Stage};
use crate::station::error::chain;
use crate::station::event::{StationEvent, short};
use crate::station::journal::{Due, JournalError, KEPT, ScanRow};
use crate::store::{Delivery, Misfit, StoreFault};

/// A scan that has been measured for a patient.
#[derive(Debug)]
pub struct Ready {
    row: ScanRow,
    files: Vec<RecordFile>,
}

/// Why work did not come to its end.
#[derive(Debug)]
enum Setback {
    /// It never will.
    Refused(Reason),
    /// The record that was to be taken back was changed by somebody, for this reason: it stays where
    /// it is until a person has looked after it.
    Kept(Misfit),
    /// It may later.
    PutOff { code: &'static str, error: String },
    /// It may when the store is in reach.
    StoreFailed { code: &'static str, error: String },
    /// It may when custody works again.
    Custody(CustodyFault),
}

/// Measures the scan of a delivery on so many threads. Where there is nothing to be put into a
/// store, says how that ended.
pub fn prepare(station: &Station, due: &Due, threads: usize) -> Result<Ready, Ended> {
    measured(station, due, threads).map_err(|setback| set_back(station, due, setback))
}

fn measured(station: &Station, due: &Due, threads: usize) -> Result<Ready, Setback> {
    let row = row(station, due)?;
    let began = Instant::now();
    let count_try = || station.custody.journal().crashed(&row.scan);
    let outcome = measuring::measured(station, &row, due.patient.clone(), threads, count_try)?;
    let refused = |code: &str, message: String, stage| {
        Err(Setback::Refused(Reason::new(code, message, stage, row.first_seen)))
    };
    match outcome {
        Outcome::Files(files) => {
            note_measured(station, began.elapsed());
            station.scan_measured(&row.scan)?;
            Ok(Ready { row, files })
        }
        Outcome::Refused { code, message } => {
            note_measured(station, began.elapsed());
            refused(&code, message, Stage::Measure)
        }
        Outcome::Lost => {
            let message = "its bytes were removed from the spool from outside".to_owned();
            refused("spool-lost", message, Stage::Intake)
        }
        Outcome::Waits { code, error } => Err(Setback::PutOff { code, error }),
    }
}

fn row(station: &Station, due: &Due) -> Result<ScanRow, Setback> {
    let row = station.custody.journal().scan(&due.scan)?;
    Ok(row.ok_or(JournalError::Unknown { what: "scan" })?)
}

fn note_measured(station: &Station, took: Duration) {
    station.board.note(|facts| {
        facts.measured += 1;
        facts.last_measurement_s = Some(took.as_secs_f64());
    });
}

/// Puts the record of a measured scan into the delivery's store.
pub fn put(station: &Station, due: &Due, ready: &Ready) -> Ended {
    let put = || -> Result<(), Setback> {
        let Ready { row, files } = ready;
        if !station.custody.journal().is_to_be_made(due)? {
            // Somebody decided otherwise while it was measured: nobody gets what is not theirs.
            return Ok(());
        }
        let store = station.store(&due.store).ok_or_else(|| no_store(due))?;
        let receipt = store
            .put(&Delivery {
                scan: &due.scan,
                patient: due.patient.as_ref().map(|patient| patient.id.as_str()),
                first_seen: row.first_seen,
                files,
                scan_file: &station.custody.spool().scan_file(&row.scan, &row.format),
                ending: &row.format,
            })
            .map_err(|fault| of_store(fault, row))?;
        station.note_store(&due.store, None);
        station.custody.delivered(due, &receipt.folder)?;
        let state = station.custody.journal().scan(&due.scan)?.map(|row| row.state);
        if state == Some(ScanState::Delivered) {
            station.booth.ended(&due.scan, light::Outcome::Delivered, station.now());
        }
        let (scan, store) = (short(&due.scan), &due.store);
        info!(event = "scan-delivered", scan, store, already_there = receipt.already_there);
        station.observer.tell(StationEvent::Delivered { scan, folder: receipt.folder });
        Ok(())
    };
    match put() {
        Ok(()) => Ended::ForGood,
        Err(setback) => set_back(station, due, setback),
    }
}

/// Takes back the record of a scan that somebody else has now.
pub fn withdraw(station: &Station, due: &Due) -> Ended {
    let withdraw = || -> Result<(), Setback> {
        let row = row(station, due)?;
        let journal = station.custody.journal();
        let store = station.store(&due.store).ok_or_else(|| no_store(due))?;
        let from = due.patient.as_ref().map(|patient| patient.id.as_str());
        let keeper = journal.keeper(&due.scan, &due.store)?;
        let Some(keeper) = keeper.filter(|keeper| keeper.as_deref() != from) else {
            let error = "nobody else has the record yet".to_owned();
            return Err(Setback::PutOff { code: "withdrawal-early", error });
        };
        let scan = short(&due.scan);
        match store.withdraw(&due.scan, from, keeper.as_deref()) {
            Err(StoreFault::Permanent(Misfit::HandedOver)) => {
                warn!(event = "withdrawn-record-kept", scan, code = HANDED_OVER);
                journal.left_there(due)?;
                return Ok(());
            }
            Err(StoreFault::Permanent(misfit)) => return Err(Setback::Kept(misfit)),
            other => other.map_err(|fault| of_store(fault, &row))?,
        }
        journal.withdrawn(due)?;
        info!(event = "record-withdrawn", scan, store = due.store);
        if !journal.keeps_changed_records()? {
            station.board.note(|facts| drop(facts.alarms.remove(KEPT)));
        }
        Ok(())
    };
    match withdraw() {
        Ok(()) => Ended::ForGood,
        Err(setback) => set_back(station, due, setback),
    }
}

fn no_store(due: &Due) -> Setback {
    let error = format!("the configuration has no store \"{}\" any more", due.store);
    Setback::PutOff { code: "no-such-store", error }
}

/// Tells of a setback and notes it.
fn set_back(station: &Station, due: &Due, setback: Setback) -> Ended {
    let scan = short(&due.scan);
    let custody_failed = |fault: CustodyFault| {
        station.check_corruption(&fault);
        ("custody-failed", chain(&fault), Ended::PutOff)
    };
    let (code, error, ended) = match setback {
        Setback::Refused(reason) => match station.custody.refuse_delivery(due, reason) {
            Ok(None) => return Ended::ForGood,
            Ok(Some(Reason { code, message, stage, .. })) => {
                if stage != Stage::Store
                    && let Err(error) = station.reopen_capture(&due.scan)
                {
                    station.check_corruption(&error);
                    warn!(event = "journal-failed", error = chain(&error));
                }
                warn!(event = "scan-refused", scan, code);
                let scan = Some(scan);
                station.booth.ended(&due.scan, light::Outcome::NeedsPerson, station.now());
                station.observer.tell(StationEvent::Refused { scan, code, message });
                return Ended::ForGood;
            }
            Err(fault) => custody_failed(fault),
        },
        Setback::Kept(misfit) => {
            station.board.note(note_kept);
            (KEPT, misfit.to_string(), Ended::Kept)
        }
        Setback::StoreFailed { code, error } => {
            station.note_store(&due.store, Some(format!("{code}: {error}")));
            (code, error, Ended::StoreFailed)
        }
        Setback::PutOff { code, error } => (code, error, Ended::PutOff),
        Setback::Custody(fault) => custody_failed(fault),
    };
    warn!(event = "delivery-put-off", scan, store = due.store, code, error);
    station.observer.tell(StationEvent::PutOff { scan, code: code.to_owned() });
    ended
}

/// A person must know that a record lies where it was taken back from.
fn note_kept(facts: &mut Facts) {
    let message = "a record that was taken back was changed by somebody and still lies in the folder \
                   of the patient it is not of";
    let alarm = Alarm { message: message.to_owned(), since: Timestamp::now() };
    facts.alarms.entry(KEPT).or_insert(alarm);
}

/// A store's fault; its path, which holds the patient's id, stays out of logs and journal.
fn of_store(fault: StoreFault, row: &ScanRow) -> Setback {
    let code = fault.code();
    match fault {
        StoreFault::Transient { what, source, .. } => {
            Setback::StoreFailed { code, error: format!("{what} failed: {source}") }
        }
        StoreFault::NotFetched => Setback::StoreFailed { code, error: fault.to_string() },
        StoreFault::Permanent(misfit) => {
            let message = misfit.to_string();
            Setback::Refused(Reason::new(code, message, Stage::Store, row.first_seen))
        }
    }
}

impl From<CustodyFault> for Setback {
    fn from(fault: CustodyFault) -> Setback {
        Setback::Custody(fault)
    }
}

impl From<JournalError> for Setback {
    fn from(error: JournalError) -> Setback {
        Setback::Custody(error.into())
    }
}
