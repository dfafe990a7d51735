//! The quarantine: scans that could not be measured or stored, each with its reason.
//!
//! `quarantine/<sha256>/` is the scan's spool folder plus `reason.json`. `quarantine/unread-<…>/` stands
//! for a file too large to read and holds only the reason.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_flow::ScanId;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::spool::{self, Intake};
use crate::store::durable;

/// The folder of refused scans.
#[derive(Debug)]
pub struct Quarantine {
    folder: PathBuf,
}

/// `reason.json`: why a scan was refused.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reason {
    /// Stable code.
    pub code: String,
    /// Message for the operator.
    pub message: String,
    /// Where it was refused.
    pub stage: Stage,
    /// When the station first saw the scan.
    pub first_seen: Timestamp,
    /// The version of gaiter that refused it.
    pub gaiter: String,
}

/// The stage at which a scan was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Before it was in the spool, or in the spool itself.
    Intake,
    /// While it was measured.
    Measure,
    /// At the record store.
    Store,
}

/// The versions of the `reason.json` schema.
#[derive(Serialize, Deserialize)]
#[serde(tag = "schema")]
enum Versioned {
    #[serde(rename = "gaiter.reason/1")]
    V1(Reason),
}

const REASON: &str = "reason.json";

/// Prefix of the names of entries without bytes.
const UNREAD: &str = "unread-";

impl Reason {
    /// A reason found by this version of gaiter.
    pub fn new(code: &str, message: String, stage: Stage, first_seen: Timestamp) -> Reason {
        let gaiter = env!("CARGO_PKG_VERSION").to_owned();
        Reason { code: code.to_owned(), message, stage, first_seen, gaiter }
    }
}

impl Quarantine {
    /// Opens the quarantine, creates it if needed, and removes entries that a crash left half made.
    pub fn open(state_dir: &Path) -> io::Result<Quarantine> {
        Ok(Quarantine { folder: durable::open_folder(state_dir, "quarantine")? })
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Reports whether the quarantine holds a scan.
    pub fn holds(&self, scan: &ScanId) -> bool {
        self.folder.join(scan.as_str()).is_dir()
    }

    /// Removes entries that failed attempts left half made. No other change may run meanwhile.
    pub fn clear(&self) -> io::Result<()> {
        durable::clear_hidden(&self.folder)
    }

    /// Makes the quarantine's names durable.
    pub fn sync(&self) -> io::Result<()> {
        durable::sync_folder(&self.folder)
    }

    /// Reports whether the quarantine holds a scan with its bytes.
    pub fn holds_bytes(&self, scan: &ScanId) -> bool {
        self.intake(scan).is_ok()
    }

    pub fn entries(&self) -> io::Result<Vec<ScanId>> {
        spool::entries(&self.folder)
    }

    /// The intake data of a scan that is here with its bytes.
    ///
    /// # Errors
    /// Any I/O error; `InvalidData` if the file is not a valid intake.
    pub fn intake(&self, scan: &ScanId) -> io::Result<Intake> {
        spool::read_intake(&self.folder.join(scan.as_str()))
    }

    /// Moves a scan's folder back to the spool. The caller syncs the spool afterwards.
    ///
    /// # Errors
    /// Any I/O error; the scan then stays here.
    pub fn give_back(&self, scan: &ScanId, entry: &Path) -> io::Result<()> {
        durable::rename_new(&self.folder.join(scan.as_str()), entry)?;
        durable::sync_folder(&self.folder)
    }

    /// Removes a scan. Returns whether it was here. The entry is renamed first, so that a crash leaves
    /// no partial entry under its name.
    pub fn remove(&self, scan: &ScanId) -> io::Result<bool> {
        self.remove_entry(scan.as_str())
    }

    fn remove_entry(&self, name: &str) -> io::Result<bool> {
        let gone = self.folder.join(format!(".gone-{name}"));
        durable::remove_folder(&gone)?;
        let renamed = durable::rename_new(&self.folder.join(name), &gone);
        if durable::if_there(renamed)?.is_none() {
            return Ok(false);
        }
        durable::sync_folder(&self.folder)?;
        durable::remove_folder(&gone)?;
        Ok(true)
    }

    /// Removes the reasons of unread files noted before a time. Returns how many.
    pub fn remove_notes(&self, before: Timestamp) -> io::Result<usize> {
        let mut removed = 0;
        for entry in fs::read_dir(&self.folder)? {
            let name = entry?.file_name();
            let Some(name) = name.to_str().filter(|name| name.starts_with(UNREAD)) else {
                continue;
            };
            let noted = read_reason(&self.folder.join(name))?;
            if noted.is_some_and(|reason| reason.first_seen < before) {
                removed += usize::from(self.remove_entry(name)?);
            }
        }
        Ok(removed)
    }

    /// Why a scan is in quarantine; `None` if it is not here or the reason cannot be read.
    pub fn reason(&self, scan: &ScanId) -> io::Result<Option<Reason>> {
        read_reason(&self.folder.join(scan.as_str()))
    }

    /// Moves a scan's folder from the spool to here. The caller syncs the spool afterwards.
    ///
    /// # Errors
    /// Any I/O error; the scan then stays in the spool.
    pub fn take(&self, entry: &Path, scan: &ScanId, reason: &Reason) -> io::Result<()> {
        let path = entry.join(REASON);
        // An attempt that failed before the move may have left its reason.
        durable::remove_file(&path)?;
        durable::write_new(&path, &text(reason)?)?;
        durable::sync_folder(entry)?;
        durable::rename_new(entry, &self.folder.join(scan.as_str()))?;
        durable::sync_folder(&self.folder)
    }

    /// Notes a reason if there are no bytes to keep. Does nothing if it is already noted.
    pub fn note(&self, name: &str, reason: &Reason) -> io::Result<()> {
        let staged = self.folder.join(format!(".tmp-{name}"));
        durable::remove_folder(&staged)?;
        durable::make_folder(&staged)?;
        durable::write_new(&staged.join(REASON), &text(reason)?)?;
        durable::sync_folder(&staged)?;
        match durable::rename_new(&staged, &self.folder.join(name)) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                durable::remove_folder(&staged)?;
            }
            other => other?,
        }
        durable::sync_folder(&self.folder)
    }
}

/// The name of the entry of an unread file, from digits that identify the file's state.
pub fn unread(digits: &str) -> String {
    format!("{UNREAD}{digits}")
}

/// The reason in an entry; `None` if there is no entry or the reason cannot be read.
fn read_reason(entry: &Path) -> io::Result<Option<Reason>> {
    let text = durable::if_there(fs::read(entry.join(REASON)))?;
    let reason = text.and_then(|text| serde_json::from_slice(&text).ok());
    Ok(reason.map(|Versioned::V1(reason)| reason))
}

fn text(reason: &Reason) -> io::Result<Vec<u8>> {
    Ok(serde_json::to_vec_pretty(&Versioned::V1(reason.clone()))?)
}
