//! Which leg of a patient a person named as affected, kept apart from the journal: a journal that is rebuilt could
//! not know.
//!
//! `affected/<hash>.json` holds what was named of one patient. The hash is that of the person's erasures, so the
//! folder shows no id. The history of the journal has what was named when.

use std::io;

use gaiter_flow::patient::person::NamedLeg;
use gaiter_record::Patient;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::{Custody, CustodyFault};

/// The folder in the state folder.
pub(super) const FOLDER: &str = "affected";

/// The versions of a file's schema.
#[derive(Serialize, Deserialize)]
#[serde(tag = "schema")]
enum Versioned {
    #[serde(rename = "gaiter.affected/1")]
    V1(NamedLeg),
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
        let _change = self.changing();
        let whose = self.erasures.hash(&patient.id);
        let what = "keeping the affected leg";
        let before = super::io(what, self.affected.bytes(&whose))?;
        let named = affected.map(|word| {
            let named = NamedLeg { affected: word.to_owned(), at: Timestamp::now() };
            serde_json::to_vec_pretty(&Versioned::V1(named)).map_err(io::Error::from)
        });
        let named = super::io(what, named.transpose())?;
        let keep = |bytes: Option<&[u8]>| match bytes {
            Some(bytes) => super::io(what, self.affected.keep(&whose, bytes)),
            None => super::io(what, self.affected.remove(&whose)),
        };
        keep(named.as_deref())?;
        let noted = self.journal.affected_named(&patient.id, affected);
        if noted.is_err() {
            keep(before.as_deref())?;
        }
        Ok(noted?)
    }

    /// Which leg of a patient a person named as affected; `None` if nobody did.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn affected_of(&self, patient: &str) -> Result<Option<NamedLeg>, CustodyFault> {
        let whose = self.erasures.hash(patient);
        let named = super::io("reading the affected leg", self.affected.read(&whose))?;
        Ok(named.map(|Versioned::V1(named)| named))
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

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
        let file = custody.affected.file(&custody.erasures().hash("4711"));
        fs::write(&file, "{").unwrap();
        custody.affected_of("4711").unwrap_err();
        custody.name_affected(&patient("4711"), Some("left")).unwrap();
        assert_eq!(word(&custody).as_deref(), Some("left"));
    }
}
