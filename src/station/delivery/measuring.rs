//! Measures spooled scans for deliveries and previews, and finds the cause if there is no answer. A
//! scan is refused only because of its own bytes; for every other cause it waits.

use std::io;
use std::path::{Path, PathBuf};

use gaiter_flow::acquired::acquired;
use gaiter_flow::cause::Cause;
use gaiter_flow::complaint::ComplaintFigures;
use gaiter_flow::confinement::Confine;
use gaiter_flow::views::ViewsSeen;
use gaiter_record::{Acquired, Patient, Provenance, RecordFile};
use jiff::Zoned;
use tracing::{info, warn};

use crate::station::board::Board;
use crate::station::core::Core;
use crate::station::journal::{JournalError, ScanRow};
use crate::station::measure::{
    self, Blame, ConfineFault, Ended, Job, JobAnswer, MeasureFault, Purpose, RecordJob, Trouble,
};
use crate::station::runtime::{chain, utc_offset_min};

/// How often what may have failed because of the scan is tried before the scan is to blame.
pub const TRIES_MAX: u32 = 3;

/// Alarm: scans cannot be measured on this machine.
const IMPAIRED: &str = "measuring-impaired";

/// The code of a measurement that could not be started.
const NOT_STARTED: &str = "measuring-not-started";

/// The outcome of a measurement.
#[derive(Debug)]
pub enum MeasureOutcome {
    Files {
        files: Vec<RecordFile>,
        /// What to do before the patient dresses, in sentences; empty if nothing.
        to_do: Vec<String>,
    },
    /// The scan cannot be measured, now or later.
    Refused {
        /// Stable code.
        code: String,
        /// Message for people.
        message: String,
    },
    /// Its bytes are no longer in the spool.
    Lost,
    /// The machine is at fault: the scan waits.
    Waits {
        /// Stable code.
        code: &'static str,
        /// Message for people.
        error: String,
    },
}

/// Measures a spooled scan for this patient on `threads` threads. `count_try` counts the tries that may
/// have failed because of the scan, including this one. Blocks.
///
/// # Errors
/// If the tries cannot be counted.
pub fn measured(
    core: &Core,
    row: &ScanRow,
    patient: Option<Patient>,
    threads: usize,
    count_try: impl FnOnce() -> Result<u32, JournalError>,
) -> Result<MeasureOutcome, JournalError> {
    let (job, ord_file) = match job(core, row, patient, threads) {
        Ok(job) => job,
        Err(error) => return Ok(unread(core, &error)),
    };
    let scan_file = core.custody.spool().scan_file(&row.scan, &row.format);
    match measure::measure(&row.scan, &job, &scan_file, ord_file.as_deref()) {
        Ok(Ended::Answered(answer)) => {
            note_possible(core);
            Ok(match answer {
                JobAnswer::Files { files, to_do, views_apart_mm } => {
                    note_views(core, ViewsSeen { at: row.first_seen, step_mm: views_apart_mm });
                    MeasureOutcome::Files { files, to_do }
                }
                JobAnswer::Refused { code, message } => MeasureOutcome::Refused { code, message },
                JobAnswer::Inspected(_) | JobAnswer::Checked(_) => {
                    let message = "the measuring process gave no record".to_owned();
                    MeasureOutcome::Refused { code: "record-not-written".to_owned(), message }
                }
            })
        }
        Ok(Ended::Trouble(trouble)) => blamed(core, &job, &trouble, count_try),
        Err(MeasureFault::Spool(error)) => Ok(unread(core, &error)),
        Err(fault) => Ok(waits(core, NOT_STARTED, chain(&fault))),
    }
}

/// Adds what a scan shows about the cameras to the series.
fn note_views(core: &Core, seen: ViewsSeen) {
    let series = core.board.note(|facts| {
        facts.views.add(seen);
        facts.views.clone()
    });
    if let Err(error) = core.custody.journal().keep_views(&series) {
        warn!(event = "views-not-kept", error = chain(&error));
    }
}

/// The outcome for a scan whose measurement gave no answer.
fn blamed(
    core: &Core,
    job: &Job,
    trouble: &Trouble,
    count_try: impl FnOnce() -> Result<u32, JournalError>,
) -> Result<MeasureOutcome, JournalError> {
    let (code, message) = (trouble.code(), trouble.to_string());
    let is_the_scans = match trouble.blame() {
        Blame::Scan => true,
        Blame::Machine => false,
        Blame::Either if count_try()? < TRIES_MAX => {
            return Ok(MeasureOutcome::Waits { code, error: message });
        }
        // If other bytes cannot be measured either, the machine is at fault.
        Blame::Either => measure::answers(job).unwrap_or(false),
    };
    Ok(match is_the_scans {
        true => MeasureOutcome::Refused { code: code.to_owned(), message },
        false => waits(core, code, message),
    })
}

/// The spool could not be read. If it is there but lacks the bytes, they were removed from outside.
fn unread(core: &Core, error: &io::Error) -> MeasureOutcome {
    if error.kind() == io::ErrorKind::NotFound && core.custody.spool().is_there() {
        return MeasureOutcome::Lost;
    }
    waits(core, NOT_STARTED, format!("the spool could not be read: {error}"))
}

/// The scan waits, and an alarm states why.
fn waits(core: &Core, code: &'static str, error: String) -> MeasureOutcome {
    note_impaired(&core.board, &error);
    MeasureOutcome::Waits { code, error }
}

/// Notes that scans cannot be measured on this machine, and why.
pub fn note_impaired(board: &Board, error: &str) {
    board.raise(IMPAIRED, ComplaintFigures::why(&Cause::verbatim(error)));
}

/// Notes that scans can be measured on this machine.
pub fn note_possible(core: &Core) {
    core.board.clear(IMPAIRED);
}

/// Tries the guards around measuring processes on this machine, and notes them on the board; or an alarm if none can
/// be set, because then no process can be prepared.
///
/// # Errors
/// If there are fewer guards than the configuration requires.
pub fn confined(confine: Confine, board: &Board) -> Result<(), ConfineFault> {
    match measure::tried() {
        Ok(found) => {
            measure::enough(found, confine)?;
            match found.missing() {
                None => info!(event = "confined", by = found.words()),
                Some(missing) => warn!(event = "confinement-missing", missing, by = found.words()),
            }
            board.note(|facts| facts.confinement = Some(found));
        }
        Err(fault) if confine == Confine::Required => return Err(fault),
        Err(fault) => {
            warn!(event = "confinement-failed", error = chain(&fault));
            note_impaired(board, &chain(&fault));
        }
    }
    Ok(())
}

/// When a scan was taken, by the clock of this machine.
pub(super) fn acquired_at(row: &ScanRow) -> Acquired {
    let acquired = acquired(row.pressed_at, row.file_time, row.first_seen);
    Acquired { utc_offset_min: utc_offset_min(acquired.at), ..acquired }
}

/// The job for the measuring process, and the file of the scanner's own measures.
fn job(
    core: &Core,
    row: &ScanRow,
    patient: Option<Patient>,
    threads: usize,
) -> io::Result<(Job, Option<PathBuf>)> {
    let spool = core.custody.spool();
    let length = |path: &Path| std::fs::metadata(path).map(|metadata| metadata.len());
    let ord_files = spool.companions(&row.scan, "ord")?;
    let ord_file = match ord_files.as_slice() {
        [file] => Some(file.clone()),
        _ => None,
    };
    let config = &core.config;
    let series = core.custody.phantom_series();
    let provenance = Provenance {
        station: Some(config.station.id.clone()),
        patient,
        acquired: Some(acquired_at(row)),
        phantom_check: series.and_then(|series| series.last_before(row.first_seen)),
        ..Provenance::of_scan(row.scan.to_string())
    };
    let scan_bytes = length(&spool.scan_file(&row.scan, &row.format))?;
    let purpose = Purpose::Record(Box::new(RecordJob {
        method: config.method.clone(),
        output: config.output.clone(),
        report: config.report_choice(Zoned::now().date()),
        provenance,
        ord_files: ord_files.len(),
    }));
    let job = Job {
        ord_bytes: ord_file.as_deref().map(length).transpose()?.unwrap_or(0),
        threads,
        ..Job::new(&config.measure, purpose, &row.format, scan_bytes)
    };
    Ok((job, ord_file))
}
