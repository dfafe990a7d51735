//! The simulated world: scanner, station, disk, stores, person and clock, and what must hold of it.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use gaiter_flow::{DeliveryState, DeliveryStep, ScanState, ScanStep};

use super::booth::{Booth, Did};
use super::chance::Chance;
use super::disk::{Disk, Patient, STORES, Store};
use super::scanner::{Bytes, Scanner, WHOLE};
use super::station::{Came, Station, StepFault};

/// More rounds than any backlog needs once the faults have ended.
const ROUNDS: u32 = 20_000;

/// How often each thing happened.
#[derive(Debug, Clone, Default)]
pub struct Tally(BTreeMap<String, u64>);

impl Tally {
    fn note(&mut self, what: &str) {
        *self.0.entry(what.to_owned()).or_default() += 1;
    }

    pub fn add(&mut self, other: &Tally) {
        for (what, count) in &other.0 {
            *self.0.entry(what.clone()).or_default() += count;
        }
    }

    /// Everything that must have happened at least once.
    pub fn counts(&self) -> impl Iterator<Item = (&str, u64)> {
        let came = [
            "New",
            "Known",
            "Held",
            "CutShort",
            "Changed",
            "Delivered",
            "Refused",
            "StoreFailed",
            "LostReply",
            "crash",
            "retry",
            "release",
            "assign",
            "Named",
            "Pressed",
            "GivenUp",
            "Scanned",
            "right patient",
        ];
        came.into_iter().map(|what| (what, self.0.get(what).copied().unwrap_or(0)))
    }
}

pub struct World {
    chance: Chance,
    now: Duration,
    scanner: Scanner,
    /// Every other life has a booth with a button, where nothing but a press makes exports, and their
    /// names say nothing. In the others the exports' names say whose they are, or nothing does.
    has_booth: bool,
    booth: Booth,
    station: Station,
    disk: Disk,
    stores: [Store; STORES],
    /// For whom a person has said that bytes are.
    said: Vec<(Bytes, Patient)>,
    /// Whose names bytes have carried, and whether the station may have seen them whole.
    carried: BTreeSet<(Bytes, Patient)>,
    tally: Tally,
}

impl World {
    pub fn new(seed: u64) -> World {
        let (now, mut disk) = (Duration::from_secs(3600), Disk::default());
        World {
            chance: Chance(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)),
            now,
            scanner: Scanner::new(),
            has_booth: seed.is_multiple_of(2),
            booth: Booth::default(),
            station: Station::start(&mut disk, now),
            disk,
            stores: Default::default(),
            said: Vec::new(),
            carried: BTreeSet::new(),
            tally: Tally::default(),
        }
    }

    pub fn tally(&self) -> Tally {
        let mut tally = self.tally.clone();
        for (bytes, patient) in self.stores[0].records.keys() {
            let by_name = *patient > 0 && !self.said.contains(&(*bytes, *patient));
            if by_name && self.scanner.truth(*bytes).is_some() {
                tally.note("right patient");
            }
        }
        tally
    }

    /// One thing happens.
    pub fn event(&mut self) {
        // No two things happen at the same time.
        self.now += Duration::from_millis(1);
        match self.chance.below(100) {
            0..=9 if self.has_booth => self.visit(),
            0..=9 => self.scanner.begin(&mut self.chance),
            10..=34 => self.scanner.go_on(&mut self.chance),
            35..=49 => self.station.look(&self.scanner, &mut self.disk, self.now),
            50..=64 => self.take(),
            65..=84 => self.work(),
            85..=91 => self.now += Duration::from_millis(self.chance.below(5_000) as u64),
            92 => self.now += Duration::from_secs(self.chance.below(600) as u64),
            93 => self.scanner.in_reach = self.chance.below(4) > 0,
            94..=95 => {
                let store = self.chance.below(STORES);
                self.stores[store].in_reach = self.chance.below(3) > 0;
            }
            96 if self.chance.below(10) == 0 => self.crash(),
            _ => self.person(),
        }
        self.note_carried();
    }

    /// Whose names the files carry now.
    fn note_carried(&mut self) {
        let files = self.scanner.files.values().filter(|file| file.bytes.length > 0);
        self.carried.extend(files.map(|file| (file.bytes, file.patient.unwrap_or(0))));
    }

    /// The people at the booth do the next thing.
    fn visit(&mut self) {
        let fails = self.fault() != StepFault::None;
        // Mostly a patient comes when the scan before has come in.
        let is_busy = self.scanner.is_writing() || self.station.captures.waiting().next().is_some();
        if !self.booth.is_visited() && is_busy && self.chance.below(20) > 0 {
            return;
        }
        let World { booth, station, disk, chance, now, .. } = self;
        let did = booth.go_on(&mut station.captures, &mut disk.booth, fails, *now, chance);
        if let Did::Scanned(patient) = did {
            self.scanner.export(patient, &mut self.chance);
            self.tally.note("Scanned");
        } else {
            self.tally.note(&format!("{did:?}"));
        }
    }

    fn fault(&mut self) -> StepFault {
        match self.chance.below(400) {
            0..=9 => StepFault::Before,
            10 => StepFault::Between,
            _ => StepFault::None,
        }
    }

    fn take(&mut self) {
        let fault = self.fault();
        let World { station, scanner, disk, chance, now, .. } = self;
        let (came, dies) = station.take(scanner, disk, fault, *now, chance);
        self.came(came, dies);
    }

    fn work(&mut self) {
        let fault = self.fault();
        let World { station, stores, disk, chance, now, .. } = self;
        let (came, dies) = station.work(disk, stores, fault, *now, chance);
        self.came(came, dies);
    }

    fn came(&mut self, came: Came, dies: bool) {
        self.tally.note(&format!("{came:?}"));
        if dies {
            self.crash();
        }
    }

    /// Memory is gone, the disk stays, the next start takes it up.
    fn crash(&mut self) {
        self.tally.note("crash");
        self.station = Station::start(&mut self.disk, self.now);
    }

    /// A person retries, releases or assigns some scan for which there is occasion.
    fn person(&mut self) {
        let scans: Vec<Bytes> = self.disk.scans.keys().copied().collect();
        let Some(bytes) = self.chance.pick(&scans).copied() else { return };
        match self.chance.below(3) {
            0 => self.reopen(bytes, DeliveryState::Refused, DeliveryStep::Retry, "retry"),
            1 => self.reopen(bytes, DeliveryState::Held, DeliveryStep::Release, "release"),
            _ => self.assign(bytes),
        }
    }

    fn reopen(&mut self, bytes: Bytes, state: DeliveryState, step: DeliveryStep, what: &str) {
        let deliveries = self.disk.open(bytes, state);
        let kept = self.disk.spool.contains_key(&bytes) || self.disk.quarantine.contains(&bytes);
        // Who releases a scan from the booth has looked whose it is.
        let truth = self.scanner.truth(bytes);
        let is_anothers = deliveries.iter().any(|(_, to, _)| *to > 0 && Some(*to) != truth);
        if deliveries.is_empty() || !kept || (truth.is_some() && is_anothers) {
            return;
        }
        self.tally.note(what);
        if self.disk.quarantine.remove(&bytes) {
            self.disk.spool.insert(bytes, deliveries[0].1);
        }
        for name in deliveries {
            self.disk.step(name, step);
            if step == DeliveryStep::Release {
                self.said.push((bytes, name.1));
            }
        }
        let scan = self.disk.scans[&bytes].after(ScanStep::Reopen).unwrap();
        self.disk.scans.insert(bytes, scan);
        self.station.hurry(bytes);
    }

    fn assign(&mut self, bytes: Bytes) {
        let patients = self.disk.patients(bytes);
        let refused = self.disk.scans[&bytes] == ScanState::Refused;
        if patients.iter().any(|patient| *patient > 0) || refused {
            return;
        }
        self.tally.note("assign");
        let anybody = 1 + self.chance.below(5) as u8;
        let patient = self.scanner.truth(bytes).unwrap_or(anybody);
        self.said.push((bytes, patient));
        self.disk.spool.entry(bytes).or_insert(patient);
        self.disk.deliveries.retain(|(of, to, _), state| {
            *of != bytes || *to > 0 || *state != DeliveryState::Pending
        });
        for store in 0..STORES {
            self.disk.deliveries.insert((bytes, patient, store), DeliveryState::Pending);
        }
        let scan = self.disk.scans[&bytes].after(ScanStep::Reopen).unwrap();
        self.disk.scans.insert(bytes, scan);
    }

    /// What must hold after every event.
    pub fn check(&self) {
        for (at, store) in self.stores.iter().enumerate() {
            for ((bytes, patient), count) in &store.records {
                let what = format!("record of {bytes:?} for {patient} in store {at}");
                assert_eq!(*count, 1, "{what} is there twice");
                assert_eq!(bytes.length, WHOLE, "{what} is half a scan");
                let theirs = match self.scanner.truth(*bytes) {
                    // However it came to be: nobody, or the one who was scanned.
                    Some(truth) => *patient == 0 || *patient == truth,
                    None => {
                        self.carried.contains(&(*bytes, *patient))
                            || self.said.contains(&(*bytes, *patient))
                    }
                };
                assert!(theirs, "{what} is somebody else's");
                let name = (*bytes, *patient, at);
                assert!(self.disk.deliveries.contains_key(&name), "{what} is in no journal");
            }
        }
        for ((bytes, patient, store), state) in &self.disk.deliveries {
            let what = format!("{bytes:?} for {patient} in store {store}: {state:?}");
            let there = self.stores[*store].records.contains_key(&(*bytes, *patient));
            match state {
                DeliveryState::Delivered => assert!(there, "{what}, and no record"),
                DeliveryState::Held => assert!(!there, "{what}, and yet a record"),
                DeliveryState::Withdrawn => assert!(!there, "{what}, and still a record"),
                DeliveryState::Pending => {
                    assert!(self.disk.spool.contains_key(bytes), "{what}, and no bytes");
                }
                DeliveryState::Refused | DeliveryState::Withdrawing => {}
            }
        }
        let pending = self.disk.deliveries.iter();
        let pending = pending.filter(|(_, state)| **state == DeliveryState::Pending);
        let pending: BTreeSet<Bytes> = pending.map(|((bytes, _, _), _)| *bytes).collect();
        for (bytes, state) in &self.disk.scans {
            let is_pending = pending.contains(bytes);
            assert_eq!(is_pending, *state == ScanState::Spooled, "{bytes:?}: {state:?}");
        }
    }

    /// The faults end; everything must come to rest by itself.
    pub fn rest(&mut self) {
        self.scanner.finish();
        self.note_carried();
        self.scanner.in_reach = true;
        self.stores.iter_mut().for_each(|store| store.in_reach = true);
        for _ in 0..ROUNDS {
            self.station.look(&self.scanner, &mut self.disk, self.now);
            for _ in 0..40 {
                let World { station, scanner, disk, stores, chance, now, .. } = self;
                station.take(scanner, disk, StepFault::None, *now, chance);
                station.work(disk, stores, StepFault::None, *now, chance);
            }
            self.check();
            if self.is_at_rest() {
                return;
            }
            let next = self.station.next_in(self.now).unwrap_or(Duration::from_secs(1));
            self.now += next.max(Duration::from_millis(100));
        }
        let open: Vec<_> = self.disk.deliveries.iter().filter(|(_, s)| is_open(**s)).collect();
        panic!("it never comes to rest: {open:?}, in hand {:?}", self.station.in_hand);
    }

    /// Nothing is open, and whatever lies whole in the export folder is accounted for.
    fn is_at_rest(&self) -> bool {
        let files = self.scanner.files.values().filter(|file| file.bytes.length > 0);
        let known = files.into_iter().all(|file| self.disk.scans.contains_key(&file.bytes));
        known && !self.disk.deliveries.values().any(|state| is_open(*state))
    }
}

fn is_open(state: DeliveryState) -> bool {
    matches!(state, DeliveryState::Pending | DeliveryState::Withdrawing)
}
