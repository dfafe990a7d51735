//! What happens to captures when their exports are taken, measured or refused.

use std::time::Duration;

use super::{Appeared, Capture, CaptureState, Captures, Doubt, Judged, Named, Opener, ids};

/// A capture whose export was taken but is not measured yet, for its patient or, if it is held, for a
/// preview: the export may still be refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Measuring {
    pub(super) capture: Capture,
    /// After this time no other export of it is expected, whatever the result.
    pub(super) until: Duration,
}

impl Captures {
    /// The state after a start, given the captures whose exports were taken and are not known to be
    /// measured.
    pub fn with_measuring(mut self, taken: Vec<Capture>, now: Duration) -> Captures {
        let late = self.rules.late;
        let may_come = |capture: &Capture| now <= capture.until + late;
        // Presses and names since then may have been lost with the previous run.
        let doubted = |mut capture: Capture| {
            capture.doubt.get_or_insert(Doubt::Unheard);
            capture
        };
        let taken = taken.into_iter().filter(may_come).map(doubted);
        self.measuring = taken.map(|capture| self.measuring_since(capture, now)).collect();
        self
    }

    /// The numbers of the captures whose exports were taken but not measured: a refusal opens them
    /// again. A capture that is no longer among them was given up, or is no longer waited for.
    pub fn measuring(&self) -> impl Iterator<Item = i64> {
        self.measuring.iter().map(|known| known.capture.number)
    }

    fn measuring_since(&self, capture: Capture, now: Duration) -> Measuring {
        Measuring { capture, until: now + self.rules.awaited() }
    }

    /// The export was taken: the capture that it answered stops waiting, and is remembered until it is
    /// measured.
    pub fn answer(&mut self, judged: &Judged, now: Duration) {
        let (answered, in_doubt, candidates) = match judged {
            Judged::Unpressed => return,
            Judged::Of(capture) => (Some(capture.number), &[][..], &[][..]),
            Judged::Held { answered, doubtful, candidates, .. } => {
                (*answered, doubtful.as_slice(), candidates.as_slice())
            }
        };
        let is_answered = |capture: &mut Capture| Some(capture.number) == answered;
        for mut capture in self.waiting.extract_if(.., is_answered).collect::<Vec<_>>() {
            candidates.iter().for_each(|named| capture.may_also_be(named));
            self.measuring.push(self.measuring_since(capture, now));
        }
        for capture in self.waiting.iter_mut().filter(|c| in_doubt.contains(&c.number)) {
            capture.doubt = Some(Doubt::Shared);
            candidates.iter().for_each(|named| capture.may_also_be(named));
        }
    }

    /// The numbers of the captures that end when the export of this one is measured: those of refused
    /// scans of the same patient.
    pub fn closed_by(&self, number: i64) -> Vec<i64> {
        let measured = self.measuring.iter().find(|known| known.capture.number == number);
        let patient = measured.and_then(|known| known.capture.patient.as_ref());
        let is_closed = |capture: &&Capture| {
            let is_theirs = patient.is_some_and(|patient| capture.is_of(&patient.id));
            capture.is_refused && is_theirs && capture.number < number
        };
        self.waiting.iter().filter(is_closed).map(|capture| capture.number).collect()
    }

    /// The export of the capture with this number was measured: nothing more is expected of it, nor of
    /// those that it closes.
    pub fn measured(&mut self, number: i64) {
        let closed = self.closed_by(number);
        self.waiting.retain(|capture| !closed.contains(&capture.number));
        self.measuring.retain(|known| known.capture.number != number);
    }

    /// The export that answered the capture with this number was refused: another is expected, for the
    /// same time again. `None` if the capture was given up, or its scan was taken too long ago.
    pub fn refused(&mut self, number: i64, now: Duration) -> Option<&Capture> {
        let is_it = |known: &mut Measuring| known.capture.number == number;
        let Measuring { capture, .. } = self.measuring.extract_if(.., is_it).last()?;
        let lasts = match capture.by {
            Opener::Press => self.rules.window,
            Opener::Name => self.rules.name_lasts,
        };
        let (state, until) = (CaptureState::Open, now + lasts);
        // A press that may have been missed since then puts it in doubt, like the waiting captures.
        let unheard =
            (capture.by == Opener::Press && self.is_in_doubt(now)).then_some(Doubt::Unheard);
        let doubt = capture.doubt.or(unheard);
        let place = self.waiting.partition_point(|known| known.number < capture.number);
        self.waiting.insert(place, Capture { state, until, is_refused: true, doubt, ..capture });
        self.waiting.get(place)
    }

    /// The capture of exactly these patients whose export is being measured, if an export that appeared
    /// then was written after it opened.
    pub(super) fn measuring_of(&self, whose: &[Named], export: Appeared) -> Option<&Capture> {
        let is_after = |capture: &&Capture| export.absent.is_some_and(|at| at >= capture.opened);
        let measuring = self.measuring.iter().map(|known| &known.capture).filter(is_after);
        measuring.filter(|capture| capture.doubt.is_none()).find(|capture| capture.is_of_all(whose))
    }

    /// The captures whose exports are being measured and that name a patient other than these, or
    /// nobody: if one of them is refused, an export that arrives now may be another one of it.
    pub(super) fn measured_for_others(&self, all: &[&Capture], export: Appeared) -> Vec<&Capture> {
        let of_all: Vec<_> = all.iter().flat_map(|capture| ids(capture)).collect();
        let is_others = |capture: &&Capture| {
            capture.opened < export.seen && ids(capture).iter().any(|id| !of_all.contains(id))
        };
        self.measuring.iter().map(|known| &known.capture).filter(is_others).collect()
    }
}
