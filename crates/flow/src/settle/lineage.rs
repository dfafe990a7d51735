//! Which content a file has, whatever its name: a file is followed by device and inode.
//!
//! Scanners write under a temporary name and rename; people and programs link, move and copy. A name does not
//! show when its content was written, so what is known about the content stays with the inode, even through
//! names that are not scans.
//!
//! A file that is brought in with older content shows it: by the clock of the file system, the new name, the
//! changed time or the move of its folder is later than the time at which its content was written. This is
//! checked whenever a content or its time is new, because programs that copy set the old time last. It is no
//! evidence against an export that was written in place: a changed mode, a link or another name comes after
//! it was seen.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::above::Above;
use super::{Remembered, Settled, Settling, Watched};
use crate::export::stamp::Stamp;
use crate::export::writing::{Appeared, Fingerprint, Writing, written_elsewhere};
use crate::settle::LookTime;

/// How many files are marked after one look at most: a backlog of old files is no reason to read the
/// beginnings of all of them.
const MARKED_A_LOOK: usize = 16;

/// A file whose present name is not a scan's.
#[derive(Debug, Clone)]
pub struct UnrelatedFile {
    pub(super) stamp: Stamp,
    pub(super) writing: Writing,
    pub(super) is_unmarked: bool,
}

/// How long departed files are remembered, and how many of the latest: a rename during a look hides a
/// file from it, and a stale listing of a share hides it for longer.
const DEPARTED_KEPT: Duration = Duration::from_secs(600);
const DEPARTED_MOST: usize = 1000;

/// A file that was not taken and is no longer seen under any name.
#[derive(Debug)]
pub(super) struct VanishedFile {
    file: Remembered,
    since: Duration,
}

/// What was known about inodes before a look.
pub(super) struct Lineages<'a> {
    known: BTreeMap<(u64, u64), (Stamp, &'a Writing)>,
    files: &'a BTreeMap<PathBuf, Watched>,
    above: &'a Above,
}

impl Lineages<'_> {
    /// What is known about the content of a file that a look found in this state.
    pub(super) fn writing(&self, path: &Path, stamp: Stamp, appeared: Appeared) -> Writing {
        let written = written_elsewhere(appeared.seen, self.above.moved(path, stamp));
        let appeared = self.above.appeared(path, appeared);
        let same_inode = |file: &&Watched| file.group.stamp.inode() == stamp.inode();
        // Two names of one inode may have been examined with a change in between: the state under the
        // file's own name is more reliable.
        let own = self.files.get(path).filter(same_inode);
        let own = own.map(|file| (file.group.stamp, &file.writing));
        let known = own.or_else(|| self.known.get(&stamp.inode()).copied());
        let Some((before, writing)) = known.filter(|(before, _)| stamp.size >= before.size) else {
            return Writing::found(appeared, written);
        };
        let mut writing = writing.clone();
        if !stamp.has_content_of(&before) {
            writing.change(appeared.seen);
            writing.date(written);
        }
        writing
    }
}

impl Settling {
    /// Takes in the files of a look that are not scans, before [`Settling::observe`] takes in the scans.
    pub fn pass_over(&mut self, others: BTreeMap<PathBuf, Stamp>, when: LookTime) {
        let lineages = self.lineages();
        let appeared = Appeared { absent: self.last_look, seen: when.ended };
        let unrelated = others.into_iter().map(|(path, stamp)| {
            let before = self.unrelated.get(&path);
            let writing = match before.filter(|before| before.stamp == stamp) {
                Some(before) => before.writing.clone(),
                None => lineages.writing(&path, stamp, appeared),
            };
            let is_unmarked = before.is_none_or(|file| file.stamp != stamp || file.is_unmarked);
            (path, UnrelatedFile { stamp, writing, is_unmarked })
        });
        let unrelated = unrelated.collect();
        let before = std::mem::replace(&mut self.unrelated, unrelated);
        // A file that has left its name may be a scan by now: the scans of this look are still to come.
        let left = before.into_iter().filter(|(path, old)| {
            self.unrelated.get(path).is_none_or(|new| new.stamp.inode() != old.stamp.inode())
        });
        self.remembered.extend(
            left.map(|(_, UnrelatedFile { stamp, writing, .. })| Remembered { stamp, writing }),
        );
    }

    /// What is known about inodes. The number of a departed file may have been reused: where part of its
    /// content was read, [`Settling::began`] compares the content.
    pub(super) fn lineages(&self) -> Lineages<'_> {
        let departed = self.departed.iter().map(|departed| &departed.file);
        let unread = departed.filter(|file| !file.writing.is_marked());
        let remembered = unread.chain(&self.remembered).map(|file| (file.stamp, &file.writing));
        let unrelated = self.unrelated.values().map(|file| (file.stamp, &file.writing));
        let files = self.files.values().map(|file| (file.group.stamp, &file.writing));
        let all = remembered.chain(unrelated).chain(files);
        let known = all.map(|of| (of.0.inode(), of)).collect();
        Lineages { known, files: &self.files, above: &self.above }
    }

    /// These files were not found by a look that ended now, nor were those that are still remembered.
    pub(super) fn depart(&mut self, gone: BTreeMap<PathBuf, Watched>, now: Duration) {
        let gone = gone.into_values().filter(|file| file.next != super::Next::Taken);
        let gone = gone.map(|Watched { group, writing, .. }| {
            let stamp = group.stamp;
            Remembered { stamp, writing }
        });
        let watched = self.files.values().map(|file| file.group.stamp.inode());
        let present: BTreeSet<(u64, u64)> =
            watched.chain(self.unrelated.values().map(|file| file.stamp.inode())).collect();
        let gone = self.remembered.drain(..).chain(gone);
        let gone = gone.filter(|file| !present.contains(&file.stamp.inode()));
        self.departed.extend(gone.map(|file| VanishedFile { file, since: now }));
        self.departed.retain(|departed| now <= departed.since + DEPARTED_KEPT);
        let spare = self.departed.len().saturating_sub(DEPARTED_MOST);
        self.departed.drain(..spare);
    }

    /// When the content of a settled file began. Part of it may have been seen before in another file that is
    /// not taken: a copy, or an export that was started again, is no younger than that, nor than any of their
    /// times.
    pub fn began(&self, settled: &Settled, bytes: &[u8]) -> Appeared {
        let own = settled.writing.began(bytes);
        let others = self.untaken().filter(|(path, _)| **path != settled.path);
        let others = others.map(|(_, file)| &file.writing);
        let others = others.chain(self.unrelated.values().map(|file| &file.writing));
        let others = others.chain(self.departed.iter().map(|departed| &departed.file.writing));
        let others: Vec<&Writing> = others.collect();
        let seen = others.iter().filter_map(|writing| writing.seen_in(bytes));
        let began = seen.fold(own, |first, seen| if seen.seen < first.seen { seen } else { first });
        let written = others.iter().filter_map(|writing| writing.written(bytes));
        began.written_by(written.chain(settled.writing.written_last(bytes)).min())
    }

    /// The files of which part is to be read now, with the state in which the look found them: those
    /// with new content first, and those from before the first look last.
    pub fn unmarked(&self) -> Vec<(PathBuf, Stamp)> {
        let files = self.untaken().filter(|(_, file)| file.is_unmarked);
        let files = files.map(|(path, file)| (path, file.group.stamp, &file.writing));
        let unrelated = self.unrelated.iter().filter(|(_, file)| file.is_unmarked);
        let unrelated = unrelated.map(|(path, file)| (path, file.stamp, &file.writing));
        let is_old = |writing: &Writing| writing.appeared().absent.is_none();
        let (old, new): (Vec<_>, Vec<_>) =
            files.chain(unrelated).partition(|(_, _, writing)| is_old(writing));
        let all = new.into_iter().chain(old).take(MARKED_A_LOOK);
        all.map(|(path, stamp, _)| (path.clone(), stamp)).collect()
    }

    /// Part of a file was read in this state, or could not be read.
    pub fn marked(&mut self, path: &Path, stamp: Stamp, mark: Option<Fingerprint>) {
        if let Some(mark) = &mark
            && self.files.get(path).is_some_and(|file| file.group.stamp == stamp)
        {
            self.read_over(path, mark);
        }
        if let Some(file) = self.files.get_mut(path).filter(|file| file.group.stamp == stamp) {
            file.is_unmarked = false;
            mark.clone().into_iter().for_each(|mark| file.writing.mark(mark));
        }
        if let Some(file) = self.unrelated.get_mut(path).filter(|file| file.stamp == stamp) {
            file.is_unmarked = false;
            mark.into_iter().for_each(|mark| file.writing.mark(mark));
        }
    }
}
