//! The same while no station runs: the verb takes the state folder for itself meanwhile.

use std::os::unix::fs::MetadataExt;
use std::path::PathBuf;

use gaiter_flow::Identity;
use gaiter_flow::patient::erasure::Erasure;
use gaiter_flow::patient::person::{KnownVisits, Person};

use super::erase::{self, ClearFault};
use super::found::{person, visits};
use crate::config::Config;
use crate::station::assembly::open_custody;
use crate::station::custody::{Custody, CustodyFault};
use crate::station::error::StationError;
use crate::station::journal::Event;
use crate::station::state_dir::{OwnStateDir, take_state_dir};
use crate::station::stores::Stores;
use crate::store::{RecordStore, StoreFault};

/// A station that does not run.
#[derive(Debug)]
pub struct Stopped {
    config: Config,
    identity: Identity,
    custody: Custody,
    stores: Stores,
    _own: OwnStateDir,
}

/// Why nothing was done.
#[derive(Debug, thiserror::Error)]
pub enum StoppedFault {
    /// The state folder cannot be used.
    #[error(transparent)]
    Station(#[from] StationError),
    /// No station ever ran on this state folder.
    #[error("no station has run on {}: it holds nothing of anybody", .0.display())]
    NoStation(PathBuf),
    /// Files would belong to the wrong user.
    #[error(
        "the state folder {} belongs to another user, whose station could not read what is written \
         there", .0.display()
    )]
    OtherUser(PathBuf),
    /// The state folder or the journal failed.
    #[error(transparent)]
    Custody(#[from] CustodyFault),
}

impl Stopped {
    /// Takes the state folder of a station that does not run.
    ///
    /// # Errors
    /// See [`StoppedFault`]; also if a station runs.
    pub fn take(config: Config) -> Result<Stopped, StoppedFault> {
        let state_dir = config.station.state_dir.clone();
        let Ok(found) = std::fs::metadata(state_dir.join("spool")) else {
            return Err(StoppedFault::NoStation(state_dir));
        };
        if found.uid() != rustix::process::geteuid().as_raw() {
            return Err(StoppedFault::OtherUser(state_dir));
        }
        let own = take_state_dir(&state_dir)?;
        let patient = &config.patient;
        let identity = Identity::new(
            config.scanner.file_name.clone(),
            patient.sidecar.clone(),
            &patient.pattern,
            patient.check_digit,
        )
        .map_err(StationError::from)?;
        let stores = Stores::from_config(&config);
        let (custody, _) = open_custody(&config, &stores, own.first_start)?;
        Ok(Stopped { config, identity, custody, stores, _own: own })
    }

    /// What it holds of a person.
    ///
    /// # Errors
    /// If the journal or the state folder cannot be read.
    pub fn person(&self, patient: &str) -> Result<Person, StoppedFault> {
        Ok(person(&self.config, &self.identity, &self.custody, &self.stores, patient)?)
    }

    /// What it knows of a patient whose visits are compared.
    ///
    /// # Errors
    /// If the journal or the state folder cannot be read.
    pub fn visits(&self, patient: &str) -> Result<KnownVisits, StoppedFault> {
        Ok(visits(&self.custody, patient)?)
    }

    /// Notes that a person's data was disclosed.
    ///
    /// # Errors
    /// If the journal cannot be written.
    pub fn disclosed(&self, patient: &str, by: &str) -> Result<(), StoppedFault> {
        Ok(disclosed(&self.custody, patient, by)?)
    }

    /// Erases a person, in the stores as far as they are in reach; a start of the station does the rest. Only a
    /// running station does what servers are owed: the erasure waits for that, except with `leaves_owed`.
    ///
    /// # Errors
    /// If it could not be noted: nothing is erased then.
    pub fn erase(
        &self,
        patient: &str,
        by: &str,
        leaves_owed: bool,
    ) -> Result<Option<Erasure>, StoppedFault> {
        let state_dir = &self.config.station.state_dir;
        self.custody.ask_for_erasure(patient, by, leaves_owed)?;
        erase::clear_own(&self.custody, &self.stores, state_dir);
        for store in self.stores.iter() {
            match erase::clear_store(&self.custody, store) {
                // The next start renews the head if it cannot be done now.
                Ok(_) => drop(renew_head(&self.custody, store)?),
                // It stays pending, and the answer states that.
                Err(ClearFault::Store(_)) => {}
                Err(ClearFault::Custody(fault)) => return Err(fault.into()),
            }
        }
        Ok(self.erasure(patient))
    }

    /// What has become of the erasure of a person; `None` if there is none.
    pub fn erasure(&self, patient: &str) -> Option<Erasure> {
        let erasures = self.custody.erasures();
        erasures.of(&erasures.hash(patient))
    }
}

/// Writes the head of the history in a store again if it belongs to the history before an erasure.
pub(in crate::station) fn renew_head(
    custody: &Custody,
    store: &dyn RecordStore,
) -> Result<Result<(), StoreFault>, CustodyFault> {
    let journal = custody.journal();
    if !journal.has_old_head(store.name())? {
        return Ok(Ok(()));
    }
    if let Some(head) = journal.head_line()? {
        let kept = store.keep_head(&head).and_then(|()| store.settle_head());
        if kept.is_err() {
            return Ok(kept);
        }
    }
    journal.head_renewed(store.name())?;
    Ok(Ok(()))
}

/// Notes in the history that a person's data was disclosed.
pub(in crate::station) fn disclosed(
    custody: &Custody,
    patient: &str,
    by: &str,
) -> Result<(), CustodyFault> {
    let person = custody.erasures().hash(patient);
    let detail = serde_json::json!({ "person": person, "by": by });
    Ok(custody.journal().note_of_person(Event::Disclosed, &detail)?)
}
