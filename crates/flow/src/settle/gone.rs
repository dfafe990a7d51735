//! Contents that were seen and are gone before they were taken: deleted, written over, or replaced under
//! their name. Each may have been the export of somebody who waits.
//!
//! What is renamed, copied or written on is not gone, nor is what was dealt with. A rename during a look
//! hides a file from it, so a file counts as gone when a second look does not find it either, or something
//! else is to be taken now.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{Next, Settled, Settling};
use crate::export::companions::Group;
use crate::export::stamp::Stamp;
use crate::export::writing::{Appeared, Fingerprint, Writing};

/// How many contents may be missing at one time: with more, the oldest are gone.
const MISSING_MOST: usize = 1000;

/// A content that was seen under a scan's name and is gone before it was taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Gone {
    /// The name under which it lay.
    pub path: PathBuf,
    /// The state in which its file was seen last.
    pub stamp: Stamp,
    /// When it appeared, as far as is known.
    pub appeared: Appeared,
}

/// A content that may be gone.
#[derive(Debug)]
pub(super) struct Missing {
    content: Gone,
    /// The name by which it is known elsewhere.
    trunk: Option<String>,
    /// Its file is there, and was cut off or written over.
    is_overwritten: bool,
    /// When the look began that missed it.
    since: Duration,
}

/// What is known about a content that may be gone.
enum Fate {
    There,
    /// The next look decides.
    Open,
    Gone,
}

impl Settling {
    /// Notes which contents a look that began then does not find, or finds cut off. `seen` are its scans.
    pub(super) fn miss(&mut self, seen: &BTreeMap<PathBuf, Group>, began: Duration) {
        let mut sizes: BTreeMap<(u64, u64), u64> = BTreeMap::new();
        let scans = seen.values().map(|group| group.stamp);
        for stamp in scans.chain(self.unrelated.values().map(|file| file.stamp)) {
            let size = sizes.entry(stamp.inode()).or_default();
            *size = stamp.size.max(*size);
        }
        let mut missing = Vec::new();
        for (path, file) in self.untaken() {
            let (stamp, writing) = (file.group.stamp, &file.writing);
            // A share that was mounted again has other numbers for the same files.
            let is_same = seen.get(path).is_some_and(|now| {
                (now.stamp.size, now.stamp.mtime_ns) == (stamp.size, stamp.mtime_ns)
            });
            let size = sizes.get(&stamp.inode()).copied();
            // A place that was reserved is cut to what was written.
            let is_cut = size.is_some_and(|size| size < stamp.size) && !writing.is_reserved();
            let is_missing = size.is_none() || is_cut;
            if is_missing && !is_same && stamp.size > 0 && !writing.is_kept(&stamp) {
                missing.push(Missing {
                    content: Gone { path: path.clone(), stamp, appeared: writing.last_began() },
                    trunk: writing.trunk().map(str::to_owned),
                    is_overwritten: is_cut,
                    since: began,
                });
            }
        }
        self.missing.extend(missing);
    }

    /// Part of a scan was read: the content that was read there before is written over if it is another.
    pub(super) fn read_over(&mut self, path: &Path, mark: &Fingerprint) {
        let file = self.files.get(path).filter(|file| file.next != Next::Taken);
        let lost = file.and_then(|file| {
            let content = lost_to(path, file.group.stamp, &file.writing, mark)?;
            let trunk = file.writing.trunk().map(str::to_owned);
            let since = self.last_look.unwrap_or_default();
            Some(Missing { content, trunk, is_overwritten: true, since })
        });
        self.missing.extend(lost);
    }

    /// The content that a settled file held before, if these bytes were written over it and no look has shown
    /// it.
    pub fn overwritten_by(&self, settled: &Settled, bytes: &[u8]) -> Option<Gone> {
        let whole = Fingerprint::whole(Duration::ZERO, Duration::ZERO, bytes);
        let file = self.files.get(&settled.path)?;
        lost_to(&settled.path, settled.group.stamp, &file.writing, &whole)
    }

    /// The contents that are gone, each returned once. Call it after each look, when parts of the files with
    /// new contents have been read. `is_any_due`: something is to be taken now, which could be mistaken for
    /// one of them.
    pub fn gone(&mut self, is_any_due: bool) -> Vec<Gone> {
        let mut gone = Vec::new();
        let mut spare = self.missing.len().saturating_sub(MISSING_MOST);
        for missing in std::mem::take(&mut self.missing) {
            let is_late = is_any_due || spare > 0;
            spare = spare.saturating_sub(1);
            match self.fate(&missing) {
                Fate::There => {}
                Fate::Open if !is_late => self.missing.push(missing),
                Fate::Open | Fate::Gone => gone.push(missing.content),
            }
        }
        gone
    }

    fn fate(&self, missing: &Missing) -> Fate {
        let files = self.files.values().map(|file| (file.group.stamp, &file.writing));
        let unrelated = self.unrelated.values().map(|file| (file.stamp, &file.writing));
        let there: Vec<(Stamp, &Writing)> = files.chain(unrelated).collect();
        let trunk = missing.trunk.as_deref();
        if trunk.is_some() && there.iter().any(|(_, writing)| writing.trunk() == trunk) {
            return Fate::There;
        }
        let own = missing.content.stamp.inode();
        let is_open = match there.iter().find(|(stamp, _)| stamp.inode() == own) {
            // The inode may be another file's by now: where something was read, the content decides.
            Some(_) if trunk.is_none() && !missing.is_overwritten => return Fate::There,
            Some((_, writing)) => writing.trunk().is_none(),
            None => Some(missing.since) == self.last_look,
        };
        if is_open { Fate::Open } else { Fate::Gone }
    }
}

/// The content that was read there before, if this part belongs to another one.
fn lost_to(path: &Path, stamp: Stamp, writing: &Writing, mark: &Fingerprint) -> Option<Gone> {
    let appeared = writing.marked_began().filter(|_| writing.loses_to(mark))?;
    Some(Gone { path: path.to_owned(), stamp, appeared })
}
