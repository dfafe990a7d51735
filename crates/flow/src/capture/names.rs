//! The waiting names: who is next, how an order or a name from the booth changes that, and the effect of
//! a failed naming.

use std::time::Duration;

use gaiter_record::SourceKind;
use serde::{Deserialize, Serialize};

use super::{
    Capture, CaptureState, Captures, DOUBTS_MOST, Doubt, NAMES_MOST, Named, NamedNext, Opener,
};
use crate::export::writing::Appeared;
use crate::orders::when::OrdersWhen;

/// A name and when it was given; times as in [`Capture`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Said {
    /// Who.
    pub named: Named,
    /// When.
    pub at: Duration,
}

/// Who may be next: one patient if that is certain.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Next {
    /// The candidates, in the order in which they were named; never empty.
    pub names: Vec<Said>,
    /// How many of them have entered the booth since; it is not known which.
    pub used: usize,
    /// Why it is not certain.
    pub doubt: Option<Doubt>,
}

impl Next {
    /// One name, certain unless there is a doubt.
    pub fn one(named: Named, at: Duration, doubt: Option<Doubt>) -> Next {
        Next { names: vec![Said { named, at }], used: 0, doubt }
    }

    /// Whether it is certain who is next.
    pub fn is_certain(&self) -> bool {
        self.names.len() == 1 && self.doubt.is_none()
    }
}

/// The patient of a press, the other patients it may be, and why that is not certain.
type Used = (Option<Named>, Vec<Named>, Option<Doubt>);

impl Captures {
    /// The ids of the patients who may be next; one if that is certain.
    pub fn next_ids(&self) -> Vec<String> {
        let names = self.next.as_ref().map_or(&[][..], |next| &next.names);
        names.iter().map(|said| said.named.id.clone()).collect()
    }

    /// The ids of the patients whose exports are expected, each once.
    pub fn awaited_ids(&self) -> Vec<String> {
        let open = |capture: &&Capture| capture.state == CaptureState::Open;
        let mut ids: Vec<String> = Vec::new();
        for named in self.waiting.iter().filter(open).flat_map(Capture::named) {
            if !ids.contains(&named.id) {
                ids.push(named.id.clone());
            }
        }
        ids
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
        if !self.rules.by_press {
            return self.name_export(named, number, now, coming);
        }
        self.drop_old_names(now);
        if named.by == SourceKind::Order {
            return self.order(named, now);
        }
        let replaced = self
            .next
            .as_ref()
            .is_some_and(|next| next.names.iter().any(|said| said.named.id != named.id));
        self.next = Some(Next::one(named, now, None));
        NamedNext::Waits { replaced, in_doubt: false }
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
        let doubt = Some(doubt);
        match &came {
            NamedNext::Waits { .. } => {
                if let Some(next) = &mut self.next {
                    next.doubt = next.doubt.or(doubt);
                }
                return NamedNext::Waits { replaced: false, in_doubt: true };
            }
            NamedNext::Opened(..) | NamedNext::Paired(_) | NamedNext::Prolonged(_) => {
                let its = |capture: &&mut Capture| {
                    capture.patient.as_ref().is_some_and(|patient| patient.id == id)
                };
                if let Some(capture) = self.waiting.iter_mut().rfind(its) {
                    capture.doubt = capture.doubt.or(doubt);
                }
                if let NamedNext::Paired(capture) = &came {
                    // Its own order may still arrive.
                    self.press_is_unsure(capture.opened);
                }
            }
        }
        came
    }

    /// A name could not be read: the patient named before may have left. An export that was seen earlier
    /// is not in doubt.
    pub fn unread(&mut self, now: Duration) {
        if let Some(next) = &mut self.next {
            next.doubt.get_or_insert(Doubt::Unread);
        }
        if !self.rules.by_press {
            let too_many = (self.unread.len() + 1).saturating_sub(DOUBTS_MOST);
            self.unread.drain(..too_many);
            self.unread.push(now);
        }
    }

    /// Without a button, a name opens a capture. A name from the page or the verb ends the captures of
    /// others, unless their export is arriving.
    fn name_export(
        &mut self,
        named: Named,
        number: i64,
        now: Duration,
        coming: &[Appeared],
    ) -> NamedNext {
        let lasts = self.rules.name_lasts;
        let open = |capture: &&mut Capture| {
            let is_open = capture.state == CaptureState::Open && now <= capture.until;
            let is_same = capture.patient.as_ref().is_some_and(|patient| patient.id == named.id);
            is_open && is_same && capture.others.is_empty()
        };
        let is_word = named.by == SourceKind::Operator;
        let given_up: Vec<i64> = match is_word {
            true => self.give_up_others(&named.id, coming),
            false => Vec::new(),
        };
        let newest = self.waiting.last().map(|capture| capture.number);
        // A name after a refusal means a new scan. What still arrives of the refused scan is another
        // export.
        let joins = |capture: &&mut Capture| !capture.is_refused && Some(capture.number) == newest;
        if let Some(capture) = self.waiting.iter_mut().filter(open).find(joins) {
            capture.until = now + lasts;
            return NamedNext::Prolonged(capture.clone());
        }
        let opened = self.open(number, now, lasts, Opener::Name, Some(named)).clone();
        NamedNext::Opened(opened, given_up)
    }

    fn give_up_others(&mut self, id: &str, coming: &[Appeared]) -> Vec<i64> {
        let is_given_up = |capture: &mut Capture| {
            let is_same = capture.patient.as_ref().is_some_and(|patient| patient.id == id);
            !is_same && !is_coming_in(capture, coming)
        };
        self.measuring.retain(|known| known.capture.is_of(id));
        self.waiting.extract_if(.., is_given_up).map(|capture| capture.number).collect()
    }

    /// An order from the practice software: it comes from the desk, where it is not known who is in the
    /// booth.
    fn order(&mut self, named: Named, now: Duration) -> NamedNext {
        if self.next.as_ref().is_some_and(|next| next.doubt == Some(Doubt::Unread))
            && let Some(next) = &mut self.next
        {
            // The corrected order, possibly of another patient: then both are candidates.
            next.doubt = None;
        }
        let crossed = match self.rules.orders {
            OrdersWhen::AfterPress => match self.pair(&named, now) {
                Paired::With(capture) => return NamedNext::Paired(capture),
                Paired::InDoubt => return NamedNext::Waits { replaced: false, in_doubt: true },
                Paired::Crossed => true,
                Paired::None => self.is_unsure(now),
            },
            OrdersWhen::BeforePress => self.cross(&named, now),
        };
        // It may be for a missed press, or for one that a lost journal knew.
        let unheard = self.is_in_doubt(now).then_some(Doubt::Unheard);
        let next = self.next.get_or_insert_with(|| Next::one(named.clone(), now, None));
        match next.names.iter_mut().find(|said| said.named.id == named.id) {
            Some(said) => said.at = now,
            None => next.names.push(Said { named, at: now }),
        }
        if crossed {
            next.doubt = Some(Doubt::Crossed);
        }
        next.doubt = next.doubt.or(unheard);
        NamedNext::Waits { replaced: false, in_doubt: !next.is_certain() }
    }

    /// Whether the button was pressed without a certain name so recently that an order may be for that
    /// press. The time counts and not the capture, because the export may have been taken already.
    fn is_unsure(&self, now: Duration) -> bool {
        let awaited = self.rules.awaited();
        self.unsure.iter().any(|at| now <= *at + awaited)
    }

    /// The button was pressed without a certain name, or the name is no longer certain.
    pub(super) fn press_is_unsure(&mut self, now: Duration) {
        let awaited = self.rules.awaited();
        self.unsure.retain(|at| now <= *at + awaited);
        let too_many = (self.unsure.len() + 1).saturating_sub(DOUBTS_MOST);
        self.unsure.drain(..too_many);
        self.unsure.push(now);
    }

    /// Whether an order may be for another press than this one.
    fn is_another_unsure(&self, opened: Duration, now: Duration) -> bool {
        let awaited = self.rules.awaited();
        self.unsure.iter().any(|at| *at != opened && now <= *at + awaited)
    }

    /// An order before the next press that may be for an earlier one: a press without a certain name may
    /// have been this patient's.
    fn cross(&mut self, named: &Named, now: Duration) -> bool {
        let is_unsure = self.is_unsure(now);
        if is_unsure {
            let unsure = |capture: &&mut Capture| {
                capture.by == Opener::Press && (capture.is_unnamed() || capture.doubt.is_some())
            };
            self.waiting.iter_mut().filter(unsure).for_each(|capture| capture.may_also_be(named));
        }
        is_unsure
    }

    /// An order in a practice that orders after the press.
    fn pair(&mut self, named: &Named, now: Duration) -> Paired {
        // The patient already has a press by name, so the order is for no other press.
        let is_theirs =
            |capture: &&Capture| capture.by == Opener::Press && capture.is_of(&named.id);
        let measuring = self.measuring.iter().map(|known| &known.capture);
        if let Some(capture) = self.waiting.iter().chain(measuring).find(is_theirs) {
            return Paired::With(capture.clone());
        }
        let by_order = |capture: &Capture| {
            capture.named().next().is_none_or(|named| named.by == SourceKind::Order)
        };
        let open: Vec<usize> = (0..self.waiting.len())
            .filter(|at| {
                self.may_be_ordered(&self.waiting[*at], now) && by_order(&self.waiting[*at])
            })
            .collect();
        let is_unnamed = |at: &usize| self.waiting[*at].is_unnamed();
        match open.as_slice() {
            [] => return Paired::None,
            [only]
                if is_unnamed(only)
                    && self.next.is_none()
                    && !self.is_another_unsure(self.waiting[*only].opened, now) =>
            {
                let capture = &mut self.waiting[*only];
                capture.patient = Some(named.clone());
                self.unsure.retain(|at| *at != capture.opened);
                return Paired::With(capture.clone());
            }
            _ => {}
        }
        let any_unnamed = open.iter().any(is_unnamed);
        for at in open {
            self.waiting[at].may_also_be(named);
        }
        if any_unnamed {
            self.press_is_unsure(now);
            if self.next.is_none() {
                return Paired::InDoubt;
            }
        }
        Paired::Crossed
    }

    /// Whether so many patients wait that adding this id is of no use: an export could be anybody's.
    pub fn is_crowded(&self, id: &str) -> bool {
        let next = self.next.iter().flat_map(|next| &next.names).map(|said| said.named.id.as_str());
        let awaited = self.waiting.iter().flat_map(Capture::named).map(|named| named.id.as_str());
        let mut known = next.chain(awaited);
        let count = self.waiting.len() + self.next.as_ref().map_or(0, |next| next.names.len());
        count >= NAMES_MOST && !known.any(|known| known == id)
    }

    /// Takes the waiting names for a press.
    pub(super) fn use_next(&mut self) -> Used {
        let Some(mut next) = self.next.take() else { return (None, Vec::new(), None) };
        if let [only] = next.names.as_slice() {
            return (Some(only.named.clone()), Vec::new(), next.doubt);
        }
        let all: Vec<Named> = next.names.iter().map(|said| said.named.clone()).collect();
        let doubt = Some(next.doubt.unwrap_or(Doubt::Shared));
        next.used += 1;
        // It is not known who the remaining patients are, either.
        next.doubt = doubt;
        if next.used < next.names.len() {
            self.next = Some(next);
        }
        (None, all, doubt)
    }

    /// Drops names that have expired; returns whether there were any.
    pub(super) fn drop_old_names(&mut self, now: Duration) -> bool {
        let lasts = self.rules.name_lasts;
        let Some(next) = &mut self.next else { return false };
        let before = next.names.len();
        next.names.retain(|said| now <= said.at + lasts);
        let left = next.names.len();
        if left == before {
            return false;
        }
        // It is not known which of them have entered the booth: it may have been the expired ones.
        next.used = next.used.min(left.saturating_sub(1));
        if left == 0 {
            self.next = None;
        }
        true
    }
}

/// How an order relates to the open presses.
enum Paired {
    /// No press is open.
    None,
    /// The open press is this patient's.
    With(Capture),
    /// More than one press may be meant.
    InDoubt,
    /// The open press has its order; this one may be for it or for the next.
    Crossed,
}

/// Whether a file was seen that may be the export of a capture.
fn is_coming_in(capture: &Capture, coming: &[Appeared]) -> bool {
    coming.iter().any(|file| capture.opened < file.seen)
}
