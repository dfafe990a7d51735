//! One look at an export folder: which files could be scans, which files belong to them, and on what
//! the folder lies. Only folders are opened.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs::{self, FileType, Metadata};
use std::io;
use std::os::unix::fs::FileTypeExt;
use std::path::{Path, PathBuf};

use gaiter_flow::export::companions::{self, Done};
use gaiter_flow::export::mount::Mount;
use gaiter_flow::export::passed_over::PassedOver;
use gaiter_flow::settle::Folders;
use gaiter_flow::{DoneFile, Group, Stamp};
use gaiter_scan::Format;

use crate::config::WatchConfig;
use crate::station::share::file_system::{self, folder_id};
use crate::station::share::stall::StepCounter;
use crate::station::share::stamped_file::stamp;

/// How deep sub-folders are searched: a year, a month, a day and a patient. The limit also ends a loop
/// of mounts.
const DEPTH_MAX: usize = 4;

/// How many ignored files are known by name, and of those that may be exports as many again. The others are
/// only counted, because a folder may hold years of other files.
const IGNORED_MAX: usize = 1000;

/// How many files without the name of a scan are followed, those that changed last. One of them may be
/// the temporary name of a coming scan that is being written.
const UNRELATED_MAX: usize = 500;

/// What a look found.
#[derive(Debug)]
pub struct Found {
    /// Regular files with the ending of a scan, and the files that belong to them.
    pub scans: BTreeMap<PathBuf, Group>,
    /// Regular files without the name of a scan, including hidden ones; if there are many, those that
    /// changed last.
    pub unrelated: BTreeMap<PathBuf, Stamp>,
    /// Others, except hidden and unfinished ones, and why they are ignored; limited in number.
    pub ignored: BTreeMap<PathBuf, Passed>,
    /// How many others there are, by the reason.
    pub passed_over: BTreeMap<PassedOver, usize>,
    /// Which folder it is, and which sub-folders were searched.
    pub folders: Folders,
    /// What the folder lies on.
    pub mount: Mount,
}

/// Something that is ignored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Passed {
    pub why: PassedOver,
    /// When it changed last, if it may be an export, else 0; by its own clock, nanoseconds since 1970.
    pub changed_ns: i128,
}

/// Looks through a folder.
///
/// # Errors
/// If the folder cannot be listed completely, or another folder has taken its place or that of a
/// sub-folder meanwhile: half a list would make files seem to vanish.
pub fn look(folder: &Path, config: &WatchConfig, counter: &StepCounter) -> io::Result<Found> {
    let before = folder_id(folder)?;
    let mount = file_system::mount(folder, config)?;
    let mut walk = Walk { config, counter, listed: Listed::default() };
    walk.list(folder, 0)?;
    let is_same = folder_id(folder)? == before && file_system::detect(folder)? == mount.file_system;
    if !is_same {
        return Err(io::Error::other("it was replaced while it was searched"));
    }
    Ok(walk.found(before, mount))
}

/// A walk through a folder and, if configured, its sub-folders.
struct Walk<'a> {
    config: &'a WatchConfig,
    counter: &'a StepCounter,
    listed: Listed,
}

/// What a walk has found so far.
#[derive(Default)]
struct Listed {
    scans: BTreeMap<PathBuf, Stamp>,
    companions: BTreeMap<PathBuf, Stamp>,
    /// By the time of their last change and by name.
    unrelated: BTreeMap<(i128, PathBuf), Stamp>,
    done: BTreeMap<PathBuf, Stamp>,
    ignored: BTreeMap<PathBuf, Passed>,
    /// How many of these may be exports.
    unread: usize,
    passed_over: BTreeMap<PassedOver, usize>,
    /// The sub-folders, in their states before they were listed.
    below: BTreeMap<PathBuf, Stamp>,
}

impl Walk<'_> {
    fn list(&mut self, folder: &Path, depth: usize) -> io::Result<()> {
        let mut names = BTreeSet::new();
        let mut scans = Vec::new();
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            self.counter.step();
            let (path, name) = (entry.path(), entry.file_name());
            let text = name.to_string_lossy();
            let is_hidden = PassedOver::by_name(&text).is_some();
            // A file that cannot be examined counts as not there yet.
            let Ok(kind) = entry.file_type() else { continue };
            if is_hidden {
                // It may be a done file, or a scan that is being written.
                self.note_unrelated(path);
            } else if kind.is_dir() {
                self.folder(path, depth)?;
            } else if Format::of_file_name(&text).is_ok() {
                if let Some(stamp) = self.regular(&path) {
                    self.listed.scans.insert(path.clone(), stamp);
                    scans.push(path);
                }
            } else if companions::is_companion(&name) {
                if let Some(stamp) = self.regular(&path) {
                    self.listed.companions.insert(path, stamp);
                }
            } else {
                self.note_unrelated(path.clone());
                let why = match kind.is_symlink() {
                    true => PassedOver::Link,
                    false => PassedOver::of_no_scan(&text),
                };
                self.ignore(path, why);
            }
            names.insert(name);
        }
        if let Some(rule) = &self.config.done_file {
            self.done_files(rule, &scans, &names);
        }
        Ok(())
    }

    /// The stamp of a regular file; ignores anything else.
    fn regular(&mut self, path: &Path) -> Option<Stamp> {
        let metadata = path.symlink_metadata().ok()?;
        if !metadata.is_file() {
            self.ignore(path.to_owned(), irregular(metadata.file_type()));
            return None;
        }
        Some(stamp(&metadata))
    }

    /// Follows a file without the name of a scan.
    fn note_unrelated(&mut self, path: PathBuf) {
        let metadata = path.symlink_metadata().ok().filter(Metadata::is_file);
        let Some(stamp) = metadata.map(|metadata| stamp(&metadata)) else { return };
        let changed_ns = stamp.ctime_ns.max(stamp.mtime_ns);
        self.listed.unrelated.insert((changed_ns, path), stamp);
        if self.listed.unrelated.len() > UNRELATED_MAX {
            self.listed.unrelated.pop_first();
        }
    }

    fn folder(&mut self, path: PathBuf, depth: usize) -> io::Result<()> {
        if !self.config.subfolders {
            self.ignore(path, PassedOver::SubFolder);
        } else if depth == DEPTH_MAX {
            self.ignore(path, PassedOver::TooDeep);
        } else {
            match self.sub_folder(&path, depth + 1) {
                // It was removed meanwhile.
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
                    self.ignore(path, PassedOver::NoAccess);
                }
                other => return other,
            }
        }
        Ok(())
    }

    fn sub_folder(&mut self, path: &Path, depth: usize) -> io::Result<()> {
        let before = stamp(&path.symlink_metadata()?);
        self.listed.below.insert(path.to_owned(), before);
        self.list(path, depth)?;
        let after = stamp(&path.symlink_metadata()?);
        if (after.dev, after.ino) != (before.dev, before.ino) {
            return Err(io::Error::other("a folder in it was replaced while it was searched"));
        }
        Ok(())
    }

    /// Finds the done files of the scans of one folder. Only listed names are examined, so that a look
    /// at a share does not query every file twice.
    fn done_files(&mut self, rule: &DoneFile, scans: &[PathBuf], names: &BTreeSet<OsString>) {
        for done in scans.iter().map(|scan| rule.of(scan)) {
            if !done.file_name().is_some_and(|name| names.contains(name)) {
                continue;
            }
            if let Some(metadata) = done.symlink_metadata().ok().filter(Metadata::is_file) {
                if let Some(Passed { why, .. }) = self.listed.ignored.remove(&done)
                    && let Some(count) = self.listed.passed_over.get_mut(&why)
                {
                    *count -= 1;
                    self.listed.unread -= usize::from(why.is_unread());
                }
                self.listed.done.insert(done, stamp(&metadata));
            }
        }
    }

    fn ignore(&mut self, path: PathBuf, why: PassedOver) {
        *self.listed.passed_over.entry(why).or_default() += 1;
        let (known, changed_ns) = match why.is_unread() {
            true => (self.listed.unread, changed(&path)),
            false => (self.listed.ignored.len() - self.listed.unread, 0),
        };
        if known < IGNORED_MAX {
            self.listed.unread += usize::from(why.is_unread());
            self.listed.ignored.insert(path, Passed { why, changed_ns });
        }
    }

    fn found(self, export: (u64, u64), mount: Mount) -> Found {
        let Listed { scans, companions, unrelated, done, ignored, passed_over, below, .. } =
            self.listed;
        let done = |scan: &Path| match &self.config.done_file {
            None => Done::NotAsked,
            Some(rule) => done.get(&rule.of(scan)).copied().map_or(Done::Missing, Done::There),
        };
        let scans = companions::groups(scans, companions, done);
        let unrelated = unrelated.into_iter().map(|((_, path), stamp)| (path, stamp)).collect();
        let folders = Folders { export, below };
        Found { scans, unrelated, ignored, passed_over, folders, mount }
    }
}

/// Why something that is not a regular file is ignored.
fn irregular(kind: FileType) -> PassedOver {
    if kind.is_symlink() {
        PassedOver::Link
    } else if kind.is_fifo() {
        PassedOver::Pipe
    } else if kind.is_socket() {
        PassedOver::Socket
    } else {
        PassedOver::Device
    }
}

/// When something changed last, by its own clock, nanoseconds since 1970; 0 if it cannot be examined.
fn changed(path: &Path) -> i128 {
    let stamp = path.symlink_metadata().map(|metadata| stamp(&metadata));
    stamp.map_or(0, |stamp| stamp.mtime_ns.max(stamp.ctime_ns))
}

#[cfg(test)]
mod tests;
