//! The simulated state folder and stores: what a crash leaves.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use gaiter_flow::round::{Capture, CaptureMatch, Rounds};
use gaiter_flow::{DeliveryState, DeliveryStep, ScanState, ScanStep};

use super::booth::{self, Kept};
use super::scanner::Bytes;

/// A patient as the journal's column holds it; 0 while nobody named the patient.
pub type Patient = u8;

/// A delivery: bytes, patient, store.
pub type Name = (Bytes, Patient, usize);

/// How many stores there are.
pub const STORES: usize = 2;

/// What becomes of a scan that comes in, as the spool keeps it beside the bytes.
#[derive(Debug, Clone)]
pub struct Intake {
    /// For whom it is.
    pub patient: Patient,
    /// Whether it is held.
    pub delivery: DeliveryState,
    /// Which capture it answers.
    pub judged: CaptureMatch,
}

/// The journal and the spool, whose changes are whole or not at all.
#[derive(Debug, Default)]
pub struct Disk {
    /// The bytes in the spool and for whom they first came.
    pub spool: BTreeMap<Bytes, Patient>,
    /// What the journal does not know yet of bytes in the spool.
    pub unentered: BTreeMap<Bytes, Intake>,
    /// The booth, as the journal has it.
    pub booth: Kept,
    /// The captures whose exports came in and are not measured.
    pub measuring: BTreeMap<Bytes, Capture>,
    /// The bytes in quarantine.
    pub quarantine: BTreeSet<Bytes>,
    /// The state of each scan.
    pub scans: BTreeMap<Bytes, ScanState>,
    /// The state of each delivery.
    pub deliveries: BTreeMap<Name, DeliveryState>,
}

/// A store: its records, and how often each was written.
#[derive(Debug, Default)]
pub struct Store {
    /// Whether it answers.
    pub in_reach: bool,
    /// The records.
    pub records: BTreeMap<(Bytes, Patient), u32>,
}

impl Store {
    /// As every store's `put`: made twice, it leaves one record.
    pub fn put(&mut self, bytes: Bytes, patient: Patient) {
        self.records.entry((bytes, patient)).or_insert(1);
    }
}

impl Disk {
    /// The patients for whom bytes are known.
    pub fn patients(&self, bytes: Bytes) -> Vec<Patient> {
        let known = self.deliveries.keys().filter(|(of, _, _)| *of == bytes);
        known.map(|(_, patient, _)| *patient).collect()
    }

    /// Enters a scan with its deliveries.
    pub fn enter(&mut self, bytes: Bytes, patient: Patient, delivery: DeliveryState) {
        let held = delivery == DeliveryState::Held;
        let state = if held { ScanState::Delivered } else { ScanState::Spooled };
        self.scans.entry(bytes).or_insert(state);
        for store in 0..STORES {
            self.deliveries.insert((bytes, patient, store), delivery);
        }
    }

    /// Takes a delivery one step on, as the lifecycle allows.
    pub fn step(&mut self, name: Name, step: DeliveryStep) {
        let state = self.deliveries[&name].after(step).unwrap();
        self.deliveries.insert(name, state);
    }

    /// Deliveries of these bytes in a state.
    pub fn open(&self, bytes: Bytes, state: DeliveryState) -> Vec<Name> {
        let open = self.deliveries.iter().filter(|((of, _, _), s)| *of == bytes && **s == state);
        open.map(|(name, _)| *name).collect()
    }

    /// The store's receipt is noted; bytes that have served are given up.
    pub fn delivered(&mut self, name: Name) {
        let (bytes, patient, store) = name;
        self.step(name, DeliveryStep::Deliver);
        let nobody = (bytes, 0, store);
        if patient > 0 && self.deliveries.get(&nobody) == Some(&DeliveryState::Delivered) {
            self.step(nobody, DeliveryStep::Withdraw);
        }
        if self.open(bytes, DeliveryState::Pending).is_empty() {
            let state = self.scans[&bytes].after(ScanStep::Finish).unwrap();
            self.scans.insert(bytes, state);
            if self.open(bytes, DeliveryState::Held).is_empty() {
                self.spool.remove(&bytes);
            }
        }
    }

    /// The scan is refused: its bytes go to quarantine, and with them its pending deliveries.
    pub fn refused(&mut self, bytes: Bytes) {
        let state = self.scans[&bytes].after(ScanStep::Refuse).unwrap();
        self.scans.insert(bytes, state);
        for name in self.open(bytes, DeliveryState::Pending) {
            self.step(name, DeliveryStep::Refuse);
        }
        self.spool.remove(&bytes);
        self.quarantine.insert(bytes);
    }

    /// What every start does, and every scan that comes in: spooled bytes that the journal does not know
    /// are entered, and answer what they would have answered.
    pub fn recover(&mut self, captures: &mut Rounds, now: Duration) {
        for (bytes, intake) in std::mem::take(&mut self.unentered) {
            self.take_in(bytes, &intake, captures, now);
        }
    }

    /// A scan comes in: it and the capture that it answers are entered in one step.
    pub fn take_in(&mut self, bytes: Bytes, intake: &Intake, captures: &mut Rounds, now: Duration) {
        let Intake { patient, delivery, judged } = intake;
        self.enter(bytes, *patient, *delivery);
        let number = booth::answered(judged);
        let capture = captures.waiting().find(|capture| Some(capture.number) == number);
        let capture = capture.cloned();
        captures.answer(judged, now);
        self.booth.keep(captures);
        self.measuring.extend(capture.map(|capture| (bytes, capture)));
        if *delivery == DeliveryState::Held {
            self.was_measured(bytes, captures, now);
        }
    }

    /// A scan was measured, for its patient or for a preview, or it was refused.
    pub fn was_measured(&mut self, bytes: Bytes, captures: &mut Rounds, now: Duration) {
        let Some(capture) = self.measuring.remove(&bytes) else { return };
        match bytes.is_measurable() {
            true => captures.measured(capture.number),
            false => drop(captures.refused(capture.number, now)),
        }
        self.booth.keep(captures);
    }

    /// For whom the beginnings of a content came in that could not be measured; none where none did.
    pub fn completes(&self, bytes: Bytes) -> Option<Vec<Patient>> {
        let is_part = |part: &&Bytes| part.scan == bytes.scan && part.length < bytes.length;
        let mut parts = self.scans.keys().filter(is_part).peekable();
        parts.peek()?;
        Some(parts.flat_map(|part| self.patients(*part)).collect())
    }
}
