//! Measurements, what people decide afterwards, and first sights of names: composed as in
//! `station/delivery/work.rs` and `station/custody`.

use std::time::Duration;

use gaiter_flow::round::CaptureMatch;
use gaiter_flow::{Appeared, ScanState, Stamp};

use super::booth::{Booth, Run, change};
use super::content::Scan;
use super::oracle::Seen;
use super::truth::{Plan, id};

/// How soon a measurement is tried again whose end the journal did not take, milliseconds.
const AGAIN_MS: u64 = 3000;

impl Booth {
    /// The measurement that is due ends; that of a held scan is for its preview.
    pub fn measure_due(&mut self) {
        let Some((_, scan)) = self.run.as_mut().and_then(|run| run.work.pop_first()) else {
            return;
        };
        let Some(row) = self.disk.scan(scan) else { return };
        let (is_due, is_held) = (row.state == ScanState::Spooled, row.is_held());
        let (is_whole, body) = (row.content.is_whole(), row.content.whole.body);
        let is_good = is_whole && !self.truth.bodies[body].is_refused;
        let ended = match (is_due, is_held, is_good) {
            (false, false, _) => return,
            (false, true, true) => Ok(()),
            (false, true, false) => self.reopen_capture(scan),
            (true, _, true) => self.disk.delivered(scan),
            (true, _, false) => self.refuse(scan, body),
        };
        if ended.is_err() && is_due {
            if let Some(run) = &mut self.run {
                run.work.insert(self.now_ms + AGAIN_MS, scan);
            }
            return;
        }
        if !is_good {
            return;
        }
        let answered = self.disk.answered_by(scan);
        if let (Some(run), Some(capture)) = (&mut self.run, answered)
            && self.disk.closed(&run.captures.closed_by(capture.number)).is_ok()
        {
            run.captures.measured(capture.number);
            self.observe(Seen::Measured(scan));
        }
        if is_due {
            self.is_measured(body);
        }
    }

    fn is_measured(&mut self, body: usize) {
        self.tell(|| format!("body {body} is measured"));
        // Everybody sees that it is done after all.
        let patient = self.truth.bodies[body].patient;
        for of in self.truth.bodies.iter_mut().filter(|of| of.patient == patient) {
            of.refused_ms = None;
        }
        self.check_records();
    }

    fn refuse(&mut self, scan: Scan, body: usize) -> Result<(), super::disk::DiskFault> {
        self.disk.refused(scan)?;
        self.tell(|| format!("body {body} is refused: {scan:?}"));
        // Of one that came for nobody nobody relies on its capture.
        let answered =
            self.disk.scan(scan).is_some_and(|row| row.judged != CaptureMatch::Unpressed);
        if answered {
            self.truth.bodies[body].refused_ms = Some(self.now_ms);
        }
        let _ = self.reopen_capture(scan);
        Ok(())
    }

    /// A person says whose a held scan is; none where nothing is held.
    pub fn decide_held(&mut self) -> bool {
        let held = self.disk.scans().find(|(_, row)| row.is_held());
        let Some((scan, row)) = held else { return false };
        let body = row.content.whole.body;
        let who = Some(id(self.truth.bodies[body].patient));
        self.decide_as(scan, who)
    }

    /// A person decides, and the scan is measured for that.
    pub fn decide_as(&mut self, scan: Scan, who: Option<String>) -> bool {
        if self.run.is_none() || self.is_suspended || self.disk.decide(scan, &who).is_err() {
            return false;
        }
        self.tell(|| format!("a person decides that {scan:?} is of {who:?}"));
        let (at, now) = (self.now_ms + 1500, self.clock());
        let judged = self.disk.scan(scan).map_or(CaptureMatch::Unpressed, |row| row.judged.clone());
        if let Some(run) = &mut self.run {
            run.work.insert(at, scan);
            if let Some(who) = &who {
                let mut after = run.captures.clone();
                let answered = after.decided(&judged, who, now);
                if change(self.setup.off, &mut self.disk, run, after).is_ok() {
                    self.disk.answers_now(scan, answered);
                    self.observe(Seen::Decided { scan, id: Some(who.clone()), round: answered });
                }
            }
        }
        self.disk.withdraw();
        true
    }

    /// Whether the station has all of a body that it will get.
    pub fn is_settled(&self, body: usize) -> bool {
        let of = &self.truth.bodies[body];
        let is_known = |length: usize| {
            self.disk
                .scans()
                .any(|(_, row)| row.content.whole.body == body && row.content.length() == length)
        };
        match of.plan {
            Plan::Over => true,
            Plan::Whole => is_known(of.whole.length()),
            Plan::Scanned | Plan::Coming | Plan::Broken => false,
        }
    }
}

/// When each name was seen first, whatever lay there since.
pub fn first_sights(run: &mut Run, found: &[(String, Stamp)], began: Duration, ended: Duration) {
    let appeared = Appeared { absent: run.last_look.replace(began), seen: ended };
    let before = std::mem::take(&mut run.names);
    let first = |name: &String| (name.clone(), before.get(name).copied().unwrap_or(appeared));
    run.names = found.iter().map(|(name, _)| first(name)).collect();
}
