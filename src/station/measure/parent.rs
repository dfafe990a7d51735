//! The station's side of a measurement: starts the process, feeds it, ends it in time and reports how
//! it ended.

use std::fs::{self, File};
use std::io::{self, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use gaiter_flow::ScanId;

use super::VERB;
use super::job::{Job, JobAnswer, Purpose};
use super::trouble::Trouble;

/// This same program, even if the file it was started from has been replaced.
const SELF: &str = "/proc/self/exe";

/// Settings of the C library's allocator for the process. A measurement takes some 60 MB and gives
/// nothing back until it ends. From one heap, of huge pages if there are any, that costs 1 000 page
/// faults; with the library's own rules it costs 11 000, which take 6 to 10 % of a measurement. Pieces
/// of more than 32 MB are mapped one by one as usual, so that growing them leaves no holes. Other C
/// libraries do not know the variable and ignore it.
const ALLOCATOR: (&str, &str) = (
    "GLIBC_TUNABLES",
    "glibc.malloc.arena_max=1:glibc.malloc.hugetlb=1:glibc.malloc.mmap_threshold=33554432:\
     glibc.malloc.trim_threshold=1073741824:glibc.malloc.top_pad=67108864",
);

/// A longer answer is refused; a record has a few megabytes.
const ANSWER_MAX_BYTES: u64 = 1 << 30;

/// How much of a process's error output is kept.
const COMPLAINT_MAX_BYTES: u64 = 400;

/// How a measurement ended.
#[derive(Debug)]
pub enum Measured {
    /// With an answer.
    Answered(JobAnswer),
    /// Its process exceeded a limit, or ended without an answer.
    Trouble(Trouble),
}

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

/// Measures a spooled scan in its own process. Blocks.
pub fn measure(
    scan: &ScanId,
    job: &Job,
    scan_file: &Path,
    ord_file: Option<&Path>,
) -> Result<Measured, MeasureFault> {
    let files = [Some(scan_file), ord_file].into_iter().flatten();
    let files: Vec<File> =
        files.map(File::open).collect::<io::Result<_>>().map_err(MeasureFault::Spool)?;
    run(Some(scan), job, |mut input| {
        files.iter().try_for_each(|mut file| io::copy(&mut file, &mut input).map(drop))
    })
}

/// Measures bytes in their own process; without a `scan` it is not told their hash. Blocks.
pub fn measure_bytes(
    scan: Option<&ScanId>,
    job: &Job,
    bytes: &[u8],
) -> Result<Measured, MeasureFault> {
    run(scan, job, |mut input| input.write_all(bytes))
}

/// Whether a measuring process can answer here and now: it gets bytes that are not a scan. Blocks.
pub fn answers(job: &Job) -> Result<bool, MeasureFault> {
    let bytes: &[u8] = b"no scan\n";
    let (scan_bytes, purpose) = (bytes.len() as u64, Purpose::Inspection);
    let job = Job { purpose, scan_bytes, ord_bytes: 0, ..job.clone() };
    Ok(matches!(measure_bytes(None, &job, bytes)?, Measured::Answered(_)))
}

/// Runs the process; `feed` gives it what follows the job's line.
fn run(
    scan: Option<&ScanId>,
    job: &Job,
    feed: impl Fn(&ChildStdin) -> io::Result<()>,
) -> Result<Measured, MeasureFault> {
    let (child, input, output, complaints) = start(scan).map_err(MeasureFault::NotStarted)?;
    let child = Mutex::new(child);
    let shared = &child;
    let (done, ended) = mpsc::channel::<()>();
    let (fed, answer, too_late) = thread::scope(|scope| {
        let killer = scope.spawn(move || {
            if ended.recv_timeout(job.limits.wall) != Err(RecvTimeoutError::Timeout) {
                return None;
            }
            let mut child = shared.lock().unwrap_or_else(PoisonError::into_inner);
            let cpu = cpu_of(child.id());
            // It may just have ended by itself, which is fine.
            let _ = child.kill();
            Some(cpu)
        });
        let fed = job.write(&mut &input).and_then(|()| feed(&input));
        // It may wait for more than the job tells of.
        drop(input);
        let answer = JobAnswer::read(&mut BufReader::new(output), ANSWER_MAX_BYTES);
        drop(done);
        (fed, answer, killer.join().unwrap_or(None))
    });
    let mut child = child.into_inner().unwrap_or_else(PoisonError::into_inner);
    let unanswered = match answer {
        Ok(answer) => {
            // It has nothing more to say and does not need to clean up.
            end(&mut child).map_err(MeasureFault::NotStarted)?;
            return Ok(Measured::Answered(answer));
        }
        Err(error) => error,
    };
    if let Err(error) = fed
        && too_late.is_none()
        // Its answer or its end explains why it stopped reading.
        && error.kind() != io::ErrorKind::BrokenPipe
    {
        // The spool could not be read; the process still waits for the rest.
        end(&mut child).map_err(MeasureFault::NotStarted)?;
        return Err(MeasureFault::Spool(error));
    }
    if unanswered.kind() == io::ErrorKind::InvalidData {
        end(&mut child).map_err(MeasureFault::NotStarted)?;
    }
    let status = child.wait().map_err(MeasureFault::NotStarted)?;
    let complaint = complaint(complaints);
    Ok(Measured::Trouble(Trouble::from_exit(status, too_late, &job.limits, &complaint)))
}

/// A process and its standard input, output and error output.
type Started = (Child, ChildStdin, ChildStdout, ChildStderr);

fn start(scan: Option<&ScanId>) -> io::Result<Started> {
    let mut child = Command::new(SELF)
        .arg(VERB)
        .args(scan.map(ScanId::as_str))
        .env_clear()
        .env(ALLOCATOR.0, ALLOCATOR.1)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    match (child.stdin.take(), child.stdout.take(), child.stderr.take()) {
        (Some(input), Some(output), Some(complaints)) => Ok((child, input, output, complaints)),
        _ => {
            end(&mut child)?;
            Err(io::Error::other("a pipe to the measuring process is missing"))
        }
    }
}

/// The processor time of a running process, all its threads together; `None` if unknown.
fn cpu_of(pid: u32) -> Option<Duration> {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // After the name, which may contain anything: utime and stime are fields 14 and 15 of the line.
    let (_, fields) = stat.rsplit_once(')')?;
    let mut fields = fields.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<u64>().ok();
    let ticks = ticks()? + ticks()?;
    Some(Duration::from_millis(ticks * 1000 / rustix::param::clock_ticks_per_second()))
}

fn end(child: &mut Child) -> io::Result<ExitStatus> {
    child.kill()?;
    child.wait()
}

fn complaint(from: impl Read) -> String {
    let mut text = Vec::new();
    // Output that cannot be read is left out.
    let _ = from.take(COMPLAINT_MAX_BYTES).read_to_end(&mut text);
    String::from_utf8_lossy(&text).trim().to_owned()
}
