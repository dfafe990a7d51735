//! The measuring process.

use std::fmt::Display;
use std::io::{self, BufReader, Read, Write};
use std::panic;

use gaiter_confined::confine;
use gaiter_flow::ScanId;
use gaiter_leg::comparison::opinion::SecondOpinion;
use gaiter_leg::comparison::second_opinion::compare;
use gaiter_leg::{self as leg, Extraction, Finding, Refusal, WholeBody, phantom};
use gaiter_record::completeness::{Completeness, Kind};
use gaiter_record::phantom::CheckRecord;
use gaiter_record::same_numbers::crop_differs;
use gaiter_record::{self as record, RecordFile, ScanFile};
use gaiter_scan::{self as scan, Format, Reading, Scan, ord};
use sha2::{Digest, Sha256};

use super::crop::{CROP, WHOLE_BODY};
use super::job::{CheckJob, CropJob, Inspection, Job, JobAnswer, Purpose, RecordJob};
use crate::station::runtime::{caught, chain};
use crate::store::archive::CropChoice;
use crate::store::sums;

/// How fingerprints of this kind begin: none is taken for one of another kind.
const FINGERPRINT_KIND: &str = "read-1:";

/// Reads the one scan that comes on `input` and writes the answer to `output`. `hash` is the scan's
/// hash from the arguments, and the bytes must match it; without one they are those of the station's memory.
///
/// # Errors
/// If no answer could be given; the station treats that as a crash.
pub fn serve(hash: Option<&str>, input: impl Read, output: impl Write) -> io::Result<()> {
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
        Ok(Ok(answer) | Err(answer)) => answer,
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

/// What the job asks for, or why the scan cannot be measured.
fn answer(job: &Job, hash: Option<&str>, scan: &[u8], ord: &[u8]) -> Result<JobAnswer, JobAnswer> {
    if hash.is_some_and(|hash| sums::scan_id(scan).as_str() != hash) {
        let message = "its bytes in the spool differ from those that came in".to_owned();
        return Err(refused("spool-damaged", message));
    }
    let format = Format::of_file_name(&format!("scan.{}", job.ending))
        .map_err(|fault| refused(fault.code(), fault.to_string()))?;
    match &job.purpose {
        Purpose::Inspection => Ok(inspected(scan, format)),
        Purpose::Record(job) => recorded(job, scan, format, ord),
        Purpose::Check(job) => Ok(checked(job, scan, format)),
        Purpose::Crop(job) => cropped(job, scan, format),
    }
}

/// How an export ends, and what identifies it.
fn inspected(scan: &[u8], format: Format) -> JobAnswer {
    let Reading { scan, end } = scan::reading(scan, format);
    let fingerprint = scan.ok().map(|scan| fingerprint(&scan));
    JobAnswer::Inspected(Inspection { end, fingerprint })
}

/// The fingerprint of the points and triangles that were read: it identifies a known scan, in whatever bytes it
/// comes.
fn fingerprint(scan: &Scan) -> String {
    let mut digest = Sha256::new();
    scan.each_piece(|piece| digest.update(piece));
    format!("{FINGERPRINT_KIND}{}", ScanId::of_digest(digest.finalize().into()))
}

/// The record of a patient's scan.
fn recorded(
    job: &RecordJob,
    scan: &[u8],
    format: Format,
    ord: &[u8],
) -> Result<JobAnswer, JobAnswer> {
    let RecordJob { method, output, report, provenance, ord_files } = job;
    let ord = (!ord.is_empty()).then_some(ord);
    let mut extraction = leg::extract(scan, format, method).map_err(not_measured)?;
    let opinions = opinions(&extraction, ord, *ord_files);
    extraction.findings.extend(opinions);
    let scan = ScanFile { bytes: scan, format, ord };
    // The station has the scan's own bytes already, in the spool.
    let made = record::files_beside_scan(&extraction, provenance, method, output, report, scan);
    let (record, files) = made.map_err(not_written)?;
    let completeness = Completeness::from_record(&record, &report.garment);
    let to_do = match completeness.kind() {
        Kind::Complete | Kind::NotMeasurable => Vec::new(),
        Kind::ByHand | Kind::ScanAgain => completeness.sentences(report.language),
    };
    Ok(JobAnswer::Files { files, to_do, views_apart_mm: extraction.views_apart_mm() })
}

/// The check with the phantom that is in the scan.
fn checked(job: &CheckJob, scan: &[u8], format: Format) -> JobAnswer {
    let CheckJob { method, phantom, tolerance_mm, at, sha256 } = job;
    let found = phantom::check(scan, format, phantom, method);
    let check = CheckRecord::new(*at, sha256.clone(), &found, *tolerance_mm);
    JobAnswer::Checked(Box::new(check))
}

/// What leaves the house of a scan, and what its whole body told. The archive gets both as bytes, so the crop is measured
/// from these bytes, and every number must be that of the whole body.
fn cropped(job: &CropJob, scan: &[u8], format: Format) -> Result<JobAnswer, JobAnswer> {
    let CropJob { method, choice } = job;
    let extraction = leg::extract(scan, format, method).map_err(not_measured)?;
    let ply = leaving(&extraction, *choice).to_ply();
    let told = WholeBody::from_extraction(&extraction);
    let bytes = serde_json::to_vec(&told).map_err(not_written)?;
    let read: WholeBody = serde_json::from_slice(&bytes).map_err(not_written)?;
    let again = leg::extract_crop(&ply, &read, method).map_err(not_measured)?;
    match crop_differs(&extraction, &again, method).map_err(not_written)? {
        None => {
            let file = |name: &str, bytes| RecordFile { name: name.to_owned(), bytes };
            let files = vec![file(CROP, ply), file(WHOLE_BODY, bytes)];
            Ok(JobAnswer::Files { files, to_do: Vec::new(), views_apart_mm: None })
        }
        Some(differs) => Err(refused("crop-differs", differs)),
    }
}

/// What of the body leaves the house, in the body frame.
fn leaving(extraction: &Extraction, choice: CropChoice) -> Scan {
    let mesh = &extraction.body.mesh;
    match choice {
        CropChoice::Legs => extraction.crop(),
        CropChoice::Whole => {
            Scan { points: mesh.points().to_vec(), triangles: mesh.triangles().to_vec() }
        }
    }
}

/// The opinions of the scanner's own measures on the extraction. Of several files none is trusted.
fn opinions(extraction: &leg::Extraction, ord: Option<&[u8]>, files: usize) -> Vec<Finding> {
    match ord.map(ord::read) {
        Some(Ok(ord)) => compare(extraction, &ord),
        Some(Err(fault)) => vec![SecondOpinion::Unreadable { why: fault.to_string() }.into()],
        None if files > 0 => vec![SecondOpinion::Ambiguous { files }.into()],
        None => Vec::new(),
    }
}

fn not_measured(refusal: Refusal) -> JobAnswer {
    refused(refusal.code(), refusal.to_string())
}

fn not_written(error: impl Display) -> JobAnswer {
    refused("record-not-written", error.to_string())
}

fn refused(code: &str, message: String) -> JobAnswer {
    JobAnswer::Refused { code: code.to_owned(), message }
}

#[cfg(test)]
mod tests {
    use gaiter_scan::read;

    use super::*;

    #[test]
    fn what_is_read_is_one_scan_however_it_is_written() {
        let of = |text: &str| fingerprint(&read(text.as_bytes(), Format::Obj).unwrap());
        let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let found = of(triangle);
        assert!(
            found.starts_with(FINGERPRINT_KIND) && found.len() == FINGERPRINT_KIND.len() + 64,
            "{found}"
        );
        assert_eq!(of(&format!("# nine\r\n{triangle}")), found);
        assert_ne!(of(&triangle.replacen("0 0 0", "0 0 1", 1)), found);
    }
}
