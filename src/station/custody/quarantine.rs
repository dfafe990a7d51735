//! The quarantine: scans that could not be measured or stored, each with its reason.
//!
//! `quarantine/<sha256>/` is the scan's spool folder plus `reason.json`. `quarantine/unread-<…>/` stands
//! for a file too large to read and holds only the reason.

use std::fs;
use std::io;
use std::path::Path;

use gaiter_flow::ScanId;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::scan_folder::ScanFolder;
use crate::store::durable;

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

impl ScanFolder {
    /// Reports whether the quarantine holds a scan with its bytes.
    pub fn holds_bytes(&self, scan: &ScanId) -> bool {
        self.intake(scan).is_ok()
    }

    /// Removes the reasons of unread files noted before a time. Returns how many.
    pub fn remove_notes(&self, before: Timestamp) -> io::Result<usize> {
        let mut removed = 0;
        for entry in fs::read_dir(self.path())? {
            let name = entry?.file_name();
            let Some(name) = name.to_str().filter(|name| name.starts_with(UNREAD)) else {
                continue;
            };
            let noted = read_reason(&self.path().join(name))?;
            if noted.is_some_and(|reason| reason.first_seen < before) {
                removed += usize::from(self.remove_entry(name)?);
            }
        }
        Ok(removed)
    }

    /// Why a scan is in quarantine; `None` if it is not here or the reason cannot be read.
    pub fn reason(&self, scan: &ScanId) -> io::Result<Option<Reason>> {
        read_reason(&self.entry(scan))
    }

    /// Moves a scan's folder to the quarantine, with the reason; durable on return.
    ///
    /// # Errors
    /// Any I/O error; if the move itself failed, the scan stays here.
    pub fn refuse(
        &self,
        quarantine: &ScanFolder,
        scan: &ScanId,
        reason: &Reason,
    ) -> io::Result<()> {
        let entry = self.entry(scan);
        // An attempt that failed before the move may have left its reason.
        durable::replace_file(&entry, REASON, &text(reason)?)?;
        self.move_to(quarantine, scan)
    }

    /// Notes a reason if there are no bytes to keep. Does nothing if it is already noted.
    pub fn note(&self, name: &str, reason: &Reason) -> io::Result<()> {
        let staged = self.path().join(format!(".tmp-{name}"));
        durable::remove_folder(&staged)?;
        durable::make_folder(&staged)?;
        durable::write_new(&staged.join(REASON), &text(reason)?)?;
        durable::sync_folder(&staged)?;
        match durable::rename_new(&staged, &self.path().join(name)) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                durable::remove_folder(&staged)?;
            }
            other => other?,
        }
        self.sync()
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
