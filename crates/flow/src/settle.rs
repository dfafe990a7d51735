//! When a file has settled: neither it nor what belongs to it has changed for the quiet time of our own
//! monotonic clock.
//!
//! The file's own times are compared for change only, never with our clock: other machines' clocks differ.
//! The interval between two times of one file system shows what was brought in from elsewhere. The wait for a
//! file that keeps changing has no limit.
//!
//! A settled file is offered at every look until the caller reports the outcome:
//! [`Settling::taken`], [`Settling::cut_short`], [`Settling::changed`] or [`Settling::failed`].

mod above;
mod gone;
mod lineage;
mod memory;
mod sights;
mod turns;
mod wait;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::backoff;
use super::export::companions::{Done, Group};
use super::export::writing::{Appeared, Fingerprint, Writing};
use above::Above;
pub use above::Folders;
pub use gone::Gone;
use gone::Missing;
pub use lineage::UnrelatedFile;
use lineage::VanishedFile;
pub use memory::{Memory, Remembered};
pub use sights::Sights;
pub use wait::{Wait, Waiting};

/// A last line end is waited for this many times as long as for a whole file.
const LINE_END_QUIETS: u32 = 3;

/// What one look at a folder found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Look {
    /// The folder's scans and the files that belong to each.
    Seen(BTreeMap<PathBuf, Group>),
    /// The folder could not be listed, or is not the expected one.
    OutOfReach,
}

/// When a look was taken, on the daemon's monotonic clock. A look at a slow share takes time, and a file
/// may change meanwhile: quiet time counts from the end of one look to the start of another.
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
    pub path: PathBuf,
    /// It and the files that go with it, unchanged for the quiet time.
    pub group: Group,
    /// The wait for its rest is over: it is to be taken even if it is cut short.
    pub awaited: bool,
    /// How it was written, as far as looks show it, on their clock.
    pub writing: Writing,
    /// It was taken before, and a file beside it has appeared or changed since.
    pub has_late_companion: bool,
}

/// The files of one folder on their way to being settled.
#[derive(Debug, Default)]
pub struct Settling {
    quiet: Duration,
    short_wait: Duration,
    overdue: Duration,
    /// How long to wait for a scan's companions; `None` if they name nobody.
    companion_wait: Option<Duration>,
    files: BTreeMap<PathBuf, Watched>,
    /// Files that are not scans, by their present names: temporary names of scans to come.
    unrelated: BTreeMap<PathBuf, UnrelatedFile>,
    /// What the previous run knew about files that were not taken, and what is known about files that
    /// have just left a name that is not a scan's.
    remembered: Vec<Remembered>,
    /// Files that were not taken and have disappeared; see [`lineage`].
    departed: Vec<VanishedFile>,
    /// Contents that may be gone; see [`gone`].
    missing: Vec<Missing>,
    /// The folders above the files.
    above: Above,
    /// When the last look at the folder began that could be trusted.
    last_look: Option<Duration>,
    /// How many files have had their turn; see [`turns`].
    turns: usize,
}

#[derive(Debug, Clone)]
struct Watched {
    group: Group,
    writing: Writing,
    /// When it appeared, or changed after it was taken: it has waited to be taken since then, however
    /// often it changes.
    since: Duration,
    /// Its content has changed since part of it was last read.
    is_unmarked: bool,
    /// Since when the scan itself has not changed.
    unchanged_since: Duration,
    /// Since when neither it nor the files that belong to it have changed.
    quiet_since: Duration,
    failures: u32,
    next: Next,
    /// The folder was out of reach; the quiet time starts when the file is seen again.
    is_lost: bool,
    is_overdue: bool,
    /// A file beside it has appeared or changed since it was taken.
    has_late_companion: bool,
}

/// What a file waits for while it does not change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Next {
    /// The end of its quiet time.
    Quiet,
    /// The rest of its content, or the end of the wait for it.
    Rest,
    /// Its last line end, which some exporters never write.
    LineEnd,
    /// The time of the next attempt to take it.
    Attempt(Duration),
    /// Nothing: it has been taken.
    Taken,
}

impl Watched {
    fn new(group: Group, writing: Writing, now: Duration) -> Watched {
        Watched {
            group,
            writing,
            since: now,
            is_unmarked: true,
            unchanged_since: now,
            quiet_since: now,
            failures: 0,
            next: Next::Quiet,
            is_lost: false,
            is_overdue: false,
            has_late_companion: false,
        }
    }

    /// The file after a look that found it like this; `news` is what is known about the content of a
    /// file whose stamp has changed, and `asks` is whether the files beside it name the patient.
    fn seen(mut self, group: Group, news: Option<Writing>, now: Duration, asks: bool) -> Watched {
        let is_taken = self.next == Next::Taken;
        if news.is_some() || self.is_lost {
            let since = if is_taken { now } else { self.since };
            let is_overdue = self.is_overdue && !is_taken;
            let writing = news.unwrap_or(self.writing);
            return Watched { since, is_overdue, ..Watched::new(group, writing, now) };
        }
        let has_news_beside = self.group.companions != group.companions;
        if is_taken && asks && has_news_beside && !group.companions.is_empty() {
            // It arrives late, but may still name the patient.
            (self.next, self.has_late_companion) = (Next::Quiet, true);
            (self.since, self.quiet_since) = (now, now);
        } else if self.group != group && !is_taken {
            self.quiet_since = now;
        }
        self.group = group;
        self
    }
}

impl Settling {
    /// Nothing seen yet. A file unchanged for `quiet` has settled; the rest of a file cut short is
    /// waited for until `short_wait` after its last change; a file kept from being taken for `overdue`
    /// raises an alarm.
    pub fn new(quiet: Duration, short_wait: Duration, overdue: Duration) -> Settling {
        Settling { quiet, short_wait: short_wait.max(quiet), overdue, ..Settling::default() }
    }

    /// For scans whose patient is named by the files beside them: a scan waits this long for such a
    /// file, and is offered once more if one arrives later.
    pub fn awaiting_companions(self, wait: Duration) -> Settling {
        Settling { companion_wait: Some(wait), ..self }
    }

    /// Processes a look; returns the files to take now, each in its turn: fresh files first, but every
    /// few turns one that has waited long.
    pub fn observe(&mut self, look: Look, when: LookTime) -> Vec<Settled> {
        let Look::Seen(seen) = look else {
            self.note_gap();
            return Vec::new();
        };
        let mut news = self.news(&seen, when);
        self.miss(&seen, when.began);
        let mut before = std::mem::take(&mut self.files);
        for (path, group) in seen {
            let known = before.remove(&path);
            let file = match (known, news.remove(&path)) {
                (Some(known), writing) => {
                    let asks = self.companion_wait.is_some();
                    known.seen(group, writing, when.ended, asks)
                }
                (None, Some(writing)) => Watched::new(group, writing, when.ended),
                (None, None) => continue,
            };
            self.files.insert(path, file);
        }
        self.depart(before, when.ended);
        self.last_look = Some(when.began);
        self.due(when.began)
    }

    /// Time has passed that is not quiet time: the folder was out of reach, or the machine slept, and
    /// the writer may have been cut off, too.
    pub fn note_gap(&mut self) {
        for file in self.files.values_mut() {
            file.is_lost = file.next != Next::Taken;
        }
    }

    /// What is known about the contents of files that are new or have changed since the last look.
    fn news(&self, seen: &BTreeMap<PathBuf, Group>, when: LookTime) -> BTreeMap<PathBuf, Writing> {
        let is_news = |(path, group): &(&PathBuf, &Group)| {
            self.files.get(*path).is_none_or(|known| known.group.stamp != group.stamp)
        };
        let lineages = self.lineages();
        let appeared = Appeared { absent: self.last_look, seen: when.ended };
        let news = seen.iter().filter(is_news);
        let news =
            news.map(|(path, group)| (path.clone(), lineages.writing(path, group.stamp, appeared)));
        news.collect()
    }

    fn due(&self, now: Duration) -> Vec<Settled> {
        let is_due = |file: &Watched| self.due_at(file).is_some_and(|at| at <= now);
        let due = self.files.iter().filter(|(_, file)| is_due(file));
        let settled = due.map(|(path, file)| {
            let settled = Settled {
                path: path.clone(),
                group: file.group.clone(),
                awaited: now.saturating_sub(file.unchanged_since) >= self.rest_wait(file.next),
                writing: file.writing.clone(),
                has_late_companion: file.has_late_companion,
            };
            (file.unchanged_since, settled)
        });
        turns::in_turn(settled.collect(), self.turns)
    }

    /// How long to wait for what a file lacks.
    fn rest_wait(&self, next: Next) -> Duration {
        match next {
            Next::LineEnd => self.short_wait.min(LINE_END_QUIETS * self.quiet),
            Next::Rest | Next::Quiet | Next::Attempt(_) | Next::Taken => self.short_wait,
        }
    }

    /// When a file can be taken if it does not change before; `None` once it is taken, and while
    /// something else must happen first.
    fn due_at(&self, file: &Watched) -> Option<Duration> {
        if file.group.done == Done::Missing || file.is_lost {
            return None;
        }
        let quiet = file.quiet_since + self.quiet.max(file.group.stamp.grain());
        let is_alone = file.group.companions.is_empty() && !file.group.is_shared;
        let quiet = match self.companion_wait.filter(|_| is_alone) {
            Some(wait) => quiet.max(file.since + wait),
            None => quiet,
        };
        match file.next {
            Next::Quiet => Some(quiet),
            Next::Rest | Next::LineEnd => {
                Some(quiet.max(file.unchanged_since + self.rest_wait(file.next)))
            }
            Next::Attempt(at) => Some(quiet.max(at)),
            Next::Taken => None,
        }
    }

    /// When the next file may be due; a look before then finds nothing to take.
    pub fn next_due(&self) -> Option<Duration> {
        self.files.values().filter_map(|file| self.due_at(file)).min()
    }

    /// The file was taken in this state, or refused unread; it is not offered again until it changes.
    pub fn taken(&mut self, settled: &Settled) {
        self.had_its_turn(settled, |file| {
            file.next = Next::Taken;
            file.writing.keep(file.group.stamp);
        });
    }

    /// The bytes of the file are safe, though it could not be taken: it may go.
    pub fn kept(&mut self, settled: &Settled) {
        let offered = self.files.get_mut(&settled.path);
        if let Some(file) = offered.filter(|file| file.group.stamp == settled.group.stamp) {
            file.writing.keep(settled.group.stamp);
        }
    }

    /// The file was read whole in the state that settled.
    pub fn read(&mut self, settled: &Settled, mark: &Fingerprint) {
        let offered = self.files.get_mut(&settled.path);
        if let Some(file) = offered.filter(|file| file.group.stamp == settled.group.stamp) {
            file.writing.known(mark.clone());
            file.is_unmarked = false;
        }
    }

    /// The file's own format shows that more is to come; it is offered again once it has changed and
    /// settled, or has been waited for long enough.
    pub fn cut_short(&mut self, settled: &Settled) {
        self.had_its_turn(settled, |file| file.next = Next::Rest);
    }

    /// Only the last line end is missing; it is offered again soon, to be taken as it is.
    pub fn lacks_line_end(&mut self, settled: &Settled) {
        self.had_its_turn(settled, |file| file.next = Next::LineEnd);
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
        if let Some(file) = offered.filter(|file| file.group.stamp == settled.group.stamp) {
            note(file);
        }
    }

    /// The files that are not taken yet and what each waits for, in name order.
    pub fn waiting(&self, now: Duration) -> impl Iterator<Item = (&Path, Waiting)> {
        self.untaken().map(move |(path, file)| (path.as_path(), self.wait(file, now)))
    }

    /// The scans that are not taken yet, in name order.
    fn untaken(&self) -> impl Iterator<Item = (&PathBuf, &Watched)> + Clone {
        self.files.iter().filter(|(_, file)| file.next != Next::Taken)
    }

    /// How many files have become overdue since the last call.
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
