//! The simulated station: what it has in memory, and its steps around the decisions of `flow`.

use std::collections::BTreeMap;
use std::time::Duration;

use gaiter_flow::outbox::{Ended, Key, Plan};
use gaiter_flow::patient::identity;
use gaiter_flow::round::Rounds;
use gaiter_flow::{
    DeliveryState, Fingerprint, LookTime, Outbox, ScanId, Settled, Settling, StatedPatient, Verdict,
};
use gaiter_record::{self as record, Source, SourceKind};

use super::booth;
use super::chance::Chance;
use super::disk::{Disk, Intake, Name, STORES, Store};
use super::scanner::{Bytes, File, Scanner, WHOLE};

/// The quiet time, the wait for a rest, the time after which a file is overdue.
const TIMES: [Duration; 3] =
    [Duration::from_secs(2), Duration::from_secs(60), Duration::from_secs(600)];

/// How many scans are in progress at a time.
const JOBS_MAX: usize = 2;

/// What a crash takes away.
pub struct Station {
    pub captures: Rounds,
    settling: Settling,
    outbox: Outbox,
    settled: Vec<Settled>,
    /// Attempts that have begun and not ended.
    pub in_hand: Vec<Name>,
    /// Stores that are being asked.
    asked: Vec<usize>,
    names: BTreeMap<ScanId, Bytes>,
}

/// What a step came to, for the tally.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Came {
    Nothing,
    New,
    Known,
    Held,
    CutShort,
    Changed,
    Delivered,
    Refused,
    StoreFailed,
    LostReply,
}

/// Faults of one step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepFault {
    None,
    /// The journal or the disk failed before anything was written.
    Before,
    /// The process ends after the first durable write.
    Between,
}

impl Station {
    /// As a start finds the journal.
    pub fn start(disk: &mut Disk, now: Duration) -> Station {
        let [quiet, short_wait, overdue] = TIMES;
        let taken = disk.measuring.values().cloned().collect();
        let mut captures = disk.booth.captures(now).with_taken(taken, now);
        disk.recover(&mut captures, now);
        let settling = Settling::new(quiet, short_wait, overdue);
        Station {
            captures,
            settling: settling.remembering(disk.booth.memory.clone()),
            outbox: Outbox::default(),
            settled: Vec::new(),
            in_hand: Vec::new(),
            asked: Vec::new(),
            names: BTreeMap::new(),
        }
    }

    pub fn look(&mut self, scanner: &Scanner, disk: &mut Disk, now: Duration) {
        let when = LookTime { began: now, ended: now };
        self.settled = self.settling.observe(scanner.look(), when);
        if scanner.in_reach {
            for (path, stamp) in self.settling.unmarked() {
                let file = scanner.read(&path, stamp);
                let mark = file.map(|file| Fingerprint::whole(now, now, &file.bytes.content()));
                self.settling.marked(&path, stamp, mark);
            }
        }
        disk.booth.memory = self.settling.memory();
        self.captures.pass(now, &[self.settling.sights()]);
        disk.booth.keep(&self.captures);
    }

    /// Takes one settled file; says what came of it and whether the process ended.
    pub fn take(
        &mut self,
        scanner: &Scanner,
        disk: &mut Disk,
        fault: StepFault,
        now: Duration,
        chance: &mut Chance,
    ) -> (Came, bool) {
        if self.settled.is_empty() {
            return (Came::Nothing, false);
        }
        let settled = self.settled.remove(0);
        let Some(file) = scanner.read(&settled.path, settled.group.stamp) else {
            self.settling.changed(&settled, now);
            return (Came::Changed, false);
        };
        if file.bytes.length < WHOLE && !settled.awaited {
            self.settling.cut_short(&settled);
            return (Came::CutShort, false);
        }
        if fault == StepFault::Before {
            self.settling.failed(&settled, now, chance.unit());
            return (Came::Nothing, false);
        }
        let mark = Fingerprint::whole(now, now, &file.bytes.content());
        self.settling.read(&settled, &mark);
        let verdict = self.admit(disk, &settled, file, fault == StepFault::Between, now);
        if fault == StepFault::Between {
            return (Came::Nothing, true);
        }
        self.settling.taken(&settled);
        let came = match verdict {
            Verdict::New => Came::New,
            Verdict::Already => Came::Known,
            Verdict::Held(_) => Came::Held,
        };
        (came, false)
    }

    /// As custody: bytes first, then the journal; `dies` between the two.
    fn admit(
        &mut self,
        disk: &mut Disk,
        settled: &Settled,
        file: File,
        dies: bool,
        now: Duration,
    ) -> Verdict {
        let bytes = file.bytes;
        disk.recover(&mut self.captures, now);
        let known = disk.patients(bytes);
        let began = self.settling.began(settled, &bytes.content());
        let completes = if known.is_empty() { disk.completes(bytes) } else { None };
        let is_cut_short = bytes.length < WHOLE;
        let content = booth::content(began, !known.is_empty(), is_cut_short, completes);
        let judged = self.captures.match_content(&content, now);
        let says = [name_says(file.patient), StatedPatient::Nothing];
        let whose = identity::of_judged(&judged, false, says);
        let sighted = whose.patient.map(|patient| patient.id);
        let names: Vec<Option<String>> =
            known.iter().map(|p| (*p > 0).then(|| p.to_string())).collect();
        let verdict = identity::verdict(names.iter().map(Option::as_deref), sighted.as_deref());
        let verdict = match verdict {
            Verdict::New => whose.held.map_or(Verdict::New, Verdict::Held),
            other => other,
        };
        let delivery = match verdict {
            Verdict::Already => return verdict,
            Verdict::New => DeliveryState::Pending,
            Verdict::Held(_) => DeliveryState::Held,
        };
        let patient = sighted.map_or(0, |id| id.parse().unwrap());
        if !disk.quarantine.contains(&bytes) || verdict == Verdict::New {
            disk.spool.entry(bytes).or_insert(patient);
        }
        let intake = Intake { patient, delivery, judged };
        match dies {
            true => drop(disk.unentered.insert(bytes, intake)),
            false => disk.take_in(bytes, &intake, &mut self.captures, now),
        }
        verdict
    }

    /// Begins what the outbox says, and ends one attempt that is in hand.
    pub fn work(
        &mut self,
        disk: &mut Disk,
        stores: &mut [Store; STORES],
        fault: StepFault,
        now: Duration,
        chance: &mut Chance,
    ) -> (Came, bool) {
        let due: Vec<Name> = disk
            .deliveries
            .iter()
            .filter(|(_, state)| {
                matches!(state, DeliveryState::Pending | DeliveryState::Withdrawing)
            })
            .map(|(name, _)| *name)
            .collect();
        let keys: Vec<Key> = due.iter().map(|name| self.key(*name)).collect();
        let plan = match self.outbox.can_start(now, JOBS_MAX) {
            true => self.outbox.plan(&keys, now, JOBS_MAX),
            false => Plan::default(),
        };
        self.asked.extend(plan.ask.iter().map(|store| store.parse::<usize>().unwrap()));
        for key in plan.attempts.iter().flatten() {
            self.in_hand.push(due[keys.iter().position(|other| other == key).unwrap()]);
        }
        if let Some(store) = self.asked.pop() {
            let in_reach = stores[store].in_reach;
            self.outbox.asked(&store.to_string(), in_reach, now, chance.unit());
        }
        if self.in_hand.is_empty() {
            return (Came::Nothing, false);
        }
        let name = self.in_hand.remove(chance.below(self.in_hand.len()));
        let (came, ended, dies) = attempt(disk, stores, name, fault);
        if matches!(came, Came::Delivered | Came::LostReply | Came::Refused) {
            disk.was_measured(name.0, &mut self.captures, now);
        }
        let key = self.key(name);
        self.outbox.ended(&key, ended, now, chance.unit());
        (came, dies)
    }

    /// A person wants a scan tried now.
    pub fn hurry(&mut self, bytes: Bytes) {
        let scan = self.scan_id(bytes);
        self.outbox.retry_now(&scan);
    }

    /// When something is due by time alone.
    pub fn next_in(&self, now: Duration) -> Option<Duration> {
        let settling = self.settling.next_due().map(|at| at.saturating_sub(now));
        [settling, self.outbox.next_in(now, JOBS_MAX)].into_iter().flatten().min()
    }

    fn key(&mut self, (bytes, patient, store): Name) -> Key {
        let patient = (patient > 0).then(|| patient.to_string());
        Key { scan: self.scan_id(bytes), patient, store: store.to_string() }
    }

    fn scan_id(&mut self, bytes: Bytes) -> ScanId {
        let mut digest = [bytes.length; 32];
        digest[..4].copy_from_slice(&bytes.scan.to_le_bytes());
        let scan = ScanId::of_digest(digest);
        self.names.insert(scan.clone(), bytes);
        scan
    }
}

/// One attempt at a delivery: what came of it, how it ended, and whether the process ended.
fn attempt(
    disk: &mut Disk,
    stores: &mut [Store; STORES],
    name: Name,
    fault: StepFault,
) -> (Came, Ended, bool) {
    let (bytes, patient, store) = name;
    match disk.deliveries.get(&name) {
        Some(DeliveryState::Pending) => {}
        Some(DeliveryState::Withdrawing) if stores[store].in_reach => {
            stores[store].records.remove(&(bytes, 0));
            disk.step(name, gaiter_flow::DeliveryStep::Gone);
            return (Came::Nothing, Ended::ForGood, false);
        }
        Some(DeliveryState::Withdrawing) => {
            return (Came::StoreFailed, Ended::StoreFailed, false);
        }
        // Another delivery of the same scan refused it meanwhile.
        _ => return (Came::Nothing, Ended::ForGood, false),
    }
    if fault == StepFault::Before {
        return (Came::Nothing, Ended::PutOff, false);
    }
    if !bytes.is_measurable() {
        disk.refused(bytes);
        return (Came::Refused, Ended::ForGood, false);
    }
    assert!(disk.spool.contains_key(&bytes), "bytes to be delivered are in the spool: {name:?}");
    if !stores[store].in_reach {
        return (Came::StoreFailed, Ended::StoreFailed, false);
    }
    stores[store].put(bytes, patient);
    match fault {
        // The record is there and the station never learns of it.
        StepFault::Between => (Came::LostReply, Ended::PutOff, true),
        _ => {
            disk.delivered(name);
            (Came::Delivered, Ended::ForGood, false)
        }
    }
}

fn name_says(patient: Option<u8>) -> StatedPatient {
    let sources = vec![Source::from_kind(SourceKind::FileName)];
    let named = |id: u8| record::Patient { id: id.to_string(), sources };
    patient.map_or(StatedPatient::Nothing, |id| StatedPatient::Patient(named(id)))
}
