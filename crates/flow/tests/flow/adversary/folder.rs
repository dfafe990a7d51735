//! The simulated export folder: names, and inodes with contents and times. What was removed gives its
//! inode back, and the next file may get it. Folders in it only ever come in with what they hold.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gaiter_flow::Stamp;
use gaiter_flow::settle::Folders;

use super::content::Content;

/// The path of the folder.
const PATH: &str = "/e";

/// File systems note times in steps of so many milliseconds.
const STEP_MS: u64 = 4;

/// What a file holds.
#[derive(Debug, Clone)]
pub enum FileContent {
    /// An export, or none of it yet.
    Export(Option<Content>),
    /// The scanner's own measures, which name a patient.
    Measures(String),
}

#[derive(Debug, Clone)]
pub struct Inode {
    pub held: FileContent,
    mtime_ms: u64,
    ctime_ms: u64,
}

/// The folder; times are on the clock of its own file system, milliseconds.
#[derive(Debug, Default)]
pub struct Folder {
    names: BTreeMap<String, u64>,
    /// The names in another folder, to which the path leads now and then.
    aside: BTreeMap<String, u64>,
    is_turned: bool,
    /// Folders in it: inode, and when each came in.
    below: BTreeMap<String, (u64, u64)>,
    inodes: BTreeMap<u64, Inode>,
    free: Vec<u64>,
    last: u64,
    /// Its clock was set forward by so much, or back, milliseconds.
    skew_ms: i64,
    /// Changes with every change.
    pub version: u64,
}

/// The clock of the file system when the simulation begins, milliseconds: later than it is ever set back by.
const EPOCH_MS: i64 = 1_000_000_000;

impl Folder {
    /// Somebody, or a time server, sets the clock of the file system.
    pub fn set_clock(&mut self, by_ms: i64) {
        self.skew_ms += by_ms;
    }

    /// What its clock says at a time of the simulation.
    fn clock_ms(&self, now_ms: u64) -> u64 {
        now_ms.saturating_add_signed(EPOCH_MS + self.skew_ms)
    }

    /// The files as a look finds them: path, state, inode.
    pub fn list(&self) -> Vec<(String, Stamp)> {
        let stamp = |ino: &u64| self.stamp_of(*ino);
        let all = self.names.iter().map(|(name, ino)| (name.clone(), stamp(ino)));
        all.collect()
    }

    fn stamp_of(&self, ino: u64) -> Stamp {
        let file = &self.inodes[&ino];
        let size = match &file.held {
            FileContent::Export(content) => content.as_ref().map_or(0, Content::length),
            FileContent::Measures(text) => text.len(),
        };
        let (mtime_ns, ctime_ns) = (ns(file.mtime_ms), ns(file.ctime_ms));
        Stamp { dev: 1, ino, size: size as u64, mtime_ns, ctime_ns }
    }

    /// The folders as a look finds them.
    pub fn folders(&self) -> Folders {
        let state = |(name, (ino, came_ms)): (&String, &(u64, u64))| {
            let (mtime_ns, ctime_ns) = (ns(0), ns(*came_ms));
            (path(name), Stamp { dev: 1, ino: *ino, size: 0, mtime_ns, ctime_ns })
        };
        let below = self.below.iter().map(state).collect();
        Folders { export: (1, u64::from(self.is_turned)), below }
    }

    pub fn stamp(&self, name: &str) -> Option<Stamp> {
        self.names.get(name).map(|ino| self.stamp_of(*ino))
    }

    pub fn inode(&self, name: &str) -> Option<u64> {
        self.names.get(name).copied()
    }

    pub fn held(&self, name: &str) -> Option<&FileContent> {
        self.names.get(name).map(|ino| &self.inodes[ino].held)
    }

    /// The export that lies there, in whatever state.
    pub fn export(&self, name: &str) -> Option<&Content> {
        match self.held(name) {
            Some(FileContent::Export(content)) => content.as_ref(),
            _ => None,
        }
    }

    /// A new file under a name that is free, or freed for it; an inode that was given back comes
    /// first.
    pub fn create(&mut self, name: &str, held: FileContent, now_ms: u64) -> u64 {
        self.version += 1;
        self.unlink(name);
        let ino = self.free.pop().unwrap_or_else(|| {
            self.last += 1;
            self.last
        });
        let now_ms = self.clock_ms(now_ms);
        self.inodes.insert(ino, Inode { held, mtime_ms: now_ms, ctime_ms: now_ms });
        self.names.insert(name.to_owned(), ino);
        ino
    }

    /// Writes what an inode holds from now on; truncating and growing are the same to it.
    pub fn write(&mut self, ino: u64, held: FileContent, now_ms: u64) {
        self.version += 1;
        let now_ms = self.clock_ms(now_ms);
        if let Some(file) = self.inodes.get_mut(&ino) {
            (file.held, file.mtime_ms, file.ctime_ms) = (held, now_ms, now_ms);
        }
    }

    /// A file comes in from elsewhere, with the time at which it was written there.
    pub fn move_in(&mut self, name: &str, held: FileContent, written_ms: u64, now_ms: u64) -> u64 {
        let ino = self.create(name, held, now_ms);
        let written_ms = self.clock_ms(written_ms);
        if let Some(file) = self.inodes.get_mut(&ino) {
            file.mtime_ms = written_ms;
        }
        ino
    }

    /// A new inode, unchanged since then.
    fn older(&mut self, held: FileContent, written_ms: u64) -> u64 {
        self.version += 1;
        self.last += 1;
        let written_ms = self.clock_ms(written_ms);
        self.inodes.insert(self.last, Inode { held, mtime_ms: written_ms, ctime_ms: written_ms });
        self.last
    }

    /// A folder comes in with a file, whose own times stay.
    pub fn move_in_folder(&mut self, file: &str, held: FileContent, written_ms: u64, now_ms: u64) {
        let ino = self.older(held, written_ms);
        self.names.insert(file.to_owned(), ino);
        self.last += 1;
        if let Some((folder, _)) = file.rsplit_once('/') {
            self.below.insert(folder.to_owned(), (self.last, self.clock_ms(now_ms)));
        }
    }

    /// A file lies in the other folder.
    pub fn put_aside(&mut self, name: &str, held: FileContent, written_ms: u64) {
        let ino = self.older(held, written_ms);
        self.aside.insert(name.to_owned(), ino);
    }

    /// The path leads to the other folder, or back.
    pub fn turn(&mut self) {
        self.version += 1;
        self.is_turned = !self.is_turned;
        std::mem::swap(&mut self.names, &mut self.aside);
    }

    /// Somebody gives a file an older time.
    pub fn set_back(&mut self, ino: u64, written_ms: u64, now_ms: u64) {
        self.change_status(ino, now_ms);
        let written_ms = self.clock_ms(written_ms);
        if let Some(file) = self.inodes.get_mut(&ino) {
            file.mtime_ms = written_ms;
        }
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
        let now_ms = self.clock_ms(now_ms);
        if let Some(file) = self.inodes.get_mut(&ino) {
            file.ctime_ms = now_ms;
        }
    }

    /// The times are set to now, the content stays.
    pub fn touch(&mut self, ino: u64, now_ms: u64) {
        self.version += 1;
        let now_ms = self.clock_ms(now_ms);
        if let Some(file) = self.inodes.get_mut(&ino) {
            (file.mtime_ms, file.ctime_ms) = (now_ms, now_ms);
        }
    }
}

fn ns(ms: u64) -> i128 {
    i128::from(ms / STEP_MS * STEP_MS) * 1_000_000
}

/// The path of a file of the folder.
pub fn path(name: &str) -> PathBuf {
    Path::new(PATH).join(name)
}

/// The name of a file of the folder with this path.
pub fn name_of(path: &Path) -> String {
    path.strip_prefix(PATH).unwrap_or(path).to_string_lossy().into_owned()
}
