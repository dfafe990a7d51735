//! What is done by what the booth says: presses, names and time open, end and call off captures, each
//! in the journal.

use jiff::Timestamp;
use serde_json::{Value, json};
use tracing::{info, warn};

use super::{Inner, NO_EXPORT};
use crate::flow::booth::{Heard, Press};
use crate::flow::capture::{Capture, Captures, Doubt, Named, NamedNext};
use crate::flow::facts::Alarm;
use crate::flow::identity::ID_NOT_ALLOWED;
use crate::flow::light::Outcome;
use crate::flow::order_habit::{ORDERS_MOST, OrderCame};
use crate::flow::{Appeared, ScanId};
use crate::record::{Patient, SourceKind};
use crate::station::assembly::Station;
use crate::station::error::chain;
use crate::station::event::StationEvent;
use crate::station::journal::{BoothChange, Event, JournalError};

/// Why a patient was not named.
#[derive(Debug, thiserror::Error)]
pub enum NameFault {
    /// The id is against the configuration's pattern or its own check digit.
    #[error("this is no patient id that patient.pattern and patient.check_digit allow")]
    NotAnId,
    /// Another patient is named and was not scanned, and is not to be replaced.
    #[error("another patient is named and was not scanned")]
    AnotherNamed,
    /// The journal failed.
    #[error("the journal could not be written")]
    Journal(#[from] JournalError),
}

impl Station {
    /// Takes what a port has heard; says whether it did, for where the journal fails nothing has
    /// happened. Blocks for a write to the journal.
    pub fn hear(&self, heard: &Heard) -> bool {
        let done = match heard {
            Heard::Press(Press::Short) => self.pressed(),
            Heard::Press(Press::Long) => self.call_off().map(drop),
            Heard::Named { id, by } => self.heard_name(id, *by, None),
            Heard::Doubtful { id, doubt } => self.heard_name(id, SourceKind::Order, Some(*doubt)),
            Heard::Unread { by } => self.unread(*by),
        };
        if let Err(error) = done {
            self.check_corruption(&error);
            warn!(event = "journal-failed", error = chain(&error));
            return false;
        }
        true
    }

    fn heard_name(
        &self,
        id: &str,
        by: SourceKind,
        doubt: Option<Doubt>,
    ) -> Result<(), JournalError> {
        let Some(Patient { id, .. }) = self.identity.patient(id, by) else {
            warn!(event = "finding", code = ID_NOT_ALLOWED);
            self.booth.inner().last = Some((Outcome::NeedsPerson, self.now()));
            return self.unread(by);
        };
        let (mut inner, now) = (self.booth.inner(), self.now());
        if inner.captures.is_crowded(&id) {
            drop(inner);
            warn!(event = "names-too-many");
            return self.unread(by);
        }
        let named = self.name(&mut inner, Named { id, by }, doubt);
        // A name that could not be kept was said all the same: the patient named before may have left.
        named.map(drop).inspect_err(|_| inner.captures.unread(now))
    }

    /// Writes a change of the captures down; it holds from then on. Where the journal fails nothing
    /// has happened.
    fn change_booth(
        &self,
        inner: &mut Inner,
        after: Captures,
        ended_as: &'static str,
        event: Option<(Event, Value)>,
    ) -> Result<(), JournalError> {
        let (before, boot) = (&inner.captures, self.booth.boot());
        let change = BoothChange { before, after: &after, boot, ended_as, event };
        self.custody.journal().booth_changed(&change)?;
        inner.captures = after;
        Ok(())
    }

    fn look_at_folders(&self) {
        self.booth.looks.iter().for_each(|look| look.notify_one());
    }

    fn pressed(&self) -> Result<(), JournalError> {
        let now = self.now();
        let mut inner = self.booth.inner();
        let number = inner.next_number;
        let mut after = inner.captures.clone();
        let capture = after.pressed(number, now);
        let patient = capture.patient.as_ref();
        let detail = json!({
            "capture": capture.number,
            "patient": patient.map_or("", |named| &named.id),
            "by": patient.map(|named| named.by),
        });
        let kept = self.change_booth(&mut inner, after, "over", Some((Event::Pressed, detail)));
        if kept.is_err() {
            inner.captures.missed_press(now);
            return kept;
        }
        inner.next_number += 1;
        (inner.missed, inner.last) = (false, None);
        drop(inner);
        self.look_at_folders();
        let (number, has_patient) = (capture.number, patient.is_some());
        info!(event = "pressed", capture = number, has_patient);
        self.observer.tell(StationEvent::Pressed { capture: number });
        Ok(())
    }

    /// Somebody names the patient of the next scan; `replaces` says whether another who is named and was
    /// not scanned is so no more. Blocks.
    ///
    /// # Errors
    /// See [`NameFault`]; nothing was changed then.
    pub fn name_patient(
        &self,
        id: &str,
        by: SourceKind,
        replaces: bool,
    ) -> Result<NamedNext, NameFault> {
        let Patient { id, .. } = self.identity.patient(id, by).ok_or(NameFault::NotAnId)?;
        let mut inner = self.booth.inner();
        if !replaces && inner.captures.is_another_named(&id) {
            return Err(NameFault::AnotherNamed);
        }
        Ok(self.name(&mut inner, Named { id, by }, None)?)
    }

    /// Names the patient of the next scan, with the reason if that is in doubt.
    fn name(
        &self,
        inner: &mut Inner,
        named: Named,
        doubt: Option<Doubt>,
    ) -> Result<NamedNext, JournalError> {
        let (now, by) = (self.now(), named.by);
        let number = inner.next_number;
        let sights = self.booth.glance().sights.clone();
        let coming: Vec<Appeared> = sights.into_iter().flat_map(|at| at.coming).collect();
        let mut after = inner.captures.clone();
        let came = match after.has_unnamed_press(now) {
            true => OrderCame::AfterPress,
            false => OrderCame::BeforePress,
        };
        let late = came == OrderCame::AfterPress;
        let mut detail = json!({ "patient": named.id, "by": by, "after_press": late });
        if doubt.is_some() {
            detail["question"] = json!(true);
        }
        let next = match doubt {
            None => after.named(named, number, now, &coming),
            Some(doubt) => after.doubtful(named, doubt, number, now, &coming),
        };
        self.change_booth(inner, after, "given_up", Some((Event::Named, detail)))?;
        if matches!(next, NamedNext::Opened(..)) {
            inner.next_number += 1;
        }
        if by == SourceKind::Order {
            inner.orders.push(came);
            let spare = inner.orders.len().saturating_sub(ORDERS_MOST);
            inner.orders.drain(..spare);
        }
        if !matches!(next, NamedNext::Waits { .. }) {
            self.look_at_folders();
        }
        info!(event = "patient-named", by = ?by);
        Ok(next)
    }

    /// Somebody tried to name a patient, and it could not be read.
    fn unread(&self, by: SourceKind) -> Result<(), JournalError> {
        let now = self.now();
        let mut inner = self.booth.inner();
        let mut after = inner.captures.clone();
        after.unread(now);
        info!(event = "name-unread", by = ?by);
        // In memory in any case: it only makes less certain.
        let kept = self.change_booth(&mut inner, after.clone(), "over", None);
        inner.captures = after;
        kept
    }

    /// The scan that answered a capture was measured: no other export of it is awaited.
    ///
    /// # Errors
    /// See [`JournalError`]; then it counts as being measured for a while longer.
    pub fn scan_measured(&self, scan: &ScanId) -> Result<(), JournalError> {
        let answered = self.custody.journal().capture_answered_by(scan)?;
        let Some(Capture { number, .. }) = answered else { return Ok(()) };
        let mut inner = self.booth.inner();
        let closed = inner.captures.closed_by(number);
        if !closed.is_empty() {
            self.custody.journal().captures_closed(&closed)?;
        }
        inner.captures.measured(number);
        Ok(())
    }

    /// The scan that answered a capture was refused: another export is awaited.
    ///
    /// # Errors
    /// See [`JournalError`]; then the capture stays answered.
    pub fn reopen_capture(&self, scan: &ScanId) -> Result<(), JournalError> {
        let mut inner = self.booth.inner();
        let answered = self.custody.journal().capture_answered_by(scan)?;
        let Some(Capture { number, .. }) = answered else { return Ok(()) };
        let mut after = inner.captures.clone();
        if after.refused(number, self.now()).is_some() {
            self.change_booth(&mut inner, after, "over", None)?;
            info!(event = "capture-reopened", capture = number);
        }
        Ok(())
    }

    /// A person gives up what waits; says whether anything did. Blocks.
    ///
    /// # Errors
    /// See [`JournalError`]; everything waits as before then.
    pub fn call_off(&self) -> Result<bool, JournalError> {
        let mut inner = self.booth.inner();
        let mut after = inner.captures.clone();
        let called_off = after.call_off();
        let any = called_off.name || !called_off.captures.is_empty() || inner.missed;
        if any {
            let detail = json!({ "captures": called_off.captures, "name": called_off.name });
            let event = Some((Event::CalledOff, detail));
            self.change_booth(&mut inner, after, "called_off", event)?;
            info!(event = "called-off", captures = called_off.captures.len());
        }
        (inner.missed, inner.last) = (false, None);
        self.clear_missed();
        Ok(any)
    }

    /// The port of a button is open, or is not any more: presses may go unheard. Blocks.
    pub fn port(&self, name: &'static str, is_open: bool) {
        let now = self.now();
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
        let now = self.now();
        let mut inner = self.booth.inner();
        let mut after = inner.captures.clone();
        let passed = after.pass(now, &self.booth.glance().sights);
        if !inner.missed && after.is_armed() {
            self.clear_missed();
        }
        if after != inner.captures {
            let has_expired = !passed.expired.is_empty() || passed.name_expired;
            let detail = json!({ "captures": passed.expired, "name": passed.name_expired });
            let event = has_expired.then_some((Event::Expired, detail));
            self.change_booth(&mut inner, after, "over", event)?;
        }
        inner.missed |= !passed.expired.is_empty();
        for capture in &passed.expired {
            warn!(event = "no-export", capture);
            self.observer.tell(StationEvent::NoExport { capture: *capture });
        }
        if passed.name_expired {
            warn!(event = "patient-name-expired");
        }
        if inner.missed {
            let message = "no export came after the last press of the button".to_owned();
            self.board.note(|facts| {
                let alarm = Alarm { message, since: Timestamp::now() };
                facts.alarms.entry(NO_EXPORT).or_insert(alarm);
            });
        }
        Ok(())
    }

    fn clear_missed(&self) {
        self.board.note(|facts| {
            facts.alarms.remove(NO_EXPORT);
        });
    }
}
