//! Handles the booth's input. Presses, names and the passing of time open, end and call off captures, and
//! every change goes into the journal.

use std::time::Duration;

use gaiter_flow::booth::{PortEvent, Press};
use gaiter_flow::complaint::ComplaintFigures;
use gaiter_flow::health::EXPORT_PASSED_OVER;
use gaiter_flow::light::{Last, NO_EXPORT};
use gaiter_flow::orders::ORDERS_MOST;
use gaiter_flow::patient::identity::ID_NOT_ALLOWED;
use gaiter_flow::round::{Capture, CaptureMatch, Doubt, Named, NamedNext, Rounds};
use gaiter_flow::{Appeared, ScanId};
use gaiter_record::SourceKind;
use serde_json::{Value, json};
use tracing::{info, warn};

use super::{Booth, Inner};
use crate::station::event::StationEvent;
use crate::station::journal::{BoothChange, Event, JournalError};
use crate::station::runtime::locked;

/// Why a patient was not named.
#[derive(Debug, thiserror::Error)]
pub enum NameFault {
    /// The id does not match the configured pattern or its check digit is wrong.
    #[error("this is not a patient id that patient.pattern and patient.check_digit allow")]
    NotAnId,
    /// Another patient is named and not scanned yet, and must not be replaced.
    #[error("another patient is named and not scanned yet")]
    AnotherNamed,
    /// The worklist has no such entry any more.
    #[error("the entry is not on the worklist any more")]
    EntryGone,
    #[error("the journal could not be written")]
    Journal(#[from] JournalError),
}

impl Booth {
    /// Handles what a port has received. Returns `false` if the journal failed; then nothing has happened.
    /// Blocks for a write to the journal.
    pub fn receive(&self, event: &PortEvent) -> bool {
        let done = match event {
            PortEvent::Press(Press::Short) => self.pressed(),
            // The operator does not see that what was called off still waits.
            PortEvent::Press(Press::Long) => {
                self.call_off().map(drop).inspect_err(|_| self.missed_anything())
            }
            PortEvent::Named { id, by } => self.received_name(id, *by, None, Some(self.core.now())),
            PortEvent::Ordered { id, doubt, absent } => {
                self.received_name(id, SourceKind::Order, *doubt, *absent)
            }
            PortEvent::Unread => self.unread(SourceKind::Reader, Some(self.core.now())),
            PortEvent::UnreadOrder { absent } => self.unread(SourceKind::Order, *absent),
        };
        self.core.logged(done).is_some()
    }

    fn received_name(
        &self,
        id: &str,
        by: SourceKind,
        doubt: Option<Doubt>,
        absent: Option<Duration>,
    ) -> Result<(), JournalError> {
        let Some(named) = self.identified(id, by) else {
            warn!(event = "finding", code = ID_NOT_ALLOWED);
            self.inner().last = Some((Last::NameUnread, self.core.now()));
            return self.unread(by, absent);
        };
        let mut inner = self.inner();
        if inner.captures.is_crowded(&named.id) {
            drop(inner);
            warn!(event = "names-too-many");
            return self.unread(by, absent);
        }
        let named = self.name(&mut inner, named, doubt, absent);
        // The name was given even if it could not be stored: the patient named before may have left.
        named.map(drop).inspect_err(|_| inner.captures.unread(absent))
    }

    /// Writes a change of the captures to the journal and then applies it. If the journal fails,
    /// nothing has happened.
    fn change_booth(
        &self,
        inner: &mut Inner,
        after: Rounds,
        ended_as: &'static str,
        event: Option<(Event, Value)>,
    ) -> Result<(), JournalError> {
        let (before, boot) = (&inner.captures, self.core.clock.boot());
        let change = BoothChange { before, after: &after, boot, ended_as, answers: None, event };
        self.core.custody.journal().booth_changed(&change)?;
        inner.captures = after;
        Ok(())
    }

    fn pressed(&self) -> Result<(), JournalError> {
        let now = self.core.now();
        let mut inner = self.inner();
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
        self.looks.send_replace(());
        let (number, has_patient) = (capture.number, patient.is_some());
        info!(event = "pressed", capture = number, has_patient);
        self.core.observer.notify(StationEvent::Pressed);
        Ok(())
    }

    /// Names the patient of the next scan. `replaces` allows replacing another patient who is named and
    /// not scanned yet. Blocks.
    ///
    /// # Errors
    /// See [`NameFault`]; nothing is changed then.
    pub fn name_patient(
        &self,
        id: &str,
        by: SourceKind,
        replaces: bool,
    ) -> Result<NamedNext, NameFault> {
        self.name_certainly(self.identified(id, by).ok_or(NameFault::NotAnId)?, replaces)
    }

    /// The same of a patient whose id is allowed.
    pub(super) fn name_certainly(
        &self,
        named: Named,
        replaces: bool,
    ) -> Result<NamedNext, NameFault> {
        let mut inner = self.inner();
        if !replaces && inner.captures.is_another_named(&named.id) {
            return Err(NameFault::AnotherNamed);
        }
        // If the journal fails, the person sees it and enters the name again.
        Ok(self.name(&mut inner, named, None, Some(self.core.now()))?)
    }

    /// Names the patient of the next scan. `doubt` is the reason if the name is in doubt; at `absent` the name
    /// was not given yet.
    fn name(
        &self,
        inner: &mut Inner,
        named: Named,
        doubt: Option<Doubt>,
        absent: Option<Duration>,
    ) -> Result<NamedNext, JournalError> {
        let (now, by) = (self.core.now(), named.by);
        let number = inner.next_number;
        let coming: Vec<Appeared> =
            locked(&self.sights).iter().flat_map(|at| at.coming.clone()).collect();
        let mut after = inner.captures.clone();
        let late = after.has_unnamed_press(now);
        let is_overtaken = by == SourceKind::Order && after.overtaken(&named, absent);
        let doubt = doubt.or(is_overtaken.then_some(Doubt::Crossed));
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
            inner.late_orders.push(late);
            let spare = inner.late_orders.len().saturating_sub(ORDERS_MOST);
            inner.late_orders.drain(..spare);
        }
        if !matches!(next, NamedNext::Waits { .. }) {
            self.looks.send_replace(());
        }
        if matches!(inner.last, Some((Last::NameUnread, _))) {
            inner.last = None;
        }
        info!(event = "patient-named", by = ?by);
        Ok(next)
    }

    /// Notes that a patient's name was given but could not be read; at `absent` it was not given yet.
    fn unread(&self, by: SourceKind, absent: Option<Duration>) -> Result<(), JournalError> {
        let mut inner = self.inner();
        let mut after = inner.captures.clone();
        after.unread(absent);
        info!(event = "name-unread", by = ?by);
        // Applied in memory even if the journal fails: it only makes names less certain.
        let kept = self.change_booth(&mut inner, after.clone(), "over", None);
        inner.captures = after;
        kept
    }

    /// Notes that the scan that answered a capture was measured: no other export of it is expected.
    ///
    /// # Errors
    /// See [`JournalError`]; the scan then counts as being measured for a while longer.
    pub fn scan_measured(&self, scan: &ScanId) -> Result<(), JournalError> {
        let answered = self.core.custody.journal().capture_answered_by(scan)?;
        let Some(Capture { number, .. }) = answered else { return Ok(()) };
        let mut inner = self.inner();
        let closed = inner.captures.closed_by(number);
        if !closed.is_empty() {
            self.core.custody.journal().captures_closed(&closed)?;
        }
        inner.captures.measured(number);
        Ok(())
    }

    /// Notes that the scan that answered a capture was refused: another export is expected.
    ///
    /// # Errors
    /// See [`JournalError`]; the capture then stays answered.
    pub fn reopen_capture(&self, scan: &ScanId) -> Result<(), JournalError> {
        let mut inner = self.inner();
        let answered = self.core.custody.journal().capture_answered_by(scan)?;
        let Some(Capture { number, .. }) = answered else { return Ok(()) };
        let mut after = inner.captures.clone();
        if after.refused(number, self.core.now()).is_some() {
            self.change_booth(&mut inner, after, "over", None)?;
            info!(event = "capture-reopened", capture = number);
        }
        Ok(())
    }

    /// Notes that a person decided whose a scan is: its round ends once it is measured. Blocks.
    ///
    /// # Errors
    /// See [`JournalError`]; what waits continues to wait.
    pub fn decided(&self, scan: &ScanId) -> Result<(), JournalError> {
        let custody = &self.core.custody;
        // Without its intake the scan has left the station, and its round ends by time.
        let judged =
            custody.spool().intake(scan).map_or(CaptureMatch::Unpressed, |intake| intake.judged);
        let owners = custody.journal().owners(scan)?;
        let mut inner = self.inner();
        // The light shows how it ends, whatever it showed last.
        inner.in_work.insert(scan.clone(), Vec::new());
        let mut after = inner.captures.clone();
        let now = self.core.now();
        let answered = owners.iter().filter_map(|id| after.decided(&judged, id, now)).next_back();
        if after == inner.captures {
            return Ok(());
        }
        let (before, boot) = (&inner.captures, self.core.clock.boot());
        let answers = answered.map(|capture| (scan, capture));
        let change =
            BoothChange { before, after: &after, boot, ended_as: "over", answers, event: None };
        custody.journal().booth_changed(&change)?;
        inner.captures = after;
        Ok(())
    }

    /// Notes that a person gave up a scan: no other export of it is expected. Blocks.
    ///
    /// # Errors
    /// See [`JournalError`]; what waits continues to wait.
    pub fn given_up(&self, scan: &ScanId) -> Result<(), JournalError> {
        let answered = self.core.custody.journal().capture_answered_by(scan)?;
        let Some(Capture { number, .. }) = answered else { return Ok(()) };
        let mut inner = self.inner();
        let mut after = inner.captures.clone();
        after.given_up(number);
        if after == inner.captures {
            return Ok(());
        }
        self.change_booth(&mut inner, after, "given_up", None)
    }

    /// Calls off everything that waits. Returns whether anything waited. Blocks.
    ///
    /// # Errors
    /// See [`JournalError`]; everything keeps waiting as before.
    pub fn call_off(&self) -> Result<bool, JournalError> {
        let mut inner = self.inner();
        let mut after = inner.captures.clone();
        let called_off = after.call_off();
        let any = called_off.name || !called_off.captures.is_empty() || inner.missed;
        let detail = json!({ "captures": called_off.captures, "name": called_off.name });
        let event = any.then_some((Event::CalledOff, detail));
        self.change_booth(&mut inner, after, "called_off", event)?;
        let had_gone = self.core.board.note(|facts| {
            let had_gone = facts.gone() > 0;
            facts.sources.iter_mut().for_each(|source| source.gone_count = 0);
            had_gone
        });
        let any = had_gone || any;
        if any {
            info!(event = "called-off", captures = called_off.captures.len());
        }
        (inner.missed, inner.last) = (false, None);
        self.core.board.clear(NO_EXPORT);
        Ok(any)
    }

    /// Notes contents of an export folder that were seen and are gone before they were taken. The journal need
    /// not know: after a start every capture is in doubt. Blocks.
    pub fn gone(&self, contents: &[Appeared]) {
        let mut inner = self.inner();
        contents.iter().for_each(|content| inner.captures.gone(*content));
    }

    /// Notes whether a port is open. While it is closed, or settles, presses or names may be missed. Blocks.
    pub fn port(&self, name: &'static str, is_open: bool) {
        if !self.core.config.buttons().contains(name) {
            return self.missed_name(name);
        }
        let now = self.core.now();
        let mut inner = self.inner();
        match is_open {
            true => inner.away.remove(name),
            false => inner.away.insert(name),
        };
        match inner.away.is_empty() {
            true => inner.captures.receives(now),
            false => inner.captures.deaf(),
        }
    }

    /// Notes that a source of names went away, or has come back. Logged only if somebody was certain, so once
    /// until the next word at the booth. Blocks.
    pub fn missed_name(&self, source: &'static str) {
        let mut inner = self.inner();
        let before = inner.captures.clone();
        inner.captures.missed_name();
        if inner.captures != before {
            warn!(event = "name-unheard", source);
        }
    }

    /// Notes that the machine slept, that the process was stopped, or that a slow disk kept a port waiting: input of
    /// that time is in buffers and files, and arrives in any order. Blocks.
    pub fn note_sleep(&self) {
        warn!(event = "booth-slept");
        self.missed_anything();
    }

    /// Presses and names may have been missed.
    fn missed_anything(&self) {
        let now = self.core.now();
        let mut inner = self.inner();
        inner.captures.missed_press(now);
        inner.captures.missed_name();
    }

    /// Handles the passing of time. Blocks if something expires.
    pub(super) fn pass(&self) -> Result<(), JournalError> {
        let now = self.core.now();
        let mut inner = self.inner();
        let mut after = inner.captures.clone();
        let passed = after.pass(now, &locked(&self.sights));
        if !inner.missed && after.is_armed() {
            self.core.board.clear(NO_EXPORT);
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
            self.core.observer.notify(StationEvent::NoExport);
        }
        if passed.name_expired {
            warn!(event = "patient-name-expired");
        }
        if inner.missed {
            self.core.board.raise(NO_EXPORT, ComplaintFigures::default());
        }
        let opened = inner.captures.waiting().map(|capture| capture.opened).min();
        self.report_unread(opened, now);
        Ok(())
    }

    /// Raises the alarm for what came into the export folders and is not read while an export is awaited
    /// since `opened`.
    fn report_unread(&self, opened: Option<Duration>, now: Duration) {
        let board = &self.core.board;
        let counts = opened.map(|opened| board.note(|facts| facts.unread_since(opened, now)));
        match counts.unwrap_or_default() {
            none if none.is_empty() => board.clear(EXPORT_PASSED_OVER),
            counts => board.raise(EXPORT_PASSED_OVER, ComplaintFigures::default().unread(counts)),
        };
    }
}
