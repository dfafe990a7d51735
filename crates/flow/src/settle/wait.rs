//! What a file waits for, in words for the person who asks where it is.

use std::fmt;
use std::time::Duration;

use super::{Next, Settling, Watched};
use crate::export::companions::Done;

/// A file that is not taken yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Waiting {
    /// What it waits for.
    pub wait: Wait,
    /// Since when it waits, on the daemon's monotonic clock.
    pub since: Duration,
    /// It has been kept from being taken for too long.
    pub overdue: bool,
}

/// What a file waits for. Displayed as what follows "it".
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wait {
    /// It changed between the last two looks.
    Changing,
    /// A file that belongs to it changed between the last two looks.
    CompanionChanging,
    /// The end of its quiet time.
    Quiet {
        /// How long it has been unchanged.
        unchanged: Duration,
        /// How long it must stay unchanged.
        quiet: Duration,
    },
    /// The rest of its content.
    Rest {
        /// How much longer it waits.
        left: Duration,
    },
    /// Its done file.
    DoneFile,
    /// A file written beside it that names its patient.
    Companion {
        /// How much longer it waits.
        left: Duration,
    },
    /// Another attempt to take it.
    Attempt {
        /// How many attempts have failed.
        failures: u32,
        /// How long until the next attempt.
        left: Duration,
    },
    /// Its turn.
    Turn,
    /// Its folder, which is out of reach.
    Folder,
}

impl fmt::Display for Wait {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = |time: &Duration| time.as_secs_f64();
        match self {
            Wait::Changing => out.write_str("is still being written"),
            Wait::CompanionChanging => {
                out.write_str("waits for a file beside it that is still being written")
            }
            Wait::Quiet { unchanged, quiet } => {
                write!(out, "has been unchanged for {:.1} s of {:.1} s", s(unchanged), s(quiet))
            }
            Wait::Rest { left } => {
                write!(out, "is incomplete; waits {:.0} s more for the rest", s(left))
            }
            Wait::DoneFile => out.write_str("waits for its done file"),
            Wait::Companion { left } => {
                write!(out, "waits {:.0} s more for the file that names its patient", s(left))
            }
            Wait::Attempt { failures, left } => {
                let times =
                    if *failures == 1 { "once".into() } else { format!("{failures} times") };
                write!(
                    out,
                    "could not be taken in (tried {times}); next attempt in {:.0} s",
                    s(left)
                )
            }
            Wait::Turn => out.write_str("has settled and waits for its turn"),
            Wait::Folder => out.write_str("was seen before its folder became unreachable"),
        }
    }
}

impl Settling {
    /// What a file that is not taken waits for.
    pub(super) fn wait(&self, file: &Watched, now: Duration) -> Waiting {
        let unchanged = now.saturating_sub(file.quiet_since);
        let left = self.due_at(file).map_or(Duration::ZERO, |at| at.saturating_sub(now));
        let wait = if file.is_lost {
            Wait::Folder
        } else if unchanged < self.quiet && file.quiet_since > file.unchanged_since {
            Wait::CompanionChanging
        } else if unchanged.is_zero() && file.quiet_since > file.since {
            Wait::Changing
        } else if unchanged < self.quiet {
            Wait::Quiet { unchanged, quiet: self.quiet }
        } else if file.group.done == Done::Missing {
            Wait::DoneFile
        } else if file.next == Next::Quiet && !left.is_zero() {
            Wait::Companion { left }
        } else {
            match file.next {
                Next::Attempt(_) => Wait::Attempt { failures: file.failures, left },
                Next::Rest | Next::LineEnd if !left.is_zero() => Wait::Rest { left },
                Next::Rest | Next::LineEnd | Next::Quiet | Next::Taken => Wait::Turn,
            }
        };
        let is_late = now.saturating_sub(file.since) >= self.overdue;
        // A queue and a folder out of reach are reported elsewhere; they are not the file's fault.
        let is_its_own = !matches!(wait, Wait::Turn | Wait::Folder);
        Waiting { wait, since: file.since, overdue: is_late && is_its_own }
    }
}
