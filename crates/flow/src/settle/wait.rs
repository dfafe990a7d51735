//! What a file waits for, in words for the person who asks where it is.

use std::fmt::Display;
use std::time::Duration;

use gaiter_language::Language;

use super::{Next, Settling, Watched};
use crate::export::companions::Done;
use crate::words::decimals;

/// A file that is not taken yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Waiting {
    pub wait: Wait,
    /// Since when it waits, on the daemon's monotonic clock.
    pub since: Duration,
    /// It has been kept from being taken for too long.
    pub overdue: bool,
}

/// What a file waits for.
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
    Turn,
    /// Its folder, which is out of reach.
    Folder,
}

impl Wait {
    /// What it waits for, in words that follow the file.
    pub fn words(&self, language: Language) -> String {
        let text = |key| language.text(key).to_owned();
        let s = |time: &Duration, places| decimals(time.as_secs_f64(), places, language);
        let left = |key, left| language.filled(key, &[("left", &s(left, 0))]);
        match self {
            Wait::Changing => text("explain.wait.changing"),
            Wait::CompanionChanging => text("explain.wait.companion_changing"),
            Wait::Quiet { unchanged, quiet } => {
                let words: [(&str, &dyn Display); 2] =
                    [("unchanged", &s(unchanged, 1)), ("quiet", &s(quiet, 1))];
                language.filled("explain.wait.quiet", &words)
            }
            Wait::Rest { left: time } => left("explain.wait.rest", time),
            Wait::DoneFile => text("explain.wait.done_file"),
            Wait::Companion { left: time } => left("explain.wait.companion", time),
            Wait::Attempt { failures: 1, left: time } => left("explain.wait.second_attempt", time),
            Wait::Attempt { failures, left: time } => {
                let words: [(&str, &dyn Display); 2] = [("count", failures), ("left", &s(time, 0))];
                language.filled("explain.wait.attempt", &words)
            }
            Wait::Turn => text("explain.wait.turn"),
            Wait::Folder => text("explain.wait.folder"),
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
