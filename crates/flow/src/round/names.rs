//! Who is next: how a word at the booth, an order and a failed naming change that.

use std::time::Duration;

use gaiter_record::SourceKind;
use serde::{Deserialize, Serialize};

use super::{
    Capture, CaptureState, DOUBTS_MOST, Doubt, NAMES_MOST, Named, NamedNext, Opener, Rounds,
    distinct,
};
use crate::export::writing::Appeared;
use crate::orders::OrdersWhen;

/// A name and when it was given; times as in [`Capture`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamedAt {
    pub named: Named,
    pub at: Duration,
}

/// Who may be next: one patient if that is certain.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Next {
    /// The candidates, in the order in which they were named; never empty.
    pub names: Vec<NamedAt>,
    /// How many of them have entered the booth since; it is not known which.
    pub used: usize,
    /// Why it is not certain.
    pub doubt: Option<Doubt>,
    /// The patients of orders that a word at the booth replaced: they were not scanned, and may come next.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left: Vec<Named>,
}

impl Next {
    /// One name, certain unless there is a doubt.
    pub fn one(named: Named, at: Duration, doubt: Option<Doubt>) -> Next {
        Next { names: vec![NamedAt { named, at }], used: 0, doubt, left: Vec::new() }
    }

    /// Whether it is certain who is next.
    pub fn is_certain(&self) -> bool {
        self.names.len() == 1 && self.doubt.is_none()
    }
}

/// A press without a certain name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unsure {
    pub at: Duration,
    /// Nobody was named for it.
    pub is_unnamed: bool,
}

/// Who may be next, as the journal keeps it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Names {
    /// The names that wait for a press.
    pub next: Option<Next>,
    /// The recent presses without a certain name: an order or a card may be for one of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unsure: Vec<Unsure>,
}

/// The patient of a press, the other patients it may be, and why that is not certain.
type Used = (Option<Named>, Vec<Named>, Option<Doubt>);

impl Rounds {
    /// From now on nobody is certain to be next, until the next word at the booth.
    pub(super) fn doubt_names(&mut self, doubt: Doubt) {
        self.uncertain.get_or_insert(doubt);
        if let Some(next) = &mut self.names.next {
            next.doubt.get_or_insert(doubt);
        }
    }

    /// These patients were named and not scanned: they may be there, even if another is ordered now (R2).
    pub(super) fn note_missed(&mut self, patients: impl IntoIterator<Item = Named>) {
        for named in patients {
            self.doubt_names(Doubt::Shared);
            if self.missed.len() < DOUBTS_MOST && !self.missed.contains(&named) {
                self.missed.push(named);
            }
        }
    }

    /// After a word at the booth nothing from before it makes a name uncertain.
    pub(super) fn clear_doubts(&mut self) {
        (self.uncertain, self.missed, self.decided) = (None, Vec::new(), Vec::new());
    }

    /// The ids of the patients who may be next; one if that is certain.
    pub fn next_ids(&self) -> Vec<String> {
        let names = self.next().map_or(&[][..], |next| &next.names);
        names.iter().map(|name| name.named.id.clone()).collect()
    }

    /// The ids of the patients whose exports are expected, each once.
    pub fn awaited_ids(&self) -> Vec<String> {
        let awaited = self.open.iter().filter(|of| of.is_open()).flat_map(Capture::named);
        distinct(awaited).into_iter().map(|named| named.id).collect()
    }

    /// Whether somebody is named, and it is not certain who is there: the light asks.
    pub fn asks_who(&self) -> bool {
        let is_unsure = |capture: &Capture| {
            capture.is_open() && !capture.is_unnamed() && capture.doubt.is_some()
        };
        match self.rules.by_press {
            true => self.next().is_some_and(|next| !next.is_certain()),
            false => self.open.iter().any(is_unsure),
        }
    }

    /// Whether another patient is named but not yet scanned: that name waits for a press or, without a
    /// button, for an export.
    pub fn is_another_named(&self, id: &str) -> bool {
        let awaited = if self.rules.by_press { Vec::new() } else { self.awaited_ids() };
        self.next_ids().iter().chain(&awaited).any(|named| named != id)
    }

    /// The patient of the next scan was named. `number` is the number of the capture that may be opened;
    /// `coming` are the files that are not taken yet.
    pub fn named(
        &mut self,
        named: Named,
        number: i64,
        now: Duration,
        coming: &[Appeared],
    ) -> NamedNext {
        self.drop_old_names(now);
        match (self.rules.by_press, named.by) {
            (false, _) => self.name_export(named, number, now, coming),
            (true, SourceKind::Order) => self.order(named, now),
            (true, _) => self.word(named, now),
        }
    }

    /// Somebody at the booth names who is there.
    fn word(&mut self, mut named: Named, now: Duration) -> NamedNext {
        // R3: it may be for a press that was made without a name.
        let is_crossed = self.unsure(now).any(|press| press.is_unnamed);
        if is_crossed {
            self.cross(&named);
        }
        self.clear_doubts();
        let before = self.names.next.take();
        let known = before.iter().flat_map(|next| &next.names);
        known.for_each(|name| named.keep_choice_of(&name.named));
        let is_other = |next: &Next| next.names.iter().any(|name| name.named.id != named.id);
        let replaced = before.as_ref().is_some_and(is_other);
        let mut next = Next::one(named.clone(), now, is_crossed.then_some(Doubt::Crossed));
        match before {
            Some(before) if contradicts(&before, &named) => {
                // R2: two people were named at the booth. The light asks, and one of them again is the answer.
                next.names.splice(0..0, before.names);
                next.left = before.left;
                next.doubt.get_or_insert(Doubt::Shared);
            }
            Some(before) => {
                let ordered = before.names.into_iter().map(|name| name.named);
                let ordered = ordered.filter(|named| named.by == SourceKind::Order);
                next.left = before.left.into_iter().chain(ordered).collect();
                next.left.retain(|left| left.id != named.id);
                next.left.truncate(DOUBTS_MOST);
            }
            None => {}
        }
        let in_doubt = !next.is_certain();
        self.names.next = Some(next);
        NamedNext::Waits { replaced, in_doubt }
    }

    /// An order whose patient may not be the next one: it arrived again with the same words, or others
    /// may have been named since it was sent.
    pub fn doubtful(
        &mut self,
        named: Named,
        doubt: Doubt,
        number: i64,
        now: Duration,
        coming: &[Appeared],
    ) -> NamedNext {
        let id = named.id.clone();
        let came = self.named(named, number, now, coming);
        if let NamedNext::Waits { .. } = came {
            if let Some(next) = &mut self.names.next {
                next.doubt.get_or_insert(doubt);
            }
            return NamedNext::Waits { replaced: false, in_doubt: true };
        }
        let is_theirs = |capture: &&mut Capture| {
            capture.is_waiting() && capture.patient.as_ref().is_some_and(|patient| patient.id == id)
        };
        if let Some(capture) = self.open.iter_mut().rfind(is_theirs) {
            capture.doubt.get_or_insert(doubt);
        }
        if let NamedNext::Paired(capture) = &came {
            // Its own order may still arrive.
            self.press_is_unsure(capture.opened, false);
        }
        came
    }

    /// An order is about to be applied whose file was not there yet at `absent` (`None`: not known). Each press
    /// since then may be its patient's. Returns whether there was one. If so, the order may have been for that
    /// press and not for the next; where orders come after their presses, for one before it.
    pub fn overtaken(&mut self, named: &Named, absent: Option<Duration>) -> bool {
        let is_since = |capture: &&mut Capture| {
            capture.by == Opener::Press && absent.is_none_or(|absent| capture.opened > absent)
        };
        let comes_after = self.rules.orders == OrdersWhen::AfterPress;
        let mut was_pressed = false;
        for capture in self.open.iter_mut().filter(is_since) {
            let is_theirs = capture.is_of(&named.id);
            was_pressed |= !(comes_after && is_theirs);
            if !is_theirs && !comes_after {
                capture.may_also_be(named);
            }
        }
        was_pressed
    }

    /// A name could not be read that had not arrived at `absent` (`None`: not known): the patient named
    /// before may have left, and each press since then may belong to the one in the unreadable name.
    pub fn unread(&mut self, absent: Option<Duration>) {
        self.lose_certainty(Doubt::Unread, |capture| {
            capture.by == Opener::Name || absent.is_none_or(|absent| capture.opened > absent)
        });
    }

    /// Without a button, a name opens a capture. A name from the page or the terminal ends the captures of
    /// others, unless their export is arriving or was refused.
    fn name_export(
        &mut self,
        named: Named,
        number: i64,
        now: Duration,
        coming: &[Appeared],
    ) -> NamedNext {
        let given_up = self.give_up(&named, coming);
        let ordered: Vec<Named> = given_up
            .iter()
            .filter_map(|capture| capture.patient.as_ref())
            .filter(|other| other.by == SourceKind::Order && other.id != named.id)
            .cloned()
            .collect();
        let given_up = given_up.iter().map(|capture| capture.number).collect();
        if named.by != SourceKind::Order {
            self.clear_doubts();
        }
        // A name after a refusal, or after an export that was held for the capture, may mean a new scan.
        let joins = |capture: &&mut Capture| {
            let is_open = capture.is_open() && now <= capture.until && !capture.is_refused;
            is_open && capture.is_of(&named.id)
        };
        if let Some(capture) = self.open.last_mut().filter(joins) {
            capture.until = now + self.rules.lasts(Opener::Name);
            if let (Some(patient), Some(request)) = (&mut capture.patient, &named.request) {
                patient.request = Some(request.clone());
            }
            let prolonged = NamedNext::Prolonged(capture.clone());
            self.note_missed(ordered);
            return prolonged;
        }
        let mut opened = self.opened(number, now, Opener::Name, Some(named));
        opened.doubt = self.uncertain;
        self.at_rest(&mut opened);
        self.missed.iter().for_each(|missed| opened.may_also_be(missed));
        self.open.push(opened.clone());
        self.note_missed(ordered);
        NamedNext::Opened(opened, given_up)
    }

    /// A name from a person ends what waits for others; a card only ends what waits for the same patient, if
    /// something was missed since.
    fn give_up(&mut self, named: &Named, coming: &[Appeared]) -> Vec<Capture> {
        let id = named.id.as_str();
        // Whether a refused export comes again is asked first: this is the answer if it stands beside hers.
        let is_hers = |capture: &Capture| capture.patient.as_ref().is_some_and(|own| own.id == id);
        let was_asked = self.waiting().any(|capture| is_hers(capture) && !capture.is_of(id));
        let is_given_up = |capture: &mut Capture| {
            let is_coming_in = coming.iter().any(|file| capture.opened < file.seen);
            let is_meant = match named.by {
                // Of a held one, too, nothing else is expected.
                SourceKind::Operator => {
                    let may_come_again = capture.is_refused && !was_asked;
                    let is_taken = capture.state == CaptureState::Taken;
                    !capture.is_of(id) && !may_come_again && !is_taken
                }
                SourceKind::Reader => {
                    let was_missed = matches!(capture.doubt, Some(Doubt::Unheard | Doubt::Unread));
                    let is_alone = capture.others.is_empty() && !capture.is_refused;
                    is_hers(capture) && capture.is_waiting() && is_alone && was_missed
                }
                _ => false,
            };
            is_meant && !is_coming_in
        };
        self.open.extract_if(.., is_given_up).collect()
    }

    /// An order from the practice software: it comes from the desk, where it is not known who is in the
    /// booth.
    fn order(&mut self, named: Named, now: Duration) -> NamedNext {
        let crossed = match self.rules.orders {
            OrdersWhen::AfterPress => match self.pair(&named, now) {
                Some(came) => return came,
                // It is too late for its press, and never for the next one.
                None => true,
            },
            OrdersWhen::BeforePress => {
                let is_unsure = self.unsure(now).next().is_some();
                if is_unsure {
                    self.cross(&named);
                }
                is_unsure
            }
        };
        self.decided.retain(|id| *id != named.id);
        // It may be for a missed press, or for one that a lost journal knew.
        let gap = self.is_in_doubt(now).then_some(Doubt::Unheard);
        let next = self.names.next.get_or_insert_with(|| Next::one(named.clone(), now, None));
        match next.names.iter_mut().find(|name| name.named.id == named.id) {
            Some(name) => name.at = now,
            None => next.names.push(NamedAt { named, at: now }),
        }
        if crossed {
            next.doubt = Some(Doubt::Crossed);
        }
        next.doubt = next.doubt.or(self.uncertain).or(gap);
        NamedNext::Waits { replaced: false, in_doubt: !next.is_certain() }
    }

    /// The presses without a certain name so recent that a name may be for one of them. The time counts and not
    /// the capture, because the export may have been taken already.
    fn unsure(&self, now: Duration) -> impl Iterator<Item = &Unsure> {
        let awaited = self.rules.awaited();
        self.names.unsure.iter().filter(move |press| now <= press.at + awaited)
    }

    /// The button was pressed without a certain name, or the name is no longer certain.
    pub(super) fn press_is_unsure(&mut self, at: Duration, is_unnamed: bool) {
        let awaited = self.rules.awaited();
        let unsure = &mut self.names.unsure;
        unsure.retain(|press| at <= press.at + awaited);
        unsure.drain(..(unsure.len() + 1).saturating_sub(DOUBTS_MOST));
        unsure.push(Unsure { at, is_unnamed });
    }

    /// A name that may be for an earlier press without a certain name: that may have been this patient's.
    fn cross(&mut self, named: &Named) {
        let unsure = |capture: &&mut Capture| {
            let is_unsure = capture.is_unnamed() || capture.doubt.is_some();
            capture.by == Opener::Press && is_unsure
        };
        self.open.iter_mut().filter(unsure).for_each(|capture| capture.may_also_be(named));
    }

    /// An order in a practice that orders after the press; `None` if no open press waits for one.
    fn pair(&mut self, named: &Named, now: Duration) -> Option<NamedNext> {
        // The patient already has a press by name, so the order is for no other press.
        let is_theirs =
            |capture: &&Capture| capture.by == Opener::Press && capture.is_of(&named.id);
        if let Some(capture) = self.open.iter().find(is_theirs) {
            self.names.unsure.retain(|press| press.at != capture.opened);
            return Some(NamedNext::Paired(capture.clone()));
        }
        let by_order = |capture: &Capture| {
            capture.named().next().is_none_or(|named| named.by == SourceKind::Order)
        };
        let open: Vec<usize> = (0..self.open.len())
            .filter(|at| self.open[*at].is_waiting())
            .filter(|at| self.may_be_ordered(&self.open[*at], now) && by_order(&self.open[*at]))
            .collect();
        let is_unnamed = |at: &usize| self.open[*at].is_unnamed();
        if let [only] = open.as_slice()
            && is_unnamed(only)
            && self.next().is_none()
        {
            let opened = self.open[*only].opened;
            if self.unsure(now).all(|press| press.at == opened) {
                let capture = &mut self.open[*only];
                capture.patient = Some(named.clone());
                self.names.unsure.retain(|press| press.at != opened);
                return Some(NamedNext::Paired(capture.clone()));
            }
        }
        let any_unnamed = open.iter().any(is_unnamed);
        for at in open {
            self.open[at].may_also_be(named);
        }
        if any_unnamed {
            self.press_is_unsure(now, false);
            if self.next().is_none() {
                return Some(NamedNext::Waits { replaced: false, in_doubt: true });
            }
        }
        None
    }

    /// Whether too many patients wait to add this id: an export could be anybody's.
    pub fn is_crowded(&self, id: &str) -> bool {
        let names = self.next().map_or(&[][..], |next| &next.names);
        let awaited = self.waiting().flat_map(Capture::named);
        let mut known = names.iter().map(|name| &name.named).chain(awaited);
        let count = self.waiting().count() + names.len();
        count >= NAMES_MOST && !known.any(|known| known.id == id)
    }

    /// Takes the waiting names for a press.
    pub(super) fn use_next(&mut self) -> Used {
        let Some(mut next) = self.names.next.take() else { return (None, Vec::new(), None) };
        if let ([only], true) = (next.names.as_slice(), self.missed.is_empty()) {
            let used = (Some(only.named.clone()), Vec::new(), next.doubt);
            self.note_missed(next.left);
            return used;
        }
        // It is not known who the remaining patients are, either.
        let doubt = next.doubt.get_or_insert(Doubt::Shared).to_owned();
        let all = distinct(next.names.iter().map(|name| &name.named).chain(&self.missed));
        next.used += 1;
        if next.used < next.names.len() {
            self.names.next = Some(next);
        } else {
            self.note_missed(next.left);
        }
        (None, all, Some(doubt))
    }

    /// Drops names that have expired; returns whether there were any. Their patients may still be
    /// there.
    pub(super) fn drop_old_names(&mut self, now: Duration) -> bool {
        let lasts = self.rules.name_lasts;
        let Some(mut next) = self.names.next.take() else { return false };
        let is_old = |name: &mut NamedAt| now > name.at + lasts;
        let old: Vec<Named> = next.names.extract_if(.., is_old).map(|name| name.named).collect();
        let had_old = !old.is_empty();
        let left = match next.names.len() {
            0 => next.left,
            count => {
                // It is not known which of them have entered the booth: it may have been the expired ones.
                next.used = next.used.min(count - 1);
                self.names.next = Some(next);
                Vec::new()
            }
        };
        self.note_missed(old.into_iter().chain(left));
        had_old
    }
}

/// Whether a card names somebody who was not yet named as present, while somebody else was. A name from a
/// person replaces that on purpose.
fn contradicts(before: &Next, named: &Named) -> bool {
    let mut present =
        before.names.iter().filter(|name| name.named.by != SourceKind::Order).peekable();
    let is_other = present.peek().is_some() && present.all(|name| name.named.id != named.id);
    named.by == SourceKind::Reader && is_other
}
