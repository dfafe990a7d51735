//! One sequence of events, and what came of it.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::rc::Rc;

use gaiter_flow::OrdersWhen;
use gaiter_flow::patient::check_digit::CheckDigit;
use gaiter_flow::patient::identity::Identity;
use gaiter_flow::round::Rules;
use regex::Regex;

use super::booth::{Booth, LATE, NAME_LASTS, Setup, WINDOW};
use super::chance::Chance;
use super::kinds::{Kind, Pairs, Share, theme};
use super::laws::Off;
use super::people::People;
use super::worklist::{DayList, wrong_request};

/// Events of a sequence.
const EVENTS: usize = 40;

/// So often another kind is drawn where there is no occasion for one.
const DRAWS: usize = 40;

/// So many times as often the kinds of a sequence's theme are drawn.
const THEME: usize = 3;

/// So many times where a law is looked for.
const LAW: usize = 4;

/// One in so many times what is away comes back.
const BACK: usize = 4;

/// The stations that are tried: with a button and without, with orders before and after the press.
pub struct Stations {
    identity: Rc<Identity>,
}

impl Stations {
    pub fn new() -> Stations {
        let line = Some(Regex::new("^PATIENT=(?<patient>.*)$").unwrap());
        let pattern = Regex::new("[0-9]+").unwrap();
        let identity = Identity::new(None, line, &pattern, CheckDigit::None).unwrap();
        Stations { identity: Rc::new(identity) }
    }

    /// One of them.
    pub fn setup(&self, chance: &mut Chance, off: Off) -> Setup {
        let by_press = chance.below(2) == 0;
        let orders = match chance.below(2) {
            0 => OrdersWhen::BeforePress,
            _ => OrdersWhen::AfterPress,
        };
        let window = if off == Off::InTime { 10 * WINDOW } else { WINDOW };
        let rules = Rules { by_press, window, late: LATE, name_lasts: NAME_LASTS, orders };
        Setup {
            rules,
            hints: chance.below(3) > 0,
            identity: Rc::clone(&self.identity),
            has_measures: chance.below(5) == 0,
            hold_unpressed: chance.below(4) == 0,
            off,
        }
    }
}

/// What came of sequences.
#[derive(Debug, Default)]
pub struct Ended {
    pub wrong: Option<String>,
    /// A rule that was broken when a scan came to a patient.
    pub unclean: Option<String>,
    pub story: Vec<String>,
    pub pairs: Pairs,
    pub events: u64,
    pub scans: u64,
    /// Scans that came to a patient, that a person had to decide upon, that came in without a patient.
    pub given: u64,
    pub held: u64,
    pub unassigned: u64,
    pub refused: u64,
    /// Why they are held.
    pub causes: BTreeMap<&'static str, u64>,
    /// Bodies that went wrong for something came later than anybody waits for it.
    pub excused: u64,
}

impl Ended {
    pub fn add(&mut self, other: Ended) {
        self.pairs.add(&other.pairs);
        self.events += other.events;
        self.scans += other.scans;
        self.given += other.given;
        self.held += other.held;
        self.unassigned += other.unassigned;
        self.refused += other.refused;
        self.excused += other.excused;
        for (why, count) in other.causes {
            *self.causes.entry(why).or_default() += count;
        }
    }

    pub fn table(&self) -> String {
        let Ended { events, scans, given, held, unassigned, refused, excused, causes, .. } = self;
        let (rarest, count) = self.pairs.rarest();
        let mut table = format!(
            "{events} events, {scans} scans came in: {given} to their patient, {held} held, \
             {unassigned} without a patient, {refused} refused; wrong because too late: {excused}\n\
             held: {causes:?}\n\
             the rarest pair, {rarest:?}, {count} times\n"
        );
        for (kind, count) in self.pairs.counts() {
            let _ = write!(table, "{kind:?} {count}  ");
        }
        table
    }
}

/// Runs the sequence of a seed; `tells` keeps what happened in words.
pub fn run(stations: &Stations, seed: u64, off: Off, tells: bool) -> Ended {
    let mut chance = Chance(seed.wrapping_mul(0xd134_2543_de82_ef95));
    chance.below(7);
    let setup = stations.setup(&mut chance, off);
    let law = if off == Off::Nothing { Off::ALL[chance.below(Off::ALL.len())] } else { off };
    let theme = theme(law);
    let kinds = some_kinds(&mut chance, off, theme);
    let keeps_orders = chance.below(2) == 0;
    let mut booth = Booth::new(setup, seed, tells);
    let rules = booth.setup.rules;
    booth.tell(|| format!("{rules:?}"));
    let list = DayList::new(seed, off);
    let mut people = People::new(booth, list, keeps_orders, theme);
    people.is_calm = people.booth.chance.below(4) > 0;
    let mut ended = Ended::default();
    let mut before = Vec::new();
    for _ in 0..EVENTS {
        let gap_ms = gap_ms(&mut people.booth.chance);
        people.booth.advance(gap_ms);
        people.read_orders();
        people.list.pass(people.patients, people.booth.run.is_some());
        let Some(kind) = some_kind(&kinds, &mut people) else { continue };
        ended.pairs.note(&before, kind);
        before.push(kind);
        ended.events += 1;
        if people.booth.truth.wrong.is_some() {
            break;
        }
    }
    rest(&mut people);
    tally(&people, &mut ended);
    ended.wrong = people.booth.truth.wrong.clone().or_else(|| wrong_request(&people.booth.disk));
    ended.unclean = people.booth.truth.unclean.clone();
    ended.story = people.booth.story.take().unwrap_or_default();
    ended
}

/// The kinds of one sequence, as often as they are drawn. Where each sequence leaves out some, the few
/// that must meet do so more often than where all are drawn every time (Groce et al., "Swarm Testing",
/// ISSTA 2012); and faults at every step would leave nothing but held scans.
fn some_kinds(chance: &mut Chance, off: Off, theme: &[Kind]) -> Vec<Kind> {
    // Where a law is looked for, few faults besides those in mind hold everything anyway.
    let faults_in = if off == Off::Nothing { [0, 1, 1, 3] } else { [0, 0, 0, 1] };
    let faults_in = faults_in[chance.below(4)];
    let is_in = |kind: &Kind, chance: &mut Chance| match kind.share() {
        Share::Always => true,
        Share::Half => chance.below(2) == 0,
        Share::Apart => off == Off::Nothing && chance.below(2) == 0,
        Share::Seldom => off == Off::Nothing || chance.below(2) == 0,
        Share::Fault => chance.below(9) < faults_in,
    };
    let is_in = |kind: &Kind, chance: &mut Chance| is_in(kind, chance) || theme.contains(kind);
    let kinds: Vec<Kind> = Kind::ALL.into_iter().filter(|kind| is_in(kind, chance)).collect();
    let times = if off == Off::Nothing { THEME } else { LAW };
    let often = |kind: &Kind| if theme.contains(kind) { times } else { 1 };
    let weighed =
        kinds.iter().flat_map(|kind| std::iter::repeat_n(*kind, kind.weight() * often(kind)));
    weighed.collect()
}

/// What is away comes back, sooner than anything else.
fn what_is_away(booth: &Booth) -> Option<Kind> {
    let away = [
        (booth.is_paused, Kind::Pause),
        (booth.is_away, Kind::FolderAway),
        (booth.is_unplugged, Kind::Unplug),
        (booth.is_suspended, Kind::Sleep),
        (booth.disk.is_store_away, Kind::StoreAway),
        (booth.run.is_none(), Kind::Crash),
    ];
    away.into_iter().find(|(is_away, _)| *is_away).map(|(_, kind)| kind)
}

fn some_kind(kinds: &[Kind], people: &mut People) -> Option<Kind> {
    for _ in 0..DRAWS {
        let back = what_is_away(&people.booth).filter(|_| people.booth.chance.below(BACK) == 0);
        let kind = match back {
            Some(back) => back,
            None => *people.booth.chance.pick(kinds)?,
        };
        if people.happens(kind) {
            return Some(kind);
        }
    }
    None
}

fn gap_ms(chance: &mut Chance) -> u64 {
    let most = match chance.below(10) {
        0..=2 => 400,
        3..=6 => 4_000,
        7 | 8 => 15_000,
        _ => 60_000,
    };
    chance.below(most) as u64
}

/// Everything comes to an end.
fn rest(people: &mut People) {
    let booth = &mut people.booth;
    if booth.is_suspended {
        booth.resumes();
    }
    (booth.is_paused, booth.is_away, booth.fault) = (false, false, None);
    (booth.disk.is_locked, booth.disk.is_store_away) = (false, false);
    if booth.run.is_none() {
        booth.start();
    }
    booth.advance(70_000);
    booth.disk.withdraw();
    booth.advance(10_000);
    booth.check_records();
}

fn tally(people: &People, ended: &mut Ended) {
    use gaiter_flow::{DeliveryState, ScanState};
    for (_, row) in people.booth.disk.scans() {
        ended.scans += 1;
        ended.refused += u64::from(row.state == ScanState::Refused);
        ended.held += u64::from(row.held.is_some());
        if let Some(why) = row.held {
            *ended.causes.entry(why).or_default() += 1;
        }
        for (who, state) in &row.deliveries {
            if *state == DeliveryState::Delivered {
                let of = if who.is_some() { &mut ended.given } else { &mut ended.unassigned };
                *of += 1;
            }
        }
    }
    ended.excused += people.booth.truth.excused as u64;
}
