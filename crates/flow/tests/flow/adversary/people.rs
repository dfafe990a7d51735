//! The people: who stands in the booth, who is named, and by what rules they speak.

use std::collections::BTreeMap;
use std::time::Duration;

use gaiter_flow::ScanState;
use gaiter_flow::round::Named;
use gaiter_record::SourceKind;

use super::booth::Booth;
use super::desk::Order;
use super::kinds::Kind;
use super::truth::{Plan, id};
use super::worklist::DayList;

/// One whole scan in so many cannot be measured.
const REFUSED: usize = 6;

/// After so long nobody relies on a name that was said, milliseconds.
const RELIED_MS: u64 = 600_000;

/// What was said of the person in the booth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Said {
    /// Their name, and the station heard it.
    Name,
    /// Their name; it was misread or lost, and nobody noticed.
    Unheard,
    /// That nobody is named.
    Nobody,
}

/// The booth with its people.
pub struct People {
    pub booth: Booth,
    pub list: DayList,
    pub standing: Option<usize>,
    /// What was said for the next scan of the person in the booth, and when.
    pub said: Option<(Said, u64)>,
    /// Whose names somebody at the booth believes to be waiting.
    pub waiting: Vec<usize>,
    /// Patients to come whose orders were sent, and when.
    pub ordered: BTreeMap<usize, u64>,
    /// Patients to come, whatever became of their orders.
    pub expected: Vec<usize>,
    /// Patients who were scanned and never ordered, with their last scan.
    pub not_ordered: BTreeMap<usize, usize>,
    pub orders: Vec<Order>,
    /// Orders that the station has not read, for it does not run or its journal cannot be written.
    pub letters: Vec<Order>,
    /// The folder of orders is out of reach.
    pub are_orders_away: bool,
    /// Then: when the station last looked into it, on its clock.
    pub orders_seen: Option<Duration>,
    pub patients: usize,
    pub keeps_orders: bool,
    /// So many scans were made before somebody last said that nobody is named.
    given_up: usize,
    /// What the sequence has in mind: it happens without a reason, too.
    pub theme: &'static [Kind],
    /// People take their time, and what is held is decided before the next patient: most rounds are clean
    /// but for what the sequence has in mind.
    pub is_calm: bool,
}

impl People {
    pub fn new(booth: Booth, list: DayList, keeps_orders: bool, theme: &'static [Kind]) -> People {
        People {
            booth,
            list,
            standing: None,
            said: None,
            waiting: Vec::new(),
            ordered: BTreeMap::new(),
            expected: Vec::new(),
            not_ordered: BTreeMap::new(),
            orders: Vec::new(),
            letters: Vec::new(),
            are_orders_away: false,
            orders_seen: None,
            patients: 0,
            keeps_orders,
            given_up: 0,
            theme,
            is_calm: false,
        }
    }

    pub fn has_button(&self) -> bool {
        self.booth.setup.rules.by_press
    }

    pub fn runs(&self) -> bool {
        self.booth.run.is_some() && !self.booth.is_suspended
    }

    /// Somebody new steps in, or somebody who is known comes back.
    pub fn step_in(&mut self, patient: usize) {
        self.standing = Some(patient);
        self.expected.retain(|other| *other != patient);
        let now = self.booth.now_ms;
        let sent = self.ordered.remove(&patient).filter(|sent| now < sent + RELIED_MS);
        self.said = sent.filter(|_| self.waiting.contains(&patient)).map(|sent| (Said::Name, sent));
        self.booth.tell(|| format!("{} steps in", id(patient)));
    }

    /// Mostly there are some minutes between two patients.
    pub fn next_patient(&mut self) -> bool {
        if self.is_calm && !self.awaits_exports() {
            while self.booth.decide_held() {}
            self.booth.advance(200_000);
        }
        if !self.awaits_exports() && self.booth.chance.below(2) == 0 {
            let by_ms = self.booth.chance.below(300_000) as u64;
            self.booth.advance(by_ms);
        }
        self.steps_in()
    }

    pub fn new_patient(&mut self) -> usize {
        self.patients += 1;
        self.patients
    }

    /// What was said of the person in the booth and still counts.
    pub fn said_now(&self) -> Option<Said> {
        let (said, at_ms) = self.said?;
        (self.booth.now_ms < at_ms + RELIED_MS).then_some(said)
    }

    /// Whether some export is still to come.
    pub fn awaits_exports(&self) -> bool {
        (0..self.booth.truth.bodies.len()).any(|body| !self.booth.is_settled(body))
    }

    /// Without a button: whether a scan nobody was named for has not begun to come, so that its export
    /// would pass for that of the person who is named now.
    pub fn is_nobodys_awaited(&self) -> bool {
        let bodies = &self.booth.truth.bodies;
        !self.has_button()
            && bodies.iter().any(|body| body.plan == Plan::Scanned && !body.is_covered)
    }

    /// Whether another patient's name waits, or without a button something may still come of the scan of
    /// one who was named.
    pub fn is_other_awaited(&self, patient: usize) -> bool {
        let bodies = &self.booth.truth.bodies;
        let others = (self.given_up..bodies.len()).filter(|at| bodies[*at].patient != patient);
        self.waiting.iter().any(|other| *other != patient)
            || (!self.has_button() && !others.into_iter().all(|body| self.is_done(body)))
    }

    /// Whether somebody may be named at the booth now.
    pub fn may_name(&self) -> bool {
        self.runs() && self.standing.is_some() && !self.is_nobodys_awaited()
    }

    pub fn card(&mut self) -> bool {
        // Nobody sees that the process stands still.
        let may_name = self.may_name() || (self.booth.is_suspended && self.has_button());
        let Some(patient) = self.standing.filter(|_| may_name) else { return false };
        // Where a code names nobody, everybody sees it and it is said by a word.
        let may_say = !self.booth.is_suspended && (self.has_button() || !self.awaits_exports());
        let named = match may_say {
            true => self.list.read(patient),
            false => Some(Named::new(id(patient), SourceKind::Reader)),
        };
        let Some(named) = named else {
            self.booth.tell(|| format!("{}'s code names nobody", id(patient)));
            self.booth.unread();
            return self.word();
        };
        self.booth.tell(|| format!("{} is named by card", id(patient)));
        let is_kept = !self.booth.disk.is_locked;
        self.booth.heard(named, None, None);
        self.is_named(patient, if is_kept { Said::Name } else { Said::Unheard });
        true
    }

    pub fn word(&mut self) -> bool {
        let Some(patient) = self.standing.filter(|_| self.may_name()) else { return false };
        // Without a button a word gives up the captures of others.
        if !self.has_button() && self.awaits_exports() {
            return false;
        }
        let named = self.list.tapped_or_typed(patient);
        let named = self.booth.name(named, None, None);
        self.booth.tell(|| format!("{} is named by word: {named:?}", id(patient)));
        if named.is_ok() {
            self.is_named(patient, Said::Name);
            if !self.has_button() {
                self.gives_up_refused(patient);
            }
        }
        true
    }

    /// Nobody relies on refused scans of others any more.
    fn gives_up_refused(&mut self, patient: usize) {
        for body in self.booth.truth.bodies.iter_mut().filter(|body| body.patient != patient) {
            body.refused_ms = None;
        }
    }

    /// At the booth: the last word counts.
    fn is_named(&mut self, patient: usize, said: Said) {
        self.says(patient, said);
        if said == Said::Name {
            self.waiting = vec![patient];
            self.ordered.clear();
        } else {
            self.is_missed(patient);
        }
    }

    /// What was said is for the next scan; without a button not while the present one is to come.
    pub fn says(&mut self, patient: usize, said: Said) {
        let is_of_before = !self.has_button() && self.unsettled_of(patient);
        self.said = (!is_of_before).then_some((said, self.booth.now_ms));
    }

    /// The card of the person in the booth is read while the reader's port is away, or settles.
    pub fn card_away(&mut self) -> bool {
        let Some(patient) = self.standing.filter(|_| self.may_name()) else { return false };
        self.booth.gap();
        self.booth.tell(|| format!("{}'s card is read at a port that is away", id(patient)));
        self.booth.missed_name();
        self.is_missed(patient);
        true
    }

    /// The person in the booth was named, and nobody noticed that it was not heard.
    pub fn is_missed(&mut self, patient: usize) {
        self.says(patient, Said::Unheard);
        if !self.waiting.contains(&patient) {
            self.waiting.push(patient);
        }
    }

    /// The card or the order of the person in the booth cannot be read.
    pub fn misread(&mut self) -> bool {
        let Some(patient) = self.standing.filter(|_| self.may_name()) else { return false };
        self.booth.tell(|| format!("{}'s card cannot be read", id(patient)));
        self.booth.unread();
        self.says(patient, Said::Unheard);
        true
    }

    /// The next operator says that nobody is named; not while an export comes in. Scans whose exports
    /// have not begun are given up with that.
    pub fn nobody(&mut self) -> bool {
        let bodies = &self.booth.truth.bodies;
        let comes = (0..bodies.len())
            .any(|at| !self.booth.is_settled(at) && bodies[at].plan != Plan::Scanned);
        if !self.runs() || self.standing.is_none() || comes {
            return false;
        }
        let called_off = self.booth.call_off();
        self.booth.tell(|| format!("nobody is named: {called_off:?}"));
        if called_off.is_ok() {
            self.said = Some((Said::Nobody, self.booth.now_ms));
            self.given_up = self.booth.truth.bodies.len();
            for body in self.booth.truth.planned(Plan::Scanned) {
                self.booth.truth.bodies[body].plan = Plan::Over;
            }
            self.nothing_waits();
        }
        true
    }

    /// Nothing waits any more, and nobody relies on what was refused.
    pub fn nothing_waits(&mut self) {
        self.waiting.clear();
        self.ordered.clear();
        for body in &mut self.booth.truth.bodies {
            body.refused_ms = None;
            if body.plan == Plan::Broken {
                body.plan = Plan::Over;
            }
        }
    }

    pub fn was_scanned(&self) -> bool {
        let mut bodies = self.booth.truth.bodies.iter().filter(|body| !body.is_older);
        bodies.next_back().is_some_and(|body| Some(body.patient) == self.standing)
    }

    /// The person in the booth is scanned, once somebody has said who it is, or nobody.
    pub fn press(&mut self) -> bool {
        let Some(patient) = self.standing else { return false };
        let Some(said) = self.ready() else { return false };
        let is_again = self.booth.truth.bodies.iter().any(|body| body.patient == patient);
        if !self.has_button() && is_again && self.unsettled_of(patient) {
            return false;
        }
        let is_kept =
            self.booth.run.is_some() && !self.booth.disk.is_locked && !self.booth.is_unplugged;
        if self.has_button() {
            let is_heard = self.booth.heard_press();
            self.booth
                .tell(|| format!("the button is pressed for {} (heard {is_heard})", id(patient)));
            if is_kept {
                self.waiting.retain(|other| *other != patient);
            }
        } else {
            self.booth.tell(|| format!("{} is scanned", id(patient)));
            self.waiting.retain(|other| *other != patient);
        }
        let is_covered = if self.has_button() { is_kept } else { said == Said::Name };
        let body = self.booth.scan_body(patient, is_covered);
        self.booth.truth.bodies[body].is_refused = self.booth.chance.below(REFUSED) == 0;
        if said != Said::Name {
            self.not_ordered.entry(patient).or_insert(body);
        }
        self.said = None;
        true
    }

    /// People do what there is reason for, and now and then what there is none for.
    pub fn has_reason(&mut self, kind: Kind) -> bool {
        let is_reason = match kind {
            Kind::Press => !self.awaits_exports() && !self.was_scanned(),
            Kind::NextPatient => self.standing.is_none() || self.was_scanned(),
            Kind::Card | Kind::Word | Kind::Order => self.said.is_none() && !self.was_scanned(),
            Kind::OrderAway if self.orders_after_press() => true,
            Kind::CardAway | Kind::OrderAway | Kind::OrderOvertaken => {
                self.said.is_none() && !self.was_scanned()
            }
            Kind::OrderEarly => self.was_scanned(),
            _ => true,
        };
        let strays = if self.is_calm { 64 } else { 8 };
        is_reason || self.theme.contains(&kind) || self.booth.chance.below(strays) == 0
    }

    /// Whether all that came in of a scan was measured, or it was none of this booth.
    fn is_done(&self, body: usize) -> bool {
        if self.booth.truth.bodies[body].is_older {
            return true;
        }
        let rows = self.booth.disk.scans().filter(|(_, row)| row.content.whole.body == body);
        let mut states =
            rows.map(|(_, row)| row.state == ScanState::Delivered && row.held.is_none()).peekable();
        states.peek().is_some() && states.all(|is_delivered| is_delivered)
    }

    /// Whether every scan was measured since somebody last said that nobody is named.
    fn is_all_done(&self) -> bool {
        let count = self.booth.truth.bodies.len();
        !self.awaits_exports() && (self.given_up..count).all(|body| self.is_done(body))
    }

    pub fn unsettled_of(&self, patient: usize) -> bool {
        let bodies = &self.booth.truth.bodies;
        (0..bodies.len()).any(|at| bodies[at].patient == patient && !self.booth.is_settled(at))
    }

    /// What was said of the person who is scanned now; it is said where it was not.
    fn ready(&mut self) -> Option<Said> {
        if let Some(said) = self.said_now() {
            let is_true = said != Said::Nobody || self.waiting.is_empty();
            if is_true {
                return Some(said);
            }
        }
        if self.waiting.is_empty() && (self.has_button() || self.is_all_done()) {
            // Nobody is named, and nobody need say so.
            return Some(Said::Nobody);
        }
        let draw = self.booth.chance.below(3);
        let is_said = match draw {
            0 => self.card(),
            1 => self.word(),
            _ => self.nobody(),
        };
        if is_said { self.said_now() } else { None }
    }
}
