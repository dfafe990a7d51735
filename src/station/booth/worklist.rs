//! The worklist of a hospital system as the booth has it: in memory only, and only for its day.
//!
//! A worker asks the server on a thread of its own. Nothing waits for it: while the server is away or slow, the last
//! answer of the day holds, and whoever is not on it is named as without a list. [`gaiter_flow::worklist`] decides
//! whom an entry or a code chooses; that is then a word at the booth.

mod ask;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use gaiter_flow::cause::Cause;
use gaiter_flow::facts::WorklistFacts;
use gaiter_flow::round::{Named, NamedNext};
use gaiter_flow::worklist::{Worklist, WorklistChoice, WorklistEntry};
use gaiter_record::{ImagingRequest, Patient, SourceKind};
use jiff::civil::Date;
use jiff::{Timestamp, Zoned};
use tokio::task::JoinError;
use tokio::time::sleep;
use tracing::{info, warn};

use super::{Booth, NameFault};
use crate::config::WorklistConfig;
use crate::station::core::Core;
use crate::station::runtime::{Heartbeat, Stop};
use crate::station::share::stall::{DEADLINE, patiently};
pub use ask::{WorklistFault, ask};

/// How soon after an answer the server is asked again because a page was opened.
const AGAIN: Duration = Duration::from_secs(5);

/// How often the worker looks whether a page asks, and whether the day is over.
const LOOK: Duration = Duration::from_secs(1);

/// What the booth has of the worklist.
#[derive(Debug, Default)]
pub(super) struct BoothWorklist {
    list: Mutex<Option<Worklist>>,
    /// A page was opened: its reader wants a new answer.
    is_wanted: AtomicBool,
}

impl BoothWorklist {
    fn list(&self) -> MutexGuard<'_, Option<Worklist>> {
        self.list.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The day on the station's clock, in the zone of the machine.
fn today() -> Date {
    Zoned::now().date()
}

/// Asks for the worklist until asked to stop.
///
/// # Errors
/// If the question panicked.
pub async fn worker(
    booth: Arc<Booth>,
    config: WorklistConfig,
    beat: Heartbeat,
    mut stop: Stop,
) -> Result<(), JoinError> {
    let config = Arc::new(config);
    booth.core().board.note(|facts| facts.worklist = Some(WorklistFacts::new(Timestamp::now())));
    let alive = || {
        beat.beat();
        booth.end_worklist(today());
    };
    while !stop.is_requested() {
        let (theirs, day) = (Arc::clone(&config), today());
        let hangs = || note_fault(booth.core(), Cause::known("no-answer", []));
        let answered =
            patiently(DEADLINE, &mut stop, move |_| ask(&theirs, day), alive, hangs).await?;
        match answered {
            Some(Ok(answer)) => booth.note_worklist(answer, &config, day),
            Some(Err(fault)) => note_fault(booth.core(), fault.cause()),
            None => break,
        }
        let since = booth.core().now();
        let waited = || booth.core().now().saturating_sub(since);
        let is_due = || waited() >= config.every || (waited() >= AGAIN && booth.takes_wish());
        while !is_due() {
            alive();
            tokio::select! {
                () = stop.requested() => return Ok(()),
                () = sleep(LOOK) => {}
            }
        }
    }
    Ok(())
}

/// Notes that there was no answer. Logged once for each outage.
fn note_fault(core: &Core, why: Cause) {
    let was_sound = core.board.note(|facts| {
        let worklist = facts.worklist.as_mut()?;
        let was_sound = worklist.fault.is_none();
        worklist.note(Some(why.clone()), Timestamp::now());
        Some(was_sound)
    });
    if was_sound == Some(true) {
        warn!(event = "worklist-out-of-reach", error = why.to_string());
    }
}

impl Booth {
    /// Takes an answer of the server for a day.
    fn note_worklist(&self, answer: Vec<WorklistEntry>, config: &WorklistConfig, day: Date) {
        let core = self.core();
        let is_id = |text: &str| core.identity.patient(text, SourceKind::Operator).is_some();
        let list = Worklist::new(answer, &config.filter, day, is_id);
        let (entries, left_out) = (list.entries(day).len(), list.left_out());
        let has_changed = self.replace_worklist(Some(list));
        let was_sound = core.board.note(|facts| {
            let worklist = facts.worklist.as_mut()?;
            let was_sound = worklist.fault.is_none() && worklist.answered.is_some();
            worklist.note(None, Timestamp::now());
            (worklist.entries, worklist.left_out) = (entries, left_out);
            worklist.edition += u64::from(has_changed);
            Some(was_sound)
        });
        if was_sound == Some(false) {
            info!(event = "worklist-in-reach", count = entries);
        }
    }

    /// Forgets the list once its day is over.
    fn end_worklist(&self, today: Date) {
        if self.worklist.list().as_ref().is_none_or(|list| !list.is_over(today)) {
            return;
        }
        self.replace_worklist(None);
        self.core().board.note(|facts| {
            if let Some(worklist) = &mut facts.worklist {
                (worklist.entries, worklist.left_out) = (0, 0);
                worklist.edition += 1;
            }
        });
    }

    /// Returns whether it is another list than before.
    fn replace_worklist(&self, new: Option<Worklist>) -> bool {
        let mut list = self.worklist.list();
        let has_changed = *list != new;
        *list = new;
        has_changed
    }

    /// Today's entries, for a reader who may know whom they name.
    pub fn listed(&self) -> Vec<WorklistEntry> {
        let list = self.worklist.list();
        list.as_ref().map_or_else(Vec::new, |list| list.entries(today()).to_vec())
    }

    /// Asks for a new answer soon.
    pub fn wish_worklist(&self) {
        self.worklist.is_wanted.store(true, Ordering::Relaxed);
    }

    fn takes_wish(&self) -> bool {
        self.worklist.is_wanted.swap(false, Ordering::Relaxed)
    }

    /// The patient of a name as a source gave it, with the request that it answers; `None` if it names nobody.
    pub(super) fn identified(&self, text: &str, by: SourceKind) -> Option<Named> {
        let patient = self.core().identity.patient(text, by).map(|Patient { id, .. }| id);
        let list = self.worklist.list();
        let (Some(list), today) = (list.as_ref(), today()) else {
            return patient.map(|id| Named::new(id, by));
        };
        let answering = |id: String, request: Option<&ImagingRequest>| Named {
            request: request.cloned(),
            ..Named::new(id, by)
        };
        match by {
            SourceKind::Reader => match list.chosen_by(text, patient.is_some(), today) {
                WorklistChoice::Patient { id, request } => Some(answering(id.to_owned(), request)),
                WorklistChoice::NotListed => patient.map(|id| Named::new(id, by)),
                WorklistChoice::Unclear => {
                    warn!(event = "worklist-code-unclear");
                    None
                }
            },
            SourceKind::Operator => patient.map(|id| {
                let request = list.request_of(&id, today);
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
        let named = Named { request, ..Named::new(patient, SourceKind::Operator) };
        self.name_certainly(named, replaces)
    }
}
