//! A folder from which another program fetches files and removes them. A file is staged in a folder of the station's
//! own and synced, noted by its store, then given its name: what was fetched does not come again.

use std::fs::{self, File, Permissions};
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use rustix::fs::{AtFlags, Mode, OFlags, statat};
use rustix::io::Errno;

use super::{StoreFault, durable, listed, tried};

/// The file that marks the folder of staged files.
const MARK: &str = ".gaiter-store";

/// Its content, for people who find it.
const MARK_TEXT: &str = "A gaiter station prepares files here before handing them over. If this \
file is missing, the station assumes that the share is not mounted.\n";

/// The program that fetches files runs as another user: the folder's group may read them.
const FETCHED_MODE: u32 = 0o660;

#[derive(Debug, Clone)]
pub(super) struct ExchangeFolder {
    folder: PathBuf,
    /// In the exchange folder, because it must be on the same disk; a folder of its own, because
    /// the other program may take every file it sees.
    staging: PathBuf,
}

impl ExchangeFolder {
    /// The exchange folder of a station.
    pub fn new(folder: PathBuf, station: &str) -> ExchangeFolder {
        let staging = folder.join(format!(".gaiter.{station}"));
        ExchangeFolder { folder, staging }
    }

    /// The exchange folder itself.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Makes the folder for staged files, marked, and the exchange folder if `make_folder` is set.
    pub fn begin(&self, make_folder: bool) -> Result<(), StoreFault> {
        if make_folder {
            tried("making", &self.folder, fs::create_dir_all(&self.folder))?;
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

    /// The folder of staged files, opened and checked for its mark: what follows refers to this very
    /// folder, even if its share goes away meanwhile.
    fn opened(&self) -> Result<File, StoreFault> {
        let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::CLOEXEC;
        let opened = rustix::fs::open(&self.staging, flags, Mode::empty()).map(File::from);
        let what = "opening the station's folder (missing if a share is not mounted)";
        let folder = tried(what, &self.staging, opened.map_err(io::Error::from))?;
        let mark = statat(&folder, MARK, AtFlags::SYMLINK_NOFOLLOW).map_err(io::Error::from);
        let what = "looking for .gaiter-store (missing if a share is not mounted)";
        tried(what, &self.staging, mark)?;
        Ok(folder)
    }

    /// Reports whether a file is staged. Only the folder that was begun can show that it is not.
    pub fn is_staged(&self, name: &str) -> Result<bool, StoreFault> {
        let folder = self.opened()?;
        match statat(&folder, name, AtFlags::SYMLINK_NOFOLLOW) {
            Ok(_) => Ok(true),
            Err(Errno::NOENT) => Ok(false),
            Err(error) => tried("looking for", &self.staging.join(name), Err(error.into())),
        }
    }

    /// The names of staged files, complete or not.
    pub fn staged(&self) -> Result<Vec<String>, StoreFault> {
        let entries = listed(&self.staging)?.into_iter();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        Ok(names.filter(|name| !name.starts_with('.')).collect())
    }

    /// Removes a staged file, if there is one.
    pub fn unstage(&self, name: &str) -> Result<(), StoreFault> {
        let staged = self.staging.join(name);
        tried("clearing", &staged, durable::remove_file(&staged))
    }

    /// Stages a file, durable.
    pub fn stage(&self, name: &str, bytes: &[u8]) -> Result<(), StoreFault> {
        self.unstage(name)?;
        let staged = self.staging.join(name);
        tried("writing", &staged, durable::write_new(&staged, bytes))?;
        let mode = Permissions::from_mode(FETCHED_MODE);
        tried("opening to the group", &staged, fs::set_permissions(&staged, mode))?;
        tried("syncing", &self.staging, durable::sync_folder(&self.staging))
    }

    /// Gives a staged file its place in the exchange folder, or in a folder in it, which is made if there is none. A
    /// file that is there is the same, because its name identifies the scan.
    pub fn publish(&self, name: &str, place: &Path) -> Result<(), StoreFault> {
        let within = place.parent().unwrap_or(&self.folder);
        if within != self.folder {
            tried("making", within, durable::make_folder_once(within))?;
            let mode = Permissions::from_mode(FETCHED_MODE | 0o110);
            tried("opening to the group", within, fs::set_permissions(within, mode))?;
        }
        tried("renaming", place, fs::rename(self.staging.join(name), place))?;
        tried("syncing", within, durable::sync_folder(within))?;
        tried("syncing", &self.staging, durable::sync_folder(&self.staging))
    }

    /// As [`ExchangeFolder::publish`], in the exchange folder itself and never over another file.
    ///
    /// # Errors
    /// [`StoreFault::NotFetched`] if there is one.
    pub fn publish_new(&self, name: &str, place: &Path) -> Result<(), StoreFault> {
        match durable::rename_new(&self.staging.join(name), place) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                return Err(StoreFault::NotFetched);
            }
            other => tried("renaming", place, other)?,
        }
        self.sync()
    }

    /// Makes the names of files durable.
    pub fn sync(&self) -> Result<(), StoreFault> {
        tried("syncing", &self.folder, durable::sync_folder(&self.folder))?;
        tried("syncing", &self.staging, durable::sync_folder(&self.staging))
    }
}
