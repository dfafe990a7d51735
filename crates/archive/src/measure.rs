//! Measures a crop in its own process: whatever its bytes make the measurement do, only that one process is affected.
//! They are unpacked and checked there, too.

use std::io::{self, BufReader, Read, Write};
use std::time::Duration;

use gaiter_confined::{Ended, Limits, RunFault, confine, read_line, run, write_line};
use gaiter_flow::confinement::Confine;
use gaiter_leg::{Method, WholeBody, extract_crop};
use gaiter_record::archive::{Outcome, unpacked};
use gaiter_record::{Provenance, ScanId, record};
use serde::{Deserialize, Serialize};

use crate::fault::chain;

/// The hidden verb with which the binary runs again.
pub const VERB: &str = "measure";

/// The limits of a measurement, those of a station: 2 GB and two minutes.
pub const LIMITS: Limits = Limits { memory_bytes: 2_000_000_000, wall: Duration::from_secs(120) };

/// The longest line to or from the process, bytes: a record has a few hundred thousand.
const LINE_MOST: u64 = 64 << 20;

/// What is measured. The packed bytes of the crop follow.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Job {
    /// SHA-256 of the crop's PLY.
    pub scan: ScanId,
    /// Its length, bytes.
    pub bytes: u64,
    /// What the rest of the body told.
    pub whole: WholeBody,
    /// How it is measured.
    pub method: Method,
}

/// What the process says.
#[derive(Debug, Serialize, Deserialize)]
pub enum Answer {
    /// What the method says.
    Said(Outcome),
    /// The object is not what its key says.
    Damaged(String),
}

/// Measures a crop of these packed bytes. Blocks.
///
/// # Errors
/// If no process runs here and now.
pub fn measure(job: &Job, packed: &[u8]) -> Result<Ended<Answer>, RunFault> {
    run(
        &[VERB],
        &LIMITS,
        |mut input| {
            write_line(&mut input, job)?;
            input.write_all(packed)
        },
        |output| read_line(output, LINE_MOST),
    )
}

/// The process.
///
/// # Errors
/// If no answer could be given; the worker takes that as a crash.
pub fn serve(input: impl Read, mut output: impl Write) -> io::Result<()> {
    let mut input = BufReader::new(input);
    let job: Job = read_line(&mut input, LINE_MOST)?;
    confine(&LIMITS, Confine::WherePossible).map_err(|fault| io::Error::other(chain(&fault)))?;
    // After the confinement, so that its thread is confined too.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(io::Error::other)?;
    let mut packed = Vec::new();
    input.read_to_end(&mut packed)?;
    let answer = pool.install(|| answer(&job, &packed));
    write_line(&mut output, &answer)?;
    output.flush()
}

fn answer(job: &Job, packed: &[u8]) -> Answer {
    let ply = match unpacked(packed, job.bytes) {
        Ok(ply) => ply,
        Err(fault) => return Answer::Damaged(fault.to_string()),
    };
    if ScanId::of_bytes(&ply) != job.scan {
        return Answer::Damaged("its bytes are not those of its hash".to_owned());
    }
    Answer::Said(match extract_crop(&ply, &job.whole, &job.method) {
        Ok(extraction) => {
            let provenance = Provenance::of_scan(job.scan.to_string());
            Outcome::Measured(Box::new(record(&extraction, &provenance, &job.method)))
        }
        Err(refusal) => {
            Outcome::Refused { code: refusal.code().to_owned(), message: refusal.to_string() }
        }
    })
}
