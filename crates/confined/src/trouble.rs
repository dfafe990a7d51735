//! Why a measurement ends without an answer, and what may be to blame for it.

use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;
use std::time::Duration;

use super::Limits;

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Trouble {
    /// It took too long.
    #[error("measuring took more than {} s", .limit.as_secs())]
    Wall {
        limit: Duration,
        /// The processor time that it used; `None` if unknown.
        cpu: Option<Duration>,
    },
    /// It needed too much memory.
    #[error("measuring needs more than {} MB of memory", .0 / 1_000_000)]
    Memory(u64),
    /// Something else ended its process.
    #[error("measuring was killed from outside by signal {signal}")]
    Killed { signal: i32 },
    /// Its process could not be prepared.
    #[error("the measuring process ended with exit code {code}{complaint}")]
    NotReady {
        /// The exit code.
        code: i32,
        /// Its error output.
        complaint: String,
    },
    #[error("measuring ended with signal {signal}{complaint}")]
    Crashed {
        signal: i32,
        /// Its error output.
        complaint: String,
    },
}

/// What is to blame for a trouble.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Blame {
    /// The scan: the same would happen again.
    Scan,
    /// The machine, or a person who works on it: the scan waits.
    Machine,
    /// Either: if it happens repeatedly, and to no other scan, it is the scan.
    Either,
}

/// Signals that end processes from outside: from the kernel when memory is short, from a person, or
/// from a session that ends.
const FROM_OUTSIDE: [i32; 5] =
    [libc::SIGKILL, libc::SIGTERM, libc::SIGINT, libc::SIGHUP, libc::SIGQUIT];

impl Trouble {
    /// The trouble of a process that ended with this status. `too_late` is set if it was ended because
    /// it took too long; it holds the processor time that it had used.
    pub(crate) fn from_exit(
        status: ExitStatus,
        too_late: Option<Option<Duration>>,
        limits: &Limits,
        complaint: &str,
    ) -> Trouble {
        if let Some(cpu) = too_late {
            return Trouble::Wall { limit: limits.wall, cpu };
        }
        let suffix = if complaint.is_empty() { String::new() } else { format!(": {complaint}") };
        match (status.signal(), status.code()) {
            _ if complaint.contains("memory allocation of") => Trouble::Memory(limits.memory_bytes),
            (Some(signal), _) if FROM_OUTSIDE.contains(&signal) => Trouble::Killed { signal },
            (Some(signal), _) => Trouble::Crashed { signal, complaint: suffix },
            (None, code) => Trouble::NotReady { code: code.unwrap_or(-1), complaint: suffix },
        }
    }

    /// The stable code.
    pub fn code(&self) -> &'static str {
        match self {
            Trouble::Wall { .. } => "measuring-too-long",
            Trouble::Memory(_) => "measuring-too-large",
            Trouble::Killed { .. } => "measuring-killed",
            Trouble::NotReady { .. } => "measuring-not-started",
            Trouble::Crashed { .. } => "measuring-crashed",
        }
    }

    pub fn blame(&self) -> Blame {
        match self {
            // A machine that sleeps or stalls lets the time pass without computing.
            Trouble::Wall { limit, cpu } => match cpu.is_some_and(|cpu| cpu >= *limit / 2) {
                true => Blame::Scan,
                false => Blame::Machine,
            },
            Trouble::Memory(_) | Trouble::Crashed { .. } => Blame::Either,
            Trouble::Killed { .. } | Trouble::NotReady { .. } => Blame::Machine,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_without_an_answer_has_its_name_and_who_is_to_blame() {
        let limits = Limits { memory_bytes: 256_000_000, wall: Duration::from_secs(10) };
        let end = |status: i32, complaint: &str| {
            let trouble =
                Trouble::from_exit(ExitStatus::from_raw(status), None, &limits, complaint);
            (trouble.code(), trouble.blame())
        };
        let no_memory = "memory allocation of 4096 bytes failed";
        assert_eq!(end(libc::SIGABRT, no_memory), ("measuring-too-large", Blame::Either));
        assert_eq!(end(libc::SIGSEGV, ""), ("measuring-crashed", Blame::Either));
        assert_eq!(end(libc::SIGKILL, ""), ("measuring-killed", Blame::Machine));
        assert_eq!(end(libc::SIGTERM, ""), ("measuring-killed", Blame::Machine));
        assert_eq!(end(70 << 8, "no limit"), ("measuring-not-started", Blame::Machine));

        let too_late = |cpu_s: Option<u64>| {
            let killed = ExitStatus::from_raw(libc::SIGKILL);
            Trouble::from_exit(killed, Some(cpu_s.map(Duration::from_secs)), &limits, "").blame()
        };
        assert_eq!(too_late(Some(5)), Blame::Scan, "it computed half of the time");
        assert_eq!(too_late(Some(4)), Blame::Machine);
        assert_eq!(too_late(None), Blame::Machine);
    }
}
