//! Two hundred stations and one archive, for a day: each has its own outbox and a line that is bad in its own ways, and
//! for an hour the archive is away for all. Every scan gets there; and when the archive is back, they do not all come in
//! one second.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::time::Duration;

use gaiter_flow::ScanId;
use gaiter_flow::outbox::{Ended, Key, Outbox};
use support::chance::Chance;

const STATIONS: usize = 200;
const SCANS_EACH: usize = 20;
const ARCHIVE: &str = "archive";

/// As a station has it.
const JOBS_MOST: usize = 3;

/// Lines are bad and scans are made until then.
const DAY: Duration = Duration::from_secs(8 * 3600);

/// How long a line stays as it is.
const SPELL: Duration = Duration::from_secs(1200);

/// The archive is away.
const OUTAGE: Range<Duration> = Duration::from_secs(3 * 3600)..Duration::from_secs(4 * 3600);

/// So many stations may come back within one second. Pauses are even up to 300 s, so 1.3 do on average.
const TOGETHER_MOST: usize = 10;

/// What a line does to what is sent over it.
#[derive(Debug, Clone, Copy)]
enum Line {
    Good,
    /// Up to a minute for an exchange.
    Slow,
    /// Every other exchange is cut before the archive has all of it.
    Cuts,
    /// The archive has it, and every other answer is lost.
    LosesAnswers,
    Down,
}

const LINES: [Line; 5] = [Line::Good, Line::Slow, Line::Cuts, Line::LosesAnswers, Line::Down];

/// What happens at a station.
#[derive(Debug)]
enum Event {
    Scanned(Key),
    Becomes(Line),
    Wakes,
    Asked { in_reach: bool },
    Tried { key: Key, ended: Ended },
}

struct Station {
    outbox: Outbox,
    due: Vec<Key>,
    line: Line,
    wakes: Option<Duration>,
}

struct Fleet {
    stations: Vec<Station>,
    /// By time, and then in the order in which it was foreseen.
    events: BTreeMap<(Duration, usize), (usize, Event)>,
    foreseen: usize,
    chance: Chance,
    /// Who sent what the archive has.
    stored: BTreeMap<ScanId, usize>,
    /// When each station first reached the archive after the outage, seconds.
    back: BTreeMap<usize, u64>,
}

impl Fleet {
    fn new(seed: u64) -> Fleet {
        let station = |_| Station {
            outbox: Outbox::default(),
            due: Vec::new(),
            line: Line::Good,
            wakes: None,
        };
        let mut fleet = Fleet {
            stations: (0..STATIONS).map(station).collect(),
            events: BTreeMap::new(),
            foreseen: 0,
            chance: Chance(seed),
            stored: BTreeMap::new(),
            back: BTreeMap::new(),
        };
        for number in 0..STATIONS {
            for scan in scans(number) {
                let at = DAY.mul_f64(fleet.chance.unit());
                let key = Key { scan, patient: None, store: ARCHIVE.to_owned() };
                fleet.foresee(at, number, Event::Scanned(key));
            }
            let mut at = SPELL.mul_f64(fleet.chance.unit());
            while at < DAY {
                let line = LINES[fleet.chance.below(LINES.len())];
                fleet.foresee(at, number, Event::Becomes(line));
                at += SPELL;
            }
            fleet.foresee(DAY, number, Event::Becomes(Line::Good));
        }
        fleet
    }

    fn foresee(&mut self, at: Duration, number: usize, event: Event) {
        self.foreseen += 1;
        self.events.insert((at, self.foreseen), (number, event));
    }

    /// Until nothing happens any more.
    fn play(&mut self) {
        while let Some(((now, _), (number, event))) = self.events.pop_first() {
            self.happens(now, number, event);
            self.goes_on(now, number);
        }
    }

    fn happens(&mut self, now: Duration, number: usize, event: Event) {
        let station = &mut self.stations[number];
        match event {
            Event::Scanned(key) => station.due.push(key),
            Event::Becomes(line) => station.line = line,
            Event::Wakes => station.wakes = station.wakes.filter(|at| *at > now),
            Event::Asked { in_reach } => {
                station.outbox.asked(ARCHIVE, in_reach, now, self.chance.unit());
            }
            Event::Tried { key, ended } => {
                station.outbox.ended(&key, ended, now, self.chance.unit());
                if ended == Ended::ForGood {
                    let before = station.due.len();
                    station.due.retain(|due| *due != key);
                    assert_eq!(station.due.len() + 1, before, "it was done before");
                }
            }
        }
    }

    fn goes_on(&mut self, now: Duration, number: usize) {
        let station = &mut self.stations[number];
        let plan = station.outbox.plan(&station.due, now, JOBS_MOST);
        let next = station.outbox.next_in(now, JOBS_MOST).map(|pause| now + pause);
        if let Some(next) = next
            && station.wakes.is_none_or(|at| next < at)
        {
            station.wakes = Some(next);
            self.foresee(next, number, Event::Wakes);
        }
        for _ in &plan.ask {
            let end = now + self.takes(number);
            let in_reach = self.is_reached(end, number);
            self.foresee(end, number, Event::Asked { in_reach });
        }
        for key in plan.attempts.into_iter().flatten() {
            let end = now + self.takes(number);
            let ended = self.tried(end, number, &key);
            self.foresee(end, number, Event::Tried { key, ended });
        }
    }

    /// How long an exchange takes.
    fn takes(&mut self, number: usize) -> Duration {
        let most = match self.stations[number].line {
            Line::Slow => Duration::from_secs(60),
            Line::Good | Line::Cuts | Line::LosesAnswers | Line::Down => Duration::from_secs(1),
        };
        most.mul_f64(self.chance.unit()) + Duration::from_millis(50)
    }

    fn is_reached(&mut self, at: Duration, number: usize) -> bool {
        let is_reached = !matches!(self.stations[number].line, Line::Down) && !OUTAGE.contains(&at);
        if is_reached && at >= OUTAGE.end {
            self.back.entry(number).or_insert(at.as_secs());
        }
        is_reached
    }

    /// An attempt that ends at this time.
    fn tried(&mut self, at: Duration, number: usize, key: &Key) -> Ended {
        let is_struck = self.chance.below(2) == 0;
        let line = self.stations[number].line;
        if !self.is_reached(at, number) || matches!(line, Line::Cuts) && is_struck {
            return Ended::StoreFailed;
        }
        let sender = *self.stored.entry(key.scan.clone()).or_insert(number);
        assert_eq!(sender, number, "the scan of another station");
        match line {
            Line::LosesAnswers if is_struck => Ended::StoreFailed,
            _ => Ended::ForGood,
        }
    }
}

/// The scans of a station.
fn scans(number: usize) -> impl Iterator<Item = ScanId> {
    (0..SCANS_EACH).map(move |scan| ScanId::of_bytes(format!("{number} {scan}").as_bytes()))
}

#[test]
fn two_hundred_stations_lose_nothing_and_do_not_come_back_in_one_second() {
    for seed in 1..=3 {
        let mut fleet = Fleet::new(seed);
        fleet.play();
        let sent = (0..STATIONS).flat_map(|number| scans(number).map(move |scan| (scan, number)));
        assert!(fleet.stored == sent.collect::<BTreeMap<_, _>>(), "seed {seed}: scans are missing");
        let left: usize = fleet.stations.iter().map(|station| station.due.len()).sum();
        assert_eq!(left, 0, "seed {seed}");
        let seconds: BTreeSet<u64> = fleet.back.values().copied().collect();
        let together = |second: &u64| fleet.back.values().filter(|at| *at == second).count();
        let most = seconds.iter().map(together).max();
        assert_eq!(fleet.back.len(), STATIONS, "seed {seed}");
        assert!(most <= Some(TOGETHER_MOST), "seed {seed}: {most:?} in one second");
    }
}
