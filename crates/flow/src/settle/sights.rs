//! What the looks at an export folder report to the captures that wait for its exports.

use std::path::Path;
use std::time::Duration;

use super::{Next, Settled, Settling, Watched};
use crate::export::writing::{Appeared, Writing};

/// What the looks at an export folder have found.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sights {
    /// Everything that was there at this time is known; `None` before the first look.
    pub looked: Option<Duration>,
    /// When the files that are not taken yet appeared.
    pub coming: Vec<Appeared>,
    /// The same for those of them that lack their end and are not being written any more.
    pub stopped: Vec<Appeared>,
    /// When the files without a scan's name appeared that have changed lately: an export may be written under
    /// another name.
    pub beside: Vec<Appeared>,
}

impl Settling {
    /// The files without a scan's name that have not changed for as long as a file may wait, and when each
    /// changed last.
    pub fn left(&self, now: Duration) -> impl Iterator<Item = (&Path, Duration)> {
        let changed = self.unrelated.iter();
        let changed = changed.map(|(path, file)| (path.as_path(), file.writing.last_changed()));
        let overdue = self.overdue;
        changed.filter(move |(_, at)| now.saturating_sub(*at) >= overdue)
    }

    /// When the contents began that are seen and not taken and were there when this file was seen whole, except
    /// other formats of its name, and copies and earlier parts of its content. What begins after that is
    /// another export of the same scan in many booths, and is judged when it is taken.
    pub fn others(&self, settled: &Settled, bytes: &[u8]) -> Vec<Appeared> {
        let whole = settled.writing.last_changed();
        let is_other = |path: &Path, file: &Watched| {
            let stamp = file.group.stamp;
            let is_its = path.with_extension("") == settled.path.with_extension("")
                || stamp.inode() == settled.group.stamp.inode()
                || file.writing.seen_in(bytes).is_some();
            let was_there = file.writing.content_seen() <= whole;
            stamp.size > 0 && !is_its && was_there
        };
        let others = self.untaken().filter(|(path, file)| is_other(path, file));
        others.map(|(_, file)| file.writing.last_began()).collect()
    }

    /// When the last look began, and when the files appeared that may become scans.
    pub fn sights(&self) -> Sights {
        let untaken = self.untaken().map(|(_, file)| file);
        let is_stopped = |file: &&Watched| file.next == Next::Rest && !file.is_lost;
        let stopped = untaken.clone().filter(is_stopped);
        let stopped = stopped.map(|file| file.writing.appeared()).collect();
        let coming = untaken.map(|file| file.writing.appeared()).collect();
        let may_grow = |writing: &Writing| {
            let since = |look: Duration| look.saturating_sub(writing.last_changed());
            self.last_look.is_none_or(|look| since(look) < self.short_wait)
        };
        let beside = self.unrelated.values().map(|file| &file.writing);
        let beside = beside.filter(|writing| may_grow(writing)).map(Writing::appeared).collect();
        Sights { looked: self.last_look, coming, stopped, beside }
    }
}
