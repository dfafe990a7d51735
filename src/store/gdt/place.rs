//! The exchange folder: where results are staged, how they get their names, and whether the folder is
//! there at all.

use std::fs::{self, File, Permissions};
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use gaiter_record::gdt::rules::{COUNTER_MOST, FileName};
use rustix::fs::{AtFlags, Mode, OFlags, statat};
use rustix::io::Errno;

use super::super::{StoreFault, durable, tried};

/// The file that marks the folder of staged results.
const MARK: &str = ".gaiter-store";

/// Its content, for people who find it.
const MARK_TEXT: &str = "A gaiter station prepares results here before handing them over. If this \
file is missing, the station assumes that the share is not mounted.\n";

/// The program that fetches results runs as another user: the folder's group may read them.
const FETCHED_MODE: u32 = 0o660;

#[derive(Debug, Clone)]
pub(super) struct ExchangeFolder {
    folder: PathBuf,
    /// In the exchange folder, because it must be on the same disk; a folder of its own, because
    /// practice software may take every file it sees.
    staging: PathBuf,
    names: FileName,
}

impl ExchangeFolder {
    /// The exchange folder of a station.
    pub fn new(folder: PathBuf, names: FileName, station: &str) -> ExchangeFolder {
        let staging = folder.join(format!(".gaiter.{station}"));
        ExchangeFolder { folder, staging, names }
    }

    /// The exchange folder itself.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Makes the folder for staged results, marked, and the exchange folder if `make_folder` is set.
    pub fn begin(&self, make_folder: bool) -> Result<(), StoreFault> {
        if make_folder {
            tried("making the exchange folder", &self.folder, fs::create_dir_all(&self.folder))?;
        }
        tried("making", &self.staging, durable::make_folder_once(&self.staging))?;
        let mark = self.staging.join(MARK);
        tried("marking", &mark, durable::write_once(&mark, MARK_TEXT.as_bytes()))?;
        self.sync()
    }

    /// Checks that the exchange folder is there and is the one that was begun.
    pub fn reach(&self) -> Result<(), StoreFault> {
        tried("listing", &self.folder, fs::read_dir(&self.folder))?;
        self.opened().map(drop)
    }

    /// The folder of staged results, opened and checked for its mark: what follows refers to this very
    /// folder, even if its share goes away meanwhile.
    fn opened(&self) -> Result<File, StoreFault> {
        let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::CLOEXEC;
        let opened = rustix::fs::open(&self.staging, flags, Mode::empty()).map(File::from);
        let what = "opening the station's folder (missing if a share is not mounted)";
        let folder = tried(what, &self.staging, opened.map_err(io::Error::from))?;
        let mark = statat(&folder, MARK, AtFlags::SYMLINK_NOFOLLOW).map_err(io::Error::from);
        tried("looking for .gaiter-store in", &self.staging, mark)?;
        Ok(folder)
    }

    /// Reports whether a result is staged. Only the folder that was begun can show that it is not.
    pub fn is_staged(&self, key: &str) -> Result<bool, StoreFault> {
        let folder = self.opened()?;
        match statat(&folder, file_name(key), AtFlags::SYMLINK_NOFOLLOW) {
            Ok(_) => Ok(true),
            Err(Errno::NOENT) => Ok(false),
            Err(error) => tried("looking for", &self.staged_file(key), Err(error.into())),
        }
    }

    /// The keys of staged results, complete or not.
    pub fn staged(&self) -> Result<Vec<String>, StoreFault> {
        let list = || -> io::Result<Vec<String>> {
            let mut keys = Vec::new();
            for entry in fs::read_dir(&self.staging)? {
                let name = entry?.file_name();
                let name = name.to_string_lossy();
                keys.extend(name.strip_suffix(ENDING).map(str::to_owned));
            }
            Ok(keys)
        };
        tried("listing", &self.staging, list())
    }

    /// Removes a staged result, if there is one.
    pub fn unstage(&self, key: &str) -> Result<(), StoreFault> {
        let staged = self.staged_file(key);
        tried("clearing", &staged, durable::remove_file(&staged))
    }

    /// Removes everything that is staged of a result, also an attachment that a crash left.
    pub fn unstage_all(&self, key: &str) -> Result<(), StoreFault> {
        let list = || -> io::Result<Vec<PathBuf>> {
            let all: io::Result<Vec<PathBuf>> =
                fs::read_dir(&self.staging)?.map(|entry| Ok(entry?.path())).collect();
            let is_its = |path: &PathBuf| {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                name == file_name(key) || name.starts_with(&format!("{key}_"))
            };
            Ok(all?.into_iter().filter(is_its).collect())
        };
        for path in tried("listing", &self.staging, list())? {
            tried("clearing", &path, durable::remove_file(&path))?;
        }
        Ok(())
    }

    /// Stages a result, durable.
    pub fn stage(&self, key: &str, message: &[u8]) -> Result<(), StoreFault> {
        self.unstage(key)?;
        let staged = self.staged_file(key);
        tried("writing", &staged, durable::write_new(&staged, message))?;
        let mode = Permissions::from_mode(FETCHED_MODE);
        tried("opening to the group", &staged, fs::set_permissions(&staged, mode))?;
        tried("syncing", &self.staging, durable::sync_folder(&self.staging))
    }

    /// The next free name and its number; `last` is the number used last.
    pub fn free_name(&self, last: u16) -> Result<(u16, String), StoreFault> {
        let tries = if self.names.counts() { COUNTER_MOST } else { 1 };
        for step in 0..tries {
            let number = (last + step) % COUNTER_MOST + 1;
            let name = self.names.of(number);
            let path = self.folder.join(&name);
            let found = durable::if_there(fs::symlink_metadata(&path));
            if tried("looking for", &path, found)?.is_none() {
                return Ok((number, name));
            }
        }
        Err(StoreFault::NotFetched)
    }

    /// Renames a staged result to its final name, never over another. Returns its path.
    pub fn publish(&self, key: &str, name: &str) -> Result<PathBuf, StoreFault> {
        let place = self.folder.join(name);
        match durable::rename_new(&self.staged_file(key), &place) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                return Err(StoreFault::NotFetched);
            }
            other => tried("renaming", &place, other)?,
        }
        self.sync()?;
        Ok(place)
    }

    /// Makes the names of results durable.
    pub fn sync(&self) -> Result<(), StoreFault> {
        tried("syncing", &self.folder, durable::sync_folder(&self.folder))?;
        tried("syncing", &self.staging, durable::sync_folder(&self.staging))
    }

    /// Writes an attachment into the exchange folder or a folder in it. A file already there under this
    /// name is the same attachment, because the name identifies the scan; it is written again.
    pub fn write_attachment(&self, path: &Path, bytes: &[u8]) -> Result<(), StoreFault> {
        let folder = path.parent().unwrap_or(&self.folder);
        if folder != self.folder {
            tried("making", folder, durable::make_folder_once(folder))?;
            let mode = Permissions::from_mode(FETCHED_MODE | 0o110);
            tried("opening to the group", folder, fs::set_permissions(folder, mode))?;
        }
        let name = path.file_name().unwrap_or_default();
        let staged = self.staging.join(name);
        tried("clearing", &staged, durable::remove_file(&staged))?;
        tried("writing", &staged, durable::write_new(&staged, bytes))?;
        let mode = Permissions::from_mode(FETCHED_MODE);
        tried("opening to the group", &staged, fs::set_permissions(&staged, mode))?;
        tried("renaming", path, fs::rename(&staged, path))?;
        tried("syncing", folder, durable::sync_folder(folder))
    }

    fn staged_file(&self, key: &str) -> PathBuf {
        self.staging.join(file_name(key))
    }
}

/// The ending of staged results; no practice software looks for it.
const ENDING: &str = ".staged";

fn file_name(key: &str) -> String {
    format!("{key}{ENDING}")
}
