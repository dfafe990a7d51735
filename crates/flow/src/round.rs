//! Rounds: whose scan an export is.
//!
//! A scan goes to a person without a decision only if a clean round was observed, from the rest before it
//! to the taking of its export. This is a list of what makes certain. Whatever is not on it is held, with
//! the patients whose it may be.
//!
//! - **R1 Rest before it.** At the press every earlier capture has ended: its own scan is measured, a person
//!   has decided, or its window and `late` are over and somebody was named at the booth since.
//! - **R2 One name.** From that rest to the press one patient was named. Card, page and terminal name who is
//!   there; an order names who is expected. Two orders, or an order left over from a round that ended
//!   otherwise, need somebody named at the booth. A name after the press belongs to the next round.
//! - **R3 One press, after the name.** A name soon after a press without one may be for that press or for the
//!   next. So may an order whose file may have lain there unread at a press ([`Rounds::overtaken`]).
//! - **R4 One new content.** No other content was written beside it since the press, and none taken since
//!   then that was seen before it. Its export was absent at a look after the press, and is not older by its own
//!   time, its change time and those of the folders above it ([`super::export::writing`]): it was not brought
//!   in, set back in time, or swapped in with a folder or a link. A content that was seen and is gone before
//!   it was taken counts ([`super::settle::Gone`]).
//! - **R5 No source missed.** Whatever could not be received for a while (a port, a name that could not be
//!   read, a press that could not be kept, the station itself) ends certainty until somebody is named at the
//!   booth again; a missed press does so for as long as its export may come.
//! - **R6 In time.** The export began within the window and was taken before `late` was over.
//!
//! Without a button the name takes the place of the press. A known scan, by bytes or geometry, answers
//! nothing. Where nobody in question has a name, nobody can be mistaken and nothing is held: an export that
//! is not certainly the export of a press counts as one without a press. A refusal opens its capture again
//! for another export without a press. A command is tried on a copy, which takes effect once it is in the
//! journal.

mod capture;
mod ending;
mod held_next;
mod names;
mod outcome;

use std::collections::BTreeSet;
use std::time::Duration;

use super::export::writing::Appeared;
use super::orders::OrdersWhen;
use capture::distinct;
pub use capture::{Capture, CaptureState, Doubt, ExportContent, Named, Opener, Rules, Why};
use gaiter_record::SourceKind;
pub use held_next::{HeldNext, HoldReason};
pub use names::{NamedAt, Names, Next, Unsure};
pub use outcome::{CalledOff, CaptureMatch, NamedNext, Passed};

/// Finding: the export could belong to captures of different patients.
pub(crate) const AMBIGUOUS: &str = Why::Ambiguous.word();

/// Finding: another export lay beside it.
pub(crate) const BESIDE: &str = Why::Beside.word();

/// The captures that have not ended, and who may be next.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rounds {
    rules: Rules,
    /// In the order in which they were opened.
    open: Vec<Capture>,
    names: Names,
    /// Why no order is certain before the next word at the booth.
    uncertain: Option<Doubt>,
    /// The patients of captures that came to nothing since that word: they may still be there.
    missed: Vec<Named>,
    /// Patients to whom a person assigned a scan since then: their orders are used.
    decided: Vec<String>,
    /// Since when every port of a button has been open; `None` while one is away.
    heard_since: Option<Duration>,
}

/// How many patients may wait, named or pressed for: more than any waiting room holds, and a program
/// that orders thousands at once is in error.
const NAMES_MOST: usize = 100;

/// How many of the latest unsure presses, and of the patients of captures that came to nothing, are kept.
const DOUBTS_MOST: usize = 64;

impl Rounds {
    /// The state from the journal after a start, before any port is open: presses and names may have been
    /// lost since the previous run.
    pub fn new(rules: Rules, open: Vec<Capture>, names: Names) -> Rounds {
        let (missed, decided) = (Vec::new(), Vec::new());
        let (uncertain, heard_since) = (None, None);
        let mut rounds = Rounds { rules, open, names, uncertain, missed, decided, heard_since };
        rounds.lose_certainty(Doubt::Unheard, |_| true);
        rounds
    }

    /// Something was missed: names and these captures are no longer certain.
    fn lose_certainty(&mut self, doubt: Doubt, of: impl Fn(&Capture) -> bool) {
        self.doubt_names(doubt);
        for capture in self.open.iter_mut().filter(|capture| of(capture)) {
            capture.doubt.get_or_insert(doubt);
        }
    }

    /// The port of a button is away: the exports of missed presses may be taken for those of others.
    pub fn deaf(&mut self) {
        self.heard_since = None;
        self.lose_certainty(Doubt::Unheard, |capture| capture.by == Opener::Press);
    }

    /// A press was received but could not be kept: its export may be taken for that of another press.
    pub fn missed_press(&mut self, now: Duration) {
        self.heard_since = self.heard_since.map(|_| now);
        self.lose_certainty(Doubt::Unheard, |capture| capture.by == Opener::Press);
    }

    /// A source of names is away, or was: call it at the beginning of the gap and at its end. A press before
    /// that has its name already.
    pub fn missed_name(&mut self) {
        self.lose_certainty(Doubt::Unheard, |capture| capture.by == Opener::Name);
    }

    /// Every port of a button is open. A press that was missed until now may have been that of a patient who
    /// was named meanwhile.
    pub fn receives(&mut self, now: Duration) {
        if self.heard_since.is_none() {
            self.heard_since = Some(now);
            if let Some(next) = &mut self.names.next {
                next.doubt.get_or_insert(Doubt::Unheard);
            }
        }
    }

    /// The captures that have not ended, in the order in which they were opened.
    pub fn open(&self) -> &[Capture] {
        &self.open
    }

    /// The captures whose exports have not arrived.
    pub fn waiting(&self) -> impl Iterator<Item = &Capture> {
        self.open.iter().filter(|capture| capture.is_waiting())
    }

    /// Who may be next, as the journal keeps it.
    pub fn names(&self) -> &Names {
        &self.names
    }

    /// The patients' names that wait for a press.
    pub fn next(&self) -> Option<&Next> {
        self.names.next.as_ref()
    }

    /// Whether the station waits for the export of a press and has not seen it yet. A refused export may
    /// be followed by another, but nobody pressed the button for that one.
    pub fn is_armed(&self) -> bool {
        self.open.iter().any(|capture| capture.is_open() && !capture.is_refused)
    }

    /// Whether a press without a name waits for its export, and an order may be for it.
    pub fn has_unnamed_press(&self, now: Duration) -> bool {
        self.waiting().any(|capture| self.may_be_ordered(capture, now) && capture.is_unnamed())
    }

    /// When orders arrive, according to the configuration.
    pub fn orders_when(&self) -> OrdersWhen {
        self.rules.orders
    }

    /// Whether a press at this time would be in doubt, because an earlier one may have been missed.
    pub fn is_in_doubt(&self, now: Duration) -> bool {
        self.rules.by_press && self.doubt_left(now) != Some(Duration::ZERO)
    }

    /// How long presses are in doubt from now on, if the button can be read; `None` while it cannot.
    pub fn doubt_left(&self, now: Duration) -> Option<Duration> {
        // The export of a missed press may arrive as late as any other.
        self.heard_since.map(|since| (since + self.rules.awaited()).saturating_sub(now))
    }

    /// The button was pressed: opens a capture with this number, for the patient whose name waited.
    pub fn pressed(&mut self, number: i64, now: Duration) -> Capture {
        self.drop_old_names(now);
        let (patient, others, doubt) = self.use_next();
        let gap = self.is_in_doubt(now).then_some(Doubt::Unheard);
        let doubt = doubt.or(gap);
        let is_unnamed = patient.is_none() && others.is_empty();
        let is_unsure = match (self.rules.orders, doubt) {
            // A patient who was ordered before the press needs no other order.
            (OrdersWhen::BeforePress, None | Some(Doubt::Shared)) => is_unnamed,
            (OrdersWhen::BeforePress, Some(_)) => true,
            // The order of this press is still to come, even if a card named its patient.
            (OrdersWhen::AfterPress, _) => true,
        };
        if is_unsure {
            self.press_is_unsure(now, is_unnamed);
        }
        let opened = self.opened(number, now, Opener::Press, patient);
        let mut opened = Capture { others, doubt, ..opened };
        self.at_rest(&mut opened);
        self.open.push(opened.clone());
        opened
    }

    /// R1: where a capture of somebody else has not ended, an export may be of either. Two that nobody was
    /// named for may be of two patients, and one of them may still be named.
    fn at_rest(&self, opened: &mut Capture) {
        let own = opened.clone();
        let is_others = |earlier: &&Capture| {
            own.is_unnamed() || earlier.doubt.is_some() || ids(earlier) != ids(&own)
        };
        for earlier in self.open.iter().filter(is_others) {
            opened.doubt.get_or_insert(Doubt::Shared);
            if !own.is_unnamed() {
                earlier.named().for_each(|named| opened.may_also_be(named));
            }
        }
    }

    fn opened(&self, number: i64, now: Duration, by: Opener, patient: Option<Named>) -> Capture {
        let (until, others, doubt) = (now + self.rules.lasts(by), Vec::new(), None);
        let (state, is_refused) = (CaptureState::Open, false);
        Capture { number, opened: now, until, by, patient, others, state, is_refused, doubt }
    }

    /// The operator gives up what waits: captures whose exports will not arrive, and names.
    pub fn call_off(&mut self) -> CalledOff {
        let captures = self.open.drain(..).map(|capture| capture.number).collect();
        let name = self.names.next.take().is_some();
        // Nobody is named for them any more; an order may still be.
        self.names.unsure.iter_mut().for_each(|press| press.is_unnamed = false);
        self.clear_doubts();
        CalledOff { captures, name }
    }

    /// Which capture an export belongs to; nothing changes before [`Rounds::answer`].
    pub fn match_export(&self, export: Appeared, now: Duration) -> CaptureMatch {
        let late = self.rules.late;
        let all: Vec<&Capture> =
            self.open.iter().filter(|capture| capture.may_have(export, late)).collect();
        let is_its_own = |capture: &&&Capture| {
            capture.state == CaptureState::Open
                && export.absent.is_some_and(|at| at >= capture.opened)
                && export.seen <= capture.until
        };
        // If a patient was scanned again, the newer scan goes before what may still arrive of the
        // refused one.
        let its_own = all.iter().filter(is_its_own).min_by_key(|capture| capture.is_refused);
        let its_own = its_own.map(|capture| (*capture).clone());
        let whose: BTreeSet<Option<&str>> = all.iter().flat_map(|capture| ids(capture)).collect();
        if whose.iter().flatten().next().is_none() {
            return its_own.map_or(CaptureMatch::Unpressed, CaptureMatch::Of);
        }
        let shared = (whose.len() > 1).then_some(Doubt::Shared);
        if let Some(doubt) = shared.or(all.iter().find_map(|capture| capture.doubt)) {
            return held(doubt.why(), &all, export);
        }
        match its_own {
            Some(capture) => match self.named_meanwhile(&capture, export) {
                others if !others.is_empty() => held(Why::Ambiguous, &all, export).or_of(others),
                _ if now <= capture.until + late => {
                    CaptureMatch::Of(capture.with_certain_request(&all))
                }
                _ => held(Why::Late, &all, export),
            },
            // A second export of a scan that is being measured.
            None if !all.iter().any(|capture| capture.is_waiting()) => CaptureMatch::Unpressed,
            None if all.iter().all(|capture| export.absent < Some(capture.opened)) => {
                held(Why::Unclear, &all, export)
            }
            None => held(Why::Late, &all, export),
        }
    }

    /// The patients who were named at the booth before this export began, while the capture waits for another
    /// export after a refusal. It may be theirs if their press was forgotten.
    fn named_meanwhile(&self, capture: &Capture, export: Appeared) -> Vec<Named> {
        let names = self.next().map_or(&[][..], |next| &next.names);
        let is_other = |name: &&NamedAt| {
            capture.is_refused
                && name.named.by != SourceKind::Order
                && name.at < export.seen
                && name.named.id != capture.patient.as_ref().map_or("", |own| &own.id)
        };
        names.iter().filter(is_other).map(|name| name.named.clone()).collect()
    }

    /// Which capture a content belongs to; nothing changes before [`Rounds::answer`].
    pub fn match_content(&self, content: &ExportContent, now: Duration) -> CaptureMatch {
        if content.is_known {
            return CaptureMatch::Known;
        }
        let mut judged = self.match_export(content.began, now);
        let late = self.rules.late;
        if let CaptureMatch::Of(capture) = &judged
            && !capture.is_unnamed()
            && content.others.iter().any(|other| capture.may_have(*other, late))
        {
            let may_have = |capture: &&Capture| capture.may_have(content.began, late);
            let all: Vec<&Capture> = self.open.iter().filter(may_have).collect();
            judged = held(Why::Beside, &all, content.began);
        }
        if let CaptureMatch::Held { answered, doubtful, .. } = &mut judged
            && content.is_cut_short
        {
            // Another export of the same body is still to come.
            doubtful.extend(answered.take());
        }
        match (&content.completes, judged) {
            // The earlier part is being measured for its capture, so this belongs to that capture too.
            (Some(whose), CaptureMatch::Unpressed) => self
                .measuring_of(whose, content.began)
                .map_or(CaptureMatch::Unpressed, |capture| CaptureMatch::Of(capture.clone())),
            (Some(whose), judged) => judged.completing(whose),
            (None, judged) => judged,
        }
    }

    /// Whether an order may still be for this waiting press rather than for a later one.
    fn may_be_ordered(&self, capture: &Capture, now: Duration) -> bool {
        capture.by == Opener::Press && now <= capture.until + self.rules.late
    }
}

/// The ids that a capture names; a single `None` if it names nobody.
fn ids(capture: &Capture) -> BTreeSet<Option<&str>> {
    if capture.is_unnamed() {
        return BTreeSet::from([None]);
    }
    capture.named().map(|named| Some(named.id.as_str())).collect()
}

/// An export that a person must decide on, because each of these captures may be meant: all of them are
/// in doubt from now on, and the oldest waits no more if the export was written after it was opened.
fn held(why: Why, all: &[&Capture], export: Appeared) -> CaptureMatch {
    let candidates = distinct(all.iter().flat_map(|capture| capture.named()));
    let patient = match candidates.as_slice() {
        [one] => Some(one.clone()),
        _ => None,
    };
    let is_after = |capture: &&&Capture| export.absent.is_some_and(|at| at >= capture.opened);
    let answered = all.iter().filter(|capture| capture.is_waiting()).find(is_after);
    let answered = answered.map(|capture| capture.number);
    let numbers = all.iter().map(|capture| capture.number);
    let doubtful = numbers.filter(|number| Some(*number) != answered).collect();
    CaptureMatch::Held { why, patient, candidates, answered, doubtful }
}

#[cfg(test)]
mod tests;
