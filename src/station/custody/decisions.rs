//! Operators' decisions about scans, stored apart from the journal: a journal can be rebuilt from spool,
//! quarantine and stores, but a decision cannot.
//!
//! `decisions/<sha256>.json` holds the decisions about one scan in order. The file is durable before a
//! decision changes the journal. The journal records how many decisions it has applied, so the next
//! start finds one that a crash interrupted.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_flow::ScanId;
use gaiter_flow::decision::Decision;
use serde::{Deserialize, Serialize};

use crate::store::durable;

/// The file-name ending of a scan's decisions.
const ENDING: &str = ".json";

/// The folder of the decisions.
#[derive(Debug)]
pub struct Decisions {
    folder: PathBuf,
}

/// The content of a scan's file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Book {
    /// The scan, 64 hexadecimal digits.
    sha256: String,
    /// The decisions about it, oldest first.
    decisions: Vec<Decision>,
}

/// The versions of the file's schema.
#[derive(Serialize, Deserialize)]
#[serde(tag = "schema")]
enum Versioned {
    #[serde(rename = "gaiter.decisions/1")]
    V1(Book),
}

impl Decisions {
    /// Opens the decisions of a state folder, creates the folder if needed, and removes files that a
    /// crash left half written.
    pub fn open(state_dir: &Path) -> io::Result<Decisions> {
        Ok(Decisions { folder: durable::open_folder(state_dir, "decisions")? })
    }

    /// The folder of the decisions.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The decisions about a scan, in order; empty for most scans.
    ///
    /// # Errors
    /// Any I/O error; `InvalidData` if the file does not hold decisions about this scan.
    pub fn of(&self, scan: &ScanId) -> io::Result<Vec<Decision>> {
        let text = match fs::read(self.path(scan)) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            read => read?,
        };
        let Versioned::V1(book) = serde_json::from_slice(&text)
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
        if book.sha256 != scan.as_str() {
            let message = "the file holds decisions about another scan";
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        Ok(book.decisions)
    }

    /// Stores all decisions about a scan; durable on return.
    ///
    /// # Errors
    /// Any I/O error; the earlier decisions then stay.
    pub fn keep(&self, scan: &ScanId, decisions: &[Decision]) -> io::Result<()> {
        if decisions.is_empty() {
            return self.remove(scan);
        }
        let book = Book { sha256: scan.to_string(), decisions: decisions.to_vec() };
        let bytes = serde_json::to_vec_pretty(&Versioned::V1(book))?;
        durable::replace_file(&self.folder, &name(scan), &bytes)
    }

    /// Removes the decisions about a scan, if there are any.
    ///
    /// # Errors
    /// Any other I/O error.
    pub fn remove(&self, scan: &ScanId) -> io::Result<()> {
        match fs::remove_file(self.path(scan)) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            removed => removed.and_then(|()| durable::sync_folder(&self.folder)),
        }
    }

    /// The scans that have decisions.
    pub fn scans(&self) -> io::Result<Vec<ScanId>> {
        let mut scans = Vec::new();
        for entry in fs::read_dir(&self.folder)? {
            let name = entry?.file_name();
            let name = name.to_string_lossy();
            scans.extend(name.strip_suffix(ENDING).and_then(ScanId::parse));
        }
        scans.sort();
        Ok(scans)
    }

    fn path(&self, scan: &ScanId) -> PathBuf {
        self.folder.join(name(scan))
    }
}

/// The name of the file with the decisions about a scan.
fn name(scan: &ScanId) -> String {
    format!("{scan}{ENDING}")
}

#[cfg(test)]
mod tests {
    use jiff::Timestamp;

    use super::*;
    use gaiter_flow::decision::Decided;

    fn assigned(id: &str) -> Decision {
        let at = "2026-11-21T09:15:00Z".parse::<Timestamp>().unwrap();
        Decision { at, what: Decided::Assigned, patient: Some(id.to_owned()) }
    }

    #[test]
    fn what_was_decided_reads_back_in_its_order_after_a_restart() {
        let dir = tempfile::tempdir().unwrap();
        let scan = ScanId::of_digest([7; 32]);
        let decisions = Decisions::open(dir.path()).unwrap();
        assert_eq!(decisions.of(&scan).unwrap(), []);
        let both = [assigned("1"), assigned("2")];
        decisions.keep(&scan, &both[..1]).unwrap();
        decisions.keep(&scan, &both).unwrap();
        // A crash while the next decision was written.
        fs::write(dir.path().join(format!("decisions/.{scan}.json")), "{").unwrap();
        let decisions = Decisions::open(dir.path()).unwrap();
        assert_eq!(decisions.of(&scan).unwrap(), both);
        assert_eq!(decisions.scans().unwrap(), std::slice::from_ref(&scan));
        let text = fs::read_to_string(decisions.path(&scan)).unwrap();
        assert!(text.contains("\"schema\": \"gaiter.decisions/1\""), "{text}");
        assert!(text.contains("\"what\": \"assigned\""), "{text}");
        decisions.keep(&scan, &[]).unwrap();
        decisions.remove(&scan).unwrap();
        assert!(decisions.scans().unwrap().is_empty());
    }

    #[test]
    fn decisions_that_cannot_be_read_are_not_taken_for_none() {
        let dir = tempfile::tempdir().unwrap();
        let decisions = Decisions::open(dir.path()).unwrap();
        let (scan, other) = (ScanId::of_digest([7; 32]), ScanId::of_digest([8; 32]));
        fs::write(decisions.path(&scan), "{").unwrap();
        assert_eq!(decisions.of(&scan).unwrap_err().kind(), io::ErrorKind::InvalidData);
        decisions.keep(&other, &[assigned("1")]).unwrap();
        fs::rename(decisions.path(&other), decisions.path(&scan)).unwrap();
        assert_eq!(decisions.of(&scan).unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
