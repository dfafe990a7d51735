//! How far the kernel of this machine confines a measuring process, and whether that is enough.

use serde::{Deserialize, Serialize};

/// `measure.confine`: what to do if the kernel lacks a guard.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Confine {
    /// Scans are measured with the guards that are available.
    #[default]
    WherePossible,
    /// The station does not start.
    Required,
}

/// How far a kernel supports a guard.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Enforced {
    /// Everything that gaiter asks of it.
    Fully,
    /// An older version: files are closed to the process; some newer restrictions are missing.
    Partly,
    Not,
}

/// The guards around a measuring process.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Confinement {
    /// Landlock: no files, no network.
    pub landlock: Enforced,
    /// Seccomp: only the system calls that a process needs for computing.
    pub seccomp: bool,
}

impl Confinement {
    /// The guards that the kernel lacks, in words; `None` if it has both.
    pub fn missing(&self) -> Option<&'static str> {
        match (self.landlock, self.seccomp) {
            (Enforced::Not, false) => Some("landlock and seccomp"),
            (Enforced::Not, true) => Some("landlock"),
            (_, false) => Some("seccomp"),
            (_, true) => None,
        }
    }

    /// The active guards, in words.
    pub fn words(&self) -> &'static str {
        match (self.landlock, self.seccomp) {
            (Enforced::Fully, true) => "landlock and seccomp",
            (Enforced::Partly, true) => "landlock (of an older kernel) and seccomp",
            (Enforced::Fully, false) => "landlock",
            (Enforced::Partly, false) => "landlock (of an older kernel)",
            (Enforced::Not, true) => "seccomp",
            (Enforced::Not, false) => "its limits alone",
        }
    }

    /// Whether it is enough.
    pub fn suffices(&self, confine: Confine) -> bool {
        confine == Confine::WherePossible || self.missing().is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kernel_that_lacks_either_guard_does_not_do_where_confinement_is_required() {
        for landlock in [Enforced::Fully, Enforced::Partly, Enforced::Not] {
            for seccomp in [true, false] {
                let found = Confinement { landlock, seccomp };
                let has_both = landlock != Enforced::Not && seccomp;
                assert_eq!(found.missing().is_none(), has_both, "{found:?}");
                assert_eq!(found.suffices(Confine::Required), has_both, "{found:?}");
                assert!(found.suffices(Confine::WherePossible));
            }
        }
    }
}
