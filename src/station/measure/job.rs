//! The messages to and from the measuring process, as bytes on pipes.

use std::io::{self, BufRead, Read, Write};

use gaiter_cad::Output;
use gaiter_confined::{Limits, read_line, write_line};
use gaiter_flow::confinement::Confine;
use gaiter_leg::Method;
use gaiter_leg::phantom::Phantom;
use gaiter_record::phantom::CheckRecord;
use gaiter_record::{Provenance, RecordFile, ReportChoice};
use gaiter_scan::End;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::config::MeasureConfig;
use crate::store::archive::CropChoice;

/// The longest line of an answer.
const LINE_MAX: u64 = 1 << 20;

/// The longest line of a job. The garments, size tables and mappings of a configuration have at most 4 MiB in their
/// files, and as data some times as much.
const JOB_MAX: u64 = 64 << 20;

/// The most that is set aside for a file before its first byte has come: the process that names the length
/// has read what the scanner wrote. No file of a record is larger, so none has to grow.
const RESERVED_MAX_BYTES: u64 = 4 << 20;

/// The line before the bytes of the scan and of its measurement file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// What the scan is read for.
    pub purpose: Purpose,
    /// The ending of its format.
    pub ending: String,
    /// How many bytes of scan follow.
    pub scan_bytes: u64,
    /// How many bytes of a file of the scanner's own measures follow the scan; 0 if there is not exactly one.
    pub ord_bytes: u64,
    /// The number of threads that measure it.
    pub threads: usize,
    pub limits: Limits,
    /// Whether it measures even if it cannot be confined.
    pub confine: Confine,
}

/// What a scan is read for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Purpose {
    /// To know how its file ends, and what identifies it.
    Inspection,
    /// To make a patient's record.
    Record(Box<RecordJob>),
    /// To check the scanner: it shows the phantom.
    Check(Box<CheckJob>),
    /// To know what of it leaves the house for an archive.
    Crop(Box<CropJob>),
}

/// How a record is made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordJob {
    pub method: Method,
    /// Which CAD files and meshes are made.
    pub output: Output,
    pub report: ReportChoice,
    /// Where the scan comes from.
    pub provenance: Provenance,
    /// How many files of the scanner's own measures came with the scan.
    pub ord_files: usize,
}

/// How the phantom is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckJob {
    pub method: Method,
    /// What is known of the phantom.
    pub phantom: Phantom,
    /// The largest difference from a known girth that counts as none, mm.
    pub tolerance_mm: f64,
    /// When the scan was taken.
    pub at: Timestamp,
    /// SHA-256 of the scan's bytes, lower-case hexadecimal.
    pub sha256: String,
}

/// How a scan is cropped.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CropJob {
    /// How the scan and its crop are measured.
    pub method: Method,
    /// How much of it leaves the house.
    pub choice: CropChoice,
}

/// The answer of a measuring process that finished.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum JobAnswer {
    Inspected(Inspection),
    /// The phantom was looked for in it.
    Checked(Box<CheckRecord>),
    /// It was measured.
    Files {
        /// The record's files except the scan's own bytes, `SHA256SUMS` last. They follow the answer's line.
        #[serde(skip)]
        files: Vec<RecordFile>,
        /// What to do before the patient dresses, in sentences; empty if nothing.
        to_do: Vec<String>,
        /// How far apart the cameras' views are, mm; `None` if they meet.
        views_apart_mm: Option<f64>,
    },
    /// The scan cannot be measured.
    Refused {
        /// Stable code.
        code: String,
        /// Message for people.
        message: String,
    },
}

/// What is known of an export before it is taken in.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Inspection {
    #[serde(with = "EndWord")]
    pub end: End,
    /// Identifies its scan, in whatever bytes it comes; `None` if there is no scan in it.
    pub fingerprint: Option<String>,
}

/// [`End`] as a word.
#[derive(Serialize, Deserialize)]
#[serde(remote = "End", rename_all = "snake_case")]
enum EndWord {
    Whole,
    NoLineEnd,
    CutShort,
}

impl Job {
    /// The job for a scan without measures of the scanner's own, on one thread.
    pub fn new(config: &MeasureConfig, purpose: Purpose, ending: &str, scan_bytes: u64) -> Job {
        let MeasureConfig { memory_bytes, wall, confine } = *config;
        Job {
            purpose,
            ending: ending.to_owned(),
            scan_bytes,
            ord_bytes: 0,
            threads: 1,
            limits: Limits { memory_bytes, wall },
            confine,
        }
    }

    /// Writes the line.
    pub fn write(&self, to: &mut impl Write) -> io::Result<()> {
        write_line(to, self)
    }

    /// Reads the line; the bytes follow in `from`.
    ///
    /// # Errors
    /// Any I/O error; `InvalidData` if the line is not a job.
    pub fn read(from: &mut impl BufRead) -> io::Result<Job> {
        read_line(from, JOB_MAX)
    }
}

impl JobAnswer {
    /// Writes the whole answer: its line, then each file's line and bytes, then a line without a file.
    pub fn write(&self, to: &mut impl Write) -> io::Result<()> {
        write_line(to, self)?;
        if let JobAnswer::Files { files, .. } = self {
            for RecordFile { name, bytes } in files {
                write_line(to, &Some((name, bytes.len())))?;
                to.write_all(bytes)?;
            }
            write_line(to, &None::<()>)?;
        }
        to.flush()
    }

    /// Reads the whole answer, with files of at most `most` bytes, names included.
    ///
    /// # Errors
    /// Any I/O error; `UnexpectedEof` if the process ended in the middle; `InvalidData` if it is not an
    /// answer.
    pub fn read(from: &mut impl BufRead, most: u64) -> io::Result<JobAnswer> {
        let mut answer: JobAnswer = read_line(from, LINE_MAX)?;
        if let JobAnswer::Files { files, .. } = &mut answer {
            let mut left = most;
            while let Some((name, length)) = read_line::<Option<(String, u64)>>(from, LINE_MAX)? {
                // With the line end: files without name and bytes would never end.
                let taken = length.saturating_add(name.len() as u64 + 1);
                let too_long =
                    || io::Error::new(io::ErrorKind::InvalidData, "the answer is too long");
                left = left.checked_sub(taken).ok_or_else(too_long)?;
                let reserved = length.min(RESERVED_MAX_BYTES);
                let mut bytes = Vec::with_capacity(usize::try_from(reserved).unwrap_or(0));
                if from.take(length).read_to_end(&mut bytes)? as u64 != length {
                    return Err(io::ErrorKind::UnexpectedEof.into());
                }
                files.push(RecordFile { name, bytes });
            }
        }
        Ok(answer)
    }
}

#[cfg(test)]
mod tests {
    use gaiter_sizes::mapping;
    use jiff::civil::date;

    use super::*;
    use crate::config;

    #[test]
    fn a_job_reads_back_with_all_that_a_configuration_says() {
        let config = config::load(include_str!("../../../config/station.toml")).unwrap();
        let table = include_str!("../../../config/sizes/invented-example.toml");
        let mappings = [
            include_str!("../../../config/orders/example-points.toml"),
            include_str!("../../../config/orders/example-wide.toml"),
            include_str!("../../../config/orders/german-spreadsheet.toml"),
        ];
        let mut report = config.report_choice(date(2026, 11, 28));
        report.sizes.tables.push(gaiter_sizes::parse(table.as_bytes()).unwrap());
        let mapping = |text: &str| mapping::parse(text.as_bytes()).unwrap();
        report.orders = Vec::from(mappings.map(mapping));
        let sha256 = "0".repeat(64);
        let record = RecordJob {
            method: config.method.clone(),
            output: config.output.clone(),
            report,
            provenance: Provenance::of_scan(sha256.clone()),
            ord_files: 1,
        };
        let check = CheckJob {
            method: config.method.clone(),
            phantom: "8:50.3, 17:50.3".parse().unwrap(),
            tolerance_mm: 2.0,
            at: Timestamp::UNIX_EPOCH,
            sha256,
        };
        let crop = CropJob { method: config.method.clone(), choice: CropChoice::Legs };
        let record = Purpose::Record(Box::new(record));
        let (check, crop) = (Purpose::Check(Box::new(check)), Purpose::Crop(Box::new(crop)));
        for purpose in [Purpose::Inspection, record, check, crop] {
            let job = Job::new(&config.measure, purpose, "obj", 7);
            let mut line = Vec::new();
            job.write(&mut line).unwrap();
            assert_eq!(Job::read(&mut &line[..]).unwrap(), job);
        }
    }

    fn file(name: &str, bytes: &[u8]) -> RecordFile {
        RecordFile { name: name.to_owned(), bytes: bytes.to_vec() }
    }

    fn complete(files: Vec<RecordFile>) -> JobAnswer {
        JobAnswer::Files { files, to_do: Vec::new(), views_apart_mm: None }
    }

    fn written(answer: &JobAnswer) -> Vec<u8> {
        let mut bytes = Vec::new();
        answer.write(&mut bytes).unwrap();
        bytes
    }

    #[test]
    fn an_answer_reads_back() {
        let files = vec![file("record.json", b"{\n}\n"), file("empty", b""), file("S", b"\0\xff")];
        let refused = JobAnswer::Refused { code: "no-leg".into(), message: "line\nbreak".into() };
        let to_do = vec!["Measure by hand: right leg: C.".to_owned()];
        let measured = JobAnswer::Files { files, to_do, views_apart_mm: Some(3.25) };
        let ends = [End::Whole, End::NoLineEnd, End::CutShort];
        let fingerprints = [None, Some("read-1:0".to_owned())];
        let inspected = ends.into_iter().flat_map(|end| {
            let of = |fingerprint| JobAnswer::Inspected(Inspection { end, fingerprint });
            fingerprints.clone().map(of)
        });
        for answer in inspected.chain([measured, refused]) {
            assert_eq!(JobAnswer::read(&mut &written(&answer)[..], 100).unwrap(), answer);
        }
    }

    #[test]
    fn an_answer_that_ends_anywhere_before_its_end_is_none() {
        let whole = written(&complete(vec![file("a", b"abc"), file("b", b"defg")]));
        for end in 0..whole.len() {
            let fault = JobAnswer::read(&mut &whole[..end], 100).unwrap_err();
            assert_eq!(fault.kind(), io::ErrorKind::UnexpectedEof, "{end}");
        }
    }

    #[test]
    fn an_answer_that_would_fill_the_memory_is_not_read() {
        let large = vec![file("a", &[0; 60]), file("b", &[0; 60])];
        for files in [large, vec![file("", b""); 101]] {
            let long = written(&complete(files));
            assert!(JobAnswer::read(&mut &long[..], 100).is_err());
        }
    }
}
