//! What each kind of event does; whether there was occasion for it.

use super::exports::{Brought, How, Rest};
use super::folder::FileContent;
use super::kinds::Kind;
use super::people::{People, Said};
use super::truth::{Plan, id};

/// An export that begins sooner than this after its press, milliseconds, is no later than the station
/// waits: window and late, less the time from one look to the next.
pub const IN_TIME_MS: u64 = 168_000;

impl People {
    /// Something happens, if there is occasion for it.
    pub fn happens(&mut self, kind: Kind) -> bool {
        if !self.has_reason(kind) {
            return false;
        }
        match kind {
            Kind::Press => self.press(),
            Kind::PressEarly => self.press_early(),
            Kind::NextPatient => self.next_patient(),
            Kind::Card => self.card(),
            Kind::Word => self.word(),
            Kind::Order => self.order_now(),
            Kind::OrderAfterPress => self.order_after_press(),
            Kind::OrderLate => self.order_late(),
            Kind::OrderEarly => self.order_early(),
            Kind::OrderRepeated => self.order_touched(true),
            Kind::OrderTouched => self.order_touched(false),
            Kind::Unread => self.misread(),
            Kind::CardAway => self.card_away(),
            Kind::OrderAway => self.order_away(),
            Kind::OrderOvertaken => self.order_overtaken(),
            Kind::Nobody => self.nobody(),
            Kind::NoShow => self.no_show(),
            Kind::Export => self.export(How::New),
            Kind::ExportRewrites => self.export(How::Rewrite),
            Kind::ExportReplaces => self.export(How::Replace),
            Kind::ExportRenamed => self.export(How::Temporary),
            Kind::ExportMovedIn => self.export(How::MovedIn),
            Kind::OlderBroughtIn => self.bring_in_older(),
            Kind::ExportOutOfOrder => self.export_out_of_order(),
            Kind::ExportLate => self.export_late(),
            Kind::Grows => self.grows(),
            Kind::Ends => self.ends(),
            Kind::BreaksOff => self.breaks_off(),
            Kind::GoesOn => self.goes_on(),
            Kind::AgainSame => self.again_same(),
            Kind::AgainComment => self.again(Plan::Whole),
            Kind::AgainWhole => self.again(Plan::Broken),
            Kind::RescanNamed => self.rescan(true),
            Kind::RescanUnnamed => self.rescan(false),
            Kind::GivenUp => self.given_up(),
            Kind::Decide => self.runs() && self.booth.decide_held(),
            Kind::TakeBack => self.take_back(),
            Kind::Wait => {
                let by_ms = 20_000 + self.booth.chance.below(200_000) as u64;
                self.booth.advance(by_ms);
                true
            }
            other => self.disturb(other),
        }
    }

    pub fn steps_in(&mut self) -> bool {
        let ordered: Vec<usize> = self.ordered.keys().copied().collect();
        let patient = match self.booth.chance.below(4) {
            0 => self.new_patient(),
            _ => match self.booth.chance.pick(&ordered) {
                Some(patient) => *patient,
                None => self.new_patient(),
            },
        };
        self.step_in(patient);
        true
    }

    fn press_early(&mut self) -> bool {
        self.awaits_exports() && self.steps_in() && self.press()
    }

    /// The person in the booth, if the desk may order for them before they are scanned.
    fn to_be_ordered(&self) -> Option<usize> {
        let patient = self.standing?;
        let is_other = self.said_now().is_some_and(|said| said != Said::Name)
            || self.not_ordered.contains_key(&patient);
        let may = !self.is_nobodys_awaited() && !self.orders_after_press() && !is_other;
        may.then_some(patient)
    }

    /// The folder of orders goes out of reach, the order is written, and the folder is back. Every other
    /// time the practice has taken the order back by then.
    fn order_away(&mut self) -> bool {
        if self.orders_after_press() {
            return self.orders_away();
        }
        let Some(patient) = self.to_be_ordered().filter(|_| self.runs()) else { return false };
        self.booth.gap();
        self.booth.tell(|| format!("an order for {} is written out of reach", id(patient)));
        let is_back = self.booth.chance.below(2) == 0;
        self.booth.missed_name();
        if is_back && self.to_be_ordered() == Some(patient) {
            return self.order_now();
        }
        self.is_missed(patient);
        true
    }

    /// The order is written, the button pressed, and the order read.
    fn order_overtaken(&mut self) -> bool {
        let is_kept = self.runs() && !self.booth.disk.is_locked && !self.booth.is_unplugged;
        let Some(patient) = self.to_be_ordered().filter(|_| is_kept) else { return false };
        if !self.has_button() || self.said.is_some() {
            return false;
        }
        let order = self.written(patient);
        self.booth.tell(|| format!("an order for {} is written", id(patient)));
        self.booth.advance(1);
        self.says(patient, Said::Unheard);
        let is_pressed = self.press();
        // Everybody takes it to be for that press.
        self.not_ordered.remove(&patient);
        self.booth.advance(500);
        self.letters.push(order);
        self.read_orders();
        is_pressed
    }

    fn order_now(&mut self) -> bool {
        let Some(patient) = self.to_be_ordered() else { return false };
        let (runs, is_kept) = (self.runs(), !self.booth.disk.is_locked);
        self.order(patient);
        let said = if is_kept { Said::Name } else { Said::Unheard };
        if runs {
            self.says(patient, said);
        }
        true
    }

    fn order_after_press(&mut self) -> bool {
        let after_ms = 500 + self.booth.chance.below(4500) as u64;
        let Some(patient) = self.newest_not_ordered() else { return false };
        let is_fresh = |body: &super::truth::Body| self.booth.now_ms < body.scanned_ms + 60_000;
        if !self.has_button() || !self.booth.truth.bodies.last().is_some_and(is_fresh) {
            return false;
        }
        self.booth.advance(after_ms);
        self.order(patient);
        true
    }

    fn order_late(&mut self) -> bool {
        let late: Vec<(usize, usize)> =
            self.not_ordered.iter().map(|(patient, body)| (*patient, *body)).collect();
        let Some(&(patient, body)) = self.booth.chance.pick(&late) else { return false };
        let is_in_time = self.booth.now_ms < self.booth.truth.bodies[body].scanned_ms + IN_TIME_MS;
        // Without a button nothing tells a late order from one before its scan.
        if !self.has_button() && (self.said.is_some() || self.is_nobodys_awaited()) {
            return false;
        }
        if !is_in_time && !self.comes_late() {
            return false;
        }
        self.order(patient);
        true
    }

    /// Whether something may come later than anybody waits for it: counted in a row of its own.
    fn comes_late(&mut self) -> bool {
        let may = self.booth.chance.below(40) == 0;
        self.booth.truth.is_late |= may;
        may
    }

    fn order_early(&mut self) -> bool {
        if !self.may_order_ahead() {
            return false;
        }
        let patient = self.new_patient();
        self.order(patient);
        self.ordered.insert(patient, self.booth.now_ms);
        self.expected.push(patient);
        true
    }

    /// A kept order is written again with the same words, or only changes its mode.
    fn order_touched(&mut self, is_rewritten: bool) -> bool {
        let (now, count, absent) = (self.booth.now_ms, self.orders.len(), self.orders_absent());
        if count == 0 || self.is_nobodys_awaited() || !self.runs() || self.booth.disk.is_locked {
            return false;
        }
        let place = self.booth.chance.below(count);
        let order = &mut self.orders[place];
        if is_rewritten {
            order.mtime_ms = now;
        }
        let order = super::desk::Order { absent, ..order.clone() };
        self.letters.push(order);
        self.read_orders();
        true
    }

    fn no_show(&mut self) -> bool {
        let Some(patient) = self.expected.pop() else { return false };
        self.ordered.remove(&patient);
        self.booth.tell(|| format!("{} never comes", id(patient)));
        true
    }

    fn export(&mut self, how: How) -> bool {
        let Some(&body) = self.booth.truth.planned(Plan::Scanned).first() else { return false };
        self.begin(body, how)
    }

    fn export_out_of_order(&mut self) -> bool {
        let scanned = self.booth.truth.planned(Plan::Scanned);
        let Some(&body) = scanned.last().filter(|_| scanned.len() > 1) else { return false };
        let how = self.some_way();
        self.begin(body, how)
    }

    fn export_late(&mut self) -> bool {
        let Some(&body) = self.booth.truth.planned(Plan::Scanned).first() else { return false };
        let since = self.booth.now_ms - self.booth.truth.bodies[body].scanned_ms;
        let at = 91_000 + self.booth.chance.below(75_000) as u64;
        if since >= at {
            return false;
        }
        self.booth.advance(at - since);
        let how = self.some_way();
        self.begin(body, how)
    }

    fn some_way(&mut self) -> How {
        let ways = [How::New, How::Rewrite, How::Replace, How::Temporary, How::MovedIn];
        ways[self.booth.chance.below(ways.len())]
    }

    fn begin(&mut self, body: usize, how: How) -> bool {
        let of = &self.booth.truth.bodies[body];
        if self.booth.now_ms >= of.scanned_ms + IN_TIME_MS {
            if !self.comes_late() {
                self.booth.truth.bodies[body].plan = Plan::Over;
                return false;
            }
            self.booth.truth.bodies[body].is_late = true;
        }
        let whole = self.booth.truth.bodies[body].whole.clone();
        self.write(body, &whole, how)
    }

    fn write(&mut self, body: usize, whole: &std::rc::Rc<super::content::Whole>, how: How) -> bool {
        let names = self.export_names();
        let name = match how {
            How::New => self.booth.fresh_name(),
            How::Rewrite | How::Replace => match self.booth.chance.pick(&names) {
                Some(name) => name.clone(),
                None => return false,
            },
            How::Temporary | How::MovedIn => match self.booth.chance.below(2) {
                0 => self.booth.fresh_name(),
                _ => self.booth.chance.pick(&names).cloned().unwrap_or("scan.obj".to_owned()),
            },
        };
        let rest = match self.booth.chance.below(5) {
            0 | 1 => Rest::Open,
            _ => Rest::After(200 + self.booth.chance.below(12_000) as u64),
        };
        self.booth.begin_export(body, whole, how, &name, rest);
        true
    }

    fn export_names(&self) -> Vec<String> {
        let all = self.booth.folder.list().into_iter().map(|(name, _)| name);
        all.filter(|name| name.ends_with(".obj") && !name.contains('/')).collect()
    }

    /// Whether a file holds a scan that somebody brought in.
    pub fn is_older(&self, name: &str) -> bool {
        let content = self.booth.folder.export(name);
        content.is_some_and(|content| self.booth.truth.bodies[content.whole.body].is_older)
    }

    fn bring_in_older(&mut self) -> bool {
        let ways = [Brought::Folder, Brought::Copy, Brought::Over, Brought::Turned];
        let how = ways[self.booth.chance.below(ways.len())];
        let mut names = self.export_names();
        let truth = &self.booth.truth;
        names.retain(|name| {
            let mut exports = truth.exports.iter();
            exports.all(|of| of.name != *name && of.then.as_ref() != Some(name))
        });
        let fresh = self.booth.fresh_name();
        let name = match how {
            Brought::Copy | Brought::Turned => fresh,
            Brought::Folder => format!("d{}/{fresh}", self.booth.truth.comment()),
            // The measures beside it would be those of the scan that was there.
            Brought::Over if self.booth.setup.has_measures => return false,
            Brought::Over => match self.booth.chance.pick(&names) {
                Some(name) => name.clone(),
                None => return false,
            },
        };
        if how == Brought::Turned && self.booth.truth.next_end_ms().is_some() {
            return false;
        }
        let patient = self.new_patient();
        self.booth.bring_in(patient, how, &name);
        true
    }

    fn open_exports(&self, is_broken: bool) -> Vec<usize> {
        let (exports, bodies) = (&self.booth.truth.exports, &self.booth.truth.bodies);
        let of = |at: &usize| {
            let is_coming = bodies[exports[*at].body].plan == Plan::Coming;
            exports[*at].ends_ms.is_none() && is_coming != is_broken
        };
        (0..exports.len()).filter(of).collect()
    }

    fn grows(&mut self) -> bool {
        let open = self.open_exports(false);
        let Some(&place) = self.booth.chance.pick(&open) else { return false };
        self.booth.grow(place);
        true
    }

    fn ends(&mut self) -> bool {
        let open = self.open_exports(false);
        let Some(&place) = self.booth.chance.pick(&open) else { return false };
        self.booth.end_export(place);
        true
    }

    fn breaks_off(&mut self) -> bool {
        let coming: Vec<usize> = (0..self.booth.truth.exports.len())
            .filter(|at| {
                let body = self.booth.truth.exports[*at].body;
                self.booth.truth.bodies[body].plan == Plan::Coming
            })
            .collect();
        let Some(&place) = self.booth.chance.pick(&coming) else { return false };
        let export = &mut self.booth.truth.exports[place];
        export.ends_ms = None;
        let body = export.body;
        self.booth.grow(place);
        self.booth.truth.bodies[body].plan = Plan::Broken;
        self.booth.tell(|| format!("the export of body {body} breaks off"));
        true
    }

    fn goes_on(&mut self) -> bool {
        let broken = self.open_exports(true);
        let Some(&place) = self.booth.chance.pick(&broken) else { return false };
        self.booth.end_export(place);
        true
    }

    fn again_same(&mut self) -> bool {
        let names = self.export_names();
        let Some(name) = self.booth.chance.pick(&names).cloned() else { return false };
        let Some(content) = self.booth.folder.export(&name).cloned() else { return false };
        let body = content.whole.body;
        // Nobody copies what the station does not know and nobody waits for.
        let known = self.booth.disk.known(content.scan(), &content.geometry());
        if !self.may_come_again(body) && known.is_none() {
            return false;
        }
        let to = self.booth.fresh_name();
        let now = self.booth.now_ms;
        self.booth.folder.create(&to, FileContent::Export(Some(content)), now);
        self.booth.tell(|| format!("{name} is written again as {to}"));
        self.booth.hint();
        true
    }

    /// Whether an export of a body that the station does not know may still come in a new file.
    fn may_come_again(&self, body: usize) -> bool {
        let of = &self.booth.truth.bodies[body];
        let since = of.refused_ms.unwrap_or(0).max(of.scanned_ms);
        let is_known_of = self.has_button() || of.is_covered;
        is_known_of && of.plan != Plan::Over && self.booth.now_ms < since + IN_TIME_MS
    }

    /// Another export of a body: with another comment, or whole after half.
    fn again(&mut self, plan: Plan) -> bool {
        let of: Vec<usize> = self.booth.truth.planned(plan);
        let may = |body: &usize| match plan {
            Plan::Whole => self.booth.is_settled(*body) || self.may_come_again(*body),
            _ => self.may_come_again(*body),
        };
        let of: Vec<usize> = of.into_iter().filter(may).collect();
        let Some(&body) = self.booth.chance.pick(&of) else { return false };
        let is_same = plan == Plan::Broken && self.booth.chance.below(2) == 0;
        let whole = match is_same {
            true => self.booth.truth.bodies[body].whole.clone(),
            false => self.booth.with_another_comment(body),
        };
        if plan == Plan::Whole {
            let name = self.booth.fresh_name();
            let before = self.booth.truth.bodies[body].clone();
            self.booth.begin_export(body, &whole, How::MovedIn, &name, Rest::Open);
            self.booth.truth.bodies[body] = before;
            return true;
        }
        let how = self.some_way();
        self.write(body, &whole, how)
    }

    fn refused(&self) -> Vec<usize> {
        let (bodies, now) = (&self.booth.truth.bodies, self.booth.now_ms);
        let is_recent = |at_ms: u64| now < at_ms + 85_000;
        let is_refused =
            |at: &usize| bodies[*at].refused_ms.is_some_and(is_recent) && bodies[*at].is_covered;
        (0..bodies.len()).filter(is_refused).collect()
    }

    /// Somebody whose scan was refused is scanned again: the one before is given up.
    fn rescan(&mut self, is_named: bool) -> bool {
        let refused = self.refused();
        let Some(&body) = self.booth.chance.pick(&refused) else { return false };
        let patient = self.booth.truth.bodies[body].patient;
        if !is_named && self.is_other_awaited(patient) {
            return false;
        }
        if self.standing != Some(patient) {
            self.step_in(patient);
        }
        if is_named && !(if self.booth.chance.below(2) == 0 { self.card() } else { self.word() }) {
            return false;
        }
        if !is_named {
            self.said = Some((Said::Name, self.booth.now_ms));
        }
        self.booth.tell(|| format!("{} is scanned again", id(patient)));
        let of = &mut self.booth.truth.bodies[body];
        (of.plan, of.refused_ms) = (Plan::Over, None);
        let is_pressed = self.press();
        if is_pressed && !is_named && !self.has_button() {
            // The rest of the refused one may come before it.
            self.booth
                .truth
                .bodies
                .iter_mut()
                .last()
                .into_iter()
                .for_each(|of| of.is_covered = false);
        }
        is_pressed
    }

    fn given_up(&mut self) -> bool {
        let refused = self.refused();
        let Some(&body) = self.booth.chance.pick(&refused) else { return false };
        let of = &mut self.booth.truth.bodies[body];
        (of.plan, of.refused_ms) = (Plan::Over, None);
        self.booth.tell(|| format!("body {body} is given up without a word"));
        true
    }

    fn take_back(&mut self) -> bool {
        let delivered: Vec<_> = self
            .booth
            .disk
            .records
            .iter()
            .filter(|(_, (_, whose))| whose.iter().any(Option::is_some))
            .map(|(scan, _)| *scan)
            .collect();
        let Some(&scan) = self.booth.chance.pick(&delivered) else { return false };
        self.booth.decide_as(scan, None)
    }
}
