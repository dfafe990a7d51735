//! How captures end: their exports are taken, measured or refused, a person decides, or time passes.

use std::time::Duration;

use super::{
    Appeared, Capture, CaptureMatch, CaptureState, DOUBTS_MOST, Doubt, Named, Opener, Passed,
    Rounds, Rules,
};
use crate::settle::Sights;

impl Rounds {
    /// The state after a start, with the captures whose exports were taken and are not known to be measured,
    /// or are held, if others of them may still come.
    pub fn with_taken(mut self, taken: Vec<Capture>, now: Duration) -> Rounds {
        let Rules { window, late, .. } = self.rules;
        for mut capture in taken.into_iter().filter(|capture| now <= capture.until + late) {
            if capture.state == CaptureState::Taken {
                capture.until = now + window;
            }
            // Presses and names since then may have been lost with the previous run.
            capture.doubt.get_or_insert(Doubt::Unheard);
            self.open.push(capture);
        }
        self.open.sort_by_key(|capture| capture.number);
        self
    }

    /// An export was taken. The capture that it answers waits no more, and is in question until its own scan
    /// is measured, a person has decided, or its time is over.
    pub fn answer(&mut self, judged: &CaptureMatch, now: Duration) {
        match judged {
            CaptureMatch::Known => {}
            CaptureMatch::Unpressed => {
                // The press may have been forgotten, and the name that waits used.
                if self.next().is_some() {
                    self.doubt_names(Doubt::Shared);
                }
                // It was seen before their presses, and there was no rest; or it is the second content of one
                // whose first may still be refused.
                let taken = |of: &&Capture| of.state == CaptureState::Taken;
                let taken = self.open.iter().filter(taken).filter_map(|of| of.patient.clone());
                let taken: Vec<Named> = taken.collect();
                for capture in &mut self.open {
                    // Another capture of the same patient: whichever it is of, it is theirs.
                    let is_theirs = taken.iter().any(|named| capture.is_of(&named.id));
                    if !is_theirs || capture.state == CaptureState::Taken {
                        capture.doubt.get_or_insert(Doubt::Shared);
                    }
                }
            }
            CaptureMatch::Of(capture) => {
                let until = now + self.rules.window;
                for own in self.open.iter_mut().filter(|own| own.number == capture.number) {
                    (own.state, own.until) = (CaptureState::Taken, until);
                }
            }
            CaptureMatch::Held { answered, doubtful, candidates, .. } => {
                for capture in &mut self.open {
                    let is_answered = Some(capture.number) == *answered;
                    if is_answered {
                        capture.state = CaptureState::Held;
                        // Whatever else comes of its scan comes soon; that of another may take its time.
                        if doubtful.is_empty() {
                            capture.until = capture.until.min(now + self.rules.window);
                        }
                    }
                    if is_answered || doubtful.contains(&capture.number) {
                        capture.doubt.get_or_insert(Doubt::Shared);
                        candidates.iter().for_each(|named| capture.may_also_be(named));
                    }
                }
            }
        }
    }

    /// A content that appeared then was seen and is gone before it was taken. It may have been the export of
    /// each capture that may have it, and what comes for that now another's (R4).
    pub fn gone(&mut self, content: Appeared) {
        let late = self.rules.late;
        let mut may_be_awaited = false;
        for capture in self.open.iter_mut().filter(|capture| capture.may_have(content, late)) {
            capture.doubt.get_or_insert(Doubt::Shared);
            may_be_awaited = true;
        }
        // As with an export without a press: that may have been forgotten, and the name used.
        let mut names = self.names.next.iter().flat_map(|next| &next.names);
        let is_after_a_name = names.any(|name| name.at < content.seen);
        if !may_be_awaited && is_after_a_name {
            self.doubt_names(Doubt::Shared);
        }
    }

    /// The numbers of the captures that end when the export of this one is measured: those of refused
    /// scans of the same patient.
    pub fn closed_by(&self, number: i64) -> Vec<i64> {
        let measured = self.open.iter().find(|capture| capture.number == number);
        let patient = measured.and_then(|capture| capture.patient.as_ref());
        let is_closed = |capture: &&Capture| {
            let is_theirs = patient.is_some_and(|patient| capture.is_of(&patient.id));
            capture.is_refused && capture.is_waiting() && is_theirs && capture.number < number
        };
        self.open.iter().filter(is_closed).map(|capture| capture.number).collect()
    }

    /// The export of the capture with this number was measured: nothing more is expected of it, nor of
    /// those that it closes. Of a held export it is not known whose it is, so its capture stays in question.
    pub fn measured(&mut self, number: i64) {
        let closed = self.closed_by(number);
        self.open.retain(|capture| {
            let is_refused = capture.is_refused && capture.is_waiting();
            let is_own = capture.state == CaptureState::Taken || is_refused;
            let is_measured = capture.number == number && is_own;
            !is_measured && !closed.contains(&capture.number)
        });
    }

    /// The export that answered the capture with this number was refused: another is expected, for the
    /// same time again. `None` if the capture was given up, or its scan was taken too long ago.
    pub fn refused(&mut self, number: i64, now: Duration) -> Option<&Capture> {
        let rules = self.rules;
        let is_in_doubt = self.is_in_doubt(now);
        let is_it = |capture: &&mut Capture| capture.number == number && !capture.is_waiting();
        let capture = self.open.iter_mut().find(is_it)?;
        let until = now + rules.lasts(capture.by);
        (capture.state, capture.until, capture.is_refused) = (CaptureState::Open, until, true);
        if is_in_doubt && capture.by == Opener::Press {
            // A press that may have been missed since then puts it in doubt, like the waiting captures.
            capture.doubt.get_or_insert(Doubt::Unheard);
        }
        Some(capture)
    }

    /// A person decided that a scan, which was judged so, belongs to this patient. It answers the capture of
    /// theirs that was in question for it, whose number is returned: that ends once the scan is measured.
    /// A capture of somebody else that it seemed to answer waits for its own again. Whatever else waits for
    /// this patient is in doubt.
    pub fn decided(&mut self, judged: &CaptureMatch, patient: &str, now: Duration) -> Option<i64> {
        let (seemed, doubtful) = match judged {
            CaptureMatch::Of(capture) => (Some(capture.number), &[][..]),
            CaptureMatch::Held { answered, doubtful, .. } => (*answered, doubtful.as_slice()),
            CaptureMatch::Unpressed | CaptureMatch::Known => (None, &[][..]),
        };
        let is_theirs = |capture: &Capture| match &capture.patient {
            Some(own) => own.id == patient,
            None => capture.others.iter().any(|other| other.id == patient),
        };
        let in_question = seemed.into_iter().chain(doubtful.iter().copied());
        let answered = in_question.into_iter().find(|number| {
            self.open.iter().any(|capture| capture.number == *number && is_theirs(capture))
        });
        for capture in &mut self.open {
            if is_theirs(capture) {
                capture.doubt.get_or_insert(Doubt::Shared);
            }
            if Some(capture.number) == answered {
                (capture.state, capture.until) = (CaptureState::Taken, now + self.rules.window);
            } else if Some(capture.number) == seemed && !capture.is_waiting() {
                capture.state = CaptureState::Open;
            }
        }
        if let Some(next) = &mut self.names.next
            && next.names.iter().any(|name| name.named.id == patient)
        {
            next.doubt.get_or_insert(Doubt::Shared);
        }
        self.missed.retain(|named| named.id != patient);
        if self.decided.len() < DOUBTS_MOST && self.decided.iter().all(|id| id != patient) {
            self.decided.push(patient.to_owned());
        }
        self.miss_other_candidates(answered);
        // No card is for its press any more; an order may still be.
        let decided = self.open.iter().find(|capture| Some(capture.number) == answered);
        for press in &mut self.names.unsure {
            press.is_unnamed &= decided.is_none_or(|capture| capture.opened != press.at);
        }
        answered
    }

    /// The other candidates of this capture were not scanned with it and may come next, unless their names still
    /// wait or another capture may be theirs.
    fn miss_other_candidates(&mut self, number: Option<i64>) {
        let waits = |id: &str| {
            let mut open = self.open.iter().filter(|of| Some(of.number) != number);
            self.next_ids().iter().any(|next| next == id)
                || self.decided.iter().any(|decided| decided == id)
                || open.any(|of| of.named().any(|named| named.id == id))
        };
        let of = self.open.iter().filter(|capture| Some(capture.number) == number);
        let left: Vec<Named> =
            of.flat_map(Capture::named).filter(|named| !waits(&named.id)).cloned().collect();
        self.note_missed(left);
    }

    /// A person gave up a scan that was refused: no other export of its capture is expected.
    pub fn given_up(&mut self, number: i64) {
        self.open.retain(|capture| capture.number != number || !capture.is_refused);
    }

    /// The capture of exactly these patients whose export is being measured, if an export that appeared
    /// then was written after it opened.
    pub(super) fn measuring_of(&self, whose: &[Named], export: Appeared) -> Option<&Capture> {
        let is_it = |capture: &&Capture| {
            capture.state == CaptureState::Taken
                && capture.doubt.is_none()
                && export.absent.is_some_and(|at| at >= capture.opened)
                && capture.is_of_all(whose)
        };
        self.open.iter().find(is_it)
    }

    /// Time has passed, and these are the sights of all export folders. A capture whose export may be
    /// among the files that have not settled does not expire. A capture whose export may be in a folder
    /// that was not looked at since then expires, but is not over.
    pub fn pass(&mut self, now: Duration, sights: &[Sights]) -> Passed {
        let mut passed = Passed { name_expired: self.drop_old_names(now), ..Passed::default() };
        for capture in self.open.iter_mut().filter(|capture| capture.is_open()) {
            let is_in_time =
                |file: &Appeared| capture.opened < file.seen && file.seen <= capture.until;
            let mut coming = sights.iter().flat_map(|folder| &folder.coming);
            if now > capture.until && !coming.any(is_in_time) {
                capture.state = CaptureState::Expired;
                // A refused one raises no alarm: the refusal was already reported.
                passed.expired.extend((!capture.is_refused).then_some(capture.number));
            }
        }
        let late = self.rules.late;
        let is_over = |capture: &mut Capture| {
            let end = capture.until + late;
            let was_looked_at = |folder: &Sights| folder.looked.is_some_and(|looked| looked > end);
            let mut files = sights.iter().flat_map(|at| at.coming.iter().chain(&at.beside));
            let may_come = |file: &Appeared| capture.may_have(*file, late);
            let is_past = now > end && !capture.is_open();
            is_past
                && (!capture.is_waiting()
                    || (sights.iter().all(was_looked_at) && !files.any(may_come)))
        };
        let over: Vec<Capture> = self.open.extract_if(.., is_over).collect();
        // Their patients may still be there.
        self.note_missed(over.iter().flat_map(Capture::named).cloned());
        passed.over = over.iter().filter(|of| of.is_waiting()).map(|of| of.number).collect();
        passed
    }
}
