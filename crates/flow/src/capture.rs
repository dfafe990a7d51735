//! Captures: which export belongs to which press of the button, and so to which patient.
//!
//! With a button, a press opens a capture; without one, naming the patient does. The laws:
//!
//! 1. **Written during the capture.** An export belongs to a capture only if its content was written
//!    after that capture opened and before another one opened ([`super::export::writing`] determines
//!    when). With a button, only presses open captures; a name that arrives during one is for the next.
//! 2. **Known scans answer nothing**, whether known by their bytes or by their geometry.
//! 3. **A capture ends** when its scan is measured; when the operator ends it; or, if no byte of an
//!    export was seen for it, after `window + late` (without a button: `expires + late`). Until the scan
//!    is measured, for at most `window + late`, another export may be a second one of it. A refusal
//!    opens the capture again for the same time; an export without a new press then belongs to it. A new
//!    scan of the same patient has its own capture, and closes the refused one once it is measured. A
//!    press for another patient, or without a name, causes the next export to be held for both.
//! 4. **The booth overrides.** Card, page and verb replace the waiting name. An order never does: two
//!    waiting orders make both patients candidates, until the booth names one. An order that arrives
//!    while a press without a name is open, or soon after one, is in doubt together with it; where the
//!    practice orders after the press (`patient.orders.when`), it pairs with the one open press.
//! 5. **A failed naming disarms**: an unreadable name puts the waiting name in doubt.
//! 6. **Journal first.** A command is tried on a copy; the copy takes effect once it is in the journal.
//!
//! If no capture in question has a patient, nothing can be mistaken and nothing is held: an export that
//! is not certainly the export of a press counts as one without a press.
//!
//! | what happens | result |
//! |---|---|
//! | one press, one export within the window | the export belongs to the capture |
//! | no press | [`Judged::Unpressed`]: the configuration decides whether it is processed or held |
//! | a second press, the same patient or none both times | the exports belong to the captures in turn |
//! | a second press, another patient or none after one | both exports are held: `capture-ambiguous` |
//! | two exports after one press | the first belongs to the capture, the second counts as unpressed |
//! | no export within the window | the capture expires: an alarm |
//! | an export after the window | held: `export-late` |
//! | an export that may have been written before the press | held: `capture-unclear` |
//! | the port was away at the press, shortly before it, or since | held: `press-unheard`, if the capture has a patient |
//! | the station restarts in between | the same, because it heard nothing meanwhile |
//! | the machine restarts in between | the capture expires; an export that may still be its own is held |
//! | the wall clock jumps | nothing: times are since the machine's start |

mod answers;
mod names;
mod outcome;
mod time;
mod types;

use std::collections::BTreeSet;
use std::time::Duration;

use super::export::writing::Appeared;
use super::orders::when::OrdersWhen;
use answers::Measuring;
pub use names::{Next, Said};
pub use outcome::{CalledOff, Judged, NamedNext, Passed};
pub use types::{Capture, CaptureState, Content, Doubt, Named, Opener, Rules, Why};

/// Finding: the export could belong to captures of different patients.
pub(crate) const AMBIGUOUS: &str = Why::Ambiguous.code();

/// Finding: the export may have been written before the press.
pub(crate) const UNCLEAR: &str = Why::Unclear.code();

/// Finding: the export arrived after the window of the press it must belong to.
pub(crate) const LATE: &str = Why::Late.code();

/// Finding: the station could not hear for a while, and a missed press may have made this export.
pub(crate) const UNHEARD: &str = Why::Unheard.code();

/// Finding: an attempt to name a patient before the export could not be read.
pub(crate) const UNREAD: &str = Why::Unread.code();

/// Finding: the order that names the patient repeats an earlier one.
pub(crate) const REPEATED: &str = Why::Repeated.code();

/// The captures whose exports have not arrived, in the order in which they were opened, and the
/// patients' names that wait for a press.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Captures {
    rules: Rules,
    waiting: Vec<Capture>,
    next: Option<Next>,
    hearing: Hearing,
    /// When the button was pressed without a certain name; an order for that press may still arrive.
    unsure: Vec<Duration>,
    /// When a naming without a button could not be read: the patient named before may have left.
    unread: Vec<Duration>,
    /// Captures whose exports were taken but are not measured yet.
    measuring: Vec<Measuring>,
}

/// How many patients may wait, named or pressed for: more than any waiting room holds, and a program
/// that orders thousands at once is in error.
const NAMES_MOST: usize = 100;

/// How many of the latest unsure presses, and of the latest failed namings, are remembered.
const DOUBTS_MOST: usize = 64;

/// Whether presses are heard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Hearing {
    /// A port is away.
    Deaf,
    /// Every port has been open since then.
    Since(Duration),
}

impl Captures {
    /// The state from the journal after a start, before any port is open.
    pub fn new(rules: Rules, waiting: Vec<Capture>, next: Option<Next>) -> Captures {
        let hearing = Hearing::Deaf;
        let (unsure, unread, measuring) = (Vec::new(), Vec::new(), Vec::new());
        let mut captures = Captures { rules, waiting, next, hearing, unsure, unread, measuring };
        // Earlier presses and names may have been lost with the previous run.
        for capture in &mut captures.waiting {
            capture.doubt.get_or_insert(Doubt::Unheard);
        }
        captures
    }

    /// Adds the times at which the button was pressed without a certain name and at which namings
    /// failed; see [`Captures::unsure_at`] and [`Captures::unread_at`].
    pub fn with_doubts(self, unsure: Vec<Duration>, unread: Vec<Duration>) -> Captures {
        Captures { unsure, unread, ..self }
    }

    /// When a name could not be read, without a button.
    pub fn unread_at(&self) -> &[Duration] {
        &self.unread
    }

    /// A port is away: the exports of missed presses may be taken for those of others.
    pub fn deaf(&mut self) {
        self.hearing = Hearing::Deaf;
        self.doubt_presses();
    }

    /// A press was heard but could not be kept: its export may be taken for that of another press.
    pub fn missed_press(&mut self, now: Duration) {
        if self.hearing != Hearing::Deaf {
            self.hearing = Hearing::Since(now);
        }
        self.doubt_presses();
    }

    fn doubt_presses(&mut self) {
        let by_press = |capture: &&mut Capture| capture.by == Opener::Press;
        for capture in self.waiting.iter_mut().filter(by_press) {
            capture.doubt.get_or_insert(Doubt::Unheard);
        }
    }

    /// Every port is open.
    pub fn hears(&mut self, now: Duration) {
        if self.hearing == Hearing::Deaf {
            self.hearing = Hearing::Since(now);
        }
    }

    /// The captures whose exports have not arrived.
    pub fn waiting(&self) -> &[Capture] {
        &self.waiting
    }

    /// The patients' names that wait for a press.
    pub fn next(&self) -> Option<&Next> {
        self.next.as_ref()
    }

    /// When the button was pressed without a certain name, so recently that an order may be for that
    /// press.
    pub fn unsure_at(&self) -> &[Duration] {
        &self.unsure
    }

    /// Whether the station waits for the export of a press and has not seen it yet. A refused export may
    /// be followed by another, but nobody pressed the button for that one.
    pub fn is_armed(&self) -> bool {
        let is_open =
            |capture: &Capture| capture.state == CaptureState::Open && !capture.is_refused;
        self.waiting.iter().any(is_open)
    }

    /// Whether a press without a name waits for its export, and an order may be for it.
    pub fn has_unnamed_press(&self, now: Duration) -> bool {
        let mut ordered = self.waiting.iter().filter(|capture| self.may_be_ordered(capture, now));
        ordered.any(Capture::is_unnamed)
    }

    /// When orders arrive, according to the configuration.
    pub fn orders_when(&self) -> OrdersWhen {
        self.rules.orders
    }

    /// Whether a press at this time would be in doubt, because an earlier one may have been missed.
    pub fn is_in_doubt(&self, now: Duration) -> bool {
        // The export of a missed press may arrive as late as any other.
        let awaited = self.rules.awaited();
        let heard_long = matches!(self.hearing, Hearing::Since(at) if now >= at + awaited);
        self.rules.by_press && !heard_long
    }

    /// The button was pressed: opens a capture with this number, for the patient whose name waited.
    pub fn pressed(&mut self, number: i64, now: Duration) -> Capture {
        self.drop_old_names(now);
        let (patient, others, doubt) = self.use_next();
        let unheard = self.is_in_doubt(now).then_some(Doubt::Unheard);
        let doubt = doubt.or(unheard);
        let is_unsure = match (self.rules.orders, doubt) {
            // A patient who was ordered before the press needs no other order.
            (OrdersWhen::BeforePress, None | Some(Doubt::Shared)) => {
                patient.is_none() && others.is_empty()
            }
            (OrdersWhen::BeforePress, Some(_)) => true,
            // The order of this press is still to come.
            (OrdersWhen::AfterPress, doubt) => patient.is_none() || doubt.is_some(),
        };
        if is_unsure {
            self.press_is_unsure(now);
        }
        let window = self.rules.window;
        let opened = self.open(number, now, window, Opener::Press, patient);
        (opened.others, opened.doubt) = (others, doubt);
        opened.clone()
    }

    fn open(
        &mut self,
        number: i64,
        now: Duration,
        lasts: Duration,
        by: Opener,
        patient: Option<Named>,
    ) -> &mut Capture {
        let doubt = self.is_in_doubt(now).then_some(Doubt::Unheard);
        self.waiting.push(Capture {
            number,
            opened: now,
            until: now + lasts,
            by,
            patient,
            others: Vec::new(),
            state: CaptureState::Open,
            is_refused: false,
            doubt,
        });
        let last = self.waiting.len() - 1;
        &mut self.waiting[last]
    }

    /// The operator gives up what waits: captures whose exports will not arrive, and names.
    pub fn call_off(&mut self) -> CalledOff {
        let measuring: Vec<i64> = self.measuring().collect();
        self.measuring.clear();
        let waiting = self.waiting.drain(..).map(|capture| capture.number);
        let captures = waiting.chain(measuring).collect();
        CalledOff { captures, name: self.next.take().is_some() }
    }

    /// Which capture an export belongs to; nothing changes before [`Captures::answer`].
    pub fn judge(&self, export: Appeared) -> Judged {
        let late = self.rules.late;
        let all: Vec<&Capture> =
            self.waiting.iter().filter(|capture| capture.may_have(export, late)).collect();
        if all.is_empty() {
            return Judged::Unpressed;
        }
        let is_after = |capture: &&&Capture| export.absent.is_some_and(|at| at >= capture.opened);
        let after: Vec<&&Capture> = all.iter().filter(is_after).collect();
        let in_time = |capture: &&&&Capture| {
            capture.state == CaptureState::Open && export.seen <= capture.until
        };
        // If a patient was scanned again, the newer scan goes before what may still arrive of the
        // refused one.
        let its_own = after.iter().filter(in_time).min_by_key(|capture| capture.is_refused);
        let its_own = its_own.map(|capture| (**capture).clone());
        let measuring = self.measured_for_others(&all, export);
        let in_question = all.iter().chain(&measuring);
        let ids: BTreeSet<Option<&str>> = in_question.flat_map(|capture| ids(capture)).collect();
        if ids.iter().flatten().next().is_none() {
            // No capture in question names a patient, so no patient can be mistaken for another.
            return its_own.map_or(Judged::Unpressed, Judged::Of);
        }
        if !measuring.is_empty() {
            return held_beside(&all, &measuring);
        }
        let shared = (ids.len() > 1).then_some(Doubt::Shared);
        let unread = all.iter().find_map(|capture| self.unread_between(capture, export));
        if let Some(doubt) = shared.or(all.iter().find_map(|capture| capture.doubt)).or(unread) {
            // The export may be older than all of these captures. Without a button it may also belong to
            // the patient whose name could not be read. In both cases the captures still wait for their
            // own exports.
            return held(doubt.why(), &all, unread.is_none() && !after.is_empty());
        }
        match (its_own, after.is_empty()) {
            (Some(capture), _) => Judged::Of(capture),
            (None, true) => held(Why::Unclear, &all, false),
            (None, false) => held(Why::Late, &all[..1], true),
        }
    }

    /// Whether a naming failed between the name that opened a capture and the start of an export.
    fn unread_between(&self, capture: &Capture, export: Appeared) -> Option<Doubt> {
        let is_between = |at: &Duration| capture.opened <= *at && *at < export.seen;
        let any = capture.by == Opener::Name && self.unread.iter().any(is_between);
        any.then_some(Doubt::Unread)
    }

    /// Which capture a content belongs to; nothing changes before [`Captures::answer`].
    pub fn judge_content(&self, content: &Content) -> Judged {
        if content.is_known {
            return Judged::Unpressed;
        }
        let mut judged = self.judge(content.began);
        if let Judged::Held { answered, doubtful, .. } = &mut judged
            && content.is_cut_short
        {
            // Another export of the same body is still to come.
            (*answered, *doubtful) = (None, Vec::new());
        }
        match (&content.completes, judged) {
            // The earlier part is being measured for its capture, so this belongs to that capture too.
            (Some(whose), Judged::Unpressed) => self
                .measuring_of(whose, content.began)
                .map_or(Judged::Unpressed, |capture| Judged::Of(capture.clone())),
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
fn ids(capture: &Capture) -> Vec<Option<&str>> {
    if capture.is_unnamed() {
        return vec![None];
    }
    capture.named().map(|named| Some(named.id.as_str())).collect()
}

/// Every patient whom the captures name, each once.
fn candidates<'a>(all: impl Iterator<Item = &'a Capture>) -> Vec<Named> {
    let mut candidates: Vec<Named> = Vec::new();
    for named in all.flat_map(Capture::named) {
        if candidates.iter().all(|known| known.id != named.id) {
            candidates.push(named.clone());
        }
    }
    candidates
}

/// An export that may be a second one of a scan that is being measured and may still be refused. Either
/// way the waiting captures are in doubt.
fn held_beside(all: &[&Capture], measuring: &[&Capture]) -> Judged {
    Judged::Held {
        why: Why::Ambiguous,
        patient: None,
        candidates: candidates(all.iter().chain(measuring).copied()),
        answered: None,
        doubtful: all.iter().map(|capture| capture.number).collect(),
    }
}

/// An export that the operator must decide on, because each of the captures may be meant. `answers` says
/// whether the oldest of them stops waiting.
fn held(why: Why, all: &[&Capture], answers: bool) -> Judged {
    let candidates = candidates(all.iter().copied());
    let patient = match candidates.as_slice() {
        [one] => Some(one.clone()),
        _ => None,
    };
    let mut numbers = all.iter().map(|capture| capture.number);
    let answered = numbers.next().filter(|_| answers);
    let doubtful = if answers { numbers.collect() } else { Vec::new() };
    Judged::Held { why, patient, candidates, answered, doubtful }
}

#[cfg(test)]
mod tests;
