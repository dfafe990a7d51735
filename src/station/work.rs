//! Making one delivery: the spooled bytes measured, the record stored, the journal told.

use std::io;

use tracing::{info, warn};

use super::assembly::Station;
use super::caught::caught;
use super::custody::CustodyFault;
use super::error::chain;
use super::event::{StationEvent, short};
use super::journal::{Due, JournalError, ScanRow};
use super::quarantine::{Reason, Stage};
use crate::flow::acquired::acquired;
use crate::leg;
use crate::record::{self, Provenance, RecordFile};
use crate::scan::Format;
use crate::store::{Delivery, Receipt, StoreFault, sums};

/// How an attempt at a delivery ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// For good: delivered or refused.
    ForGood,
    /// It is to be tried again.
    PutOff,
}

/// Why a delivery was not made.
enum Setback {
    /// It never will be.
    Refused(Reason),
    /// It may be later.
    PutOff { code: &'static str, error: String },
}

/// Tries to make a delivery. Blocks.
pub fn deliver(station: &Station, due: &Due) -> Ended {
    let scan = short(&due.scan);
    let setback = match attempt(station, due) {
        Ok(receipt) => {
            info!(event = "scan-delivered", scan, already_there = receipt.already_there);
            station.observer.tell(StationEvent::Delivered { scan, folder: receipt.folder });
            return Ended::ForGood;
        }
        Err(Setback::Refused(reason)) => match station.custody.refuse(&due.scan, &reason) {
            Ok(()) => {
                let Reason { code, message, .. } = reason;
                warn!(event = "scan-refused", scan, code);
                let scan = Some(scan);
                station.observer.tell(StationEvent::Refused { scan, code, message });
                return Ended::ForGood;
            }
            Err(fault) => Setback::from(fault),
        },
        Err(put_off) => put_off,
    };
    if let Setback::PutOff { code, error } = setback {
        warn!(event = "delivery-put-off", scan, code, error);
        station.observer.tell(StationEvent::PutOff { scan, code: code.to_owned() });
    }
    Ended::PutOff
}

fn attempt(station: &Station, due: &Due) -> Result<Receipt, Setback> {
    let row = station.custody.journal().scan(&due.scan)?;
    let row = row.ok_or(JournalError::Unknown { what: "scan" })?;
    station.store.reach().map_err(|fault| of_store(fault, &row))?;
    let (bytes, format) = spooled(station, &row)?;
    let files = measured(station, due, &row, &bytes, format)?;
    let receipt = station
        .store
        .put(&Delivery {
            scan: &due.scan,
            patient: due.patient.as_ref().map(|patient| patient.id.as_str()),
            first_seen: row.first_seen,
            files: &files,
        })
        .map_err(|fault| of_store(fault, &row))?;
    station.custody.delivered(due, &receipt.folder)?;
    Ok(receipt)
}

/// The bytes from the spool, if they still are what they were.
fn spooled(station: &Station, row: &ScanRow) -> Result<(Vec<u8>, Format), Setback> {
    let damaged = |code, message: String| {
        Setback::Refused(Reason::new(code, message, Stage::Intake, row.first_seen))
    };
    let bytes = match station.custody.spool().bytes(&row.scan, &row.format) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let message = "its bytes were removed from the spool from outside".to_owned();
            return Err(damaged("spool-lost", message));
        }
        Err(error) => {
            let error = error.to_string();
            return Err(Setback::PutOff { code: "spool-unreadable", error });
        }
    };
    if sums::scan_id(&bytes) != row.scan {
        let message = "its bytes in the spool are not those that came in".to_owned();
        return Err(damaged("spool-damaged", message));
    }
    match Format::of_file_name(&format!("scan.{}", row.format)) {
        Ok(format) => Ok((bytes, format)),
        Err(fault) => Err(damaged(fault.code(), fault.to_string())),
    }
}

/// The record's files. A panic is this scan's fault alone.
fn measured(
    station: &Station,
    due: &Due,
    row: &ScanRow,
    bytes: &[u8],
    format: Format,
) -> Result<Vec<RecordFile>, Setback> {
    let provenance = Provenance {
        station: Some(station.config.station.id.clone()),
        patient: due.patient.clone(),
        acquired: Some(acquired(row.file_time, row.first_seen)),
        sha256: row.scan.to_string(),
    };
    let (method, output) = (&station.config.method, &station.config.output);
    let refused = |code: &str, message: String| {
        Setback::Refused(Reason::new(code, message, Stage::Measure, row.first_seen))
    };
    let measured = caught(|| {
        let extraction = leg::extract(bytes, format, method)?;
        let made = record::record_files(&extraction, &provenance, method, output, bytes, format);
        Ok::<_, leg::Refusal>(made)
    });
    match measured {
        Ok(Ok(Ok((_, files)))) => Ok(files),
        Ok(Ok(Err(error))) => Err(refused("record-not-written", error.to_string())),
        Ok(Err(refusal)) => Err(refused(refusal.code(), refusal.to_string())),
        Err(panic) => Err(refused("panic", panic)),
    }
}

/// A store's fault; its path, which holds the patient's id, stays out of logs and journal.
fn of_store(fault: StoreFault, row: &ScanRow) -> Setback {
    let code = fault.code();
    match fault {
        StoreFault::Transient { what, source, .. } => {
            Setback::PutOff { code, error: format!("{what} failed: {source}") }
        }
        StoreFault::Permanent(misfit) => {
            let message = misfit.to_string();
            Setback::Refused(Reason::new(code, message, Stage::Store, row.first_seen))
        }
    }
}

impl From<CustodyFault> for Setback {
    fn from(fault: CustodyFault) -> Setback {
        Setback::PutOff { code: "custody-failed", error: chain(&fault) }
    }
}

impl From<JournalError> for Setback {
    fn from(error: JournalError) -> Setback {
        Setback::PutOff { code: "journal-failed", error: chain(&error) }
    }
}
