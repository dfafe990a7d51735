//! The side of the program that starts a confined process: it feeds it, ends it in time and reports how it ended.

use std::fs;
use std::io::{self, BufReader, Read};
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use super::Limits;
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

/// How much of a process's error output is kept.
const COMPLAINT_MAX_BYTES: u64 = 400;

/// How a process ended.
#[derive(Debug)]
pub enum Ended<A> {
    Answered(A),
    /// It exceeded a limit, or ended without an answer.
    Trouble(Trouble),
}

/// Why a process could not run to any end; it may succeed later.
#[derive(Debug, thiserror::Error)]
pub enum RunFault {
    /// What it gets could not be read.
    #[error("what the process gets could not be read")]
    Input(#[source] io::Error),
    /// It could not be started or could not be fed.
    #[error("the process could not be started")]
    NotStarted(#[source] io::Error),
}

/// Runs this same program with these arguments: `feed` gives it what it reads, `read` takes its answer. Blocks.
///
/// # Errors
/// See [`RunFault`].
pub fn run<A>(
    arguments: &[&str],
    limits: &Limits,
    feed: impl Fn(&ChildStdin) -> io::Result<()>,
    read: impl FnOnce(&mut BufReader<ChildStdout>) -> io::Result<A>,
) -> Result<Ended<A>, RunFault> {
    let mut child = start(arguments).map_err(RunFault::NotStarted)?;
    let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    let (Some(input), Some(output), Some(complaints)) = pipes else {
        return Err(RunFault::NotStarted(io::Error::other("a pipe to the process is missing")));
    };
    let child = Mutex::new(child);
    let shared = &child;
    let (done, ended) = mpsc::channel::<()>();
    let (fed, answer, too_late) = thread::scope(|scope| {
        let killer = scope.spawn(move || {
            if ended.recv_timeout(limits.wall) != Err(RecvTimeoutError::Timeout) {
                return None;
            }
            let mut child = shared.lock().unwrap_or_else(PoisonError::into_inner);
            let cpu = cpu_of(child.id());
            // It may just have ended by itself, which is fine.
            let _ = child.kill();
            Some(cpu)
        });
        let fed = feed(&input);
        // It may wait for more than the job announces.
        drop(input);
        let answer = read(&mut BufReader::new(output));
        drop(done);
        (fed, answer, killer.join().unwrap_or(None))
    });
    let mut child = child.into_inner().unwrap_or_else(PoisonError::into_inner);
    let unanswered = match answer {
        Ok(answer) => {
            // Its answer is complete, and it has nothing to clean up.
            end(&mut child).map_err(RunFault::NotStarted)?;
            return Ok(Ended::Answered(answer));
        }
        Err(error) => error,
    };
    if let Err(error) = fed
        && too_late.is_none()
        && !is_closed(&error)
    {
        // What it gets could not be read; the process still waits for the rest.
        end(&mut child).map_err(RunFault::NotStarted)?;
        return Err(RunFault::Input(error));
    }
    if unanswered.kind() == io::ErrorKind::InvalidData {
        end(&mut child).map_err(RunFault::NotStarted)?;
    }
    let status = child.wait().map_err(RunFault::NotStarted)?;
    let complaint = complaint(complaints);
    Ok(Ended::Trouble(Trouble::from_exit(status, too_late, limits, &complaint)))
}

fn start(arguments: &[&str]) -> io::Result<Child> {
    Command::new(SELF)
        .args(arguments)
        .env_clear()
        .env(ALLOCATOR.0, ALLOCATOR.1)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
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

/// Whether the process stopped reading; its answer or its end explains why.
fn is_closed(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::BrokenPipe
}

fn complaint(from: impl Read) -> String {
    let mut text = Vec::new();
    // Output that cannot be read is left out.
    let _ = from.take(COMPLAINT_MAX_BYTES).read_to_end(&mut text);
    String::from_utf8_lossy(&text).trim().to_owned()
}
