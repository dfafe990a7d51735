//! Measures spooled scans, for deliveries and previews, and tells what is to blame where one gives no
//! answer: only a scan's own bytes refuse it, and for everything else it waits.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use tracing::{info, warn};

use super::measure::{
    self, Answer, Blame, ConfineFault, Job, Limits, MeasureFault, Measured, Trouble,
};
use crate::flow::acquired::acquired;
use crate::flow::confinement::{Confine, Confinement};
use crate::flow::facts::Alarm;
use crate::record::{FIRST_REVISION, Patient, Provenance, RecordFile};
use crate::station::assembly::Station;
use crate::station::error::chain;
use crate::station::journal::{JournalError, ScanRow};

/// A measurement that may have failed by the scan's own fault is tried so often before the scan is
/// refused.
const TRIES_MAX: u32 = 3;

/// The alarm of a machine on which scans cannot be measured.
pub const IMPAIRED: &str = "measuring-impaired";

/// The code of a measurement that could not be begun.
const NOT_STARTED: &str = "measuring-not-started";

/// What came of a measurement.
#[derive(Debug)]
pub enum Outcome {
    /// The record's files.
    Files(Vec<RecordFile>),
    /// The scan cannot be measured, and will not be.
    Refused {
        /// Stable code.
        code: String,
        /// For people.
        message: String,
    },
    /// Its bytes are not in the spool any more.
    Lost,
    /// The machine is at fault: the scan waits.
    Waits {
        /// Stable code.
        code: &'static str,
        /// For people.
        error: String,
    },
}

/// Measures a spooled scan for this patient on so many threads. `count_try` counts the tries that may have
/// failed by the scan's fault, this one among them. Blocks.
///
/// # Errors
/// Where they cannot be counted.
pub fn measured(
    station: &Station,
    row: &ScanRow,
    patient: Option<Patient>,
    threads: usize,
    count_try: impl FnOnce() -> Result<u32, JournalError>,
) -> Result<Outcome, JournalError> {
    let (job, ord_file) = match job(station, row, patient, threads) {
        Ok(job) => job,
        Err(error) => return Ok(unread(station, &error)),
    };
    let scan_file = station.custody.spool().scan_file(&row.scan, &row.format);
    match measure::measure(&row.scan, &job, &scan_file, ord_file.as_deref()) {
        Ok(Measured::Answered(answer)) => {
            station.board.note(|facts| drop(facts.alarms.remove(IMPAIRED)));
            Ok(match answer {
                Answer::Files(files) => Outcome::Files(files),
                Answer::Refused { code, message } => Outcome::Refused { code, message },
            })
        }
        Ok(Measured::Trouble(trouble)) => blamed(station, &job, &trouble, count_try),
        Err(MeasureFault::Spool(error)) => Ok(unread(station, &error)),
        Err(fault) => Ok(waits(station, NOT_STARTED, chain(&fault))),
    }
}

/// What becomes of a scan whose measurement gave no answer.
fn blamed(
    station: &Station,
    job: &Job,
    trouble: &Trouble,
    count_try: impl FnOnce() -> Result<u32, JournalError>,
) -> Result<Outcome, JournalError> {
    let (code, message) = (trouble.code(), trouble.to_string());
    let is_the_scans = match trouble.blame() {
        Blame::Scan => true,
        Blame::Machine => false,
        Blame::Either if count_try()? < TRIES_MAX => {
            return Ok(Outcome::Waits { code, error: message });
        }
        // Where no other bytes can be measured either, it is the machine.
        Blame::Either => measure::answers(job).unwrap_or(false),
    };
    Ok(match is_the_scans {
        true => Outcome::Refused { code: code.to_owned(), message },
        false => waits(station, code, message),
    })
}

/// The spool could not be read: where it stands and has no such bytes, they were removed from outside.
fn unread(station: &Station, error: &io::Error) -> Outcome {
    if error.kind() == io::ErrorKind::NotFound && station.custody.spool().is_there() {
        return Outcome::Lost;
    }
    waits(station, NOT_STARTED, format!("the spool could not be read: {error}"))
}

/// The scan waits, and people are told why.
fn waits(station: &Station, code: &'static str, error: String) -> Outcome {
    station.board.note(|facts| {
        facts.alarms.entry(IMPAIRED).or_insert(impaired(&error));
    });
    Outcome::Waits { code, error }
}

/// The guards around measuring processes on this machine, or the alarm where none can be set: then no
/// process can be made ready.
///
/// # Errors
/// Where they are fewer than the configuration requires.
pub fn confined(confine: Confine) -> Result<Result<Confinement, Alarm>, ConfineFault> {
    match measure::tried() {
        Ok(found) => {
            measure::enough(found, confine)?;
            match found.missing() {
                None => info!(event = "confined", by = found.words()),
                Some(missing) => warn!(event = "confinement-missing", missing, by = found.words()),
            }
            Ok(Ok(found))
        }
        Err(fault) if confine == Confine::Required => Err(fault),
        Err(fault) => {
            warn!(event = "confinement-failed", error = chain(&fault));
            Ok(Err(impaired(chain(&fault))))
        }
    }
}

/// Scans cannot be measured on this machine, for this reason.
fn impaired(error: impl Display) -> Alarm {
    let message = format!("scans wait, for they cannot be measured on this machine: {error}");
    Alarm { message, since: Timestamp::now() }
}

/// What the measuring process is told, and where the scanner's own measures lie.
fn job(
    station: &Station,
    row: &ScanRow,
    patient: Option<Patient>,
    threads: usize,
) -> io::Result<(Job, Option<PathBuf>)> {
    let spool = station.custody.spool();
    let length = |path: &Path| std::fs::metadata(path).map(|metadata| metadata.len());
    let ord_files = spool.companions(&row.scan, "ord")?;
    let ord_file = match ord_files.as_slice() {
        [file] => Some(file.clone()),
        _ => None,
    };
    let config = &station.config;
    let job = Job {
        config: config.text.clone(),
        provenance: Provenance {
            station: Some(config.station.id.clone()),
            patient,
            acquired: Some(acquired(row.pressed_at, row.file_time, row.first_seen)),
            sha256: row.scan.to_string(),
            revision: FIRST_REVISION,
        },
        ending: row.format.clone(),
        scan_bytes: length(&spool.scan_file(&row.scan, &row.format))?,
        ord_files: ord_files.len(),
        ord_bytes: ord_file.as_deref().map(length).transpose()?.unwrap_or(0),
        threads,
        limits: Limits {
            memory_bytes: config.measure.memory_bytes,
            cpu: config.measure.cpu,
            wall: config.measure.wall,
        },
        confine: config.measure.confine,
    };
    Ok((job, ord_file))
}
