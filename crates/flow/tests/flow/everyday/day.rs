//! One day at a booth: who comes when, what people do, and what the scanner writes.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use gaiter_flow::ScanState;
use gaiter_flow::round::{Capture, Named};
use gaiter_flow::worklist::{
    AccessionNumbers, FindResponse, Worklist, WorklistChoice, WorklistEntry, WorklistFilter,
};
use gaiter_record::SourceKind;
use jiff::civil::{self, Date};

use super::booth::Booth;
use super::exports::{How, Rest};
use super::truth::{Plan, id};
use super::workflow::{Habits, Naming};

/// A day, milliseconds.
const DAY_MS: u64 = 8 * 3600 * 1000;

/// So many exports are left in the folder.
const FILES: usize = 12;

/// The date of a day with a worklist.
const TODAY: Date = civil::date(2026, 11, 28);

/// One in so many patients is not on the list: they come unannounced.
const UNLISTED: usize = 15;

/// So often another's entry is tapped first.
const MISTAKEN: usize = 50;

/// In one of so many hospitals accession numbers may be ids.
const LIKE_IDS: usize = 3;

/// So often the station has no list: it was started while the server was away.
const UNKNOWN: usize = 10;

/// So long it takes to see that somebody else is named, or nobody, milliseconds.
const SEEN_MS: u64 = 3_000;

/// What happens at some time.
#[derive(Debug, Clone, Copy)]
enum Act {
    Order(usize),
    Card(usize),
    /// The patient's entry of the worklist is chosen.
    Choose(usize),
    /// The operator looks at the light, and answers what it asks, or not.
    Ask(usize),
    Press(usize),
    Export(usize),
    Grow(usize),
    SecondExport(usize),
    /// Whether the scan was refused, and what people do then.
    After(usize),
}

/// A day, and what came of it.
pub struct Day<'a> {
    pub booth: Booth,
    pub habits: &'a Habits,
    acts: BTreeMap<(u64, u64), Act>,
    acts_made: u64,
    files: Vec<String>,
    list: Worklist,
    /// What the station knows of the hospital's numbers, also when it has no list.
    numbers: AccessionNumbers,
    pressed_ms: u64,
    /// Of each body, whether it is a second scan of somebody whose first one was refused.
    pub is_again: Vec<bool>,
    /// Patients at whose scan the light asked who is there, and nobody answered.
    pub unanswered: BTreeSet<usize>,
    /// How often somebody did.
    pub answers: usize,
    /// Patients who were expected and never came.
    pub no_shows: usize,
}

/// Plays the day of a seed.
pub fn play(habits: &Habits, seed: u64, tells: bool) -> Day<'_> {
    let booth = Booth::new(habits.setup(), seed, tells);
    let (acts, files) = (BTreeMap::new(), Vec::new());
    let (list, numbers) = worklist(0, false);
    let mut day = Day {
        booth,
        habits,
        acts,
        acts_made: 0,
        files,
        list,
        numbers,
        pressed_ms: 0,
        is_again: Vec::new(),
        unanswered: BTreeSet::new(),
        answers: 0,
        no_shows: 0,
    };
    day.plan();
    while let Some(((at, _), act)) = day.acts.pop_first() {
        let by_ms = at.saturating_sub(day.booth.now_ms);
        day.booth.advance(by_ms);
        day.act(act);
    }
    day.booth.advance(300_000);
    day.booth.check_records();
    day
}

fn is_id(text: &str) -> bool {
    text.bytes().all(|byte| byte.is_ascii_digit())
}

/// A list with an entry for most of so many patients, and a second one for some; and what it shows of the numbers, which
/// are ids of other patients for some if `has_like_ids`.
fn worklist(patients: usize, has_like_ids: bool) -> (Worklist, AccessionNumbers) {
    let entry = |patient: usize, number: &str| {
        WorklistEntry::from(FindResponse {
            patient_id: &id(patient),
            study_instance_uid: &format!("1.2.{patient}.{}", number.len()),
            accession_number: number,
            scheduled_station_ae_title: "LEGSCAN",
            start_date: "20261128",
            ..FindResponse::default()
        })
    };
    let first = (0..patients).map(|patient| match patient % 20 {
        3 if has_like_ids => entry(patient, &id((patient + 7) % patients)),
        _ => entry(patient, &format!("A{patient}")),
    });
    let second = (0..patients).filter(|patient| patient % 10 == 5);
    let second = second.map(|patient| entry(patient, &format!("SECOND{patient}")));
    let unlisted: Vec<String> = (7..patients).step_by(UNLISTED).map(id).collect();
    let all = first.chain(second).filter(|entry| !unlisted.contains(&entry.patient));
    let answer: Vec<WorklistEntry> = all.collect();
    let numbers = AccessionNumbers::default().seen_with(&answer, is_id);
    let expected = WorklistFilter { station: "LEGSCAN".to_owned(), modality: None };
    (Worklist::new(answer, &expected, TODAY, is_id), numbers)
}

impl Day<'_> {
    fn at(&mut self, at_ms: u64, act: Act) {
        self.acts_made += 1;
        self.acts.insert((at_ms.max(self.booth.now_ms), self.acts_made), act);
    }

    /// Evenly from `least` to `most` seconds, in milliseconds.
    fn some_s(&mut self, least: u64, most: u64) -> u64 {
        least * 1000 + self.booth.chance.below(((most - least) * 1000) as usize) as u64
    }

    fn one_in(&mut self, count: usize) -> bool {
        self.booth.chance.below(count) == 0
    }

    fn plan(&mut self) {
        let patients = 40 + self.booth.chance.below(21);
        let apart = DAY_MS / patients as u64;
        let begin = self.booth.now_ms + 600_000;
        // The first order, too, comes before its press.
        let mut press_before = self.booth.now_ms;
        // Days without a worklist draw nothing for it.
        let has_like_ids = self.habits.naming == Naming::Worklist && self.one_in(LIKE_IDS);
        (self.list, self.numbers) = worklist(patients, has_like_ids);
        for patient in 0..patients {
            let press = begin + apart * patient as u64 + self.some_s(0, apart / 2500);
            let never_comes = self.habits.no_shows && self.one_in(50);
            match self.habits.naming {
                Naming::Order => {
                    // Before the first patient nobody is in the booth.
                    let early = patient > 0 && self.habits.early && self.booth.chance.below(10) < 3;
                    let order = match early {
                        _ if self.habits.after_press => press + self.some_s(1, 5),
                        true => press_before + self.some_s(5, 120),
                        false => press - self.some_s(15, 120),
                    };
                    self.at(order.max(press_before + 1000), Act::Order(patient));
                }
                Naming::Card if !never_comes => {
                    let card = press - self.some_s(5, 40);
                    self.at(card, Act::Card(patient));
                }
                Naming::Worklist if !never_comes => {
                    let choice = press - self.some_s(10, 40);
                    self.at(choice, Act::Choose(patient));
                }
                Naming::Card | Naming::Worklist | Naming::FileName | Naming::Nobody => {}
            }
            if never_comes {
                self.no_shows += 1;
                continue;
            }
            let ask = press - self.some_s(2, 4);
            self.at(ask, Act::Ask(patient));
            self.at(press, Act::Press(patient));
            press_before = press;
        }
    }

    fn act(&mut self, act: Act) {
        match act {
            Act::Order(patient) => self.name(patient, SourceKind::Order),
            Act::Card(patient) => self.name(patient, SourceKind::Reader),
            Act::Choose(patient) => self.choose(patient),
            Act::Ask(patient) => self.ask(patient),
            Act::Press(patient) => self.press(patient, false),
            Act::Export(body) => self.export(body),
            Act::Grow(body) => self.grow(body),
            Act::SecondExport(body) => self.second_export(body),
            Act::After(body) => self.after(body),
        }
    }

    fn name(&mut self, patient: usize, by: SourceKind) {
        self.booth.tell(|| format!("{} is named: {by:?}", id(patient)));
        // The folder of orders is looked into every two seconds, and at each press.
        let ago_ms = self.booth.chance.below(2000) as u64;
        let since_press_ms = self.booth.now_ms - self.pressed_ms;
        let ago = Duration::from_millis(ago_ms.min(since_press_ms));
        let absent = self.booth.clock().saturating_sub(ago);
        self.booth.heard_name(&id(patient), by, None, Some(absent));
    }

    /// Half of the patients are named by a tap on their entry, or by their id where there is none; of the others a code
    /// is read, from the card or the paper that the patient brings. If it is not clear whom a code names, the patient is
    /// named on the page after all. Sometimes somebody else's entry is tapped, and the operator sees it.
    fn choose(&mut self, patient: usize) {
        let own = id(patient);
        if self.one_in(MISTAKEN) {
            let other = self.booth.chance.pick(self.list.entries(TODAY));
            if let Some(other) = other.map(|entry| entry.patient.clone()) {
                self.chosen(&other, SourceKind::Operator);
                self.booth.advance(SEEN_MS);
            }
            return self.chosen(&own, SourceKind::Operator);
        }
        let is_known = !self.one_in(UNKNOWN);
        let entry = self.list.entries(TODAY).iter().find(|entry| entry.patient == own);
        let number = entry.and_then(WorklistEntry::accession_number);
        let code = match self.booth.chance.below(4) {
            0 => number.map(str::to_owned),
            1 => Some(own.clone()),
            _ => None,
        };
        let Some(code) = code else { return self.chosen(&own, SourceKind::Operator) };
        let list = is_known.then_some(&self.list);
        let named = match self.numbers.chosen_by(&code, is_id(&code), list, TODAY) {
            WorklistChoice::Patient { id, .. } => Some(id.to_owned()),
            WorklistChoice::NotListed if is_id(&code) => Some(code),
            WorklistChoice::NotListed | WorklistChoice::Unclear => None,
        };
        if let Some(named) = named {
            return self.chosen(&named, SourceKind::Reader);
        }
        self.booth.tell(|| format!("{own}'s code names nobody"));
        self.booth.unread();
        self.booth.advance(SEEN_MS);
        self.chosen(&own, SourceKind::Operator);
    }

    fn chosen(&mut self, named: &str, by: SourceKind) {
        self.booth.tell(|| format!("{named} is chosen: {by:?}"));
        let absent = self.booth.clock();
        self.booth.heard_name(named, by, None, Some(absent));
    }

    /// Half of what the light asks is answered.
    fn ask(&mut self, patient: usize) {
        let Some(run) = &self.booth.run else { return };
        let is_other = |capture: &Capture| {
            capture.patient.as_ref().is_some_and(|whose| whose.id != id(patient))
        };
        let is_other_awaited = !self.habits.button && run.captures.waiting().any(is_other);
        let is_asked = run.captures.asks_who() || is_other_awaited;
        if !is_asked {
            return;
        }
        if self.one_in(2) {
            self.unanswered.insert(patient);
        } else {
            self.answers += 1;
            self.booth.tell(|| "the operator answers what the light asks".to_owned());
            if self.habits.gives_up {
                let _ = self.booth.call_off();
            }
            let _ = self.booth.name(Named::new(id(patient), SourceKind::Operator), None, None);
        }
    }

    fn press(&mut self, patient: usize, is_again: bool) {
        if self.habits.button {
            self.booth.heard_press();
            self.pressed_ms = self.booth.now_ms;
        }
        self.booth.tell(|| format!("{} is scanned", id(patient)));
        let body = self.booth.scan_body(patient, true);
        self.is_again.push(is_again);
        let is_refused = self.habits.refused && !is_again && self.one_in(25);
        // Half of the refused scans are cut short, half are whole and cannot be measured.
        let is_short = is_refused && self.one_in(2);
        let of = &mut self.booth.truth.bodies[body];
        of.is_refused = is_refused;
        of.is_late = false;
        if is_short {
            of.plan = Plan::Broken;
        }
        let begins = self.booth.now_ms + self.some_s(5, 40);
        self.at(begins, Act::Export(body));
        if is_refused {
            // Within the window that a refusal opens again, or the operator is not quick enough.
            let after = begins + self.some_s(90, 130);
            self.at(after, Act::After(body));
        }
    }

    fn export(&mut self, body: usize) {
        let patient = id(self.booth.truth.bodies[body].patient);
        let is_short = self.booth.truth.bodies[body].plan == Plan::Broken;
        let whole = self.booth.truth.bodies[body].whole.clone();
        let name = match (self.habits.one_name, self.habits.naming) {
            (true, _) => "scan.obj".to_owned(),
            (_, Naming::FileName) => format!("{patient}_{body}.obj"),
            _ => self.booth.fresh_name(),
        };
        let how = match (self.habits.temporary, self.habits.one_name) {
            (true, _) => How::Temporary,
            (_, true) if self.one_in(2) => How::Rewrite,
            (_, true) => How::Replace,
            _ => How::New,
        };
        let lasts = if self.habits.slow { 60_000 } else { self.some_s(1, 10) };
        let rest = if is_short { Rest::Open } else { Rest::After(lasts) };
        self.booth.begin_export(body, &whole, how, &name, rest);
        if is_short {
            // An empty file is no export that was cut short.
            self.at(self.booth.now_ms + 500, Act::Grow(body));
        }
        let grows = if self.habits.slow { 5_000 } else { 700 };
        for at in 1..lasts / grows {
            self.at(self.booth.now_ms + at * grows, Act::Grow(body));
        }
        if self.habits.two_exports {
            let again = self.booth.now_ms + lasts + self.some_s(1, 30);
            self.at(again, Act::SecondExport(body));
        }
        self.tidy(name);
    }

    /// The scanner keeps its last exports only.
    fn tidy(&mut self, name: String) {
        if !self.files.contains(&name) {
            self.files.push(name);
        }
        if self.files.len() > FILES {
            let oldest = self.files.remove(0);
            self.booth.folder.unlink(&oldest);
        }
    }

    fn grow(&mut self, body: usize) {
        let mut exports = self.booth.truth.exports.iter();
        if let Some(place) = exports.position(|export| export.body == body) {
            self.booth.grow(place);
        }
    }

    fn second_export(&mut self, body: usize) {
        let whole = self.booth.with_another_comment(body);
        let name = match self.habits.one_name {
            true => "scan.obj".to_owned(),
            false => self.booth.fresh_name(),
        };
        let how = if self.habits.temporary { How::Temporary } else { How::Replace };
        let lasts = self.some_s(1, 10);
        self.booth.begin_export(body, &whole, how, &name, Rest::After(lasts));
        self.tidy(name);
    }

    /// Of the refused scans half are scanned again and named, a quarter scanned again without a name,
    /// a quarter given up without a word.
    fn after(&mut self, body: usize) {
        let is_refused = self
            .booth
            .disk
            .scans()
            .any(|(_, row)| row.content.whole.body == body && row.state == ScanState::Refused);
        if !is_refused {
            return;
        }
        let patient = self.booth.truth.bodies[body].patient;
        match self.booth.chance.below(4) {
            0 | 1 => {
                match self.habits.naming {
                    Naming::Order => self.name(patient, SourceKind::Order),
                    Naming::Card => self.name(patient, SourceKind::Reader),
                    Naming::Worklist => self.choose(patient),
                    Naming::FileName | Naming::Nobody => {}
                }
                let soon = 5_000 + self.booth.chance.below(20_000) as u64;
                self.booth.advance(soon);
                self.ask(patient);
                self.press(patient, true);
            }
            2 => self.press(patient, true),
            _ => self.booth.tell(|| "given up without a word".to_owned()),
        }
    }
}
