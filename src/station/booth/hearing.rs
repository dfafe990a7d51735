//! What is done by what the booth says: presses, names and time open, end and call off captures, each
//! in the journal.

use std::time::Duration;

use jiff::Timestamp;
use tracing::{info, warn};

use super::NO_EXPORT;
use crate::flow::booth::{Heard, Press};
use crate::flow::capture::{Named, NamedNext};
use crate::flow::facts::Alarm;
use crate::flow::identity::ID_NOT_ALLOWED;
use crate::flow::light::Outcome;
use crate::record::{Patient, SourceKind};
use crate::station::assembly::Station;
use crate::station::error::chain;
use crate::station::event::StationEvent;
use crate::station::journal::{CaptureRow, JournalError};

/// Why a patient was not named.
#[derive(Debug, thiserror::Error)]
pub enum NameFault {
    /// The id is against the configuration's pattern or its own check digit.
    #[error("this is no patient id that patient.pattern and patient.check_digit allow")]
    NotAnId,
    /// The journal failed.
    #[error("the journal could not be written")]
    Journal(#[from] JournalError),
}

impl Station {
    /// The machine's clock since its start.
    fn machine_now(&self) -> Duration {
        self.booth.offset + self.now()
    }

    /// Takes what a port has heard. Blocks for a write to the journal.
    pub fn hear(&self, heard: &Heard) {
        let now = self.machine_now();
        let done = match heard {
            Heard::Press(Press::Short) => self.pressed(now),
            Heard::Press(Press::Long) => self.call_off().map(drop),
            Heard::Named { id, by } => match self.name_patient(id, *by) {
                Ok(_) => Ok(()),
                Err(NameFault::NotAnId) => {
                    warn!(event = "finding", code = ID_NOT_ALLOWED);
                    self.booth.inner().last = Some((Outcome::NeedsPerson, self.now()));
                    Ok(())
                }
                Err(NameFault::Journal(error)) => Err(error),
            },
        };
        if let Err(error) = done {
            self.mind(&error);
            warn!(event = "journal-failed", error = chain(&error));
        }
    }

    fn pressed(&self, now: Duration) -> Result<(), JournalError> {
        let mut inner = self.booth.inner();
        let number = inner.next_number;
        inner.next_number += 1;
        (inner.missed, inner.last) = (false, None);
        let capture = inner.captures.pressed(number, now).clone();
        let has_patient = capture.patient.is_some();
        let (at, boot) = (Timestamp::now(), self.booth.boot.clone());
        let journaled = self.custody.journal().captured(&CaptureRow { capture, at, boot });
        drop(inner);
        self.booth.looks.iter().for_each(|look| look.notify_one());
        info!(event = "pressed", capture = number, has_patient);
        self.observer.tell(StationEvent::Pressed { capture: number });
        journaled
    }

    /// Somebody names the patient of the next scan. Blocks.
    ///
    /// # Errors
    /// See [`NameFault`].
    pub fn name_patient(&self, id: &str, by: SourceKind) -> Result<NamedNext, NameFault> {
        let Patient { id, .. } = self.identity.patient(id, by).ok_or(NameFault::NotAnId)?;
        let now = self.machine_now();
        let mut inner = self.booth.inner();
        let number = inner.next_number;
        let next = inner.captures.named(Named { id, by }, number, now);
        let (journal, boot) = (self.custody.journal(), &self.booth.boot);
        match &next {
            NamedNext::Waits { .. } => {
                if let Some(next) = inner.captures.next() {
                    journal.named_next(next, boot)?;
                }
            }
            NamedNext::Opened(capture) | NamedNext::Prolonged(capture) => {
                inner.next_number = inner.next_number.max(capture.number + 1);
                let (capture, at, boot) = (capture.clone(), Timestamp::now(), boot.clone());
                journal.captured(&CaptureRow { capture, at, boot })?;
                self.booth.looks.iter().for_each(|look| look.notify_one());
            }
        }
        info!(event = "patient-named", by = ?by);
        Ok(next)
    }

    /// A person calls off what waits; says whether anything did. Blocks.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn call_off(&self) -> Result<bool, JournalError> {
        let mut inner = self.booth.inner();
        let called_off = inner.captures.call_off();
        let any = called_off.name || !called_off.captures.is_empty() || inner.missed;
        (inner.missed, inner.last) = (false, None);
        self.clear_missed();
        if any {
            self.custody.journal().called_off(&called_off)?;
            info!(event = "called-off", captures = called_off.captures.len());
        }
        Ok(any)
    }

    /// The port of a button is open, or is not any more: presses may go unheard.
    pub fn port(&self, name: &'static str, is_open: bool) {
        let now = self.machine_now();
        let mut inner = self.booth.inner();
        match is_open {
            true => inner.away.remove(name),
            false => inner.away.insert(name),
        };
        match inner.away.is_empty() {
            true => inner.captures.hears(now),
            false => inner.captures.deaf(),
        }
    }

    /// Time has passed. Blocks where something expires.
    pub(super) fn pass(&self) -> Result<(), JournalError> {
        let now = self.machine_now();
        let mut inner = self.booth.inner();
        let coming: Vec<Duration> = inner.coming.values().flatten().copied().collect();
        let passed = inner.captures.pass(now, &coming);
        if !inner.missed && inner.captures.is_armed() {
            self.clear_missed();
        }
        let journal = self.custody.journal();
        if !passed.expired.is_empty() || passed.name_expired {
            inner.missed |= !passed.expired.is_empty();
            journal.expired(&passed.expired, passed.name_expired)?;
            for capture in &passed.expired {
                warn!(event = "no-export", capture);
                self.observer.tell(StationEvent::NoExport { capture: *capture });
            }
            if passed.name_expired {
                warn!(event = "patient-name-expired");
            }
        }
        if inner.missed {
            let message = "no export came after the last press of the button".to_owned();
            self.board.note(|facts| {
                let alarm = Alarm { message, since: Timestamp::now() };
                facts.alarms.entry(NO_EXPORT).or_insert(alarm);
            });
        }
        if passed.over.is_empty() { Ok(()) } else { journal.captures_over(&passed.over) }
    }

    fn clear_missed(&self) {
        self.board.note(|facts| {
            facts.alarms.remove(NO_EXPORT);
        });
    }
}
