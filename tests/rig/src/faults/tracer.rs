//! Runs a program under ptrace and answers each of its calls that change a file in given folders:
//! done, failed, cut short, only pretended, or the program killed before it.
//!
//! strace counts `when=N` for each thread by itself, and the station has many: this counts over
//! all threads and children, so that the Nth call is the Nth of the run. A short write is a real
//! one, for the length is changed before the kernel sees it.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::Write;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

use nix::errno::Errno;
use nix::libc;
use nix::sys::ptrace::{self, Options};
use nix::sys::signal::{Signal, kill, killpg};
use nix::sys::wait::{WaitPidFlag, WaitStatus, waitpid};
use nix::unistd::Pid;

use crate::station::PATIENCE;

/// How often it is asked whether the run has done its work.
const ASK: Duration = Duration::from_millis(5);

/// The longest path that is read from the program.
const PATH_BYTES: usize = 4096;

/// What a call does to its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Opens for writing, or creates.
    Open,
    /// Writes, or changes the length.
    Write,
    /// Makes content or names durable.
    Sync,
    /// Gives another name.
    Rename,
    /// Removes a name.
    Unlink,
    /// Makes a folder.
    Mkdir,
    /// Changes the mode.
    Mode,
}

/// A call that is about to be made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Call {
    /// Its place in the run, from 1, over all threads and processes.
    pub nth: usize,
    /// What it does.
    pub kind: Kind,
    /// Its file; where it is renamed, under its old name.
    pub path: PathBuf,
    /// Whether it is a folder that is synced.
    pub folder: bool,
}

/// What becomes of a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CallFate {
    /// It is made.
    Do,
    /// It is not made; its process is killed.
    Kill,
    /// It is not made; every process is killed.
    KillAll,
    /// It is not made and fails.
    Fail(Errno),
    /// Half of the bytes are written.
    Short,
    /// It is not made and succeeds.
    Pretend,
}

/// What a run came to.
#[derive(Debug)]
pub struct Run {
    /// Its calls in order.
    pub calls: Vec<Call>,
    /// Its exit code; none where a signal ended it.
    pub code: Option<i32>,
    /// It had to be ended by force.
    pub hung: bool,
}

/// Runs a program to its end, SIGTERM as soon as `finished`. Every call within `folders` is put to
/// `answer`. The program's standard input is empty.
pub fn run(
    mut command: Command,
    folders: &[PathBuf],
    finished: impl Fn() -> bool + Sync,
    mut answer: impl FnMut(&Call) -> CallFate,
) -> Run {
    use std::os::unix::process::CommandExt;
    // The tracer also waits for it, with every process it begins.
    #[allow(clippy::zombie_processes)]
    let mut child = command.process_group(0).stdin(Stdio::piped()).spawn().unwrap();
    let root = Pid::from_raw(child.id().cast_signed());
    let options = Options::PTRACE_O_TRACESYSGOOD
        | Options::PTRACE_O_TRACECLONE
        | Options::PTRACE_O_TRACEFORK
        | Options::PTRACE_O_TRACEVFORK
        | Options::PTRACE_O_TRACEEXEC
        | Options::PTRACE_O_EXITKILL;
    ptrace::seize(root, options).unwrap();
    ptrace::interrupt(root).unwrap();
    let mut tracer = Tracer {
        root,
        folders: folders.to_vec(),
        alive: BTreeSet::from([root]),
        inside: BTreeSet::new(),
        results: BTreeMap::new(),
        calls: Vec::new(),
        code: None,
    };
    // What the program waits for before it becomes the station; see `BEHIND_A_GATE`.
    child.stdin.take().unwrap().write_all(b"go\n").unwrap();
    let (over, hung) = (AtomicBool::new(false), AtomicBool::new(false));
    scope(|scope| {
        scope.spawn(|| end_it(root, &over, &hung, &finished));
        tracer.follow(&mut answer);
        over.store(true, Ordering::Relaxed);
    });
    Run { calls: tracer.calls, code: tracer.code, hung: hung.into_inner() }
}

/// What to put before a program and its arguments so that [`run`] can take hold of it first.
pub const BEHIND_A_GATE: [&str; 3] = ["sh", "-c", r#"read go; exec "$0" "$@" </dev/null"#];

/// Whether programs can be traced here; else says so.
pub fn can_trace() -> bool {
    let traced = std::panic::catch_unwind(|| {
        let [shell, option, gate] = BEHIND_A_GATE;
        let mut command = Command::new(shell);
        command.args([option, gate, "true"]);
        run(command, &[], || false, |_| CallFate::Do)
    });
    let can = traced.is_ok_and(|run| run.code == Some(0));
    if !can {
        println!("programs cannot be traced here (ptrace)");
    }
    can
}

fn end_it(root: Pid, over: &AtomicBool, hung: &AtomicBool, finished: &impl Fn() -> bool) {
    // A run that takes longer hangs.
    let deadline = Instant::now() + PATIENCE;
    let mut asked = false;
    while !over.load(Ordering::Relaxed) {
        if !asked && finished() {
            asked = true;
            let _ = kill(root, Signal::SIGTERM);
        }
        if Instant::now() > deadline {
            hung.store(true, Ordering::Relaxed);
            let _ = killpg(root, Signal::SIGKILL);
        }
        sleep(ASK);
    }
}

struct Tracer {
    root: Pid,
    folders: Vec<PathBuf>,
    alive: BTreeSet<Pid>,
    /// Threads that have entered a call and not left it: each call stops them twice.
    inside: BTreeSet<Pid>,
    /// What calls that are not made are to give.
    results: BTreeMap<Pid, u64>,
    calls: Vec<Call>,
    code: Option<i32>,
}

impl Tracer {
    fn follow(&mut self, answer: &mut impl FnMut(&Call) -> CallFate) {
        // Only what this thread started: other tests have children too.
        let flags = WaitPidFlag::__WALL | WaitPidFlag::__WNOTHREAD;
        loop {
            match waitpid(None, Some(flags)) {
                Err(Errno::ECHILD) => return,
                Err(Errno::EINTR) => {}
                Err(error) => panic!("waiting for the traced program: {error}"),
                Ok(WaitStatus::PtraceSyscall(pid)) => self.at_call(pid, answer),
                Ok(WaitStatus::Stopped(pid, signal)) => resume(pid, Some(signal)),
                Ok(WaitStatus::PtraceEvent(pid, ..)) => {
                    self.alive.insert(pid);
                    resume(pid, None);
                }
                Ok(WaitStatus::Exited(pid, code)) => {
                    self.gone(pid);
                    if pid == self.root {
                        self.code = Some(code);
                    }
                }
                Ok(WaitStatus::Signaled(pid, ..)) => {
                    self.gone(pid);
                }
                Ok(_) => {}
            }
        }
    }

    fn gone(&mut self, pid: Pid) {
        self.alive.remove(&pid);
        self.inside.remove(&pid);
    }

    fn at_call(&mut self, pid: Pid, answer: &mut impl FnMut(&Call) -> CallFate) {
        // A process that was killed meanwhile is gone.
        let Ok(mut registers) = ptrace::getregs(pid) else { return };
        if self.inside.remove(&pid) {
            if let Some(result) = self.results.remove(&pid) {
                registers.rax = result;
                let _ = ptrace::setregs(pid, registers);
            }
            return resume(pid, None);
        }
        self.inside.insert(pid);
        let Some(call) = self.call(pid, &registers) else { return resume(pid, None) };
        let given = answer(&call);
        self.calls.push(call);
        match given {
            CallFate::Do => {}
            CallFate::Kill => {
                let _ = kill(pid, Signal::SIGKILL);
                return;
            }
            CallFate::KillAll => {
                for pid in &self.alive {
                    let _ = kill(*pid, Signal::SIGKILL);
                }
                return;
            }
            CallFate::Fail(errno) => self.refuse(pid, registers, -i64::from(errno as i32)),
            CallFate::Pretend => self.refuse(pid, registers, 0),
            CallFate::Short => {
                registers.rdx = registers.rdx.div_ceil(2);
                let _ = ptrace::setregs(pid, registers);
            }
        }
        resume(pid, None);
    }

    /// Turns the call into none, and notes what it is to give.
    fn refuse(&mut self, pid: Pid, mut registers: libc::user_regs_struct, result: i64) {
        registers.orig_rax = u64::MAX;
        let _ = ptrace::setregs(pid, registers);
        self.results.insert(pid, result.cast_unsigned());
    }

    /// The call, where it changes a file in the folders.
    fn call(&self, pid: Pid, registers: &libc::user_regs_struct) -> Option<Call> {
        let (first, second) = (registers.rdi, registers.rsi);
        let number = registers.orig_rax.cast_signed();
        let at = libc::AT_FDCWD as u64;
        let (kind, path) = match number {
            libc::SYS_openat if writes(registers.rdx) => (Kind::Open, named(pid, first, second)),
            libc::SYS_open if writes(second) => (Kind::Open, named(pid, at, first)),
            libc::SYS_creat => (Kind::Open, named(pid, at, first)),
            libc::SYS_write
            | libc::SYS_pwrite64
            | libc::SYS_writev
            | libc::SYS_pwritev
            | libc::SYS_ftruncate
            | libc::SYS_fallocate
            | libc::SYS_copy_file_range
            | libc::SYS_sendfile => (Kind::Write, opened(pid, first)),
            libc::SYS_fsync | libc::SYS_fdatasync | libc::SYS_syncfs => {
                (Kind::Sync, opened(pid, first))
            }
            libc::SYS_rename | libc::SYS_link => (Kind::Rename, named(pid, at, first)),
            libc::SYS_renameat | libc::SYS_renameat2 | libc::SYS_linkat => {
                (Kind::Rename, named(pid, first, second))
            }
            libc::SYS_unlink | libc::SYS_rmdir => (Kind::Unlink, named(pid, at, first)),
            libc::SYS_unlinkat => (Kind::Unlink, named(pid, first, second)),
            libc::SYS_mkdir => (Kind::Mkdir, named(pid, at, first)),
            libc::SYS_mkdirat => (Kind::Mkdir, named(pid, first, second)),
            libc::SYS_chmod => (Kind::Mode, named(pid, at, first)),
            libc::SYS_fchmod => (Kind::Mode, opened(pid, first)),
            libc::SYS_fchmodat => (Kind::Mode, named(pid, first, second)),
            _ => return None,
        };
        let path =
            path.filter(|path| self.folders.iter().any(|folder| path.starts_with(folder)))?;
        let folder = kind == Kind::Sync && path.is_dir();
        Some(Call { nth: self.calls.len() + 1, kind, path, folder })
    }
}

fn writes(flags: u64) -> bool {
    let flags = flags as i32;
    flags & (libc::O_WRONLY | libc::O_RDWR | libc::O_CREAT | libc::O_TRUNC) != 0
}

fn resume(pid: Pid, signal: Option<Signal>) {
    // It may have been killed meanwhile.
    let _ = ptrace::syscall(pid, signal);
}

/// Where an open file lies.
fn opened(pid: Pid, fd: u64) -> Option<PathBuf> {
    fs::read_link(format!("/proc/{pid}/fd/{}", fd as i32)).ok()
}

/// The path a call names by a folder and an address.
fn named(pid: Pid, folder: u64, address: u64) -> Option<PathBuf> {
    let memory = File::open(format!("/proc/{pid}/mem")).ok()?;
    let mut bytes = vec![0; PATH_BYTES];
    let read = memory.read_at(&mut bytes, address).ok()?;
    let end = bytes[..read].iter().position(|byte| *byte == 0)?;
    let path = Path::new(std::str::from_utf8(&bytes[..end]).ok()?);
    if path.is_absolute() {
        return Some(path.to_owned());
    }
    let within = match folder as i32 {
        libc::AT_FDCWD => fs::read_link(format!("/proc/{pid}/cwd")).ok(),
        _ => opened(pid, folder),
    };
    Some(within?.join(path))
}
