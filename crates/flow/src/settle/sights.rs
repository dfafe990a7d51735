//! What the looks at an export folder report to the captures that wait for its exports.

use std::path::Path;
use std::time::Duration;

use super::{Next, Settling};
use crate::export::writing::Appeared;

/// What the looks at an export folder have found.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sights {
    /// Everything that was there at this time is known; `None` before the first look.
    pub looked: Option<Duration>,
    /// When the files that are not taken yet appeared.
    pub coming: Vec<Appeared>,
    /// When the files without a scan's name appeared: an export may be written under another name.
    pub beside: Vec<Appeared>,
}

impl Settling {
    /// The files without a scan's name that have not changed for as long as a file may wait, and when each
    /// changed last.
    pub fn left(&self, now: Duration) -> impl Iterator<Item = (&Path, Duration)> {
        let changed = self.passers.iter();
        let changed = changed.map(|(path, file)| (path.as_path(), file.writing.last_changed()));
        let overdue = self.overdue;
        changed.filter(move |(_, at)| now.saturating_sub(*at) >= overdue)
    }

    /// When the last look began, and when the files appeared that may become scans.
    pub fn sights(&self) -> Sights {
        let untaken = self.files.values().filter(|file| file.next != Next::Taken);
        let coming = untaken.map(|file| file.writing.appeared()).collect();
        let beside = self.passers.values().map(|file| file.writing.appeared()).collect();
        Sights { looked: self.last_look, coming, beside }
    }
}
