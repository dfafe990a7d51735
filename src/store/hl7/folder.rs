//! A folder from which a receiver fetches messages. A message is staged in a folder of the station's own and synced,
//! then noted as sent, then given its name, as results of practice software are: what was fetched does not come again.

use std::ffi::OsString;
use std::fs::{self, Permissions};
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;

use crate::store::{StoreFault, durable, tried};

/// The ending of message files.
const ENDING: &str = "hl7";

/// The receiver runs as another user: the folder's group may fetch messages.
const FETCHED_MODE: u32 = 0o660;

#[derive(Debug, Clone)]
pub(super) struct MessageFolder {
    folder: PathBuf,
    /// In that folder, because it must be on the same disk. Without it the share is not mounted.
    staging: PathBuf,
}

impl MessageFolder {
    /// The folder as this station uses it.
    pub fn new(folder: PathBuf, station: &str) -> MessageFolder {
        let staging = folder.join(format!(".gaiter.{station}"));
        MessageFolder { folder, staging }
    }

    /// Makes the folder for staged messages, and that of messages if `make_folder` is set.
    pub fn begin(&self, make_folder: bool) -> Result<(), StoreFault> {
        if make_folder {
            tried("making", &self.folder, fs::create_dir_all(&self.folder))?;
        }
        tried("making", &self.staging, durable::make_folder_once(&self.staging))?;
        tried("syncing", &self.folder, durable::sync_folder(&self.folder))
    }

    /// Checks that the folder is there and is the one that was begun.
    pub fn reach(&self) -> Result<(), StoreFault> {
        tried("listing", &self.folder, fs::read_dir(&self.folder))?;
        let what = "opening the station's folder (missing if a share is not mounted)";
        tried(what, &self.staging, fs::read_dir(&self.staging)).map(drop)
    }

    /// Key and control id of each staged message, complete or not.
    pub fn staged(&self) -> Result<Vec<(String, String)>, StoreFault> {
        let names = || -> io::Result<Vec<String>> {
            let names = fs::read_dir(&self.staging)?.map(|entry| Ok(entry?.file_name()));
            let plain = |name: OsString| name.to_string_lossy().into_owned();
            names.map(|name: io::Result<OsString>| name.map(plain)).collect()
        };
        let names = tried("listing", &self.staging, names())?;
        let parts = names.iter().filter_map(|name| name.split_once('.'));
        Ok(parts.map(|(key, control)| (key.to_owned(), control.to_owned())).collect())
    }

    /// Stages a message, durable.
    pub fn stage(&self, key: &str, control: &str, message: &[u8]) -> Result<(), StoreFault> {
        self.unstage(key, control)?;
        let path = self.staged_file(key, control);
        let write = || -> io::Result<()> {
            durable::write_new(&path, message)?;
            fs::set_permissions(&path, Permissions::from_mode(FETCHED_MODE))?;
            durable::sync_folder(&self.staging)
        };
        tried("writing", &path, write())
    }

    /// Removes a staged message, if there is one.
    pub fn unstage(&self, key: &str, control: &str) -> Result<(), StoreFault> {
        let path = self.staged_file(key, control);
        tried("clearing", &path, durable::remove_file(&path))
    }

    /// Gives a staged message its name. Does nothing if it has it, or had it.
    pub fn publish(&self, key: &str, control: &str) -> Result<(), StoreFault> {
        let staged = self.staged_file(key, control);
        match fs::rename(&staged, self.message(control)) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                // Only the folder that was begun can show that it is not there.
                self.reach()?;
                if staged.exists() {
                    return tried("renaming", &staged, Err(error));
                }
            }
            renamed => tried("renaming", &staged, renamed)?,
        }
        // The run that gave it its name may have ended before this sync.
        tried("syncing", &self.folder, durable::sync_folder(&self.folder))
    }

    /// The file of a message.
    pub fn message(&self, control: &str) -> PathBuf {
        self.folder.join(format!("{control}.{ENDING}"))
    }

    fn staged_file(&self, key: &str, control: &str) -> PathBuf {
        self.staging.join(format!("{key}.{control}"))
    }
}
