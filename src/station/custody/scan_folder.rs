//! A folder of the state folder that holds scans, each in a folder of its own: the spool, and the quarantine.
//!
//! A scan's folder under its final name is complete and durable. Names that begin with a dot are left by a crash.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_flow::ScanId;

use crate::store::durable;

/// A folder of scans.
#[derive(Debug)]
pub struct ScanFolder(PathBuf);

impl ScanFolder {
    /// Opens a folder of this name, creates it if needed, and removes entries that a crash left half made.
    pub fn open(state_dir: &Path, name: &str) -> io::Result<ScanFolder> {
        Ok(ScanFolder(durable::open_folder(state_dir, name)?))
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Reports whether the folder exists: another process may have removed it.
    pub fn is_there(&self) -> bool {
        self.0.is_dir()
    }

    /// The scans that have a folder here.
    pub fn entries(&self) -> io::Result<Vec<ScanId>> {
        let mut scans = Vec::new();
        for entry in fs::read_dir(&self.0)? {
            // Entries with other names do not belong to gaiter.
            scans.extend(ScanId::parse(&entry?.file_name().to_string_lossy()));
        }
        scans.sort();
        Ok(scans)
    }

    /// The folder of a scan.
    pub fn entry(&self, scan: &ScanId) -> PathBuf {
        self.0.join(scan.as_str())
    }

    /// Reports whether a scan has a folder here.
    pub fn holds(&self, scan: &ScanId) -> bool {
        self.entry(scan).is_dir()
    }

    /// Moves a scan's folder to another folder of scans; durable on return.
    ///
    /// # Errors
    /// Any I/O error; if the move itself failed, the scan stays here.
    pub fn move_to(&self, other: &ScanFolder, scan: &ScanId) -> io::Result<()> {
        durable::rename_new(&self.entry(scan), &other.entry(scan))?;
        other.sync()?;
        self.sync()
    }

    /// Removes a scan. Returns whether it was here.
    pub fn remove(&self, scan: &ScanId) -> io::Result<bool> {
        self.remove_entry(scan.as_str())
    }

    /// Removes an entry. It is renamed first, so that a crash leaves no partial entry under its name.
    pub(super) fn remove_entry(&self, name: &str) -> io::Result<bool> {
        let gone = self.0.join(format!(".gone-{name}"));
        durable::remove_folder(&gone)?;
        if durable::if_there(durable::rename_new(&self.0.join(name), &gone))?.is_none() {
            return Ok(false);
        }
        self.sync()?;
        durable::remove_folder(&gone)?;
        Ok(true)
    }

    /// Removes entries that failed attempts left half made. No other change may run meanwhile.
    pub fn clear(&self) -> io::Result<()> {
        durable::clear_hidden(&self.0)
    }

    /// Makes the folder's names durable.
    pub fn sync(&self) -> io::Result<()> {
        durable::sync_folder(&self.0)
    }
}
