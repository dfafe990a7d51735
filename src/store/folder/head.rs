//! The head of a station's history, kept beside its records. A station whose journal does not hold it works
//! on an older copy of its state folder, and does not know which records were made since.

use std::fs::{self, OpenOptions};
use std::io::ErrorKind;
use std::os::unix::fs::{FileExt, OpenOptionsExt};

use super::FolderStore;
use crate::store::{RecordStore, StoreFault, tried};

impl FolderStore {
    /// The head as it was last kept; `None` if it never was.
    ///
    /// # Errors
    /// A transient fault if it cannot be read.
    pub(super) fn read_head(&self) -> Result<Option<String>, StoreFault> {
        let path = self.root.join(&self.head);
        match fs::read(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            read => {
                let bytes = tried("reading", &path, read)?;
                Ok(Some(String::from_utf8_lossy(&bytes).into_owned()))
            }
        }
    }

    /// Keeps the head. It is not synced: a power cut may leave an older one, which only makes the check a
    /// little weaker. Written in place, because each line is as long as the last.
    ///
    /// # Errors
    /// A transient fault if it cannot be written, or if the store is out of reach.
    pub(super) fn write_head(&self, line: &str) -> Result<(), StoreFault> {
        self.reach()?;
        let path = self.root.join(&self.head);
        let mut options = OpenOptions::new();
        options.write(true).create(true).truncate(false).mode(self.access.file_mode());
        let written = options.open(&path).and_then(|file| file.write_all_at(line.as_bytes(), 0));
        tried("writing", &path, written)
    }

    /// Makes the head that was kept last durable: after an erasure an older one would be of another history.
    ///
    /// # Errors
    /// A transient fault if it cannot be synced.
    pub(super) fn sync_head(&self) -> Result<(), StoreFault> {
        let path = self.root.join(&self.head);
        let synced = OpenOptions::new().write(true).open(&path).and_then(|file| file.sync_all());
        tried("syncing", &path, synced)
    }
}
