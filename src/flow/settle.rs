//! When a file has settled: nobody has changed it for the quiet time of our own monotonic clock.
//!
//! The file's own times are compared for change only, never for age: copies may keep old times,
//! and other machines' clocks differ. A file that goes on changing is waited for without limit.
//!
//! A settled file is offered at every look until the caller says what became of it:
//! [`Settling::taken`], [`Settling::cut_short`], [`Settling::changed`] or [`Settling::failed`].

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::backoff;

/// What tells one state of a file from the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stamp {
    /// Device.
    pub dev: u64,
    /// Inode.
    pub ino: u64,
    /// Size, bytes.
    pub size: u64,
    /// Time of the last change of content, nanoseconds since 1970.
    pub mtime_ns: i128,
    /// Time of the last change of content or name, nanoseconds since 1970.
    pub ctime_ns: i128,
}

/// What one look at a folder found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Look {
    /// The folder's files.
    Seen(BTreeMap<PathBuf, Stamp>),
    /// The folder could not be listed.
    OutOfReach,
}

/// When a look was taken, on the daemon's monotonic clock. A look at a slow share takes time, and
/// a file may change in it: quiet time counts from the end of one look to the start of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LookTime {
    /// Before the folder was listed.
    pub began: Duration,
    /// After the last file was examined.
    pub ended: Duration,
}

/// A file that may be taken now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Settled {
    /// The file.
    pub path: PathBuf,
    /// The state in which it was unchanged for the quiet time.
    pub stamp: Stamp,
    /// Its rest has been awaited long enough: it is to be taken even if it is cut short.
    pub awaited: bool,
}

/// The files of one folder on their way to being settled.
#[derive(Debug)]
pub struct Settling {
    quiet: Duration,
    short_wait: Duration,
    files: BTreeMap<PathBuf, Watched>,
}

#[derive(Debug, Clone, Copy)]
struct Watched {
    stamp: Stamp,
    unchanged_since: Duration,
    failures: u32,
    next: Next,
}

/// What a file waits for while it does not change.
#[derive(Debug, Clone, Copy)]
enum Next {
    /// The end of its quiet time.
    Quiet,
    /// Its rest, or the end of the wait for it.
    Rest,
    /// The time of the next attempt to take it.
    Attempt(Duration),
    /// Nothing: it has been taken.
    Taken,
}

impl Settling {
    /// Nothing seen yet. `quiet` unchanged is settled; a file cut short is awaited `short_wait`
    /// since its last change.
    pub fn new(quiet: Duration, short_wait: Duration) -> Settling {
        Settling { quiet, short_wait: short_wait.max(quiet), files: BTreeMap::new() }
    }

    /// Takes in a look; returns the files to be taken now, in name order.
    pub fn observe(&mut self, look: Look, when: LookTime) -> Vec<Settled> {
        let Look::Seen(seen) = look else {
            // Time out of reach is not quiet time: the writer was cut off too. What is not taken
            // yet starts again.
            self.files.retain(|_, file| matches!(file.next, Next::Taken));
            return Vec::new();
        };
        let mut before = std::mem::take(&mut self.files);
        for (path, stamp) in seen {
            let file = match before.remove(&path) {
                Some(known) if known.stamp == stamp => known,
                _ => Watched { stamp, unchanged_since: when.ended, failures: 0, next: Next::Quiet },
            };
            self.files.insert(path, file);
        }
        self.due(when.began)
    }

    fn due(&self, now: Duration) -> Vec<Settled> {
        self.files
            .iter()
            .filter(|(_, file)| self.due_at(file).is_some_and(|at| at <= now))
            .map(|(path, file)| Settled {
                path: path.clone(),
                stamp: file.stamp,
                awaited: now.saturating_sub(file.unchanged_since) >= self.short_wait,
            })
            .collect()
    }

    /// When a file may be taken if it does not change before; none once it is taken.
    fn due_at(&self, file: &Watched) -> Option<Duration> {
        match file.next {
            Next::Quiet => Some(file.unchanged_since + self.quiet),
            Next::Rest => Some(file.unchanged_since + self.short_wait),
            Next::Attempt(at) => Some(at.max(file.unchanged_since + self.quiet)),
            Next::Taken => None,
        }
    }

    /// When the next file may be due, so that a look before then finds nothing to take.
    pub fn next_due(&self) -> Option<Duration> {
        self.files.values().filter_map(|file| self.due_at(file)).min()
    }

    /// The file has been taken in this state; it is not offered again until it changes.
    pub fn taken(&mut self, settled: &Settled) {
        if let Some(file) = self.offered(&settled.path, settled.stamp) {
            file.next = Next::Taken;
        }
    }

    /// The file's own format shows that more is to come; it is offered again once it has changed
    /// and settled, or has been awaited long enough.
    pub fn cut_short(&mut self, settled: &Settled) {
        if let Some(file) = self.offered(&settled.path, settled.stamp) {
            file.next = Next::Rest;
        }
    }

    /// The file changed while it was being taken: its quiet time starts again at `now`.
    pub fn changed(&mut self, settled: &Settled, now: Duration) {
        if let Some(file) = self.offered(&settled.path, settled.stamp) {
            file.unchanged_since = now;
            file.next = Next::Quiet;
        }
    }

    /// Taking the file failed for a reason that may pass; it is offered again after a growing
    /// pause, without limit. `chance` is uniform in [0, 1).
    pub fn failed(&mut self, settled: &Settled, now: Duration, chance: f64) {
        if let Some(file) = self.offered(&settled.path, settled.stamp) {
            file.failures = file.failures.saturating_add(1);
            file.next = Next::Attempt(now + backoff::pause(file.failures, chance));
        }
    }

    fn offered(&mut self, path: &Path, stamp: Stamp) -> Option<&mut Watched> {
        self.files.get_mut(path).filter(|file| file.stamp == stamp)
    }
}

#[cfg(test)]
mod tests;
