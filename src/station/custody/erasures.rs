//! The erasures of persons, kept apart from the journal: a journal that is rebuilt must know which scans are
//! not to be taken in again, and which erasures were cut off.
//!
//! `erasures/<hash>.json` holds the erasures of one person. The hash is that of the patient's id with a
//! secret of this station, `erasures/key`: without it, a short id could be found by trying.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use gaiter_flow::ScanId;
use gaiter_flow::patient::erasure::{Erasure, Next};
use gaiter_record::{hex, sha256};
use serde::{Deserialize, Serialize};

use crate::store::durable;
use crate::store::json_folder::JsonFolder;

/// The file with the station's secret.
const KEY: &str = "key";

/// The length of the secret, bytes.
const KEY_BYTES: usize = 32;

/// Hexadecimal digits of a person's hash: two persons share one with a probability of 2⁻⁶⁴.
const DIGITS: usize = 16;

/// The erasures of a station.
#[derive(Debug)]
pub struct Erasures {
    pub(super) folder: JsonFolder,
    key: String,
    /// By the person's hash.
    known: Mutex<BTreeMap<String, Erasure>>,
}

/// The versions of a file's schema.
#[derive(Serialize, Deserialize)]
#[serde(tag = "schema")]
enum Versioned {
    #[serde(rename = "gaiter.erasure/1")]
    V1(Erasure),
}

impl Erasures {
    /// Opens the erasures of a state folder, creates the folder and the secret if needed, and removes files
    /// that a crash left half written.
    ///
    /// # Errors
    /// Any I/O error; `InvalidData` if a file cannot be understood: an erasure must not be forgotten.
    pub fn open(state_dir: &Path) -> io::Result<Erasures> {
        let folder = JsonFolder::open(state_dir, "erasures")?;
        let key = match durable::if_there(fs::read_to_string(folder.path().join(KEY)))? {
            Some(key) => key,
            None => {
                let mut bytes = [0; KEY_BYTES];
                File::open("/dev/urandom")?.read_exact(&mut bytes)?;
                let key = hex(&bytes);
                durable::replace_file(folder.path(), KEY, key.as_bytes())?;
                key
            }
        };
        let mut known = BTreeMap::new();
        for whose in folder.names()? {
            if let Some(Versioned::V1(erasure)) = folder.read(&whose)? {
                known.insert(whose, erasure);
            }
        }
        Ok(Erasures { folder, key, known: Mutex::new(known) })
    }

    /// The hash that stands for a person.
    pub fn hash(&self, patient: &str) -> String {
        let mut hash = sha256(format!("{}\0{patient}", self.key).as_bytes());
        hash.truncate(DIGITS);
        hash
    }

    /// The erasure of a person; `None` if none was ever asked for.
    pub fn of(&self, whose: &str) -> Option<Erasure> {
        self.known().get(whose).cloned()
    }

    /// Keeps an erasure; durable on return.
    ///
    /// # Errors
    /// Any I/O error; the earlier state then stays.
    pub fn keep(&self, whose: &str, erasure: &Erasure) -> io::Result<()> {
        let bytes = serde_json::to_vec_pretty(&Versioned::V1(erasure.clone()))?;
        self.folder.keep(whose, &bytes)?;
        self.known().insert(whose.to_owned(), erasure.clone());
        Ok(())
    }

    /// The erasures that have not ended, by the persons' hashes.
    pub fn pending(&self) -> Vec<(String, Erasure)> {
        let known = self.known();
        let pending = known.iter().filter(|(_, erasure)| erasure.next() != Next::Nothing);
        pending.map(|(whose, erasure)| (whose.clone(), erasure.clone())).collect()
    }

    /// The stores that erasures wait for, by their names.
    pub fn awaited_stores(&self) -> BTreeSet<String> {
        self.known().values().flat_map(|erasure| erasure.stores.iter().cloned()).collect()
    }

    /// Whether a scan is not to be taken in, for this patient or for no one by name, because it was erased.
    pub fn refuse(&self, scan: &ScanId, patient: Option<&str>) -> bool {
        let known = self.known();
        if known.is_empty() {
            return false;
        }
        let whose = patient.map(|patient| self.hash(patient));
        known.iter().any(|(hash, erasure)| {
            erasure.refuses(scan.as_str(), whose.as_deref() == Some(hash.as_str()))
        })
    }

    fn known(&self) -> MutexGuard<'_, BTreeMap<String, Erasure>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gaiter_flow::patient::erasure::ErasedScan;

    fn asked(patient: &str) -> Erasure {
        let at = "2027-01-01T00:00:00Z".parse().unwrap();
        Erasure::asked(None, patient, at, "uid 0".to_owned(), vec!["folder".to_owned()])
    }

    #[test]
    fn an_erasure_outlasts_a_start_and_its_file_shows_the_id_only_until_it_has_ended() {
        let dir = tempfile::tempdir().unwrap();
        let erasures = Erasures::open(dir.path()).unwrap();
        let whose = erasures.hash("4711");
        let mut erasure = asked("4711");
        erasures.keep(&whose, &erasure).unwrap();
        let erasures = Erasures::open(dir.path()).unwrap();
        assert_eq!(erasures.pending(), [(whose.clone(), erasure.clone())]);
        assert_eq!(erasures.hash("4711"), whose, "the secret stays");
        let scan = ScanId::of_digest([7; 32]);
        erasure.add([ErasedScan { sha256: scan.to_string(), is_whole: true }]);
        erasure.own_cleared(erasure.at, &[]);
        erasures.keep(&whose, &erasure).unwrap();
        let erasures = Erasures::open(dir.path()).unwrap();
        assert!(erasures.pending().is_empty());
        assert!(erasures.refuse(&scan, None) && erasures.refuse(&scan, Some("4712")));
        assert!(!erasures.refuse(&ScanId::of_digest([8; 32]), Some("4711")));
        let file = dir.path().join("erasures").join(format!("{whose}.json"));
        assert!(!fs::read_to_string(file).unwrap().contains("4711"));
    }

    #[test]
    fn two_stations_have_different_hashes_of_one_person() {
        let dirs = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        let hashes = dirs.map(|dir| Erasures::open(dir.path()).unwrap().hash("4711"));
        assert_ne!(hashes[0], hashes[1]);
    }

    #[test]
    fn an_erasure_that_cannot_be_understood_is_not_taken_for_none() {
        let dir = tempfile::tempdir().unwrap();
        let erasures = Erasures::open(dir.path()).unwrap();
        fs::write(erasures.folder.file("0123"), "{").unwrap();
        let fault = Erasures::open(dir.path()).unwrap_err();
        assert_eq!(fault.kind(), io::ErrorKind::InvalidData);
    }
}
