//! Which leg of a patient a person named as affected, kept apart from the journal: a journal that is rebuilt could
//! not know.
//!
//! `affected/<hash>.json` holds what was named of one patient. The hash is that of the person's erasures, so the
//! folder shows no id. The history of the journal tells what was named when.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::PoisonError;

use gaiter_flow::patient::person::NamedLeg;
use gaiter_record::Patient;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::{Custody, CustodyFault};
use crate::store::durable;

/// The folder in the state folder.
const FOLDER: &str = "affected";

/// The file-name ending.
const ENDING: &str = ".json";

/// The affected legs of a station's patients.
#[derive(Debug)]
pub struct AffectedLegs {
    folder: PathBuf,
}

/// The versions of a file's schema.
#[derive(Serialize, Deserialize)]
#[serde(tag = "schema")]
enum Versioned {
    #[serde(rename = "gaiter.affected/1")]
    V1(NamedLeg),
}

impl AffectedLegs {
    /// Opens the affected legs of a state folder, creates the folder if needed, and removes files that a crash
    /// left half written.
    ///
    /// # Errors
    /// Any I/O error.
    pub fn open(state_dir: &Path) -> io::Result<AffectedLegs> {
        Ok(AffectedLegs { folder: durable::open_folder(state_dir, FOLDER)? })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What was named of a person; `None` if nothing was.
    fn of(&self, whose: &str) -> io::Result<Option<NamedLeg>> {
        let Some(bytes) = self.bytes(whose)? else { return Ok(None) };
        let Versioned::V1(named) = serde_json::from_slice(&bytes)
            .map_err(|error| io::Error::new(ErrorKind::InvalidData, error))?;
        Ok(Some(named))
    }

    fn bytes(&self, whose: &str) -> io::Result<Option<Vec<u8>>> {
        match fs::read(self.folder.join(name(whose))) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            read => read.map(Some),
        }
    }

    /// Keeps these bytes of a person's file, or none; durable on return.
    fn keep(&self, whose: &str, bytes: Option<&[u8]>) -> io::Result<()> {
        match bytes {
            Some(bytes) => durable::replace_file(&self.folder, &name(whose), bytes),
            None => self.remove(whose),
        }
    }

    /// Forgets what was named of a person, if anything was.
    ///
    /// # Errors
    /// Any other I/O error.
    pub(super) fn remove(&self, whose: &str) -> io::Result<()> {
        match fs::remove_file(self.folder.join(name(whose))) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            removed => removed.and_then(|()| durable::sync_folder(&self.folder)),
        }
    }
}

fn name(whose: &str) -> String {
    format!("{whose}{ENDING}")
}

impl Custody {
    /// Notes which leg of a patient a person named as affected; `None` takes it back. Durable on return. If the
    /// journal fails, what was named before stays.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn name_affected(
        &self,
        patient: &Patient,
        affected: Option<&str>,
    ) -> Result<(), CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        let whose = self.erasures.hash(&patient.id);
        let what = "keeping the affected leg";
        let before = super::io(what, self.affected.bytes(&whose))?;
        let named = affected.map(|word| {
            let named = NamedLeg { affected: word.to_owned(), at: Timestamp::now() };
            serde_json::to_vec_pretty(&Versioned::V1(named)).map_err(io::Error::from)
        });
        let named = super::io(what, named.transpose())?;
        super::io(what, self.affected.keep(&whose, named.as_deref()))?;
        let noted = self.journal.affected_named(&patient.id, affected);
        if noted.is_err() {
            super::io(what, self.affected.keep(&whose, before.as_deref()))?;
        }
        Ok(noted?)
    }

    /// Which leg of a patient a person named as affected; `None` if nobody did.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn affected_of(&self, patient: &str) -> Result<Option<NamedLeg>, CustodyFault> {
        let whose = self.erasures.hash(patient);
        super::io("reading the affected leg", self.affected.of(&whose))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{open, patient};
    use super::*;

    fn word(custody: &Custody) -> Option<String> {
        custody.affected_of("4711").unwrap().map(|named| named.affected)
    }

    #[test]
    fn the_affected_leg_outlasts_a_start_and_a_lost_journal_and_shows_no_id() {
        let dir = tempfile::tempdir().unwrap();
        let custody = open(dir.path());
        assert_eq!(word(&custody), None);
        custody.name_affected(&patient("4711"), Some("left")).unwrap();
        custody.name_affected(&patient("4711"), Some("both")).unwrap();
        assert_eq!(custody.affected_of("4712").unwrap(), None);
        drop(custody);
        for file in ["journal.db", "journal.db-wal", "journal.db-shm", "history.head"] {
            let _ = fs::remove_file(dir.path().join(file));
        }
        let custody = open(dir.path());
        assert_eq!(word(&custody).as_deref(), Some("both"));
        for entry in fs::read_dir(dir.path().join(FOLDER)).unwrap() {
            let path = entry.unwrap().path();
            assert!(!path.display().to_string().contains("4711"));
            assert!(!fs::read_to_string(path).unwrap().contains("4711"));
        }
        custody.name_affected(&patient("4711"), None).unwrap();
        assert_eq!(word(&custody), None);
        assert_eq!(fs::read_dir(dir.path().join(FOLDER)).unwrap().count(), 0);
    }

    #[test]
    fn the_history_says_what_was_named_and_a_damaged_file_is_named_anew() {
        let dir = tempfile::tempdir().unwrap();
        let custody = open(dir.path());
        custody.name_affected(&patient("4711"), Some("right")).unwrap();
        let said = custody.journal().history_of_person("4711", &[]).unwrap();
        let [of] = said.as_slice() else { panic!("{said:?}") };
        assert_eq!(of.happened.event, "affected-named");
        assert!(of.happened.detail.contains("\"right\""), "{of:?}");
        let file = dir.path().join(FOLDER).join(name(&custody.erasures().hash("4711")));
        fs::write(&file, "{").unwrap();
        custody.affected_of("4711").unwrap_err();
        custody.name_affected(&patient("4711"), Some("left")).unwrap();
        assert_eq!(word(&custody).as_deref(), Some("left"));
    }
}
