//! What the looks at an export folder tell those who wait for its exports.

use std::time::Duration;

use super::super::writing::Appeared;
use super::{Next, Settling};

/// What the looks at an export folder have found.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sights {
    /// What was there at this time is known; none before the first look.
    pub looked: Option<Duration>,
    /// When the files appeared that are not taken yet.
    pub coming: Vec<Appeared>,
    /// When the files appeared that have no scan's name: an export may be written under another one.
    pub beside: Vec<Appeared>,
}

impl Settling {
    /// When the last look began, and when the files appeared that may become scans.
    pub fn sights(&self) -> Sights {
        let untaken = self.files.values().filter(|file| file.next != Next::Taken);
        let coming = untaken.map(|file| file.writing.appeared()).collect();
        let beside = self.passers.values().map(|file| file.writing.appeared()).collect();
        Sights { looked: self.last_look, coming, beside }
    }
}
