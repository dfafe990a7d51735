//! The station's side of a measurement: what the process gets, and what it answers.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::process::ChildStdin;

use gaiter_confined::{Ended, RunFault};
use gaiter_flow::ScanId;

use super::VERB;
use super::job::{Job, JobAnswer, Purpose};

/// A longer answer is refused; a record has a few megabytes.
const ANSWER_MAX_BYTES: u64 = 1 << 30;

/// Why a measurement could not run to any end; it may succeed later.
#[derive(Debug, thiserror::Error)]
pub enum MeasureFault {
    /// The spooled files could not be read.
    #[error("the spool could not be read")]
    Spool(#[source] io::Error),
    /// The process could not be started or could not be fed.
    #[error("the measuring process could not be started")]
    NotStarted(#[source] io::Error),
}

impl From<RunFault> for MeasureFault {
    fn from(fault: RunFault) -> MeasureFault {
        match fault {
            RunFault::Input(error) => MeasureFault::Spool(error),
            RunFault::NotStarted(error) => MeasureFault::NotStarted(error),
        }
    }
}

/// Measures a spooled scan in its own process. Blocks.
pub fn measure(
    scan: &ScanId,
    job: &Job,
    scan_file: &Path,
    ord_file: Option<&Path>,
) -> Result<Ended<JobAnswer>, MeasureFault> {
    let files = [Some(scan_file), ord_file].into_iter().flatten();
    let files: Vec<File> =
        files.map(File::open).collect::<io::Result<_>>().map_err(MeasureFault::Spool)?;
    run(Some(scan), job, |mut input| {
        files.iter().try_for_each(|mut file| io::copy(&mut file, &mut input).map(drop))
    })
}

/// Measures bytes in their own process; without a `scan` it does not get their hash. Blocks.
pub fn measure_bytes(
    scan: Option<&ScanId>,
    job: &Job,
    bytes: &[u8],
) -> Result<Ended<JobAnswer>, MeasureFault> {
    run(scan, job, |mut input| input.write_all(bytes))
}

/// Whether a measuring process can answer here and now: it gets bytes that are not a scan. Blocks.
pub fn answers(job: &Job) -> Result<bool, MeasureFault> {
    let bytes: &[u8] = b"no scan\n";
    let (scan_bytes, purpose) = (bytes.len() as u64, Purpose::Inspection);
    let job = Job { purpose, scan_bytes, ord_bytes: 0, ..job.clone() };
    Ok(matches!(measure_bytes(None, &job, bytes)?, Ended::Answered(_)))
}

/// Runs the process; `feed` gives it what follows the job's line.
fn run(
    scan: Option<&ScanId>,
    job: &Job,
    feed: impl Fn(&ChildStdin) -> io::Result<()>,
) -> Result<Ended<JobAnswer>, MeasureFault> {
    let arguments: Vec<&str> = [VERB].into_iter().chain(scan.map(ScanId::as_str)).collect();
    let ended = gaiter_confined::run(
        &arguments,
        &job.limits,
        |mut input| job.write(&mut input).and_then(|()| feed(input)),
        |output| JobAnswer::read(output, ANSWER_MAX_BYTES),
    );
    Ok(ended?)
}
