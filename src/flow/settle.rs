//! When a file has settled: nobody has changed it, or what belongs to it, for the quiet time of our
//! own monotonic clock.
//!
//! The file's own times are compared for change only, never for age: copies may keep old times,
//! and other machines' clocks differ. A file that goes on changing is waited for without limit.
//!
//! A settled file is offered at every look until the caller says what became of it:
//! [`Settling::taken`], [`Settling::cut_short`], [`Settling::changed`] or [`Settling::failed`].

mod turns;
mod wait;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::backoff;
use super::capture::Appeared;
use super::companions::{Companion, Done, Group};
use super::stamp::Stamp;
pub use wait::{Wait, Waiting};

/// What one look at a folder found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Look {
    /// The folder's scans and what belongs to each.
    Seen(BTreeMap<PathBuf, Group>),
    /// The folder could not be listed, or is not the one that should be there.
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
    /// What goes with it, unchanged for as long.
    pub companions: Vec<Companion>,
    /// Its rest has been awaited long enough: it is to be taken even if it is cut short.
    pub awaited: bool,
    /// When it appeared, on the clock of the looks.
    pub appeared: Appeared,
}

/// The files of one folder on their way to being settled.
#[derive(Debug)]
pub struct Settling {
    quiet: Duration,
    short_wait: Duration,
    overdue: Duration,
    files: BTreeMap<PathBuf, Watched>,
    /// When the last look at the folder began that could be believed.
    last_look: Option<Duration>,
    /// How many files have had their turn; see [`turns`].
    turns: usize,
}

#[derive(Debug, Clone)]
struct Watched {
    group: Group,
    /// When it appeared, or changed after it was taken: it waits to be taken since then, however often
    /// it changes.
    appeared: Appeared,
    /// Since when the scan itself has not changed.
    unchanged_since: Duration,
    /// Since when neither it nor what belongs to it has changed.
    quiet_since: Duration,
    failures: u32,
    next: Next,
    /// The folder was out of reach; the quiet time starts when the file is seen again.
    is_lost: bool,
    is_overdue: bool,
}

/// What a file waits for while it does not change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

impl Watched {
    fn new(group: Group, appeared: Appeared, now: Duration) -> Watched {
        Watched {
            group,
            appeared,
            unchanged_since: now,
            quiet_since: now,
            failures: 0,
            next: Next::Quiet,
            is_lost: false,
            is_overdue: false,
        }
    }

    /// The file as it is after a look that found it like this; `appeared` is for one that is new.
    fn seen(mut self, group: Group, appeared: Appeared) -> Watched {
        let (is_taken, now) = (self.next == Next::Taken, appeared.seen);
        if self.group.stamp != group.stamp || self.is_lost {
            let appeared = if is_taken { appeared } else { self.appeared };
            let is_overdue = self.is_overdue && !is_taken;
            return Watched { is_overdue, ..Watched::new(group, appeared, now) };
        }
        // What comes to a scan that has been taken comes too late.
        if self.group != group && !is_taken {
            self.quiet_since = now;
        }
        self.group = group;
        self
    }
}

impl Settling {
    /// Nothing seen yet. `quiet` unchanged is settled; a file cut short is awaited `short_wait`
    /// since its last change; one that is kept from being taken for `overdue` is worth an alarm.
    pub fn new(quiet: Duration, short_wait: Duration, overdue: Duration) -> Settling {
        let short_wait = short_wait.max(quiet);
        let files = BTreeMap::new();
        Settling { quiet, short_wait, overdue, files, last_look: None, turns: 0 }
    }

    /// Takes in a look; returns the files to be taken now, each in its turn: fresh files first, and of every few one that waits long.
    pub fn observe(&mut self, look: Look, when: LookTime) -> Vec<Settled> {
        let Look::Seen(seen) = look else {
            // Time out of reach is not quiet time: the writer was cut off too.
            for file in self.files.values_mut() {
                file.is_lost = file.next != Next::Taken;
            }
            return Vec::new();
        };
        let mut before = std::mem::take(&mut self.files);
        let appeared = Appeared { absent: self.last_look, seen: when.ended };
        for (path, group) in seen {
            let file = match before.remove(&path) {
                Some(known) => known.seen(group, appeared),
                None => Watched::new(group, appeared, when.ended),
            };
            self.files.insert(path, file);
        }
        self.last_look = Some(when.began);
        self.due(when.began)
    }

    fn due(&self, now: Duration) -> Vec<Settled> {
        let due = self.files.iter().filter(|(_, file)| self.is_due(file, now));
        let settled = due.map(|(path, file)| {
            let settled = Settled {
                path: path.clone(),
                stamp: file.group.stamp,
                companions: file.group.companions.clone(),
                awaited: now.saturating_sub(file.unchanged_since) >= self.short_wait,
                appeared: file.appeared,
            };
            (file.unchanged_since, settled)
        });
        turns::in_turn(settled.collect(), self.turns)
    }

    fn is_due(&self, file: &Watched, now: Duration) -> bool {
        self.due_at(file).is_some_and(|at| at <= now)
    }

    /// When a file may be taken if it does not change before; none once it is taken, and none
    /// while something else must happen first.
    fn due_at(&self, file: &Watched) -> Option<Duration> {
        if file.group.done == Done::Missing || file.is_lost {
            return None;
        }
        let quiet = file.quiet_since + self.quiet;
        match file.next {
            Next::Quiet => Some(quiet),
            Next::Rest => Some(quiet.max(file.unchanged_since + self.short_wait)),
            Next::Attempt(at) => Some(quiet.max(at)),
            Next::Taken => None,
        }
    }

    /// When the next file may be due, so that a look before then finds nothing to take.
    pub fn next_due(&self) -> Option<Duration> {
        self.files.values().filter_map(|file| self.due_at(file)).min()
    }

    /// The file has been taken in this state; it is not offered again until it changes.
    pub fn taken(&mut self, settled: &Settled) {
        self.had_its_turn(settled, |file| file.next = Next::Taken);
    }

    /// The file's own format shows that more is to come; it is offered again once it has changed
    /// and settled, or has been awaited long enough.
    pub fn cut_short(&mut self, settled: &Settled) {
        self.had_its_turn(settled, |file| file.next = Next::Rest);
    }

    /// The file changed while it was being taken: its quiet time starts again at `now`.
    pub fn changed(&mut self, settled: &Settled, now: Duration) {
        self.had_its_turn(settled, |file| {
            file.unchanged_since = now;
            file.quiet_since = now;
            file.next = Next::Quiet;
        });
    }

    /// Taking the file failed for a reason that may pass; it is offered again after a growing
    /// pause, without limit. `chance` is uniform in [0, 1).
    pub fn failed(&mut self, settled: &Settled, now: Duration, chance: f64) {
        self.had_its_turn(settled, |file| {
            file.failures = file.failures.saturating_add(1);
            file.next = Next::Attempt(now + backoff::pause(file.failures, chance));
        });
    }

    fn had_its_turn(&mut self, settled: &Settled, note: impl FnOnce(&mut Watched)) {
        self.turns = self.turns.wrapping_add(1);
        let offered = self.files.get_mut(&settled.path);
        if let Some(file) = offered.filter(|file| file.group.stamp == settled.stamp) {
            note(file);
        }
    }

    /// The files that are not taken yet and what each waits for, in name order.
    pub fn waiting(&self, now: Duration) -> impl Iterator<Item = (&Path, Waiting)> {
        let untaken = self.files.iter().filter(|(_, file)| file.next != Next::Taken);
        untaken.map(move |(path, file)| (path.as_path(), self.wait(file, now)))
    }

    /// When the files appeared that are not taken yet.
    pub fn coming(&self) -> impl Iterator<Item = Duration> {
        let untaken = self.files.values().filter(|file| file.next != Next::Taken);
        untaken.map(|file| file.appeared.seen)
    }

    /// How many files have become overdue since this was asked last.
    pub fn newly_overdue(&mut self, now: Duration) -> usize {
        let mut files = std::mem::take(&mut self.files);
        let mut count = 0;
        for file in files.values_mut().filter(|file| file.next != Next::Taken && !file.is_overdue) {
            file.is_overdue = self.wait(file, now).overdue;
            count += usize::from(file.is_overdue);
        }
        self.files = files;
        count
    }
}

#[cfg(test)]
mod tests;
