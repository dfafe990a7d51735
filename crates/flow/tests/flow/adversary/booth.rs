//! The simulated booth with its station: what the ports hear and what becomes of it, composed as in
//! `station/booth/hearing.rs`. What is decided is decided by `gaiter_flow`.

use std::collections::BTreeMap;
use std::rc::Rc;
use std::slice;
use std::time::Duration;

use gaiter_flow::patient::identity::Identity;
use gaiter_flow::round::{Capture, CaptureMatch, Doubt, Named, NamedNext, Names, Rounds, Rules};
use gaiter_flow::settle::{Memory, Sights};
use gaiter_flow::{Appeared, OrdersWhen, Settling};
use gaiter_record::SourceKind;

use super::chance::Chance;
use super::content::Scan;
use super::disk::{Disk, DiskFault};
use super::folder::Folder;
use super::intake::{Phase, TakeFault};
use super::laws::Off;
use super::oracle::{Began, Oracle, Seen};
use super::truth::{Truth, id};

/// The times of the shipped configuration.
pub const QUIET: Duration = Duration::from_secs(2);
pub const SHORT_WAIT: Duration = Duration::from_secs(60);
pub const RESCAN_MS: u64 = 10_000;
pub const WINDOW: Duration = Duration::from_secs(90);
pub const LATE: Duration = Duration::from_secs(90);
pub const NAME_LASTS: Duration = Duration::from_secs(900);

/// How often captures and names are asked whether their time is over, milliseconds.
const PASS_MS: u64 = 500;

/// A look takes less than this, milliseconds, and so many steps.
const LOOK_MS: u64 = 200;
const LOOK_STEPS: usize = 5;

/// Never.
pub const NEVER: u64 = u64::MAX;

/// What differs from station to station.
#[derive(Clone)]
pub struct Setup {
    pub rules: Rules,
    /// The folder tells of its changes.
    pub hints: bool,
    /// How the scanner's own measures name the patient, where they do.
    pub identity: Rc<Identity>,
    pub has_measures: bool,
    pub hold_unpressed: bool,
    pub off: Off,
}

/// What a crash takes away.
pub struct Run {
    pub settling: Settling,
    pub captures: Rounds,
    /// What the journal has of the looks.
    pub kept: Option<Memory>,
    /// What the looks have found.
    pub sights: Sights,
    pub phase: Phase,
    pub step_at_ms: u64,
    /// Measurements in hand, by when they end.
    pub work: BTreeMap<u64, Scan>,
    /// When names were first seen, and when they were absent: for the law of contents switched off.
    pub names: BTreeMap<String, Appeared>,
    pub last_look: Option<Duration>,
    /// Where nothing is to be found, when the next look is due; it is made when it is missed.
    pub idle_ms: Option<u64>,
    /// How the folder was when it was listed last.
    pub listed: u64,
    pass_at_ms: u64,
}

/// What is said while the process stands still lies in the buffer of its port.
enum Buffered {
    Press,
    Name { id: String, by: SourceKind },
}

/// Everything there is, at one time.
pub struct Booth {
    pub setup: Setup,
    pub chance: Chance,
    pub now_ms: u64,
    boot_ms: u64,
    pub folder: Folder,
    pub disk: Disk,
    /// None while the station does not run.
    pub run: Option<Run>,
    pub truth: Truth,
    pub oracle: Oracle,
    pub is_paused: bool,
    pub is_away: bool,
    pub is_unplugged: bool,
    /// The process stands still.
    pub is_suspended: bool,
    buffered: Vec<Buffered>,
    /// When the journal can be written again.
    pub unlock_ms: Option<u64>,
    /// When somebody starts the process again.
    pub start_ms: Option<u64>,
    /// What goes wrong with the next scan that comes in.
    pub fault: Option<TakeFault>,
    /// What happened, in words; kept only where somebody will read it.
    pub story: Option<Vec<String>>,
}

impl Booth {
    /// A station that has been running for long.
    pub fn new(setup: Setup, seed: u64, tells: bool) -> Booth {
        let now_ms = 3_600_000;
        let mut booth = Booth {
            setup,
            chance: Chance(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)),
            now_ms,
            boot_ms: 0,
            folder: Folder::default(),
            disk: Disk::default(),
            run: None,
            truth: Truth::default(),
            oracle: Oracle::default(),
            is_paused: false,
            is_away: false,
            is_unplugged: false,
            is_suspended: false,
            buffered: Vec::new(),
            unlock_ms: None,
            start_ms: None,
            fault: None,
            story: tells.then(Vec::new),
        };
        booth.start();
        let heard = Duration::from_secs(1);
        let looked = booth.clock();
        let rules = booth.setup.rules;
        booth.oracle = Oracle::new(rules.by_press, rules.orders == OrdersWhen::AfterPress);
        if let Some(run) = &mut booth.run {
            run.captures = Rounds::new(booth.setup.rules, Vec::new(), Names::default());
            run.captures.receives(heard);
            // Somebody was named since the start.
            let named = Named::new(id(0), SourceKind::Operator);
            run.captures.named(named, 1, heard, &[]);
            run.captures.call_off();
            let memory = Memory { looked: Some(looked), files: Vec::new() };
            run.settling = settling().remembering(memory);
        }
        booth
    }

    /// The station's clock: since the machine's start.
    pub fn clock(&self) -> Duration {
        Duration::from_millis(self.now_ms - self.boot_ms)
    }

    /// What the station observed now.
    pub fn observe(&mut self, what: Seen) {
        self.oracle.observe(self.now_ms, what);
    }

    /// A time of the station's clock, milliseconds.
    fn ms(&self, at: Duration) -> u64 {
        self.boot_ms + at.as_millis() as u64
    }

    pub fn began(&self, content: Appeared) -> Began {
        let absent_ms = content.absent.map(|absent| self.ms(absent));
        Began { absent_ms, seen_ms: self.ms(content.seen) }
    }

    pub fn tell(&mut self, what: impl FnOnce() -> String) {
        let at = self.now_ms as f64 / 1000.0 - 3600.0;
        if let Some(story) = &mut self.story {
            story.push(format!("{at:9.3}  {}", what()));
        }
    }

    /// The process starts and takes up what the journal holds.
    pub fn start(&mut self) {
        self.start_ms = None;
        (self.disk.is_locked, self.unlock_ms) = (false, None);
        self.disk.recover();
        let (waiting, names) = self.disk.captures();
        let mut captures = Rounds::new(self.setup.rules, waiting, names)
            .with_taken(self.disk.taken(), self.clock());
        if !self.setup.rules.by_press {
            captures.receives(Duration::ZERO);
        } else if !self.is_unplugged {
            captures.receives(self.clock());
        }
        let memory = self.disk.look();
        let last_look = memory.looked;
        let mut work = BTreeMap::new();
        for (scan, row) in self.disk.scans() {
            if row.state == gaiter_flow::ScanState::Spooled || row.is_held() {
                work.insert(self.now_ms + 1000 + work.len() as u64, scan);
            }
        }
        self.run = Some(Run {
            settling: settling().remembering(memory),
            captures,
            kept: None,
            sights: Sights::default(),
            phase: Phase::Rest,
            step_at_ms: self.now_ms,
            work,
            names: BTreeMap::new(),
            last_look,
            idle_ms: None,
            listed: 0,
            pass_at_ms: self.now_ms,
        });
        self.observe(Seen::Start);
        self.tell(|| "the station starts".to_owned());
    }

    pub fn crash(&mut self) {
        self.run = None;
        self.start_ms = Some(self.now_ms + 1000 + self.chance.below(120_000) as u64);
        self.tell(|| "the station is killed".to_owned());
    }

    /// The machine starts anew: its clock begins again.
    pub fn reboot(&mut self) {
        self.run = None;
        self.disk.machine_was_off(self.boot_ms, self.now_ms, self.setup.rules.late);
        self.boot_ms = self.now_ms - 20_000;
        self.start_ms = Some(self.now_ms + 1000);
        self.observe(Seen::Reboot);
        self.tell(|| "the machine starts anew".to_owned());
    }

    /// Time goes on; everything happens that is due.
    pub fn advance(&mut self, by_ms: u64) {
        let until = self.now_ms + by_ms;
        self.wake();
        loop {
            let export = self.truth.next_end_ms().unwrap_or(NEVER);
            let run = self.run.as_ref().filter(|_| !self.is_suspended);
            let (step, work, pass) = run.map_or((NEVER, NEVER, NEVER), |run| {
                let is_idle = run.captures.open().is_empty() && run.captures.next().is_none();
                let pass = if is_idle { NEVER } else { run.pass_at_ms };
                (run.step_at_ms, run.work.keys().next().copied().unwrap_or(NEVER), pass)
            });
            let unlock = self.unlock_ms.unwrap_or(NEVER);
            let start = self.start_ms.unwrap_or(NEVER);
            let due = export.min(step).min(work).min(pass).min(unlock).min(start);
            if due > until {
                break;
            }
            self.now_ms = self.now_ms.max(due);
            if unlock == due {
                (self.disk.is_locked, self.unlock_ms) = (false, None);
                self.tell(|| "the journal can be written again".to_owned());
            } else if start == due {
                self.start();
            } else if export == due {
                self.make_up_looks();
                self.end_due_export();
                self.wake();
            } else if work == due {
                self.measure_due();
            } else if step == due {
                self.step();
            } else {
                self.pass();
            }
        }
        self.now_ms = until;
        self.make_up_looks();
    }

    /// Looks go on where something has changed.
    fn wake(&mut self) {
        let is_quiet = !self.is_away && !self.is_paused;
        let version = self.folder.version;
        if let Some(run) = &mut self.run
            && let Some(at) = run.idle_ms.filter(|_| !is_quiet || run.listed != version)
        {
            (run.idle_ms, run.step_at_ms) = (None, run.step_at_ms.min(at.max(self.now_ms)));
        }
    }

    /// Makes the last of the looks at which nothing was to be found: only its time matters.
    fn make_up_looks(&mut self) {
        let now_ms = self.now_ms;
        let Some(at) = self.run.as_ref().and_then(|run| run.idle_ms) else { return };
        if now_ms < at + LOOK_MS || self.is_suspended {
            return;
        }
        let missed = (now_ms - LOOK_MS - at) / RESCAN_MS;
        self.now_ms = at + missed * RESCAN_MS;
        if let Some(run) = &mut self.run {
            run.idle_ms = None;
        }
        for _ in 0..LOOK_STEPS {
            self.step();
            let step_at = self.run.as_ref().map_or(NEVER, |run| run.step_at_ms);
            self.now_ms = if step_at == NEVER { self.now_ms } else { step_at.min(now_ms) };
        }
        self.now_ms = now_ms;
    }

    fn pass(&mut self) {
        let now = self.clock();
        // A look since its end says that a capture is over.
        let is_past = |capture: &Capture| capture.is_waiting() && now > capture.until + LATE;
        if self.run.as_ref().is_some_and(|run| run.captures.open().iter().any(is_past)) {
            self.make_up_looks();
        }
        let Some(run) = &mut self.run else { return };
        run.pass_at_ms = self.now_ms + PASS_MS;
        let mut after = run.captures.clone();
        after.pass(now, slice::from_ref(&run.sights));
        if after != run.captures {
            let _ = change(self.setup.off, &mut self.disk, run, after);
        }
    }

    /// The button is pressed; whether the press was heard.
    pub fn heard_press(&mut self) -> bool {
        if self.is_suspended {
            self.buffered.extend((!self.is_unplugged).then_some(Buffered::Press));
            return !self.is_unplugged;
        }
        let now = self.clock();
        let Some(run) = self.run.as_mut().filter(|_| !self.is_unplugged) else { return false };
        let mut after = at_rest(self.setup.off, &run.captures);
        if self.setup.off == Off::PressAfterName && after.next().is_none() {
            let nobody = Named::new(NOBODY.to_owned(), SourceKind::Operator);
            after.named(nobody, 0, now, &[]);
        }
        let number = self.disk.next_capture();
        after.pressed(number, now);
        let is_kept = change(self.setup.off, &mut self.disk, run, after).is_ok();
        if !is_kept {
            run.captures.missed_press(now);
        }
        self.observe(if is_kept { Seen::Press { number } } else { Seen::PressesAway });
        self.look_at_once();
        true
    }

    /// A card was read or an order came in.
    pub fn heard_name(
        &mut self,
        id: &str,
        by: SourceKind,
        doubt: Option<Doubt>,
        absent: Option<Duration>,
    ) {
        self.heard(Named::new(id, by), doubt, absent);
    }

    /// The same, with the request that was chosen.
    pub fn heard(&mut self, named: Named, doubt: Option<Doubt>, absent: Option<Duration>) {
        if self.is_suspended {
            return self.buffered.push(Buffered::Name { id: named.id, by: named.by });
        }
        if self.name(named, doubt, absent).is_err()
            && let Some(run) = &mut self.run
        {
            run.captures.unread(absent);
            self.observe(Seen::Unread);
        }
    }

    /// Somebody names the patient of the next scan; the file of an order did not lie there yet at `absent`.
    pub fn name(
        &mut self,
        named: Named,
        doubt: Option<Doubt>,
        absent: Option<Duration>,
    ) -> Result<(), DiskFault> {
        let now = self.clock();
        let Some(run) = &mut self.run else { return Err(DiskFault) };
        let number = self.disk.next_capture();
        let Sights { coming, .. } = run.sights.clone();
        let mut after = match self.setup.rules.by_press {
            true => run.captures.clone(),
            false => at_rest(self.setup.off, &run.captures),
        };
        let (id, by) = (named.id.clone(), named.by);
        let named = Named { by: as_heard(self.setup.off, run, &id, by), ..named };
        let is_told = by == SourceKind::Order && self.setup.off != Off::EarsOpen;
        let is_overtaken = is_told && after.overtaken(&named, absent);
        let is_sure = doubt.is_none();
        let doubt = doubt.or(is_overtaken.then_some(Doubt::Crossed));
        let came = match doubt {
            None => after.named(named, number, now, &coming),
            Some(doubt) => after.doubtful(named, doubt, number, now, &coming),
        };
        let still = |number: &i64| after.open().iter().any(|of| of.number == *number);
        let before = run.captures.open().iter().map(|of| of.number);
        let ended: Vec<i64> = before.filter(|number| !still(number)).collect();
        change(self.setup.off, &mut self.disk, run, after)?;
        if !matches!(came, NamedNext::Waits { .. }) {
            self.look_at_once();
        }
        let round = match came {
            NamedNext::Opened(capture, _) | NamedNext::Prolonged(capture) => capture.number,
            NamedNext::Paired(_) | NamedNext::Waits { .. } => 0,
        };
        let absent_ms = absent.map_or(0, |absent| self.ms(absent));
        self.observe(Seen::Named { id, by, is_sure, absent_ms, round, ended });
        Ok(())
    }

    /// A source of names is away, or has come back.
    pub fn missed_name(&mut self) {
        let Some(run) = &mut self.run else { return };
        if self.setup.off != Off::EarsOpen {
            run.captures.missed_name();
        }
        self.observe(Seen::NamesAway);
    }

    /// A source of names goes away for some seconds.
    pub fn gap(&mut self) {
        self.missed_name();
        let by_ms = self.chance.below(5000) as u64;
        self.advance(by_ms);
    }

    /// Somebody tried to name a patient, and it could not be read.
    pub fn unread(&mut self) {
        let now = self.clock();
        let Some(run) = &mut self.run else { return };
        self.oracle.observe(self.now_ms, Seen::Unread);
        if self.setup.off == Off::FailedNamingDisarms {
            return;
        }
        let mut after = run.captures.clone();
        after.unread(Some(now));
        let _ = change(self.setup.off, &mut self.disk, run, after.clone());
        run.captures = after;
    }

    /// A person gives up what waits.
    pub fn call_off(&mut self) -> Result<(), DiskFault> {
        let Some(run) = &mut self.run else { return Err(DiskFault) };
        let mut after = run.captures.clone();
        after.call_off();
        change(self.setup.off, &mut self.disk, run, after)?;
        self.observe(Seen::CalledOff);
        Ok(())
    }

    /// The process stands still: nothing is heard, looked at or measured.
    pub fn suspends(&mut self) {
        self.make_up_looks();
        self.is_suspended = true;
        self.tell(|| "the process stands still".to_owned());
    }

    /// It goes on. It notices that first, and hears what was said meanwhile in any order.
    pub fn resumes(&mut self) {
        self.is_suspended = false;
        let (now, off) = (self.clock(), self.setup.off);
        if let Some(run) = &mut self.run {
            if off != Off::EarsOpen {
                run.captures.missed_press(now);
                run.captures.missed_name();
            }
            run.settling.note_gap();
            self.observe(Seen::PressesAway);
            self.observe(Seen::NamesAway);
        }
        self.tell(|| "the process goes on".to_owned());
        let mut buffered = std::mem::take(&mut self.buffered);
        while !buffered.is_empty() {
            match buffered.swap_remove(self.chance.below(buffered.len())) {
                Buffered::Press => drop(self.heard_press()),
                Buffered::Name { id, by } => self.heard_name(&id, by, None, None),
            }
        }
    }

    /// The scan that answered a capture was refused: another export is awaited.
    pub fn reopen_capture(&mut self, scan: Scan) -> Result<(), DiskFault> {
        let now = self.clock();
        let Some(run) = &mut self.run else { return Err(DiskFault) };
        if let Some(capture) = self.disk.answered_by(scan) {
            let mut after = run.captures.clone();
            after.refused(capture.number, now);
            change(self.setup.off, &mut self.disk, run, after)?;
        }
        self.observe(Seen::Refused(scan));
        Ok(())
    }

    /// The port of the button is open, or is not any more.
    pub fn port(&mut self, is_open: bool) {
        let now = self.clock();
        self.is_unplugged = !is_open;
        if let Some(run) = &mut self.run {
            if is_open {
                run.captures.receives(now)
            } else {
                run.captures.deaf()
            }
            self.observe(if is_open { Seen::PressesBack } else { Seen::PressesAway });
        }
    }
}

pub fn settling() -> Settling {
    Settling::new(QUIET, SHORT_WAIT, Duration::from_secs(3600))
}

/// As `Station::change_booth`: the journal first.
pub fn change(off: Off, disk: &mut Disk, run: &mut Run, after: Rounds) -> Result<(), DiskFault> {
    let written = disk.booth_changed(&run.captures, &after);
    if written.is_ok() || off == Off::JournalFirst {
        run.captures = after;
    }
    written
}

/// The patient of a press without a name, where nothing follows from that.
pub const NOBODY: &str = "nobody";

/// With the law of rest switched off a new round finds every capture ended.
fn at_rest(off: Off, captures: &Rounds) -> Rounds {
    let mut rounds = captures.clone();
    if off == Off::RestBefore {
        for capture in captures.open() {
            rounds.answer(&CaptureMatch::Of(capture.clone()), capture.opened);
            rounds.measured(capture.number);
        }
    }
    rounds
}

/// With the law of orders switched off an order is heard as if somebody at the booth had said it.
fn as_heard(off: Off, run: &Run, id: &str, by: SourceKind) -> SourceKind {
    let mut waiting = run.captures.next().into_iter().flat_map(|next| &next.names);
    let replaces = off == Off::OrdersAddUp && waiting.any(|said| said.named.id != id);
    if by == SourceKind::Order && replaces { SourceKind::Operator } else { by }
}
