//! The simulated export folder: names, and inodes with contents and times. What was removed gives its
//! inode back, and the next file may get it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use gaiter_flow::Stamp;

use super::content::Content;

/// File systems note times in steps of so many milliseconds.
const STEP_MS: u64 = 4;

/// What a file holds.
#[derive(Debug, Clone)]
pub enum Held {
    /// An export, or none of it yet.
    Export(Option<Content>),
    /// The scanner's own measures, which name a patient.
    Measures(String),
}

#[derive(Debug, Clone)]
pub struct Inode {
    pub held: Held,
    mtime_ms: u64,
    ctime_ms: u64,
}

/// The folder; times are on the clock of its own file system, milliseconds.
#[derive(Debug, Default)]
pub struct Folder {
    names: BTreeMap<String, u64>,
    inodes: BTreeMap<u64, Inode>,
    free: Vec<u64>,
    last: u64,
    /// Changes with every change.
    pub version: u64,
}

impl Folder {
    /// The files as a look finds them: path, state, inode.
    pub fn list(&self) -> Vec<(String, Stamp)> {
        let stamp = |ino: &u64| self.stamp_of(*ino);
        let all = self.names.iter().map(|(name, ino)| (name.clone(), stamp(ino)));
        all.collect()
    }

    fn stamp_of(&self, ino: u64) -> Stamp {
        let file = &self.inodes[&ino];
        let size = match &file.held {
            Held::Export(content) => content.as_ref().map_or(0, Content::length),
            Held::Measures(text) => text.len(),
        };
        let ns = |ms: u64| i128::from(ms / STEP_MS * STEP_MS) * 1_000_000;
        let (mtime_ns, ctime_ns) = (ns(file.mtime_ms), ns(file.ctime_ms));
        Stamp { dev: 1, ino, size: size as u64, mtime_ns, ctime_ns }
    }

    pub fn stamp(&self, name: &str) -> Option<Stamp> {
        self.names.get(name).map(|ino| self.stamp_of(*ino))
    }

    pub fn inode(&self, name: &str) -> Option<u64> {
        self.names.get(name).copied()
    }

    pub fn held(&self, name: &str) -> Option<&Held> {
        self.names.get(name).map(|ino| &self.inodes[ino].held)
    }

    /// The export that a file holds, if it is in this state.
    pub fn content(&self, name: &str, stamp: Stamp) -> Option<Content> {
        match self.held(name) {
            Some(Held::Export(content)) if self.stamp(name) == Some(stamp) => content.clone(),
            _ => None,
        }
    }

    /// The export that lies there, in whatever state.
    pub fn export(&self, name: &str) -> Option<&Content> {
        match self.held(name) {
            Some(Held::Export(content)) => content.as_ref(),
            _ => None,
        }
    }

    /// A new file under a name that is free, or freed for it; an inode that was given back comes
    /// first.
    pub fn create(&mut self, name: &str, held: Held, now_ms: u64) -> u64 {
        self.version += 1;
        self.unlink(name);
        let ino = self.free.pop().unwrap_or_else(|| {
            self.last += 1;
            self.last
        });
        self.inodes.insert(ino, Inode { held, mtime_ms: now_ms, ctime_ms: now_ms });
        self.names.insert(name.to_owned(), ino);
        ino
    }

    /// Writes what an inode holds from now on; truncating and growing are the same to it.
    pub fn write(&mut self, ino: u64, held: Held, now_ms: u64) {
        self.version += 1;
        if let Some(file) = self.inodes.get_mut(&ino) {
            (file.held, file.mtime_ms, file.ctime_ms) = (held, now_ms, now_ms);
        }
    }

    /// A file comes in from elsewhere, with the time at which it was written there.
    pub fn move_in(&mut self, name: &str, held: Held, written_ms: u64, now_ms: u64) -> u64 {
        let ino = self.create(name, held, now_ms);
        if let Some(file) = self.inodes.get_mut(&ino) {
            file.mtime_ms = written_ms;
        }
        ino
    }

    pub fn unlink(&mut self, name: &str) {
        self.version += 1;
        let Some(ino) = self.names.remove(name) else { return };
        if self.names.values().all(|other| *other != ino) {
            self.inodes.remove(&ino);
            self.free.push(ino);
        }
    }

    pub fn rename(&mut self, from: &str, to: &str, now_ms: u64) {
        let Some(ino) = self.names.get(from).copied() else { return };
        if from == to {
            return;
        }
        self.unlink(to);
        self.names.remove(from);
        self.names.insert(to.to_owned(), ino);
        self.change_status(ino, now_ms);
    }

    pub fn link(&mut self, from: &str, to: &str, now_ms: u64) {
        let Some(ino) = self.names.get(from).copied() else { return };
        self.unlink(to);
        self.names.insert(to.to_owned(), ino);
        self.change_status(ino, now_ms);
    }

    /// A change of mode, owner or links.
    pub fn change_status(&mut self, ino: u64, now_ms: u64) {
        self.version += 1;
        if let Some(file) = self.inodes.get_mut(&ino) {
            file.ctime_ms = now_ms;
        }
    }

    /// The times are set to now, the content stays.
    pub fn touch(&mut self, ino: u64, now_ms: u64) {
        self.version += 1;
        if let Some(file) = self.inodes.get_mut(&ino) {
            (file.mtime_ms, file.ctime_ms) = (now_ms, now_ms);
        }
    }
}

/// The path of a file of the folder.
pub fn path(name: &str) -> PathBuf {
    PathBuf::from("/e").join(name)
}
