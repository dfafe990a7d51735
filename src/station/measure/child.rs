//! The measuring process.

use std::io::{self, BufReader, Read, Write};
use std::panic;

use gaiter_leg::comparison::opinion::SecondOpinion;
use gaiter_leg::comparison::second_opinion::compare;
use gaiter_leg::{self as leg, Finding, phantom};
use gaiter_record::completeness::{Completeness, Kind};
use gaiter_record::phantom::CheckRecord;
use gaiter_record::{self as record, RecordFile, ScanFile};
use gaiter_scan::{Format, ord};

use super::confine::confine;
use super::job::{Answer, Job, Subject};
use crate::config::{self, Config, Files};
use crate::station::runtime::caught::caught;
use crate::station::runtime::causes::chain;
use crate::store::sums;

/// Measures the one scan that comes on `input` and writes the answer to `output`. `hash` is the scan's
/// hash from the arguments, and the bytes must match it.
///
/// # Errors
/// If no answer could be given; the station treats that as a crash.
pub fn serve(hash: &str, input: impl Read, output: impl Write) -> io::Result<()> {
    let mut input = BufReader::new(input);
    let job = Job::read(&mut input)?;
    confine(&job.limits, job.confine).map_err(|fault| io::Error::other(chain(&fault)))?;
    // After the confinement, so that its threads are confined too.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(job.threads.max(1));
    let pool = pool.build().map_err(io::Error::other)?;
    let scan = take(&mut input, job.scan_bytes)?;
    let ord = take(&mut input, job.ord_bytes)?;
    // Panics come back as an answer; their messages go nowhere else.
    panic::set_hook(Box::new(|_| {}));
    let answer = match caught(|| pool.install(|| answer(&job, hash, &scan, &ord))) {
        Ok(answer) => answer,
        Err(panic) => refused("panic", panic),
    };
    let mut output = io::BufWriter::new(output);
    answer.write(&mut output)
}

fn take(input: &mut impl Read, length: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    if input.take(length).read_to_end(&mut bytes)? as u64 != length {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    Ok(bytes)
}

fn answer(job: &Job, hash: &str, scan: &[u8], ord: &[u8]) -> Answer {
    if sums::scan_id(scan).as_str() != hash {
        let message = "its bytes in the spool differ from those that came in".to_owned();
        return refused("spool-damaged", message);
    }
    let format = match Format::of_file_name(&format!("scan.{}", job.ending)) {
        Ok(format) => format,
        Err(fault) => return refused(fault.code(), fault.to_string()),
    };
    let config = match config::load_with(&job.config, Files::Read(&job.beside)) {
        Ok(config) => config,
        Err(faults) => return refused("config", format!("{} faults", faults.len())),
    };
    if job.subject == Subject::Phantom {
        return check(job, scan, format, &config);
    }
    let ord = (!ord.is_empty()).then_some(ord);
    let mut extraction = match leg::extract(scan, format, &config.method) {
        Ok(extraction) => extraction,
        Err(refusal) => return refused(refusal.code(), refusal.to_string()),
    };
    let opinions = opinions(&extraction, ord, job.ord_files);
    extraction.findings.extend(opinions);
    let (method, output) = (&config.method, &config.output);
    let choice = config.report_choice(job.today);
    let scan = ScanFile { bytes: scan, format, ord };
    // The station has the scan's own bytes already, in the spool.
    match record::files_beside_scan(&extraction, &job.provenance, method, output, &choice, scan) {
        Ok((record, files)) => {
            let completeness = Completeness::of(&record, &config.garment);
            let to_do = match completeness.kind() {
                Kind::Complete | Kind::NotMeasurable => Vec::new(),
                Kind::ByHand | Kind::ScanAgain => completeness.sentences(config.language),
            };
            Answer::Files { files, to_do, views_apart_mm: extraction.views_apart_mm() }
        }
        Err(error) => refused("record-not-written", error.to_string()),
    }
}

/// The check with the phantom that is in the scan.
fn check(job: &Job, scan: &[u8], format: Format, config: &Config) -> Answer {
    let (Some(known), Some(acquired)) = (&config.phantom, &job.provenance.acquired) else {
        return refused("config", "there is no phantom in the configuration".to_owned());
    };
    let found = phantom::check(scan, format, &known.phantom, &config.method);
    let sha256 = job.provenance.sha256.clone();
    let check = CheckRecord::new(acquired.at, sha256, &found, known.tolerance_mm);
    match serde_json::to_vec(&check) {
        Ok(bytes) => {
            let files = vec![RecordFile { name: "check.json".to_owned(), bytes }];
            Answer::Files { files, to_do: Vec::new(), views_apart_mm: None }
        }
        Err(error) => refused("record-not-written", error.to_string()),
    }
}

/// What the scanner's own measures say about the extraction. Of several files none is believed.
fn opinions(extraction: &leg::Extraction, ord: Option<&[u8]>, files: usize) -> Vec<Finding> {
    match ord.map(ord::read) {
        Some(Ok(ord)) => compare(extraction, &ord),
        Some(Err(fault)) => vec![SecondOpinion::Unreadable { why: fault.to_string() }.into()],
        None if files > 0 => vec![SecondOpinion::Ambiguous { files }.into()],
        None => Vec::new(),
    }
}

fn refused(code: &str, message: String) -> Answer {
    Answer::Refused { code: code.to_owned(), message }
}
