//! The worklist of a hospital system as the booth has it: in memory only, and only for its day.
//!
//! A worker asks the server on a thread of its own. Nothing waits for it: while the server is away or slow, the last
//! answer of the day holds, and whoever is not on it is named as without a list. What kind of accession numbers the
//! hospital has is in the journal, too. [`gaiter_flow::worklist`] decides whom an entry or a code chooses; that is then
//! a word at the booth.

#[cfg(feature = "dicom")]
mod ask;
#[cfg(test)]
#[cfg(feature = "dicom")]
mod tests;
#[cfg(feature = "dicom")]
mod worker;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard};

use gaiter_flow::round::{Named, NamedNext};
use gaiter_flow::worklist::{
    AccessionNumbers, ListedPerson, Worklist, WorklistChoice, WorklistEntry,
};
use gaiter_record::{ImagingRequest, Patient, SourceKind};
use jiff::Zoned;
use jiff::civil::Date;
use tracing::warn;

use super::{Booth, NameFault};
#[cfg(feature = "dicom")]
use crate::config::PatientConfig;
#[cfg(feature = "dicom")]
use crate::station::core::Core;
#[cfg(feature = "dicom")]
use crate::station::journal::JournalError;
use crate::station::runtime::locked;
#[cfg(feature = "dicom")]
pub use ask::{WorklistAnswer, ask};
#[cfg(feature = "dicom")]
pub use worker::worker;

/// What the booth has of the worklist.
#[derive(Debug, Default)]
pub(super) struct BoothWorklist {
    list: Mutex<Option<Worklist>>,
    /// What is known of the hospital's accession numbers; `None` without a worklist.
    numbers: Mutex<Option<AccessionNumbers>>,
    /// A page was opened: its reader wants a new answer.
    is_wanted: AtomicBool,
}

impl BoothWorklist {
    /// A worklist that was not asked yet, with what the journal knows of its hospital.
    #[cfg(feature = "dicom")]
    pub(super) fn recall(core: &Core) -> Result<BoothWorklist, JournalError> {
        let numbers = match &core.config.patient.worklist {
            Some(_) => Some(core.custody.journal().accession_numbers(&id_rules(core))?),
            None => None,
        };
        Ok(BoothWorklist { numbers: Mutex::new(numbers), ..BoothWorklist::default() })
    }

    fn numbers(&self) -> MutexGuard<'_, Option<AccessionNumbers>> {
        locked(&self.numbers)
    }

    fn list(&self) -> MutexGuard<'_, Option<Worklist>> {
        locked(&self.list)
    }
}

/// What decides whether a text is allowed as an id. Under other rules another number may be like one.
#[cfg(feature = "dicom")]
fn id_rules(core: &Core) -> String {
    let PatientConfig { pattern, check_digit, .. } = &core.config.patient;
    format!("{check_digit:?} {pattern}")
}

/// The day on the station's clock, in the zone of the machine.
fn today() -> Date {
    Zoned::now().date()
}

impl Booth {
    /// Today's entries, for a reader who may know whom they name; `None` while the server has given no answer for
    /// today.
    pub fn listed(&self) -> Option<Vec<WorklistEntry>> {
        let (list, today) = (self.worklist.list(), today());
        let of_today = list.as_ref().filter(|list| !list.is_over(today));
        of_today.map(|list| list.entries(today).to_vec())
    }

    /// Who the worklist says a patient is, if the request that was chosen with the patient is on today's.
    pub fn listed_person(&self, patient: &Patient) -> Option<ListedPerson> {
        let request = patient.request()?;
        let list = self.worklist.list();
        list.as_ref()?.person_of(&patient.id, request, today()).cloned()
    }

    /// Asks for a new answer soon.
    pub fn wish_worklist(&self) {
        self.worklist.is_wanted.store(true, Ordering::Relaxed);
    }

    /// The patient of a name as a source gave it, with the request that it answers; `None` if it names nobody.
    pub(super) fn identified(&self, text: &str, by: SourceKind) -> Option<Named> {
        let patient = self.core().identity.patient(text, by).map(|Patient { id, .. }| id);
        let Some(numbers) = *self.worklist.numbers() else {
            return patient.map(|id| Named::new(id, by));
        };
        let (known, today) = (self.worklist.list(), today());
        let list = known.as_ref();
        let answering = |id: String, request: Option<&ImagingRequest>| Named {
            request: request.cloned(),
            ..Named::new(id, by)
        };
        match by {
            SourceKind::Reader => match numbers.chosen_by(text, patient.is_some(), list, today) {
                WorklistChoice::Patient { id, request } => Some(answering(id.to_owned(), request)),
                WorklistChoice::NotListed => patient.map(|id| Named::new(id, by)),
                WorklistChoice::Unclear => {
                    warn!(event = "worklist-code-unclear");
                    None
                }
            },
            SourceKind::Operator => patient.map(|id| {
                let request = list.and_then(|list| list.request_of(&id, today));
                answering(id, request)
            }),
            // Whoever sent it did not choose from the list.
            _ => patient.map(|id| Named::new(id, by)),
        }
    }

    /// Names the patient of the worklist's entry with this key for the next scan. `replaces` as of
    /// [`Booth::name_patient`]. Blocks.
    ///
    /// # Errors
    /// See [`NameFault`]; nothing is changed then.
    pub fn name_listed(&self, key: &str, replaces: bool) -> Result<NamedNext, NameFault> {
        let entry =
            self.worklist.list().as_ref().and_then(|list| list.entry(key, today()).cloned());
        let WorklistEntry { patient, request, .. } = entry.ok_or(NameFault::EntryGone)?;
        let by = SourceKind::Operator;
        let named = Named { request, is_chosen: true, ..Named::new(patient, by) };
        self.name_certainly(named, replaces)
    }
}
