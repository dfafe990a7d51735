//! The messages to and from the measuring process, as bytes on pipes.

use std::io::{self, BufRead, Read, Write};
use std::time::Duration;

use gaiter_flow::confinement::Confine;
use gaiter_record::{Provenance, RecordFile};
use jiff::Zoned;
use jiff::civil::Date;
use serde::{Deserialize, Serialize};

use crate::config::{Beside, Config, MeasureConfig};

/// The longest line of an answer.
const LINE_MAX: u64 = 1 << 20;

/// The longest line of a job: a configuration has some kilobytes, and what it names at most 4 MiB.
const JOB_MAX: u64 = 16 << 20;

/// The most that is set aside for a file before its first byte has come: the process that names the length
/// has read what the scanner wrote. No file of a record is larger, so none has to grow.
const RESERVED_MAX_BYTES: u64 = 4 << 20;

/// The limits of a measuring process.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limits {
    /// Address space, bytes.
    pub memory_bytes: u64,
    /// Time from its start to its answer.
    pub wall: Duration,
}

/// The line before the bytes of the scan and of its measurement file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// The text of the station's configuration: method and output.
    pub config: String,
    /// The garments and size tables that the configuration names.
    pub beside: Vec<Beside>,
    /// The station's day: a size table may be expired by then.
    pub today: Date,
    /// What the scan shows.
    pub subject: Subject,
    /// Where the scan comes from.
    pub provenance: Provenance,
    /// The ending of its format.
    pub ending: String,
    /// How many bytes of scan follow.
    pub scan_bytes: u64,
    /// How many files of the scanner's own measures came with the scan.
    pub ord_files: usize,
    /// How many bytes of such a file follow the scan; 0 if there is not exactly one.
    pub ord_bytes: u64,
    /// The number of threads that measure it.
    pub threads: usize,
    /// The limits of the process.
    pub limits: Limits,
    /// Whether it measures even if it cannot be confined.
    pub confine: Confine,
}

/// What a scan shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Subject {
    /// A patient: the answer is a record.
    Patient,
    /// The phantom: the answer is a check.
    Phantom,
}

/// The answer of a measuring process that finished.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// It was measured.
    Files {
        /// The record's files except the scan's own bytes, `SHA256SUMS` last.
        files: Vec<RecordFile>,
        /// What is to be done before the patient dresses, in sentences; empty if nothing is.
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

/// The line before the bytes of an answer.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Header {
    Files { files: Vec<(String, u64)>, to_do: Vec<String>, views_apart_mm: Option<f64> },
    Refused { code: String, message: String },
}

impl Job {
    /// The job for a patient's scan without measures of the scanner's own, on one thread.
    pub fn new(config: &Config, provenance: Provenance, ending: &str, scan_bytes: u64) -> Job {
        let MeasureConfig { memory_bytes, wall, confine } = config.measure;
        Job {
            config: config.text.clone(),
            beside: config.beside.clone(),
            today: Zoned::now().date(),
            subject: Subject::Patient,
            provenance,
            ending: ending.to_owned(),
            scan_bytes,
            ord_files: 0,
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

impl Answer {
    /// Writes the whole answer.
    pub fn write(&self, to: &mut impl Write) -> io::Result<()> {
        match self {
            Answer::Files { files, to_do, views_apart_mm } => {
                let names = files.iter().map(|file| (file.name.clone(), len(&file.bytes)));
                let (files_sent, to_do) = (names.collect(), to_do.clone());
                let header =
                    Header::Files { files: files_sent, to_do, views_apart_mm: *views_apart_mm };
                write_line(to, &header)?;
                files.iter().try_for_each(|file| to.write_all(&file.bytes))?;
            }
            Answer::Refused { code, message } => {
                let (code, message) = (code.clone(), message.clone());
                write_line(to, &Header::Refused { code, message })?;
            }
        }
        to.flush()
    }

    /// Reads the whole answer, of at most `most` bytes.
    ///
    /// # Errors
    /// Any I/O error; `UnexpectedEof` if the process ended in the middle; `InvalidData` if it is not an
    /// answer.
    pub fn read(from: &mut impl BufRead, most: u64) -> io::Result<Answer> {
        let (names, to_do, views_apart_mm) = match read_line(from, LINE_MAX)? {
            Header::Refused { code, message } => return Ok(Answer::Refused { code, message }),
            Header::Files { files, to_do, views_apart_mm } => (files, to_do, views_apart_mm),
        };
        let mut left = most;
        let mut files = Vec::with_capacity(names.len().min(64));
        for (name, length) in names {
            left = left.checked_sub(length).ok_or_else(|| invalid("the answer is too long"))?;
            let reserved = length.min(RESERVED_MAX_BYTES);
            let mut bytes = Vec::with_capacity(usize::try_from(reserved).unwrap_or(0));
            if from.take(length).read_to_end(&mut bytes)? as u64 != length {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            files.push(RecordFile { name, bytes });
        }
        Ok(Answer::Files { files, to_do, views_apart_mm })
    }
}

fn len(bytes: &[u8]) -> u64 {
    bytes.len() as u64
}

fn write_line(to: &mut impl Write, value: &impl Serialize) -> io::Result<()> {
    let mut line = serde_json::to_vec(value)?;
    line.push(b'\n');
    to.write_all(&line)
}

fn read_line<T: serde::de::DeserializeOwned>(from: &mut impl BufRead, most: u64) -> io::Result<T> {
    let mut line = Vec::new();
    from.take(most).read_until(b'\n', &mut line)?;
    if line.last() != Some(&b'\n') {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    serde_json::from_slice(&line).map_err(invalid)
}

fn invalid(why: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, why)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, bytes: &[u8]) -> RecordFile {
        RecordFile { name: name.to_owned(), bytes: bytes.to_vec() }
    }

    fn complete(files: Vec<RecordFile>) -> Answer {
        Answer::Files { files, to_do: Vec::new(), views_apart_mm: None }
    }

    fn written(answer: &Answer) -> Vec<u8> {
        let mut bytes = Vec::new();
        answer.write(&mut bytes).unwrap();
        bytes
    }

    #[test]
    fn an_answer_reads_back() {
        let files = vec![file("record.json", b"{\n}\n"), file("empty", b""), file("S", b"\0\xff")];
        let refused = Answer::Refused { code: "no-leg".into(), message: "line\nbreak".into() };
        let to_do = vec!["Measure by hand: right leg: C.".to_owned()];
        let measured = Answer::Files { files, to_do, views_apart_mm: Some(3.25) };
        for answer in [measured, refused] {
            assert_eq!(Answer::read(&mut &written(&answer)[..], 100).unwrap(), answer);
        }
    }

    #[test]
    fn an_answer_that_ends_anywhere_before_its_end_is_none() {
        let whole = written(&complete(vec![file("a", b"abc"), file("b", b"defg")]));
        for end in 0..whole.len() {
            let fault = Answer::read(&mut &whole[..end], 100).unwrap_err();
            assert_eq!(fault.kind(), io::ErrorKind::UnexpectedEof, "{end}");
        }
    }

    #[test]
    fn an_answer_that_would_fill_the_memory_is_not_read() {
        let long = written(&complete(vec![file("a", &[0; 60]), file("b", &[0; 60])]));
        assert!(Answer::read(&mut &long[..], 100).is_err());
    }
}
