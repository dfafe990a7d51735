//! What a measuring process gives up before it reads the scanner's data.

use std::collections::BTreeMap;
use std::thread;

use gaiter_flow::confinement::{Confine, Confinement, Enforced};
use landlock::{
    ABI, Access, AccessFs, AccessNet, CompatLevel, Compatible, Ruleset, RulesetAttr, RulesetStatus,
    Scope,
};
use rustix::process::{
    Resource, Rlimit, Signal, getrlimit, set_parent_process_death_signal, setrlimit,
};
use seccompiler::{BpfProgram, SeccompAction, SeccompFilter, TargetArch};

use super::Limits;

/// The newest landlock interface whose rights are given up; older kernels give up the rights they know.
const NEWEST: ABI = ABI::V6;

/// Why a process could not be confined.
#[derive(Debug, thiserror::Error)]
pub enum ConfineFault {
    /// A limit could not be set.
    #[error("a limit of the process could not be set")]
    Limit(#[from] rustix::io::Errno),
    /// The kernel knows landlock and refused the rules.
    #[error("landlock could not be set")]
    Landlock(#[from] landlock::RulesetError),
    /// The filter of system calls could not be made or set.
    #[error("seccomp could not be set")]
    Seccomp(#[from] seccompiler::Error),
    /// The kernel lacks a guard that the configuration requires.
    #[error("the kernel has no {missing}, and measure.confine requires it")]
    Lacking { missing: &'static str },
    /// The guards could not be tried.
    #[error("the guards of this machine could not be tried")]
    NotTried(#[from] std::io::Error),
    /// Trying them panicked.
    #[error("trying the guards of this machine panicked")]
    Panicked,
}

/// The system calls of a process that computes: memory, threads, time, and files that are already open.
/// Every other call fails with EPERM, so that a library can do without it.
const ALLOWED: [i64; 49] = [
    libc::SYS_brk,
    libc::SYS_clock_getres,
    libc::SYS_clock_gettime,
    libc::SYS_clock_nanosleep,
    libc::SYS_clone,
    libc::SYS_clone3,
    libc::SYS_close,
    libc::SYS_exit,
    libc::SYS_exit_group,
    libc::SYS_fcntl,
    libc::SYS_fstat,
    libc::SYS_futex,
    libc::SYS_getcpu,
    libc::SYS_getpid,
    libc::SYS_getrandom,
    libc::SYS_gettid,
    libc::SYS_gettimeofday,
    libc::SYS_lseek,
    libc::SYS_madvise,
    libc::SYS_membarrier,
    libc::SYS_mmap,
    libc::SYS_mprotect,
    libc::SYS_mremap,
    libc::SYS_munmap,
    libc::SYS_nanosleep,
    libc::SYS_ppoll,
    libc::SYS_prctl,
    libc::SYS_prlimit64,
    libc::SYS_read,
    libc::SYS_readv,
    libc::SYS_restart_syscall,
    libc::SYS_rseq,
    libc::SYS_rt_sigaction,
    libc::SYS_rt_sigprocmask,
    libc::SYS_rt_sigreturn,
    libc::SYS_sched_getaffinity,
    libc::SYS_sched_getparam,
    libc::SYS_sched_getscheduler,
    libc::SYS_sched_setaffinity,
    libc::SYS_sched_yield,
    libc::SYS_set_robust_list,
    libc::SYS_set_tid_address,
    libc::SYS_sigaltstack,
    libc::SYS_sysinfo,
    libc::SYS_tgkill,
    libc::SYS_times,
    libc::SYS_uname,
    libc::SYS_write,
    libc::SYS_writev,
];

/// Confines the process. Must be called while it has one thread, because later threads inherit it.
///
/// # Errors
/// See [`ConfineFault`]. A kernel without landlock or seccomp is an error only if confinement is
/// required.
pub fn confine(limits: &Limits, confine: Confine) -> Result<(), ConfineFault> {
    // Only the station waits for this process.
    set_parent_process_death_signal(Some(Signal::KILL))?;
    // The unit's limit is meant for the station, not for this process.
    let data = getrlimit(Resource::Data).maximum;
    setrlimit(Resource::Data, Rlimit { current: data, maximum: data })?;
    limit(Resource::As, limits.memory_bytes)?;
    // A core dump holds a patient's body.
    limit(Resource::Core, 0)?;
    limit(Resource::Fsize, 0)?;
    guarded().and_then(|found| enough(found, confine))
}

/// What confines a measuring process on this machine, tried on a thread that ends afterwards.
///
/// # Errors
/// See [`ConfineFault`]: a measuring process could not be confined either.
pub fn tried() -> Result<Confinement, ConfineFault> {
    let thread = thread::Builder::new().name("guards".to_owned()).spawn(guarded)?;
    thread.join().map_err(|_| ConfineFault::Panicked)?
}

/// Checks whether these guards are enough.
///
/// # Errors
/// [`ConfineFault::Lacking`] if they are not.
pub fn enough(found: Confinement, confine: Confine) -> Result<(), ConfineFault> {
    match found.missing() {
        Some(missing) if !found.suffices(confine) => Err(ConfineFault::Lacking { missing }),
        _ => Ok(()),
    }
}

/// Gives up what the guards of this machine control, for this thread and those it starts.
fn guarded() -> Result<Confinement, ConfineFault> {
    let landlock = no_files_no_network()?;
    Ok(Confinement { landlock, seccomp: no_other_calls()? })
}

fn limit(resource: Resource, most: u64) -> Result<(), ConfineFault> {
    Ok(setrlimit(resource, Rlimit { current: Some(most), maximum: Some(most) })?)
}

/// Gives up every right that landlock controls.
fn no_files_no_network() -> Result<Enforced, ConfineFault> {
    let status = Ruleset::default()
        .set_compatibility(CompatLevel::BestEffort)
        .handle_access(AccessFs::from_all(NEWEST))?
        .handle_access(AccessNet::from_all(NEWEST))?
        .scope(Scope::from_all(NEWEST))?
        .create()?
        .restrict_self()?;
    Ok(match status.ruleset {
        RulesetStatus::FullyEnforced => Enforced::Fully,
        RulesetStatus::PartiallyEnforced => Enforced::Partly,
        RulesetStatus::NotEnforced => Enforced::Not,
    })
}

/// Gives up all other system calls. Returns whether the kernel supports that.
fn no_other_calls() -> Result<bool, ConfineFault> {
    // seccompiler knows the machines gaiter is built for; elsewhere the other guards must suffice.
    let Ok(machine) = TargetArch::try_from(std::env::consts::ARCH) else { return Ok(false) };
    let rules: BTreeMap<i64, _> = ALLOWED.iter().map(|call| (*call, Vec::new())).collect();
    let refused = SeccompAction::Errno(libc::EPERM.cast_unsigned());
    let filter = SeccompFilter::new(rules, refused, SeccompAction::Allow, machine)
        .map_err(seccompiler::Error::from)?;
    let program: BpfProgram = filter.try_into().map_err(seccompiler::Error::from)?;
    match seccompiler::apply_filter(&program) {
        Ok(()) => Ok(true),
        // A kernel without filters, or without seccomp.
        Err(seccompiler::Error::Seccomp(error))
            if [Some(libc::EINVAL), Some(libc::ENOSYS)].contains(&error.raw_os_error()) =>
        {
            Ok(false)
        }
        Err(error) => Err(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::net::TcpListener;
    use std::thread;

    use super::*;

    #[test]
    fn what_is_given_up_is_gone_and_computing_goes_on() {
        // Both guards hold for one thread and those it starts, so the other tests are not affected.
        let confined = thread::spawn(|| {
            no_files_no_network().unwrap();
            let landlocked = File::open("/etc/passwd").is_err();
            no_other_calls().unwrap();
            let listener = TcpListener::bind("127.0.0.1:0");
            let computed = thread::spawn(|| (0..100).flat_map(|n| vec![n; 100]).sum::<usize>());
            (landlocked, listener.is_err(), computed.join().unwrap())
        });
        let (landlocked, no_network, computed) = confined.join().unwrap();
        assert!(landlocked && no_network);
        assert_eq!(computed, 495_000);
        assert!(File::open("/etc/passwd").is_ok());
    }
}
