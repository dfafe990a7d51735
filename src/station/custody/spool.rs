//! The spool: the station's own copy of each scan until its deliveries are made.
//!
//! `spool/<sha256>/` holds `scan.<ending>`, companion files such as `scan.ord`, and `intake.json`, from
//! which a lost journal can be rebuilt.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use gaiter_flow::ScanId;
use gaiter_flow::round::CaptureMatch;
use gaiter_record::Patient;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::scan_folder::ScanFolder;
use crate::station::runtime::random_bits;
use crate::store::{Access, durable};

/// `intake.json`: what was known when the bytes came in.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Intake {
    /// The scan, 64 hexadecimal digits.
    pub sha256: String,
    /// The file-name ending of its format.
    pub format: String,
    /// Size, bytes.
    pub size: u64,
    /// When the station first saw these bytes, whole seconds, UTC; never changes.
    pub first_seen: Timestamp,
    /// The file's own time.
    pub file_time: Option<Timestamp>,
    /// When the button was pressed for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressed_at: Option<Timestamp>,
    /// The patient named for the scan.
    pub patient: Option<Patient>,
    /// The bytes are kept for an operator's decision; nothing is delivered without it.
    pub held: bool,
    /// Codes of findings the operator should know.
    pub findings: Vec<String>,
    /// The fingerprint of what was read in it; '' if nothing was.
    pub geometry: String,
    /// The capture it answers.
    pub judged: CaptureMatch,
    /// All patients it may belong to, if that is uncertain.
    pub candidates: Vec<String>,
}

/// A file that came with a scan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Companion {
    /// What follows `scan.` in its name here: `ord`, `mtl`, `2.ord` if there are two.
    pub name_ending: String,
    pub bytes: Vec<u8>,
}

/// The versions of the `intake.json` schema.
#[derive(Serialize, Deserialize)]
#[serde(tag = "schema")]
enum Versioned {
    #[serde(rename = "gaiter.intake/1")]
    V1(Intake),
}

const INTAKE: &str = "intake.json";

impl ScanFolder {
    /// Keeps the bytes of a scan that is not here yet, and its companion files; durable on return.
    ///
    /// # Errors
    /// Any I/O error; the spool is then unchanged.
    pub fn keep(
        &self,
        scan: &ScanId,
        intake: Intake,
        bytes: &[u8],
        companions: &[Companion],
    ) -> io::Result<()> {
        let staged = self.path().join(format!(".tmp-{:016x}", random_bits()));
        let kept = self.stage(&staged, scan, intake, bytes, companions);
        if kept.is_err() {
            // The likely cause is a full disk: free the space that was used.
            durable::remove_folder(&staged)?;
        }
        kept
    }

    fn stage(
        &self,
        staged: &Path,
        scan: &ScanId,
        intake: Intake,
        bytes: &[u8],
        companions: &[Companion],
    ) -> io::Result<()> {
        durable::make_folder(staged)?;
        let write =
            |name: &str, bytes: &[u8]| Access::Private.write_unsynced(&staged.join(name), bytes);
        let mut written = vec![write(&file_name(&intake.format), bytes)?];
        for Companion { name_ending, bytes } in companions {
            written.push(write(&file_name(name_ending), bytes)?);
        }
        let text = serde_json::to_vec_pretty(&Versioned::V1(intake))?;
        written.push(write(INTAKE, &text)?);
        written.iter().try_for_each(File::sync_all)?;
        durable::sync_folder(staged)?;
        durable::rename_new(staged, &self.entry(scan))?;
        self.sync()
    }

    /// What was known when a scan came in.
    ///
    /// # Errors
    /// Any I/O error; `InvalidData` if the file is not a valid intake.
    pub fn intake(&self, scan: &ScanId) -> io::Result<Intake> {
        let text = fs::read(self.entry(scan).join(INTAKE))?;
        let Versioned::V1(intake) = serde_json::from_slice(&text)
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
        Ok(intake)
    }

    /// Writes an intake in the place of a scan's own; durable on return.
    pub fn replace_intake(&self, scan: &ScanId, intake: Intake) -> io::Result<()> {
        let text = serde_json::to_vec_pretty(&Versioned::V1(intake))?;
        durable::replace_file(&self.entry(scan), INTAKE, &text)
    }

    /// The file that holds the bytes of a scan.
    pub fn scan_file(&self, scan: &ScanId, format: &str) -> PathBuf {
        self.entry(scan).join(file_name(format))
    }

    /// The companion files of a scan with this ending, sorted by name.
    ///
    /// # Errors
    /// Any I/O error; `NotFound` if the scan is not here.
    pub fn companions(&self, scan: &ScanId, ending: &str) -> io::Result<Vec<PathBuf>> {
        let mut files = Vec::new();
        for file in fs::read_dir(self.entry(scan))? {
            let path = file?.path();
            files.extend(path.extension().is_some_and(|found| found == ending).then_some(path));
        }
        files.sort();
        Ok(files)
    }
}

fn file_name(format: &str) -> String {
    format!("scan.{format}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn intake(scan: &ScanId) -> Intake {
        Intake {
            sha256: scan.to_string(),
            format: "obj".to_owned(),
            size: 3,
            first_seen: "2026-11-21T09:15:00Z".parse().unwrap(),
            file_time: None,
            pressed_at: None,
            patient: None,
            held: false,
            findings: Vec::new(),
            geometry: String::new(),
            judged: CaptureMatch::Unpressed,
            candidates: Vec::new(),
        }
    }

    #[test]
    fn what_is_kept_reads_back_and_is_gone_when_removed() {
        let dir = tempfile::tempdir().unwrap();
        let spool = ScanFolder::open(dir.path(), "spool").unwrap();
        let scan = ScanId::of_digest([7; 32]);
        let ord = Companion { name_ending: "ord".into(), bytes: b"de".to_vec() };
        spool.keep(&scan, intake(&scan), b"abc", &[ord]).unwrap();
        assert_eq!(fs::read(spool.entry(&scan).join("scan.ord")).unwrap(), b"de");
        assert_eq!(spool.companions(&scan, "ord").unwrap(), [spool.entry(&scan).join("scan.ord")]);
        assert!(spool.companions(&scan, "mtl").unwrap().is_empty());
        assert_eq!(spool.entries().unwrap(), std::slice::from_ref(&scan));
        assert_eq!(spool.intake(&scan).unwrap(), intake(&scan));
        assert_eq!(fs::read(spool.scan_file(&scan, "obj")).unwrap(), b"abc");
        let text = fs::read_to_string(spool.entry(&scan).join(INTAKE)).unwrap();
        assert!(text.contains("\"schema\": \"gaiter.intake/1\""), "{text}");
        spool.remove(&scan).unwrap();
        spool.remove(&scan).unwrap();
        assert!(spool.entries().unwrap().is_empty());
    }

    #[test]
    fn a_second_keep_of_the_same_scan_leaves_the_first_and_no_rest() {
        let dir = tempfile::tempdir().unwrap();
        let spool = ScanFolder::open(dir.path(), "spool").unwrap();
        let scan = ScanId::of_digest([7; 32]);
        spool.keep(&scan, intake(&scan), b"abc", &[]).unwrap();
        let later = Intake { size: 99, ..intake(&scan) };
        assert!(spool.keep(&scan, later, b"abc", &[]).is_err());
        assert_eq!(spool.intake(&scan).unwrap().size, 3);
        assert_eq!(fs::read_dir(dir.path().join("spool")).unwrap().count(), 1);
    }

    #[test]
    fn what_a_crash_left_half_made_is_cleared_at_the_start() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir_all(dir.path().join("spool/.tmp-1")).unwrap();
        fs::write(dir.path().join("spool/.tmp-1/scan.obj"), "v").unwrap();
        ScanFolder::open(dir.path(), "spool").unwrap();
        assert_eq!(fs::read_dir(dir.path().join("spool")).unwrap().count(), 0);
    }
}
