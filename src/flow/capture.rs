//! Captures: which export belongs to which press of the button, and so to which patient.
//!
//! A press opens a capture. The next export that is first seen after it, within its window, belongs
//! to it. Nothing is guessed: where an export could belong to more than one patient's capture, where
//! it may have lain there before the press, or where it comes after the window, it is held, and a
//! person decides.
//!
//! A station without a button opens a capture when somebody names the next patient. Where no capture
//! in question has a patient nothing can be mistaken, and nothing is held: what is not certainly the
//! export of a press counts as one without.
//!
//! | what happens | what becomes of it |
//! |---|---|
//! | one press, one export within the window | the export is the capture's |
//! | no press | [`Judged::Unpressed`]: the configuration says whether it is taken or held |
//! | a second press, the same patient or none both times | the exports are the captures' in turn |
//! | a second press, another patient or none after one | both exports are held: `capture-ambiguous` |
//! | two exports after one press | the first is the capture's, the second unpressed |
//! | no export within the window | the capture expires: an alarm |
//! | an export after the window | held: `export-late` |
//! | an export that a look before the press cannot rule out | held: `capture-unclear` |
//! | a press while another scan is measured | as any other: an export counts when it is first seen |
//! | an order of the practice software names another patient before the press | held: `capture-ambiguous`, unless somebody at the booth says who it is |
//! | the port was away at or shortly before the press, or since | held: `press-unheard`, where the capture has a patient |
//! | the station restarts in between | likewise, for it heard nothing meanwhile |
//! | the machine restarts in between | the capture expires |
//! | the clock on the wall jumps | nothing: times are since the machine's start |

mod outcome;

use std::collections::BTreeSet;
use std::time::Duration;

use crate::record::SourceKind;
pub use outcome::{CalledOff, Judged, NamedNext, Passed};

/// Finding: the export could belong to captures of different patients.
pub const AMBIGUOUS: &str = "capture-ambiguous";

/// Finding: the export may have lain there before the press.
pub const UNCLEAR: &str = "capture-unclear";

/// Finding: the export came after the window of the press it must belong to.
pub const LATE: &str = "export-late";

/// Finding: nobody listened for a while, and a press that was not heard may have made this export.
pub const UNHEARD: &str = "press-unheard";

/// Times that rule captures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rules {
    /// Captures are opened by presses; without a button, by naming the patient.
    pub by_press: bool,
    /// How long the export of a press is awaited.
    pub window: Duration,
    /// How long after its window an export may still come, and is held.
    pub late: Duration,
    /// How long a patient's name waits for its press, or without a button for its export.
    pub name_lasts: Duration,
}

/// The patient whom somebody named for the next scan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// The id, allowed as one.
    pub id: String,
    /// Who named it.
    pub by: SourceKind,
}

/// The name that waits for a press.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Next {
    /// Who.
    pub named: Named,
    /// When it was said; as in [`Capture`].
    pub at: Duration,
    /// An order named somebody else than the name that waited: whoever stands in the booth may be
    /// either.
    pub is_doubtful: bool,
}

/// The time in which the export of a press is awaited. All times are since the machine's start.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Capture {
    /// Its number in the journal.
    pub number: i64,
    /// When the button was pressed, or the patient named.
    pub opened: Duration,
    /// The end of its window.
    pub until: Duration,
    /// What opened it.
    pub by: Opener,
    /// Whose scan it is said to be.
    pub patient: Option<Named>,
    /// Why its export is still to come.
    pub state: CaptureState,
    /// Why its export could be another's, besides what other captures show.
    pub doubt: Option<Doubt>,
}

/// Why the export of a capture could be another patient's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doubt {
    /// An export that could have been its own was held.
    Shared,
    /// A press may have gone unheard.
    Unheard,
}

impl Doubt {
    /// The finding's code.
    pub const fn code(self) -> &'static str {
        match self {
            Doubt::Shared => AMBIGUOUS,
            Doubt::Unheard => UNHEARD,
        }
    }
}

/// What opened a capture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Opener {
    /// The button.
    Press,
    /// The patient's name, where there is no button.
    Name,
}

/// The states of a capture whose export has not come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CaptureState {
    /// Its export is awaited.
    Open,
    /// Its window is over.
    Expired,
    /// A person called it off.
    CalledOff,
}

/// When an export appeared, as far as looks can tell; times as in [`Capture`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Appeared {
    /// The beginning of the last look that did not find it; none where there was no look before.
    pub absent: Option<Duration>,
    /// The end of the first look that found it.
    pub seen: Duration,
}

/// The captures whose exports have not come, in the order in which they were opened, and the
/// patient's name that waits for a press.
#[derive(Debug, Clone)]
pub struct Captures {
    rules: Rules,
    waiting: Vec<Capture>,
    next: Option<Next>,
    hearing: Hearing,
}

/// Whether presses are heard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Hearing {
    /// A port is away.
    Deaf,
    /// Every port has been open since then.
    Since(Duration),
}

impl Captures {
    /// As the journal has them after a start, at which nobody has listened yet.
    pub fn new(rules: Rules, waiting: Vec<Capture>, next: Option<Next>) -> Captures {
        let mut captures = Captures { rules, waiting, next, hearing: Hearing::Deaf };
        captures.deaf();
        captures
    }

    /// A port is away: the exports of presses that are not heard may pass for those of others.
    pub fn deaf(&mut self) {
        self.hearing = Hearing::Deaf;
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

    /// The captures whose exports have not come.
    pub fn waiting(&self) -> &[Capture] {
        &self.waiting
    }

    /// The patient's name that waits for a press.
    pub fn next(&self) -> Option<&Next> {
        self.next.as_ref()
    }

    /// Whether an export is awaited.
    pub fn is_armed(&self) -> bool {
        self.waiting.iter().any(|capture| capture.state == CaptureState::Open)
    }

    /// Whether a press at this time would be in doubt, for one before it may have gone unheard.
    pub fn is_in_doubt(&self, now: Duration) -> bool {
        // The export of a press that was not heard may still come for as long as any other.
        let still = self.rules.window + self.rules.late;
        let heard_long = matches!(self.hearing, Hearing::Since(at) if now >= at + still);
        self.rules.by_press && !heard_long
    }

    /// The button was pressed: a capture with this number, with the patient whose name waited.
    pub fn pressed(&mut self, number: i64, now: Duration) -> &Capture {
        self.drop_old_name(now);
        let next = self.next.take();
        let doubt = next.as_ref().filter(|next| next.is_doubtful).map(|_| Doubt::Shared);
        let patient = next.map(|next| next.named);
        let opened = self.open(number, now, self.rules.window, Opener::Press, patient);
        opened.doubt = doubt.or(opened.doubt);
        opened
    }

    /// Somebody named the patient of the next scan. `number` is the number of the capture that may
    /// be opened.
    pub fn named(&mut self, named: Named, number: i64, now: Duration) -> NamedNext {
        if self.rules.by_press {
            self.drop_old_name(now);
            let replaced = self.next.as_ref().is_some_and(|next| next.named.id != named.id);
            let was_doubtful = self.next.as_ref().is_some_and(|next| next.is_doubtful);
            // An order comes from the desk, and who is at the booth is not known there.
            let is_doubtful = named.by == SourceKind::Order && (replaced || was_doubtful);
            self.next = Some(Next { named, at: now, is_doubtful });
            return NamedNext::Waits { replaced };
        }
        let until = now + self.rules.name_lasts;
        let newest = self.waiting.last_mut().filter(|capture| {
            let same = capture.patient.as_ref().is_some_and(|patient| patient.id == named.id);
            same && capture.state == CaptureState::Open && now <= capture.until
        });
        if let Some(capture) = newest {
            capture.until = until;
            return NamedNext::Prolonged(capture.clone());
        }
        let lasts = self.rules.name_lasts;
        NamedNext::Opened(self.open(number, now, lasts, Opener::Name, Some(named)).clone())
    }

    fn open(
        &mut self,
        number: i64,
        now: Duration,
        lasts: Duration,
        by: Opener,
        patient: Option<Named>,
    ) -> &mut Capture {
        let (state, until) = (CaptureState::Open, now + lasts);
        let doubt = self.is_in_doubt(now).then_some(Doubt::Unheard);
        self.waiting.push(Capture { number, opened: now, until, by, patient, state, doubt });
        let last = self.waiting.len() - 1;
        &mut self.waiting[last]
    }

    /// A person calls off what waits. The scanner may be at work for a press all the same, so its
    /// export would not pass for another's; a name alone moves no scanner.
    pub fn call_off(&mut self) -> CalledOff {
        let is_open = |capture: &&mut Capture| capture.state == CaptureState::Open;
        let mut captures = Vec::new();
        for capture in self.waiting.iter_mut().filter(is_open) {
            capture.state = CaptureState::CalledOff;
            captures.push(capture.number);
        }
        self.waiting.retain(|capture| {
            capture.by == Opener::Press || capture.state != CaptureState::CalledOff
        });
        CalledOff { captures, name: self.next.take().is_some() }
    }

    /// Which capture an export belongs to; nothing is changed before [`Captures::answer`].
    pub fn judge(&self, export: Appeared) -> Judged {
        let may_be_its = |capture: &&Capture| {
            capture.opened < export.seen && export.seen <= capture.until + self.rules.late
        };
        let all: Vec<&Capture> = self.waiting.iter().filter(may_be_its).collect();
        let Some(oldest) = all.first() else { return Judged::Unpressed };
        let ids: BTreeSet<Option<&str>> = all.iter().map(|capture| id(capture)).collect();
        let named = ids.iter().flatten().count();
        let patient = all.iter().find_map(|capture| capture.patient.clone());
        let patient = patient.filter(|_| named == 1);
        let is_after = |capture: &&&Capture| export.absent.is_some_and(|at| at >= capture.opened);
        let after: Vec<&&Capture> = all.iter().filter(is_after).collect();
        let in_time = |capture: &&&&Capture| {
            capture.state == CaptureState::Open && export.seen <= capture.until
        };
        let its_own = after.iter().find(in_time).map(|capture| (**capture).clone());
        if named == 0 {
            // Whose scan it is cannot be mistaken where no capture in question says it.
            return its_own.map_or(Judged::Unpressed, Judged::Of);
        }
        let shared = (ids.len() > 1).then_some(Doubt::Shared);
        if let Some(doubt) = shared.or(all.iter().find_map(|capture| capture.doubt)) {
            let doubtful = all[1..].iter().map(|capture| capture.number).collect();
            let answered = Some(oldest.number);
            return Judged::Held { code: doubt.code(), patient, answered, doubtful };
        }
        let Some(oldest) = after.first() else {
            return Judged::Held { code: UNCLEAR, patient, answered: None, doubtful: Vec::new() };
        };
        its_own.map_or_else(
            || {
                let answered = Some(oldest.number);
                Judged::Held { code: LATE, patient, answered, doubtful: Vec::new() }
            },
            Judged::Of,
        )
    }

    /// The export was taken: what it answered waits no more.
    pub fn answer(&mut self, judged: &Judged) {
        let (answered, in_doubt) = match judged {
            Judged::Unpressed => return,
            Judged::Of(capture) => (Some(capture.number), &[][..]),
            Judged::Held { answered, doubtful, .. } => (*answered, doubtful.as_slice()),
        };
        self.waiting.retain(|capture| Some(capture.number) != answered);
        for capture in self.waiting.iter_mut().filter(|c| in_doubt.contains(&c.number)) {
            capture.doubt = Some(Doubt::Shared);
        }
    }

    /// Time has passed. `coming` are the times at which files were first seen that have not settled:
    /// a capture with such a file does not expire.
    pub fn pass(&mut self, now: Duration, coming: &[Duration]) -> Passed {
        let mut passed = Passed { name_expired: self.drop_old_name(now), ..Passed::default() };
        for capture in self.waiting.iter_mut().filter(|c| c.state == CaptureState::Open) {
            let is_coming = |seen: &Duration| capture.opened < *seen && *seen <= capture.until;
            if now > capture.until && !coming.iter().any(is_coming) {
                capture.state = CaptureState::Expired;
                passed.expired.push(capture.number);
            }
        }
        let late = self.rules.late;
        let over = |capture: &mut Capture| {
            let end = capture.until + late;
            let is_coming = |seen: &Duration| capture.opened < *seen && *seen <= end;
            capture.state != CaptureState::Open && now > end && !coming.iter().any(is_coming)
        };
        passed.over = self.waiting.extract_if(.., over).map(|capture| capture.number).collect();
        passed
    }

    fn drop_old_name(&mut self, now: Duration) -> bool {
        let lasts = self.rules.name_lasts;
        let old = self.next.take_if(|next| now > next.at + lasts);
        old.is_some()
    }
}

fn id(capture: &Capture) -> Option<&str> {
    capture.patient.as_ref().map(|named| named.id.as_str())
}

#[cfg(test)]
mod tests;
