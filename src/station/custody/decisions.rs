//! Operators' decisions about scans, stored apart from the journal: a journal can be rebuilt from spool,
//! quarantine and stores, but a decision cannot.
//!
//! `decisions/<sha256>.json` holds the decisions about one scan in order. The file is durable before a
//! decision changes the journal. The journal records how many decisions it has applied, so the next
//! start finds one that a crash interrupted.

use std::io;
use std::path::Path;

use gaiter_flow::ScanId;
use gaiter_flow::decision::Decision;
use serde::{Deserialize, Serialize};

use crate::store::json_folder::JsonFolder;

#[derive(Debug)]
pub(super) struct Decisions(pub(super) JsonFolder);

/// The versions of the schema of a scan's file.
#[derive(Serialize, Deserialize)]
#[serde(tag = "schema", deny_unknown_fields)]
enum Versioned {
    #[serde(rename = "gaiter.decisions/1")]
    V1 {
        /// The scan, 64 hexadecimal digits.
        sha256: String,
        /// The decisions about it, oldest first.
        decisions: Vec<Decision>,
    },
}

impl Decisions {
    /// Opens the decisions of a state folder.
    pub fn open(state_dir: &Path) -> io::Result<Decisions> {
        Ok(Decisions(JsonFolder::open(state_dir, "decisions")?))
    }

    /// The decisions about a scan, in order; empty for most scans.
    ///
    /// # Errors
    /// Any I/O error; `InvalidData` if the file does not hold decisions about this scan.
    pub fn of(&self, scan: &ScanId) -> io::Result<Vec<Decision>> {
        let Some(Versioned::V1 { sha256, decisions }) = self.0.read(scan.as_str())? else {
            return Ok(Vec::new());
        };
        if sha256 != scan.as_str() {
            let message = "the file holds decisions about another scan";
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        Ok(decisions)
    }

    /// Stores all decisions about a scan; durable on return.
    ///
    /// # Errors
    /// Any I/O error; the earlier decisions then stay.
    pub fn keep(&self, scan: &ScanId, decisions: &[Decision]) -> io::Result<()> {
        if decisions.is_empty() {
            return self.0.remove(scan.as_str());
        }
        let book = Versioned::V1 { sha256: scan.to_string(), decisions: decisions.to_vec() };
        self.0.keep(scan.as_str(), &serde_json::to_vec_pretty(&book)?)
    }

    pub fn scans(&self) -> io::Result<Vec<ScanId>> {
        Ok(self.0.names()?.iter().filter_map(|name| ScanId::parse(name)).collect())
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use jiff::Timestamp;

    use super::*;
    use gaiter_flow::decision::Decided;

    fn assigned(id: &str) -> Decision {
        let at = "2026-11-21T09:15:00Z".parse::<Timestamp>().unwrap();
        Decision { at, what: Decided::Assigned, patient: Some(id.to_owned()), request: None }
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
        let text = fs::read_to_string(decisions.0.file(scan.as_str())).unwrap();
        assert!(text.contains("\"schema\": \"gaiter.decisions/1\""), "{text}");
        assert!(text.contains("\"what\": \"assigned\""), "{text}");
        decisions.keep(&scan, &[]).unwrap();
        decisions.keep(&scan, &[]).unwrap();
        assert!(decisions.scans().unwrap().is_empty());
    }

    #[test]
    fn decisions_that_cannot_be_read_are_not_taken_for_none() {
        let dir = tempfile::tempdir().unwrap();
        let decisions = Decisions::open(dir.path()).unwrap();
        let (scan, other) = (ScanId::of_digest([7; 32]), ScanId::of_digest([8; 32]));
        fs::write(decisions.0.file(scan.as_str()), "{").unwrap();
        assert_eq!(decisions.of(&scan).unwrap_err().kind(), io::ErrorKind::InvalidData);
        decisions.keep(&other, &[assigned("1")]).unwrap();
        fs::rename(decisions.0.file(other.as_str()), decisions.0.file(scan.as_str())).unwrap();
        assert_eq!(decisions.of(&scan).unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
