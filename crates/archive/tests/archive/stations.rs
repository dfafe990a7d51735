//! Twelve real stations and one archive, for an hour: each has its own folders, journal and line, and puts its scans into
//! one store of objects by HTTPS. Lines are cut and fall silent, stations, workers and indexer are killed with -9 at
//! random, and for a sixth of the time the store is away for all. At rest every scan that was exported is announced, and
//! there with one result; none is lost, none is there twice, none is somebody else's.
//!
//! `GAITER_FLEET_MINUTES` sets for how long (3 are enough for a try), `GAITER_FLEET_STATIONS` how many stations there are,
//! `GAITER_SEED` draws other faults. The program of the stations is built before, or `GAITER_BIN` names it.

#![allow(clippy::panic)]

use std::collections::BTreeMap;
use std::env;
use std::str::FromStr;
use std::thread::sleep;
use std::time::{Duration, Instant};

use gaiter_record::archive::{
    Announcement, Document, ObjectKey, Outcome, Pseudonym, RecordHash, SiteKey, unpacked,
};
use gaiter_record::same_numbers::record_differs;
use gaiter_record::{Record, ScanId};
use rig::invariants::Moment;
use rig::{Booth, Daemon, Setting};
use serde_json::Value;
use support::chance::Chance;
use support::coarse_body;

use crate::gate::{Gate, Stop};
use crate::place::{Place, Ports, Running, method};
use crate::servers::{database, tls_file, tls_store};

/// Where nothing else is asked for.
const MINUTES: u64 = 60;
const STATIONS: usize = 12;

/// With fewer stations it is no wonder if most of them come back within one second.
const STATIONS_LEAST: usize = 10;

/// Processes that measure for the archive.
const WORKERS: usize = 2;

/// How often something may happen.
const TICK: Duration = Duration::from_secs(1);

/// How often it does, of all stations together: scans beside the bursts, killed stations, killed processes of the archive,
/// lines that are stopped. A scan takes some six seconds of one core, in all places together.
const SCANS_A_MINUTE: f64 = 1.0;
const KILLS_A_MINUTE: [f64; 2] = [1.0, 1.0];
const STOPS_A_MINUTE: f64 = 6.0;

/// What is killed comes back within this time, seconds.
const AWAY_MOST_S: f64 = 20.0;

/// A line stops within so many pieces: a heartbeat has some four of them, a scan some ten.
const PIECES_MOST: usize = 12;

/// How long a line is silent on average, seconds.
const SILENCE_S: usize = 20;

/// More than a crop or a record has, bytes.
const MOST: u64 = 1 << 26;

/// What happens at a time of its own, as a share of the whole. Pauses of stations grow up to five minutes, so an outage
/// of ten and twenty minutes after it leave nobody waiting.
const EVENTS: [(f64, Event); 5] = [
    (0.0, Event::Burst),
    (0.25, Event::Burst),
    (0.5, Event::StoreGoes),
    (0.51, Event::Burst),
    (0.667, Event::StoreReturns),
];

#[derive(Debug, Clone, Copy)]
enum Event {
    /// Every station has a scan at once.
    Burst,
    StoreGoes,
    StoreReturns,
}

/// A station, and its line to the store.
struct Station {
    name: String,
    booth: Booth,
    gate: Gate,
}

/// A scan that was exported.
struct Exported {
    station: String,
    patient: String,
    scan: ScanId,
}

/// A process that does not end by itself, and is killed with -9 where it is dropped.
trait Process {
    fn has_ended(&mut self) -> bool;
}

impl Process for Daemon {
    fn has_ended(&mut self) -> bool {
        Daemon::has_ended(self)
    }
}

impl Process for Running {
    fn has_ended(&mut self) -> bool {
        Running::has_ended(self)
    }
}

/// A process that comes back.
struct Kept<'a> {
    start: Box<dyn Fn() -> Box<dyn Process> + 'a>,
    running: Option<Box<dyn Process>>,
    back: Instant,
}

impl<'a> Kept<'a> {
    fn new<P: Process + 'static>(start: impl Fn() -> P + 'a) -> Kept<'a> {
        let start = Box::new(move || -> Box<dyn Process> { Box::new(start()) });
        Kept { start, running: None, back: Instant::now() }
    }

    fn kill(&mut self, away: Duration) {
        self.running = None;
        self.back = Instant::now() + away;
    }

    fn look(&mut self) {
        match &mut self.running {
            Some(running) => assert!(!running.has_ended(), "a process has ended by itself"),
            None if Instant::now() >= self.back => self.running = Some((self.start)()),
            None => {}
        }
    }
}

/// All that runs, and what happens to it.
struct Fleet<'a> {
    stations: &'a [Station],
    /// The line of workers and indexer to the store.
    gate: &'a Gate,
    /// The stations; workers and indexer.
    kept: [Vec<Kept<'a>>; 2],
    exported: Vec<Exported>,
    chance: Chance,
    /// When the store came back.
    back: Option<Instant>,
}

impl<'a> Fleet<'a> {
    fn new(place: &'a Place, stations: &'a [Station], gate: &'a Gate, seed: u64) -> Fleet<'a> {
        let ports = Ports { store: gate.port, ..place.ports };
        let verb = |args: &'static [&'static str]| Kept::new(move || place.start(ports, args));
        let mut archive: Vec<Kept<'a>> = (0..WORKERS).map(|_| verb(&["work"])).collect();
        archive.push(verb(&["index"]));
        let daemon = |station: &'a Station| Kept::new(move || station.booth.start());
        let kept = [stations.iter().map(daemon).collect(), archive];
        Fleet { stations, gate, kept, exported: Vec::new(), chance: Chance(seed), back: None }
    }

    /// Whether something happens in this tick.
    fn comes(&mut self, a_minute: f64) -> bool {
        self.chance.unit() < a_minute * TICK.as_secs_f64() / 60.0
    }

    fn look(&mut self) {
        self.kept.iter_mut().flatten().for_each(Kept::look);
    }

    /// What may happen at any time.
    fn tick(&mut self) {
        self.look();
        if self.comes(SCANS_A_MINUTE) {
            let at = self.chance.below(self.stations.len());
            self.export(at);
        }
        for (of, a_minute) in KILLS_A_MINUTE.into_iter().enumerate() {
            if self.comes(a_minute) {
                let at = self.chance.below(self.kept[of].len());
                let away = self.chance.unit() * AWAY_MOST_S;
                self.kept[of][at].kill(Duration::from_secs_f64(away));
            }
        }
        if self.comes(STOPS_A_MINUTE) {
            let at = self.chance.below(self.stations.len());
            let kinds = [Stop::Before, Stop::After, Stop::Within];
            let kind = kinds[self.chance.below(kinds.len())];
            self.stations[at].gate.stop_again(kind, 1 + self.chance.below(PIECES_MOST));
        }
        for station in self.stations {
            if station.gate.has_stopped() && self.chance.below(SILENCE_S) == 0 {
                station.gate.resume();
            }
        }
    }

    fn happens(&mut self, event: Event) {
        match event {
            Event::Burst => (0..self.stations.len()).for_each(|at| self.export(at)),
            Event::StoreGoes => self.gates().iter().for_each(|gate| gate.close(true)),
            Event::StoreReturns => {
                self.back = Some(Instant::now());
                self.gates().iter().for_each(|gate| gate.close(false));
            }
        }
    }

    fn gates(&self) -> Vec<&Gate> {
        self.stations.iter().map(|station| &station.gate).chain([self.gate]).collect()
    }

    /// A station gets a scan of a body and a patient of its own.
    fn export(&mut self, at: usize) {
        let Station { name, booth, .. } = &self.stations[at];
        let number = self.exported.len();
        let (patient, bytes) = (format!("P{number:06}"), body(number));
        booth.export(&format!("{patient}_fleet.obj"), &bytes);
        let scan = ScanId::of_bytes(&bytes);
        self.exported.push(Exported { station: name.clone(), patient, scan });
    }

    /// Nothing happens any more, and everything runs until nothing is left to do.
    fn rest(&mut self, place: &Place) {
        self.gates().iter().for_each(|gate| gate.resume());
        for kept in self.kept.iter_mut().flatten() {
            kept.back = Instant::now();
        }
        self.look();
        for Station { name, booth, .. } in self.stations {
            // To the folder and to the archive.
            let delivered = "SELECT count(*) FROM deliveries WHERE state = 'delivered'";
            let own = self.exported.iter().filter(|of| of.station == *name).count();
            booth.wait_long_for_journal(delivered, 2 * i64::try_from(own).unwrap());
        }
        place.time_passes();
        let jobs = "select count(*) from job";
        let is_done = || {
            place.keys(ObjectKey::INBOX).is_empty()
                && place.client().query_one(jobs, &[]).unwrap().get::<_, i64>(0) == 0
        };
        self.stations[0].booth.wait_for("the last result of the archive", is_done);
        self.look();
        self.kept.iter_mut().for_each(Vec::clear);
    }

    /// The most stations that came back within one second after the outage.
    fn together(&self) -> usize {
        let back = self.back.unwrap();
        let first = self.stations.iter().filter_map(|station| station.gate.first_since(back));
        let first: Vec<Instant> = first.collect();
        assert_eq!(first.len(), self.stations.len(), "some station has not come back");
        let within = |from: &Instant| {
            let second = *from..*from + Duration::from_secs(1);
            first.iter().filter(|at| second.contains(*at)).count()
        };
        first.iter().map(within).max().unwrap()
    }
}

/// Another body for each number: a coarse one, larger by a hundred-thousandth each, so that all figures differ.
fn body(number: usize) -> Vec<u8> {
    let scale = 1.0 + 1e-5 * number as f64;
    let scaled = |word: &str| format!(" {:.4}", scale * word.parse::<f64>().unwrap());
    let line = |line: &str| match line.strip_prefix("v ") {
        Some(point) => format!("v{}\n", point.split(' ').map(scaled).collect::<String>()),
        None => format!("{line}\n"),
    };
    let text = String::from_utf8(coarse_body(0)).unwrap();
    text.lines().map(line).collect::<String>().into_bytes()
}

/// A number of the environment.
fn asked<N: FromStr>(name: &str, usual: N) -> N {
    let Ok(text) = env::var(name) else { return usual };
    text.parse().ok().unwrap_or_else(|| panic!("{name}={text} is no number"))
}

fn station(number: usize, place: &Place, tls_port: u16, site: &str) -> Station {
    let (name, gate) = (format!("booth-{number}"), Gate::open(tls_port));
    let booth = Booth::set(&Setting { files: "[]", ..Setting::default() });
    let address = format!("https://127.0.0.1:{}", gate.port);
    let authorities = format!("authorities = \"{}\"\n", tls_file("localhost.pem").display());
    booth.send_to_archive(&address, place.bucket_name(), &name, site, &authorities);
    Station { name, booth, gate }
}

/// What was said of each scan, by station and export: once, or the same each time but for when. An announcement whose
/// answer is lost is repeated.
fn announcements(place: &Place) -> BTreeMap<(String, String), Announcement> {
    let mut all: BTreeMap<_, Announcement> = BTreeMap::new();
    let without_time = |of: &Announcement| {
        let mut json = serde_json::to_value(of).unwrap();
        json["at"] = Value::Null;
        json
    };
    for key in place.keys(ObjectKey::ANNOUNCED) {
        let own = key.replacen(ObjectKey::ANNOUNCED, ObjectKey::INBOX, 1);
        let bytes = place.bucket.get(&key).unwrap().unwrap();
        let said = Announcement::read_at(&own.parse().unwrap(), &bytes).unwrap();
        let of = (said.station.as_str().to_owned(), said.export.as_str().to_owned());
        if let Some(before) = all.get(&of) {
            assert_eq!(without_time(before), without_time(&said), "{key}");
        }
        all.insert(of, said);
    }
    all
}

/// The objects of a scan are what was announced, and its result has the figures of its station.
fn check_objects(place: &Place, announced: &Announcement) {
    let Announcement { scan, station, record, .. } = announced;
    let object = |key: ObjectKey| {
        unpacked(&place.bucket.get(&key.to_string()).unwrap().unwrap(), MOST).unwrap()
    };
    let ply = object(ObjectKey::Scan(scan.clone()));
    assert_eq!((&ScanId::of_bytes(&ply), ply.len() as u64), (scan, announced.bytes));
    let (station, scan, hash) = (station.clone(), scan.clone(), record.clone());
    let json = object(ObjectKey::Record { station, scan: scan.clone(), record: hash });
    assert_eq!(RecordHash::of_bytes(&json), *record);
    let record: Record = serde_json::from_slice(&json).unwrap();
    let named = record.patient.as_ref().map(|patient| patient.id.as_str());
    assert_eq!(named, announced.patient.as_ref().map(Pseudonym::as_str));
    let key = ObjectKey::Result { method: method(), scan };
    let result = place.result(&key.to_string());
    let Outcome::Measured(measured) = result.outcome else { panic!("{key} is a refusal") };
    let Record { body, legs, differences, .. } = *measured;
    let by_archive = Record { body, legs, differences, ..record.clone() };
    assert_eq!(record_differs(&record, &by_archive).unwrap(), None, "{key}");
}

/// Whose scan was exported where: station, scan, pseudonym, sorted.
fn expected(exported: &[Exported], site: &SiteKey) -> Vec<(String, String, String)> {
    let mut all: Vec<_> = exported
        .iter()
        .map(|Exported { station, patient, scan }| {
            let pseudonym = Pseudonym::of(site, patient).as_str().to_owned();
            (station.clone(), scan.as_str().to_owned(), pseudonym)
        })
        .collect();
    all.sort();
    all
}

/// The same as the index has it.
fn indexed(place: &Place) -> Vec<(String, String, String)> {
    let statement =
        "select station, encode(export, 'hex'), encode(patient, 'hex') from announcement";
    let rows = place.client().query(statement, &[]).unwrap();
    let mut all: Vec<(String, String, String)> =
        rows.iter().map(|row| (row.get(0), row.get(1), row.get(2))).collect();
    all.sort();
    all
}

#[test]
#[ignore = "needs PostgreSQL, moto and an hour; docs/tests.md says how to run it"]
fn stations_and_an_archive_that_are_killed_and_cut_off_for_an_hour_lose_nothing() {
    let minutes = asked("GAITER_FLEET_MINUTES", MINUTES);
    let (count, seed) = (asked("GAITER_FLEET_STATIONS", STATIONS), asked("GAITER_SEED", 1));
    assert!(count >= STATIONS_LEAST, "at least {STATIONS_LEAST} stations");
    println!("GAITER_FLEET_MINUTES={minutes} GAITER_FLEET_STATIONS={count} GAITER_SEED={seed}");
    let (store, tls_port) = tls_store();
    let place = Place::on(Ports { store: store.port, database: database().port });
    let site = "0b".repeat(32);
    let stations: Vec<Station> =
        (1..=count).map(|number| station(number, &place, tls_port, &site)).collect();
    let gate = Gate::open(store.port);
    let mut fleet = Fleet::new(&place, &stations, &gate, seed);
    fleet.look();
    let (began, length) = (Instant::now(), Duration::from_secs(60 * minutes));
    let mut events = EVENTS.into_iter().peekable();
    while began.elapsed() < length {
        let share = began.elapsed().div_duration_f64(length);
        while let Some((_, event)) = events.next_if(|(at, _)| *at <= share) {
            fleet.happens(event);
        }
        fleet.tick();
        sleep(TICK);
    }
    fleet.rest(&place);

    let (together, exported) = (fleet.together(), fleet.exported.len());
    let said = place.keys(ObjectKey::ANNOUNCED).len();
    println!(
        "{exported} scans, announced {said} times; after the outage at most {together} of {count} stations came within \
         one second"
    );
    let site = SiteKey::parse(&site).unwrap();
    let expected = expected(&fleet.exported, &site);
    assert_eq!(indexed(&place), expected);
    let announced = announcements(&place);
    let of_objects = announced.iter().map(|((station, export), of)| {
        (station.clone(), export.clone(), of.patient.as_ref().unwrap().as_str().to_owned())
    });
    assert_eq!(of_objects.collect::<Vec<_>>(), expected);
    assert_eq!(place.wrong_rows(exported), Vec::<String>::new());
    announced.values().for_each(|announced| check_objects(&place, announced));
    // With the scan of no byte stations try the store out.
    let trial = ObjectKey::Scan(ScanId::of_bytes(b"")).to_string();
    for prefix in ["scan/", "record/", ObjectKey::RESULTS] {
        let count = place.keys(prefix).into_iter().filter(|key| *key != trial).count();
        assert_eq!(count, exported, "{prefix}");
    }
    assert_eq!(place.keys(ObjectKey::FLEET).len(), count);
    for Station { name, booth, .. } in &stations {
        assert_eq!(booth.violations(Moment::Rest), [], "{name}:\n{}", booth.log());
    }
    assert!(together <= count / 2, "{together} of {count} stations came back within one second");
}
