//! The people: who stands in the booth, who is named, and by what rules they speak.

use std::collections::BTreeMap;

use gaiter::flow::OrdersWhen;
use gaiter::flow::capture::Doubt;
use gaiter::flow::order_news::{self, News, OrderState};
use gaiter::record::SourceKind;

use super::booth::Booth;
use super::laws::Off;
use super::truth::{Plan, id};

/// After so long nobody relies on a name that was said, milliseconds.
const RELIED_MS: u64 = 600_000;

/// What was said of whoever stands in the booth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Said {
    /// Their name, and the station heard it.
    Name,
    /// Their name; it was misread or lost, and nobody noticed.
    Unheard,
    /// That nobody is named.
    Nobody,
}

/// An order, as the practice software keeps it.
#[derive(Debug, Clone)]
pub struct Order {
    pub file: String,
    pub patient: usize,
    pub mtime_ms: u64,
    /// The journal failed when it was to be heard.
    pub is_late: bool,
}

/// The booth with its people.
pub struct People {
    pub booth: Booth,
    pub standing: Option<usize>,
    /// What was said for the next scan of whoever stands there, and when.
    pub said: Option<(Said, u64)>,
    /// Whose names somebody at the booth believes to be waiting.
    pub waiting: Vec<usize>,
    /// Patients to come whose orders were sent, and when.
    pub ordered: BTreeMap<usize, u64>,
    /// Patients who were scanned and never ordered, with their last scan.
    pub not_ordered: BTreeMap<usize, usize>,
    pub orders: Vec<Order>,
    /// Orders that the station has not read, for it does not run or its journal cannot be written.
    pub letters: Vec<Order>,
    pub patients: usize,
    pub keeps_orders: bool,
}

impl People {
    pub fn new(booth: Booth, keeps_orders: bool) -> People {
        People {
            booth,
            standing: None,
            said: None,
            waiting: Vec::new(),
            ordered: BTreeMap::new(),
            not_ordered: BTreeMap::new(),
            orders: Vec::new(),
            letters: Vec::new(),
            patients: 0,
            keeps_orders,
        }
    }

    pub fn has_button(&self) -> bool {
        self.booth.setup.rules.by_press
    }

    pub fn runs(&self) -> bool {
        self.booth.run.is_some()
    }

    /// Somebody new steps in, or somebody who is known comes back.
    pub fn step_in(&mut self, patient: usize) {
        self.standing = Some(patient);
        let now = self.booth.now_ms;
        let sent = self.ordered.remove(&patient).filter(|sent| now < sent + RELIED_MS);
        self.said = sent.filter(|_| self.waiting.contains(&patient)).map(|sent| (Said::Name, sent));
        self.booth.tell(|| format!("{} steps in", id(patient)));
    }

    /// Mostly there are some minutes between two patients.
    pub fn next_patient(&mut self) -> bool {
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

    /// What was said of whoever stands there and still counts.
    pub fn said_now(&self) -> Option<Said> {
        let (said, at_ms) = self.said?;
        (self.booth.now_ms < at_ms + RELIED_MS).then_some(said)
    }

    /// Whether some export is still to come.
    pub fn awaits_exports(&self) -> bool {
        (0..self.booth.truth.bodies.len()).any(|body| !self.booth.is_settled(body))
    }

    /// Without a button: whether a scan nobody was named for has not begun to come, so that its export
    /// would pass for that of whoever is named now.
    pub fn is_nobodys_awaited(&self) -> bool {
        let bodies = &self.booth.truth.bodies;
        !self.has_button()
            && bodies.iter().any(|body| body.plan == Plan::Scanned && !body.is_covered)
    }

    /// Whether another patient's name waits, or without a button the export of one who was named.
    pub fn is_other_awaited(&self, patient: usize) -> bool {
        let bodies = &self.booth.truth.bodies;
        let comes = |at: usize| bodies[at].patient != patient && !self.booth.is_settled(at);
        self.waiting.iter().any(|other| *other != patient)
            || (!self.has_button() && (0..bodies.len()).any(comes))
    }

    /// Whether somebody may be named at the booth now.
    pub fn may_name(&self) -> bool {
        self.runs() && self.standing.is_some() && !self.is_nobodys_awaited()
    }

    pub fn card(&mut self) -> bool {
        let Some(patient) = self.standing.filter(|_| self.may_name()) else { return false };
        self.booth.tell(|| format!("{} is named by card", id(patient)));
        let is_kept = !self.booth.disk.is_locked;
        self.booth.heard_name(&id(patient), SourceKind::Reader, None);
        self.is_named(patient, if is_kept { Said::Name } else { Said::Unheard });
        true
    }

    pub fn word(&mut self) -> bool {
        let Some(patient) = self.standing.filter(|_| self.may_name()) else { return false };
        // Without a button a word gives up the captures of others.
        if !self.has_button() && self.awaits_exports() {
            return false;
        }
        let named = self.booth.name(&id(patient), SourceKind::Operator, None);
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
        } else if !self.waiting.contains(&patient) {
            self.waiting.push(patient);
        }
    }

    /// What was said is for the next scan; without a button not while the present one is to come.
    pub fn says(&mut self, patient: usize, said: Said) {
        let is_of_before = !self.has_button() && self.unsettled_of(patient);
        self.said = (!is_of_before).then_some((said, self.booth.now_ms));
    }

    /// A card of whoever stands there cannot be read, or their order.
    pub fn misread(&mut self) -> bool {
        let Some(patient) = self.standing.filter(|_| self.may_name()) else { return false };
        self.booth.tell(|| format!("{}'s card cannot be read", id(patient)));
        self.booth.unread();
        self.says(patient, Said::Unheard);
        true
    }

    /// Whoever takes over says that nobody is named; not while an export comes in. Scans whose exports
    /// have not begun are given up with that.
    pub fn nobody(&mut self) -> bool {
        let bodies = &self.booth.truth.bodies;
        let comes = (0..bodies.len())
            .any(|at| !self.booth.is_settled(at) && bodies[at].plan != Plan::Scanned);
        if !self.runs() || self.standing.is_none() || comes {
            return false;
        }
        for body in self.booth.truth.planned(Plan::Scanned) {
            self.booth.truth.bodies[body].plan = Plan::Over;
        }
        let called_off = self.booth.call_off();
        self.booth.tell(|| format!("nobody is named: {called_off:?}"));
        if called_off.is_ok() {
            self.said = Some((Said::Nobody, self.booth.now_ms));
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

    /// An order of the practice software is written. The desk does not order for somebody else while
    /// somebody stands in the booth unnamed who has not been scanned.
    pub fn order(&mut self, patient: usize) {
        let file = format!("order{}", self.booth.truth.comment());
        let order = Order { file, patient, mtime_ms: self.booth.now_ms, is_late: false };
        self.booth.tell(|| format!("an order for {}", id(patient)));
        self.not_ordered.remove(&patient);
        if !self.waiting.contains(&patient) {
            self.waiting.push(patient);
        }
        if self.keeps_orders {
            self.orders.push(order.clone());
        }
        self.letters.push(order);
        self.read_orders();
    }

    /// The station reads what orders there are.
    pub fn read_orders(&mut self) {
        if !self.runs() {
            // What a run could not keep it takes with it.
            self.letters.iter_mut().for_each(|order| order.is_late = false);
        }
        if !self.runs() || self.letters.is_empty() {
            return;
        }
        if self.booth.disk.is_locked {
            // They were said and are not kept.
            self.booth.unread();
            self.letters.iter_mut().for_each(|order| order.is_late = true);
            return;
        }
        for order in std::mem::take(&mut self.letters) {
            // One that could not be read in time comes too late where no button tells one scan from
            // the next.
            let is_of_before = order.mtime_ms < self.booth.now_ms;
            self.booth.truth.is_late |= is_of_before && self.is_nobodys_awaited();
            self.read_order(&order);
        }
    }

    fn read_order(&mut self, order: &Order) {
        let words = id(order.patient);
        let mtime_ns = i128::from(order.mtime_ms) * 1_000_000;
        let found = OrderState { size: 100, mtime_ns, digest: words.clone() };
        let known = self.booth.disk.orders.insert(order.file.clone(), found.clone());
        let news = match self.booth.setup.off {
            Off::OrdersNameOnce => News::New,
            _ => order_news::news(known.as_ref(), &found),
        };
        match news {
            News::Known => {}
            News::Repeated => {
                self.booth.tell(|| format!("the order for {words} came again"));
                self.booth.heard_name(&words, SourceKind::Order, Some(Doubt::Repeated));
            }
            News::New => {
                let doubt = order.is_late.then_some(Doubt::Unread);
                self.booth.heard_name(&words, SourceKind::Order, doubt);
            }
        }
    }

    /// Whether this is a practice that orders after the press.
    pub fn orders_after_press(&self) -> bool {
        self.has_button() && self.booth.setup.rules.orders == OrdersWhen::AfterPress
    }

    /// Whether the desk may send an order for somebody who is not in the booth.
    pub fn may_order_ahead(&self) -> bool {
        if self.orders_after_press() {
            return false;
        }
        let is_unnamed = self.standing.is_some() && self.said_now() != Some(Said::Name);
        let was_scanned = self.said.is_none() && self.was_scanned();
        self.runs()
            && !self.booth.disk.is_locked
            && (!is_unnamed || was_scanned)
            && !self.is_nobodys_awaited()
            && !self.is_order_owed()
    }

    /// Whether the order of a scan is still to come where orders come after the press.
    pub fn is_order_owed(&self) -> bool {
        let is_after_press = self.booth.setup.rules.orders == OrdersWhen::AfterPress;
        is_after_press && self.not_ordered.keys().any(|patient| self.unsettled_of(*patient))
    }

    pub fn was_scanned(&self) -> bool {
        let bodies = &self.booth.truth.bodies;
        bodies.last().is_some_and(|body| Some(body.patient) == self.standing)
    }

    /// Whoever stands there is scanned, once somebody has said who it is, or nobody.
    pub fn press(&mut self) -> bool {
        let Some(patient) = self.standing else { return false };
        let Some(said) = self.ready() else { return false };
        let is_again = self.booth.truth.bodies.iter().any(|body| body.patient == patient);
        if !self.has_button() && is_again && self.unsettled_of(patient) {
            return false;
        }
        let is_kept = self.runs() && !self.booth.disk.is_locked && !self.booth.is_unplugged;
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
        self.booth.truth.bodies[body].is_refused = self.booth.chance.below(25) == 0;
        if said != Said::Name {
            self.not_ordered.entry(patient).or_insert(body);
        }
        self.said = None;
        true
    }

    /// People do what there is reason for, and now and then what there is none for.
    pub fn has_reason(&mut self, is_reason: bool) -> bool {
        is_reason || self.booth.chance.below(8) == 0
    }

    /// Whoever stands there has not been scanned, and nobody's export is to come.
    pub fn is_ones_turn(&self) -> bool {
        !self.awaits_exports() && !self.was_scanned()
    }

    /// Whoever stands there was not named and has not been scanned.
    pub fn is_unsaid(&self) -> bool {
        self.said.is_none() && !self.was_scanned()
    }

    /// Whoever stands there has not been scanned.
    pub fn is_waiting_in_booth(&self) -> bool {
        self.standing.is_some() && !self.was_scanned()
    }

    fn unsettled_of(&self, patient: usize) -> bool {
        let bodies = &self.booth.truth.bodies;
        (0..bodies.len()).any(|at| bodies[at].patient == patient && !self.booth.is_settled(at))
    }

    /// What was said of whoever is scanned now; it is said where it was not.
    fn ready(&mut self) -> Option<Said> {
        if let Some(said) = self.said_now() {
            let is_true = said != Said::Nobody || self.waiting.is_empty();
            if is_true {
                return Some(said);
            }
        }
        if self.waiting.is_empty() && self.has_button() {
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
