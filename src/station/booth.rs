//! The station's side of the booth: takes the input of the ports, keeps the captures, and determines
//! what the light shows. [`gaiter_flow::round`] decides what a capture means. Every step is in the
//! journal before anything acts on it.

mod hearing;
pub(in crate::station) mod orders;
pub mod trigger;
pub mod worklist;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use gaiter_flow::account::Whole;
use gaiter_flow::booth::Signal;
use gaiter_flow::light::{self, Last, LastOutcome, Light, Progress, Scene};
use gaiter_flow::orders::{OrdersComeLate, orders_come_late};
use gaiter_flow::page::Situation;
use gaiter_flow::round::{Capture, CaptureMatch, ExportContent, Rounds, Rules};
use gaiter_flow::settle::Sights;
use gaiter_flow::words::stepped;
use gaiter_flow::{Appeared, OrdersWhen, ScanId};
use jiff::{SignedDuration, Timestamp};
use tokio::sync::watch;
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;

use super::core::Core;
use super::journal::{CaptureRow, Journal, JournalError};
use super::overview::Overview;
use super::runtime::{ASLEEP, Heartbeat, Stop, locked};
pub use hearing::NameFault;

/// Interval between updates of the light: a person notices no shorter delay.
const LIGHT: Duration = Duration::from_millis(200);

/// Interval between checks whether the whole station is ready, and while it is not; each reads the journal.
const READY: Duration = Duration::from_secs(5);
const NOT_READY: Duration = Duration::from_secs(1);

/// How many scans that waited for their records before a start the light follows: more than a day has.
const IN_WORK_MOST: u32 = 1000;

/// How long after a scan the light still shows at a start what it needs.
const TODAY: SignedDuration = SignedDuration::from_hours(24);

/// The booth of a station.
#[derive(Debug)]
pub struct Booth {
    core: Arc<Core>,
    /// Locked during writes to the journal, so only threads that may block may lock it.
    inner: Mutex<Inner>,
    /// What the looks have found, per export folder. Locked only for moments.
    sights: Mutex<Vec<Sights>>,
    signal: watch::Sender<Signal>,
    /// Sent at each press: what is in the folders of exports and orders now was there before it, and the light
    /// answers it at once.
    looks: watch::Sender<()>,
    worklist: worklist::BoothWorklist,
}

#[derive(Debug)]
struct Inner {
    captures: Rounds,
    next_number: i64,
    /// The ports that are not open.
    away: BTreeSet<&'static str>,
    /// Scans that came in and whose records are not all delivered, with what to do with the patient.
    in_work: BTreeMap<ScanId, Vec<String>>,
    /// Whether each of the last orders came after the press.
    late_orders: Vec<bool>,
    missed: bool,
    last: Option<(Last, Duration)>,
}

impl Inner {
    /// The captures from the journal, for this machine start and this time of its clock. `buttons` are
    /// the ports with buttons.
    fn recall(
        journal: &Journal,
        rules: Rules,
        buttons: BTreeSet<&'static str>,
        boot: &str,
        now: Duration,
    ) -> Result<Inner, JournalError> {
        let is_ours = |row: &CaptureRow| row.boot == boot && !boot.is_empty();
        // The machine was off: what a press began expires, unless it can be carried over.
        let carried_over = |row: &CaptureRow| {
            let age = Duration::try_from(Timestamp::now().duration_since(row.at)).ok();
            row.capture.clone().carried_over(age, rules.late, now)
        };
        let (ours, others): (Vec<CaptureRow>, Vec<CaptureRow>) =
            journal.captures_waiting()?.into_iter().partition(is_ours);
        let kept: Vec<Capture> = others.iter().filter_map(carried_over).collect();
        let others: Vec<i64> = others.iter().map(|row| row.capture.number).collect();
        let names = journal.names()?;
        let is_name_over = names.as_ref().is_some_and(|names| names.boot != boot);
        if !others.is_empty() || is_name_over {
            journal.captures_of_before(&others, &kept, boot, is_name_over)?;
        }
        let names = names.filter(|_| !is_name_over).map(|of_boot| of_boot.names);
        let ours = ours.into_iter().map(|row| row.capture);
        let waiting = kept.into_iter().chain(ours).collect();
        let taken = journal.captures_taken()?.into_iter();
        let taken = taken.filter_map(|row| match is_ours(&row) {
            true => Some(row.capture),
            false => carried_over(&row),
        });
        let mut captures =
            Rounds::new(rules, waiting, names.unwrap_or_default()).with_taken(taken.collect(), now);
        if buttons.is_empty() {
            captures.receives(Duration::ZERO);
        }
        let next_number = journal.next_capture()?;
        let mut in_work = BTreeMap::new();
        for scan in journal.spooled(IN_WORK_MOST)? {
            // The light has already shown how others ended.
            if journal.whole(&scan)?.is_some_and(|whole| is_of_today(&whole) && !whole.has_record())
            {
                in_work.insert(scan, Vec::new());
            }
        }
        Ok(Inner {
            captures,
            next_number,
            away: buttons,
            in_work,
            late_orders: journal.orders_came_late()?,
            missed: !others.is_empty(),
            last: last_before(journal, next_number)?.map(|last| (last, now)),
        })
    }

    /// Whether this scan is what happened last.
    fn has_last(&self, this: &ScanId) -> bool {
        matches!(&self.last, Some((Last::Scan { scan, .. }, _)) if scan == this)
    }
}

/// What the light showed before the start, if a person must still see it: for the newest scan, unless the button
/// was pressed or a patient named after it. What older ones need is on the page.
fn last_before(journal: &Journal, next_capture: i64) -> Result<Option<Last>, JournalError> {
    let Some(scan) = journal.newest(1)?.pop() else { return Ok(None) };
    let Some(whole) = journal.whole(&scan)? else { return Ok(None) };
    let captured = journal.captured_at(next_capture - 1)?;
    let is_last = captured.is_none_or(|at| at <= whole.summary.first_seen) && is_of_today(&whole);
    let needs_person =
        LastOutcome::from_whole(&whole, &[]).is_some_and(|outcome| outcome.needs_person());
    Ok((is_last && needs_person).then(|| Last::Scan { scan, to_do: Vec::new() }))
}

/// Whether a scan was seen so recently that the light shows it after a start.
fn is_of_today(whole: &Whole) -> bool {
    Timestamp::now().duration_since(whole.summary.first_seen) < TODAY
}

/// The captures, locked while an export is taken in: no press or other export comes in between.
#[derive(Debug)]
pub struct LockedCaptures<'a> {
    booth: &'a Booth,
    inner: MutexGuard<'a, Inner>,
}

/// The state of the booth at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoothState {
    /// What the light shows.
    pub signal: Signal,
    pub awaited: usize,
    /// A patient is named for the next press.
    pub is_named: bool,
    /// A press may have been missed a short while ago.
    pub is_in_doubt: bool,
    /// How much longer presses are in doubt for that, as far as it is known, in steps.
    pub doubt_left: Option<Duration>,
    /// Most orders come after the press, and the configuration expects them before it.
    pub orders_come_late: Option<OrdersComeLate>,
}

impl Booth {
    /// Opens the booth with what the journal holds.
    pub fn open(core: Arc<Core>) -> Result<Booth, JournalError> {
        let (config, buttons) = (&core.config, core.config.buttons());
        let orders = config.patient.orders.as_ref();
        let orders = orders.map_or(OrdersWhen::default(), |orders| orders.when);
        let rules = config.capture.rules(&buttons, orders);
        let folders = config.scanner.export_dirs.len();
        let (journal, boot) = (core.custody.journal(), core.clock.boot());
        let inner = Inner::recall(journal, rules, buttons, boot, core.now())?;
        let (signal, looks) = (watch::Sender::new(Signal::Ready), watch::Sender::new(()));
        let (inner, sights) = (Mutex::new(inner), Mutex::new(vec![Sights::default(); folders]));
        #[cfg(feature = "dicom")]
        let worklist = worklist::BoothWorklist::recall(&core)?;
        #[cfg(not(feature = "dicom"))]
        let worklist = worklist::BoothWorklist::default();
        Ok(Booth { core, inner, sights, signal, looks, worklist })
    }

    /// The core that the workers share.
    pub fn core(&self) -> &Arc<Core> {
        &self.core
    }

    /// Passes on who is next, and whose exports are awaited. Blocks.
    pub fn who_is_next<T>(&self, then: impl FnOnce(Situation<'_>) -> T) -> T {
        let state = self.state();
        let has_button = !self.core.config.buttons().is_empty();
        let mut inner = self.inner();
        // First: a scan that was released or tried again has not ended any more.
        let progress = self.progress(&mut inner);
        let (last, last_of) = self.last(&inner).unzip();
        let last_scan = match &inner.last {
            Some((Last::Scan { scan, .. }, _)) => Some(scan.clone()),
            _ => None,
        };
        let is_button_away = self.is_button_away(&inner);
        let (next, awaited_for) = (inner.captures.next_ids(), inner.captures.awaited_ids());
        let is_asked = inner.captures.asks_who();
        let held_next = inner.captures.held_next(self.core.now());
        drop(inner);
        then(Situation {
            signal: state.signal,
            has_button,
            is_button_away,
            awaited: state.awaited,
            next: &next,
            awaited_for: &awaited_for,
            is_asked,
            is_in_doubt: state.is_in_doubt,
            doubt_left: state.doubt_left,
            held_next: held_next.as_ref(),
            progress,
            last: last.as_ref(),
            last_scan: last_scan.as_ref().map(ScanId::as_str),
            last_of: &last_of.unwrap_or_default(),
        })
    }

    /// Locks the captures. Blocks during writes to the journal.
    fn inner(&self) -> MutexGuard<'_, Inner> {
        locked(&self.inner)
    }

    /// What the light shows, now and whenever it changes.
    pub fn signal(&self) -> watch::Receiver<Signal> {
        self.signal.subscribe()
    }

    /// Changes when somebody should look at once.
    pub fn looks(&self) -> watch::Receiver<()> {
        self.looks.subscribe()
    }

    /// Locks the captures while an export is taken in. Blocks.
    pub fn hold(&self) -> LockedCaptures<'_> {
        LockedCaptures { booth: self, inner: self.inner() }
    }

    /// Notes what the looks at an export folder have found.
    pub fn looked(&self, place: usize, sights: Sights) {
        if let Some(known) = locked(&self.sights).get_mut(place) {
            *known = sights;
        }
    }

    /// What to do with the patient of a scan, as far as this run knows.
    pub fn to_do(&self, of: &ScanId) -> Vec<String> {
        let inner = self.inner();
        match (inner.in_work.get(of), &inner.last) {
            (Some(to_do), _) => to_do.clone(),
            (None, Some((Last::Scan { scan, to_do }, _))) if scan == of => to_do.clone(),
            _ => Vec::new(),
        }
    }

    /// Notes that a step of a scan has ended, and what to do with the patient. If the station does not work on the
    /// scan any more, the light shows how it ended. Blocks.
    pub fn ended(&self, scan: &ScanId, to_do: &[String]) {
        let now = self.core.now();
        let mut inner = self.inner();
        let Some(whole) = self.whole(scan) else { return };
        let outcome = LastOutcome::from_whole(&whole, to_do);
        let needs_person =
            matches!(outcome, Some(LastOutcome::Held { .. } | LastOutcome::Refused { .. }));
        let was_in_work = inner.in_work.contains_key(scan);
        if whole.is_in_work(&self.core.board.unfetched()) {
            inner.in_work.entry(scan.clone()).and_modify(|known| *known = to_do.to_owned());
        } else if was_in_work || needs_person || inner.has_last(scan) {
            inner.in_work.remove(scan);
            let at =
                inner.last.as_ref().filter(|_| inner.has_last(scan)).map_or(now, |(_, at)| *at);
            inner.last = Some((Last::Scan { scan: scan.clone(), to_do: to_do.to_owned() }, at));
        }
    }

    /// Notes that a person settled measures of a scan: what is still to be done with its patient. Blocks.
    pub fn amended(&self, settled: &ScanId, still: Vec<String>) {
        match &mut self.inner().last {
            Some((Last::Scan { scan, to_do }, _)) if scan == settled => *to_do = still,
            _ => {}
        }
    }

    /// A scan as the journal knows it; `None` if it does not, or cannot be read.
    fn whole(&self, scan: &ScanId) -> Option<Whole> {
        self.core.read(self.core.custody.journal().whole(scan)).flatten()
    }

    /// What the light shows of the last event, and whose scan it was.
    fn last(&self, inner: &Inner) -> Option<(LastOutcome, Vec<String>)> {
        let (last, _) = inner.last.as_ref()?;
        match last {
            Last::Scan { scan, to_do } => {
                let whole = self.whole(scan)?;
                Some((LastOutcome::from_whole(&whole, to_do)?, whole.possible_owners()))
            }
            Last::NameUnread => Some((LastOutcome::NameUnread, Vec::new())),
            Last::Known(scan) => {
                let owners = self.whole(scan).map(|whole| whole.possible_owners());
                Some((LastOutcome::Known, owners.unwrap_or_default()))
            }
        }
    }

    /// The current state of the booth. Blocks.
    pub fn state(&self) -> BoothState {
        let now = self.core.now();
        let inner = self.inner();
        BoothState {
            signal: *self.signal.borrow(),
            awaited: inner.captures.open().iter().filter(|capture| capture.is_open()).count(),
            is_named: inner.captures.next().is_some(),
            is_in_doubt: inner.captures.is_in_doubt(now),
            doubt_left: inner.captures.doubt_left(now).map(stepped),
            orders_come_late: match inner.captures.orders_when() {
                OrdersWhen::BeforePress => orders_come_late(&inner.late_orders),
                OrdersWhen::AfterPress => None,
            },
        }
    }

    /// When the last waiting capture was opened; `None` if none waits. Blocks.
    pub fn last_opened(&self) -> Option<Duration> {
        self.inner().captures.waiting().map(|capture| capture.opened).max()
    }

    /// Whether a button is not there. At a start, and while a port settles, there is nothing to be done.
    fn is_button_away(&self, inner: &Inner) -> bool {
        self.core.board.note(|facts| {
            let mut away = inner.away.iter().filter_map(|port| facts.triggers.get(port));
            away.any(|port| port.state.is_fault())
        })
    }

    fn scene(&self, not_ready: bool) -> Scene {
        let mut inner = self.inner();
        let progress = self.progress(&mut inner);
        let at = inner.last.as_ref().map(|(_, at)| *at);
        Scene {
            not_ready,
            paused: self.core.is_paused(),
            is_button_away: self.is_button_away(&inner),
            missed: inner.missed,
            armed: inner.captures.is_armed(),
            progress,
            last: self.last(&inner).map(|(outcome, _)| outcome).zip(at),
        }
    }

    /// How far the export or scan is that needs a person soonest.
    fn progress(&self, inner: &mut Inner) -> Option<Progress> {
        // What lay there at the first look may be known: it counts once it is taken.
        let is_any_new = |files: &[Appeared]| files.iter().any(|file| file.absent.is_some());
        let sights = locked(&self.sights);
        let is_any = |of: fn(&Sights) -> &[Appeared]| sights.iter().any(|at| is_any_new(of(at)));
        if is_any(|at| &at.stopped) {
            Some(Progress::Stopped)
        } else if is_any(|at| &at.coming) {
            Some(Progress::ComingIn)
        } else {
            drop(sights);
            self.is_any_in_work(inner).then_some(Progress::Measuring)
        }
    }

    /// Whether a scan that came in, or that ended last and that a person has released or tried again, is on its way
    /// to its record. What a person has settled otherwise is not.
    fn is_any_in_work(&self, inner: &mut Inner) -> bool {
        let unfetched = self.core.board.unfetched();
        if let Some((Last::Scan { scan, to_do }, _)) = &inner.last
            && self.whole(scan).is_some_and(|whole| whole.is_in_work(&unfetched))
        {
            inner.in_work.insert(scan.clone(), to_do.clone());
            inner.last = None;
        }
        while let Some((scan, _)) = inner.in_work.first_key_value() {
            let whole = self.core.read(self.core.custody.journal().whole(scan));
            let Some(whole) = whole else { return true };
            if whole.as_ref().is_some_and(|whole| whole.is_in_work(&unfetched)) {
                return true;
            }
            if let Some(((scan, to_do), _)) = inner.in_work.pop_first().zip(whole) {
                inner.last = Some((Last::Scan { scan, to_do }, self.core.now()));
            }
        }
        false
    }
}

impl LockedCaptures<'_> {
    /// Which capture an export belongs to; its times are on the station's clock.
    pub fn match_content(&self, content: &ExportContent) -> CaptureMatch {
        self.inner.captures.match_content(content, self.booth.core.now())
    }

    /// A known scan was exported again: if another export is expected, or somebody named, the light shows it.
    pub fn known(&mut self, scan: &ScanId) {
        // The scanner may write a scan once more that is being measured.
        if self.inner.in_work.contains_key(scan) {
            return;
        }
        let captures = &self.inner.captures;
        if captures.open().iter().any(Capture::is_open) || !captures.next_ids().is_empty() {
            self.inner.last = Some((Last::Known(scan.clone()), self.booth.core.now()));
        }
    }

    /// Applies an export that is in the journal, or whose bytes are in the spool with what it answers.
    pub fn answer(&mut self, judged: &CaptureMatch, scan: &ScanId, held: bool, now: Duration) {
        self.inner.captures.answer(judged, now);
        if !matches!(judged, CaptureMatch::Unpressed | CaptureMatch::Known) {
            self.inner.missed = false;
        }
        if !held {
            self.inner.in_work.insert(scan.clone(), Vec::new());
        }
    }
}

/// Keeps captures and the light up to date until asked to stop.
///
/// # Errors
/// If a step panicked.
pub async fn worker(booth: Arc<Booth>, beat: Heartbeat, mut stop: Stop) -> Result<(), JoinError> {
    let core = Arc::clone(booth.core());
    let (mut light, mut looks) = (Light::switched_on(), booth.looks());
    let (mut not_ready, mut next_ready) = (false, core.now());
    let mut slept = false;
    while !stop.is_requested() {
        beat.beat();
        let began = core.now();
        let (looked, asks) = (Arc::clone(&booth), began >= next_ready);
        let step = spawn_blocking(move || {
            if slept {
                looked.note_sleep();
            }
            let passed = looked.pass();
            let complaints = || Overview::take(&looked.core).complaints;
            let asked = asks.then(|| light::first_fault(&complaints()).is_some());
            let scene = looked.scene(asked.unwrap_or(not_ready));
            (passed, asked, scene)
        });
        let (passed, asked, scene) = step.await?;
        core.logged(passed);
        if let Some(asked) = asked {
            // A light that shows what is over sends people to look for nothing.
            let pause = if asked { NOT_READY } else { READY };
            (not_ready, next_ready) = (asked, core.now() + pause);
        }
        let shown = light.show(&scene, core.now());
        booth.signal.send_if_modified(|signal| std::mem::replace(signal, shown) != shown);
        tokio::select! {
            () = stop.requested() => break,
            _ = looks.changed() => {}
            () = sleep(LIGHT) => {}
        }
        // The step counts too: the process may have been stopped in it, and a disk that holds it up for so long holds
        // up the ports.
        slept = core.now().saturating_sub(began) > LIGHT + ASLEEP;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
