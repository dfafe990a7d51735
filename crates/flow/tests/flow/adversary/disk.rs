//! What a crash leaves: journal, spool, decisions and the records in the store. Each change of the
//! journal is whole or not at all, as in the station's `journal` and `custody`.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use gaiter_flow::orders::OrderState;
use gaiter_flow::round::{Capture, CaptureMatch, Named, Names, Rounds};
use gaiter_flow::settle::Memory;
use gaiter_flow::{DeliveryState, ScanState, Stamp};

use super::content::{Content, Scan};
use super::laws::Off;

#[path = "disk_known.rs"]
mod known;

/// A patient's id; none stands for no patient.
pub type Who = Option<String>;

/// The journal could not be written, or the spool.
#[derive(Debug)]
pub struct DiskFault;

/// Why a capture waits no more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    Answered,
    Held,
    Over,
}

#[derive(Debug, Clone)]
struct CaptureRow {
    capture: Capture,
    end: Option<End>,
    scan: Option<Scan>,
    /// When it was opened, where the machine has started anew since.
    at_ms: Option<u64>,
}

/// What is known of a scan.
#[derive(Debug, Clone)]
pub struct ScanRow {
    pub content: Content,
    pub state: ScanState,
    pub deliveries: BTreeMap<Who, DeliveryState>,
    geometry: String,
    /// Why a person must decide.
    pub held: Option<&'static str>,
    pub judged: CaptureMatch,
}

/// `intake.json`.
#[derive(Debug, Clone)]
pub struct Intake {
    pub content: Content,
    pub patient: Who,
    pub held: Option<&'static str>,
    pub geometry: String,
    pub judged: CaptureMatch,
}

#[derive(Debug, Default)]
pub struct Disk {
    pub is_locked: bool,
    captures: BTreeMap<i64, CaptureRow>,
    names: Names,
    last_capture: i64,
    /// In the order of first sight.
    scans: Vec<(Scan, ScanRow)>,
    sighted: BTreeMap<String, Stamp>,
    looks: Option<Memory>,
    spool: BTreeMap<Scan, Intake>,
    /// What the orders' folder knew: each order's words and time of change.
    pub orders: BTreeMap<String, OrderState>,
    /// Of each stem, the companion that lay there when a scan under it was taken last.
    pub companions: BTreeMap<String, Stamp>,
    /// What a person decided, beside the journal.
    decisions: BTreeMap<Scan, Who>,
    /// The store: whose folders a scan lies in.
    pub records: BTreeMap<Scan, (Content, BTreeSet<Who>)>,
    pub is_store_away: bool,
}

impl Disk {
    fn change(&self) -> Result<(), DiskFault> {
        if self.is_locked { Err(DiskFault) } else { Ok(()) }
    }

    pub fn next_capture(&self) -> i64 {
        self.last_capture + 1
    }

    /// As `Journal::booth_changed`.
    pub fn booth_changed(&mut self, before: &Rounds, after: &Rounds) -> Result<(), DiskFault> {
        self.change()?;
        for capture in after.waiting() {
            if before.waiting().all(|known| known != capture) {
                self.save(capture.clone());
            }
        }
        let still = |number: i64| after.open().iter().any(|known| known.number == number);
        for gone in before.open().iter().filter(|known| !still(known.number)) {
            if let Some(row) = self.captures.get_mut(&gone.number) {
                row.end = Some(End::Over);
            }
        }
        self.names = after.names().clone();
        Ok(())
    }

    fn save(&mut self, capture: Capture) {
        self.last_capture = self.last_capture.max(capture.number);
        let before = self.captures.get(&capture.number);
        let (at_ms, scan) = before.map_or((None, None), |row| (row.at_ms, row.scan));
        self.captures.insert(capture.number, CaptureRow { capture, end: None, scan, at_ms });
    }

    /// What a start finds: the captures whose exports have not come, and the names.
    pub fn captures(&self) -> (Vec<Capture>, Names) {
        let waiting = self.captures.values().filter(|row| row.end.is_none());
        let waiting = waiting.map(|row| row.capture.clone()).collect();
        (waiting, self.names.clone())
    }

    /// The machine was off: whatever a press had begun expires. Its clock had begun at `boot_ms`, and
    /// begins anew now.
    pub fn machine_was_off(&mut self, boot_ms: u64, now_ms: u64, late: Duration) {
        for row in self.captures.values_mut().filter(|row| row.end != Some(End::Over)) {
            let opened_ms = boot_ms + row.capture.opened.as_millis() as u64;
            let at_ms = *row.at_ms.get_or_insert(opened_ms);
            let age = Duration::from_millis(now_ms.saturating_sub(at_ms));
            match row.capture.clone().carried_over(Some(age), late, Duration::from_secs(20)) {
                Some(capture) => row.capture = capture,
                None => row.end = Some(End::Over),
            }
        }
        (self.names, self.looks) = (Names::default(), None);
    }

    pub fn answered_by(&self, scan: Scan) -> Option<Capture> {
        let mut rows = self.captures.values();
        let row = rows.find(|row| row.end != Some(End::Over) && row.scan == Some(scan));
        row.map(|row| row.capture.clone())
    }

    pub fn scan(&self, scan: Scan) -> Option<&ScanRow> {
        self.scans.iter().find(|(known, _)| *known == scan).map(|(_, row)| row)
    }

    fn scan_mut(&mut self, scan: Scan) -> Option<&mut ScanRow> {
        self.scans.iter_mut().find(|(known, _)| *known == scan).map(|(_, row)| row)
    }

    pub fn scans(&self) -> impl Iterator<Item = (Scan, &ScanRow)> {
        self.scans.iter().map(|(scan, row)| (*scan, row))
    }

    /// As `Journal::patients`.
    pub fn patients(&self, scan: Scan) -> Vec<Who> {
        self.scan(scan).map_or_else(Vec::new, |row| row.deliveries.keys().cloned().collect())
    }

    pub fn spool_holds(&self, scan: Scan) -> bool {
        self.spool.contains_key(&scan)
    }

    pub fn spool_keep(&mut self, scan: Scan, intake: Intake) {
        self.spool.entry(scan).or_insert(intake);
    }

    /// As `Journal::enter`: a scan, its delivery and what it means for captures.
    pub fn enter(&mut self, scan: Scan, intake: &Intake) -> Result<(), DiskFault> {
        self.change()?;
        let state = if intake.held.is_some() { ScanState::Delivered } else { ScanState::Spooled };
        let is_new = self.scan(scan).is_none();
        if is_new {
            let Intake { content, geometry, held, judged, .. } = intake.clone();
            let deliveries = BTreeMap::new();
            let row = ScanRow { content, state, deliveries, geometry, held, judged };
            self.scans.push((scan, row));
        }
        let delivery =
            if intake.held.is_some() { DeliveryState::Held } else { DeliveryState::Pending };
        if let Some(row) = self.scan_mut(scan) {
            row.deliver_to(intake.patient.clone(), delivery);
        }
        self.answer(scan, &intake.judged);
        // What was decided while an earlier journal knew the scan is carried out.
        match self.decisions.get(&scan).cloned().filter(|_| is_new) {
            Some(who) => self.decide(scan, &who),
            None => Ok(()),
        }
    }

    fn answer(&mut self, scan: Scan, judged: &CaptureMatch) {
        let (answered, end, doubtful, candidates): (_, _, &[i64], &[Named]) = match judged {
            CaptureMatch::Unpressed | CaptureMatch::Known => return,
            CaptureMatch::Of(capture) => (Some(capture.number), End::Answered, &[], &[]),
            CaptureMatch::Held { answered, doubtful, candidates, .. } => {
                (*answered, End::Held, doubtful, candidates)
            }
        };
        for number in doubtful {
            if let Some(row) = self.captures.get_mut(number) {
                candidates.iter().for_each(|named| row.capture.may_also_be(named));
            }
        }
        if let Some(row) = answered.and_then(|number| self.captures.get_mut(&number)) {
            candidates.iter().for_each(|named| row.capture.may_also_be(named));
            (row.end, row.scan) = (Some(end), Some(scan));
        }
    }

    pub fn was_sighted(&self, name: &str, stamp: Stamp) -> bool {
        self.sighted.get(name) == Some(&stamp)
    }

    pub fn sighted(&mut self, name: &str, stamp: Stamp) -> Result<(), DiskFault> {
        self.change()?;
        self.sighted.insert(name.to_owned(), stamp);
        Ok(())
    }

    pub fn look(&self) -> Memory {
        self.looks.clone().unwrap_or_default()
    }

    pub fn looked(&mut self, memory: &Memory) -> Result<(), DiskFault> {
        self.change()?;
        self.looks = Some(memory.clone());
        Ok(())
    }

    /// As `Custody::refuse`.
    pub fn refused(&mut self, scan: Scan) -> Result<(), DiskFault> {
        self.change()?;
        if let Some(row) = self.scan_mut(scan) {
            row.state = ScanState::Refused;
            row.step(DeliveryState::Pending, DeliveryState::Refused);
        }
        self.spool.remove(&scan);
        Ok(())
    }

    /// The records of a measured scan lie in the store; an unassigned one goes.
    pub fn delivered(&mut self, scan: Scan) -> Result<(), DiskFault> {
        self.change()?;
        let Some(row) = self.scan_mut(scan) else { return Ok(()) };
        row.state = ScanState::Delivered;
        let due = row.step(DeliveryState::Pending, DeliveryState::Delivered);
        let content = row.content.clone();
        let is_kept = row.deliveries.values().any(|state| *state == DeliveryState::Held);
        let entry = self.records.entry(scan).or_insert((content, BTreeSet::new()));
        entry.1.extend(due.iter().cloned());
        if due.iter().any(Option::is_some) {
            entry.1.remove(&None);
        }
        if !is_kept {
            self.spool.remove(&scan);
        }
        Ok(())
    }

    /// A person says whose a scan is: one patient's, or unassigned. The decision is kept first.
    pub fn decide(&mut self, scan: Scan, who: &Who) -> Result<(), DiskFault> {
        self.change()?;
        self.decisions.insert(scan, who.clone());
        let Some(row) = self.scan_mut(scan) else { return Ok(()) };
        for (other, state) in &mut row.deliveries {
            if other != who {
                *state = match state {
                    DeliveryState::Delivered | DeliveryState::Withdrawing => {
                        DeliveryState::Withdrawing
                    }
                    _ => DeliveryState::Withdrawn,
                };
            }
        }
        row.deliveries.insert(who.clone(), DeliveryState::Pending);
        row.state = ScanState::Spooled;
        Ok(())
    }

    /// What a person decided of a scan, if anything.
    pub fn decision(&self, scan: Scan) -> Option<&Who> {
        self.decisions.get(&scan)
    }

    /// Records that are to go leave the store where it can be reached.
    pub fn withdraw(&mut self) {
        if self.is_store_away {
            return;
        }
        for (scan, row) in &mut self.scans {
            for gone in row.step(DeliveryState::Withdrawing, DeliveryState::Withdrawn) {
                if let Some((_, whose)) = self.records.get_mut(scan) {
                    whose.remove(&gone);
                }
            }
        }
    }

    /// Whether somebody's record of a scan is to go.
    pub fn is_withdrawing(&self, scan: Scan, who: &Who) -> bool {
        let state = self.scan(scan).and_then(|row| row.deliveries.get(who));
        state == Some(&DeliveryState::Withdrawing)
    }

    /// As `Custody::recover`: what the spool keeps and the journal does not know is entered.
    pub fn recover(&mut self) {
        for (scan, intake) in self.unentered() {
            let _ = self.enter(scan, &intake);
        }
    }

    /// The journal is lost and built anew from decisions, spool and store.
    pub fn rebuild(&mut self, off: Off) {
        let refused: Vec<(Scan, ScanRow)> = self
            .scans()
            .filter(|(_, row)| row.state == ScanState::Refused)
            .map(|(scan, row)| (scan, row.clone()))
            .collect();
        self.captures.clear();
        self.scans = refused;
        self.sighted.clear();
        self.companions.clear();
        (self.names, self.looks) = (Names::default(), None);
        self.recover();
        for (scan, (content, whose)) in self.records.clone() {
            for who in whose {
                self.found(scan, content.clone(), who);
            }
        }
        if off == Off::DecisionsOutlive {
            return;
        }
        for (scan, who) in self.decisions.clone() {
            if self.scan(scan).is_some_and(|row| row.deliveries.keys().any(|of| *of != who)) {
                let _ = self.decide(scan, &who);
            }
        }
    }

    fn found(&mut self, scan: Scan, content: Content, who: Who) {
        if self.scan(scan).is_none() {
            let (state, deliveries) = (ScanState::Delivered, BTreeMap::new());
            let (geometry, judged) = (String::new(), CaptureMatch::Unpressed);
            let row = ScanRow { content, state, deliveries, geometry, held: None, judged };
            self.scans.push((scan, row));
        }
        if let Some(row) = self.scan_mut(scan) {
            row.deliveries.insert(who, DeliveryState::Delivered);
        }
    }
}

impl ScanRow {
    fn deliver_to(&mut self, who: Who, state: DeliveryState) {
        let known = self.deliveries.get(&who);
        if known.is_none_or(|known| {
            matches!(known, DeliveryState::Withdrawn | DeliveryState::Withdrawing)
        }) {
            self.deliveries.insert(who, state);
        }
    }

    /// Takes every delivery in one state to another; whose they are.
    fn step(&mut self, from: DeliveryState, to: DeliveryState) -> Vec<Who> {
        let of = self.deliveries.iter_mut().filter(|(_, state)| **state == from);
        of.map(|(who, state)| {
            *state = to;
            who.clone()
        })
        .collect()
    }

    pub fn is_held(&self) -> bool {
        self.deliveries.values().any(|state| *state == DeliveryState::Held)
    }
}
