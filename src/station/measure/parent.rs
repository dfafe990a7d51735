//! The station's side of a measurement: starting the process, feeding it, ending it in time, and
//! telling how it ended.

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use super::job::{Answer, Job};
use super::{Limits, VERB};
use crate::flow::ScanId;

/// This very program, whatever has become of the file it was started from.
const SELF: &str = "/proc/self/exe";

/// What the C library's allocator is told before the process begins. A measurement takes some 60 MB
/// and gives nothing back until it ends: from one heap of huge pages, where there are such, that
/// costs 500 page faults, by the library's own rule 10 600, which are a tenth of a measurement.
/// Pieces of more than 32 MB are mapped one by one as usual, so that growing them leaves no holes.
/// Other C libraries do not know the name and heed none of it.
const ALLOCATOR: (&str, &str) = (
    "GLIBC_TUNABLES",
    "glibc.malloc.arena_max=1:glibc.malloc.hugetlb=1:glibc.malloc.mmap_threshold=33554432:\
     glibc.malloc.trim_threshold=1073741824:glibc.malloc.top_pad=67108864",
);

/// An answer longer than this is none; a record has a few megabytes.
const ANSWER_MAX_BYTES: u64 = 1 << 30;

/// How much of what a process complained of is kept.
const COMPLAINT_MAX_BYTES: u64 = 400;

/// How a measurement ended.
#[derive(Debug)]
pub enum Measured {
    /// With an answer.
    Answered(Answer),
    /// Its process took more than it may, or ended without an answer.
    Trouble(Trouble),
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Trouble {
    /// It took too long.
    #[error("measuring it took more than {} s", .0.as_secs())]
    Wall(Duration),
    /// It took too much of the processors.
    #[error("measuring it took more than {} s of processor time", .0.as_secs())]
    Cpu(Duration),
    /// It wanted too much memory.
    #[error("measuring it needs more than {} MB of memory", .0 / 1_000_000)]
    Memory(u64),
    /// Its process ended without an answer.
    #[error("measuring it ended with {how}{complaint}")]
    Crashed {
        /// The signal or exit code.
        how: String,
        /// What it said.
        complaint: String,
    },
}

impl Trouble {
    /// The stable code.
    pub fn code(&self) -> &'static str {
        match self {
            Trouble::Wall(_) | Trouble::Cpu(_) => "measuring-too-long",
            Trouble::Memory(_) => "measuring-too-large",
            Trouble::Crashed { .. } => "measuring-crashed",
        }
    }

    /// Whether it might not happen again: a process may be killed by somebody else.
    pub fn may_pass(&self) -> bool {
        matches!(self, Trouble::Crashed { .. })
    }
}

/// Measures a spooled scan in a process of its own. Blocks.
///
/// # Errors
/// Where the process could not be started or the spooled files not be read; it may be later.
pub fn measure(
    scan: &ScanId,
    job: &Job,
    scan_file: &Path,
    ord_file: Option<&Path>,
) -> io::Result<Measured> {
    let files = [Some(scan_file), ord_file].into_iter().flatten();
    let files: Vec<File> = files.map(File::open).collect::<io::Result<_>>()?;
    let mut child = Command::new(SELF)
        .args([VERB, scan.as_str()])
        .env_clear()
        .env(ALLOCATOR.0, ALLOCATOR.1)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    let (Some(input), Some(output), Some(complaints)) = pipes else {
        end(&mut child)?;
        return Err(io::Error::other("a pipe to the measuring process is missing"));
    };
    let child = Mutex::new(child);
    let shared = &child;
    let (done, ended) = mpsc::channel::<()>();
    let (fed, answer, in_time) = thread::scope(|scope| {
        let killer = scope.spawn(move || {
            let in_time = ended.recv_timeout(job.limits.wall) != Err(RecvTimeoutError::Timeout);
            if !in_time {
                let mut child = shared.lock().unwrap_or_else(PoisonError::into_inner);
                // That it has just ended by itself is fine.
                let _ = child.kill();
            }
            in_time
        });
        let fed = feed(input, job, files);
        let answer = Answer::read(&mut BufReader::new(output), ANSWER_MAX_BYTES);
        drop(done);
        (fed, answer, killer.join().unwrap_or(true))
    });
    let mut child = child.into_inner().unwrap_or_else(PoisonError::into_inner);
    let unanswered = match answer {
        Ok(answer) => {
            // It has nothing more to say, and need not tidy up.
            end(&mut child)?;
            return Ok(Measured::Answered(answer));
        }
        Err(error) => error,
    };
    if let Err(error) = fed
        && in_time
        && !is_closed(&error)
    {
        // The spool could not be read; the process still waits for the rest.
        end(&mut child)?;
        return Err(error);
    }
    if unanswered.kind() == io::ErrorKind::InvalidData {
        end(&mut child)?;
    }
    let status = child.wait()?;
    Ok(Measured::Trouble(trouble(status, in_time, &job.limits, complaint(complaints))))
}

fn end(child: &mut Child) -> io::Result<ExitStatus> {
    child.kill()?;
    child.wait()
}

fn feed(mut input: impl Write, job: &Job, files: Vec<File>) -> io::Result<()> {
    job.write(&mut input)?;
    for mut file in files {
        io::copy(&mut file, &mut input)?;
    }
    input.flush()
}

/// Whether the process stopped listening, which its answer or its end explains.
fn is_closed(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::BrokenPipe
}

fn complaint(from: impl Read) -> String {
    let mut text = Vec::new();
    // What cannot be read was not said.
    let _ = from.take(COMPLAINT_MAX_BYTES).read_to_end(&mut text);
    String::from_utf8_lossy(&text).trim().to_owned()
}

fn trouble(status: ExitStatus, in_time: bool, limits: &Limits, complaint: String) -> Trouble {
    if !in_time {
        return Trouble::Wall(limits.wall);
    }
    match (status.signal(), status.code()) {
        (Some(libc::SIGXCPU), _) => Trouble::Cpu(limits.cpu),
        _ if complaint.contains("memory allocation of") => Trouble::Memory(limits.memory_bytes),
        (Some(signal), _) => {
            Trouble::Crashed { how: format!("signal {signal}"), complaint: said(&complaint) }
        }
        (None, code) => Trouble::Crashed {
            how: format!("exit code {}", code.unwrap_or(-1)),
            complaint: said(&complaint),
        },
    }
}

fn said(complaint: &str) -> String {
    if complaint.is_empty() { String::new() } else { format!(": {complaint}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_without_an_answer_has_its_name() {
        let limits = Limits {
            memory_bytes: 256_000_000,
            cpu: Duration::from_secs(5),
            wall: Duration::from_secs(9),
        };
        let end = |status: i32, in_time, complaint: &str| {
            trouble(ExitStatus::from_raw(status), in_time, &limits, complaint.to_owned())
        };
        assert_eq!(end(libc::SIGKILL, false, ""), Trouble::Wall(limits.wall));
        assert_eq!(end(libc::SIGXCPU, true, ""), Trouble::Cpu(limits.cpu));
        let oom = "memory allocation of 4096 bytes failed";
        assert_eq!(end(libc::SIGABRT, true, oom), Trouble::Memory(256_000_000));
        let crashed = [(libc::SIGSEGV, "signal 11"), (70 << 8, "exit code 70")];
        for (status, how) in crashed {
            let trouble = end(status, true, "x");
            assert!(trouble.may_pass() && trouble.to_string().contains(how), "{trouble}");
        }
    }
}
