//! The station's side of the booth: takes what the ports hear, keeps the captures, and says what
//! the light shows. What a capture means is decided by [`crate::flow::capture`]; every step stands in
//! the journal before anything is done by it.

mod hearing;
pub(in crate::station) mod orders;
pub mod trigger;

use std::collections::BTreeSet;
use std::fs;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use jiff::Timestamp;
use tokio::sync::{Notify, watch};
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;
use tracing::warn;

use super::assembly::Station;
use super::beat::Beat;
use super::error::chain;
use super::journal::{CaptureRow, Journal, JournalError};
use super::operator::overview::Overview;
use super::stop::Stop;
use crate::flow::booth::Signal;
use crate::flow::capture::{Capture, CaptureState, Captures, Content, Judged, Rules};
use crate::flow::light::{Light, Outcome, Scene};
use crate::flow::order_habit::{OrderCame, OrdersComeLate, orders_come_late};
use crate::flow::page::Situation;
use crate::flow::settle::Sights;
use crate::flow::{OrdersWhen, ScanId};
pub use hearing::NameFault;

/// How often the light is looked after: a person sees no shorter delay.
const LIGHT: Duration = Duration::from_millis(200);

/// How often the whole station is asked whether it is ready, which reads the journal.
const READY: Duration = Duration::from_secs(5);

/// The alarm for an export that did not come.
const NO_EXPORT: &str = "no-export";

/// The booth of a station.
#[derive(Debug)]
pub struct Booth {
    /// Locked over writes to the journal, so by threads that may block and by no others.
    inner: Mutex<Inner>,
    /// Locked for moments.
    glance: Mutex<Glance>,
    signal: watch::Sender<Signal>,
    /// Told at each press: what lies in the export folders now was there before it.
    looks: Vec<Arc<Notify>>,
    /// What tells this start of the machine from another.
    boot: String,
}

#[derive(Debug)]
struct Inner {
    captures: Captures,
    next_number: i64,
    /// The ports that are not open.
    away: BTreeSet<&'static str>,
    /// Scans that came in and whose records are not all delivered.
    in_work: BTreeSet<ScanId>,
    /// When the last orders came.
    orders: Vec<OrderCame>,
    missed: bool,
    last: Option<(Outcome, Duration)>,
}

impl Inner {
    /// When the last capture was opened that waits; none while none does.
    fn last_opened(&self) -> Option<Duration> {
        self.captures.waiting().iter().map(|capture| capture.opened).max()
    }
}

/// What is told and noted without waiting for the journal.
#[derive(Debug)]
struct Glance {
    /// What the looks have found, by export folder.
    sights: Vec<Sights>,
    /// When the last capture was opened that waits; none while none does.
    last_opened: Option<Duration>,
}

/// The booth's captures, locked.
#[derive(Debug)]
struct Locked<'a> {
    booth: &'a Booth,
    inner: MutexGuard<'a, Inner>,
}

impl Deref for Locked<'_> {
    type Target = Inner;

    fn deref(&self) -> &Inner {
        &self.inner
    }
}

impl DerefMut for Locked<'_> {
    fn deref_mut(&mut self) -> &mut Inner {
        &mut self.inner
    }
}

impl Drop for Locked<'_> {
    /// Tells what has changed to those who do not wait.
    fn drop(&mut self) {
        self.booth.glance().last_opened = self.inner.last_opened();
    }
}

/// The captures, held while an export is taken: no press or other export comes in between.
#[derive(Debug)]
pub struct Held<'a> {
    inner: Locked<'a>,
}

/// How the booth is at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoothState {
    /// What the light shows.
    pub signal: Signal,
    /// How many exports are awaited.
    pub awaited: usize,
    /// Somebody is named for the next press.
    pub is_named: bool,
    /// A press may have gone unheard a short while ago.
    pub is_in_doubt: bool,
    /// Most orders come after the press, and the configuration expects them before it.
    pub orders_come_late: Option<OrdersComeLate>,
}

/// Who is next, and whose exports are awaited.
#[derive(Debug, Clone)]
pub struct WhoIsNext {
    state: BoothState,
    has_button: bool,
    next: Vec<String>,
    awaited_for: Vec<String>,
}

impl WhoIsNext {
    /// The same for the page.
    pub fn situation(&self) -> Situation<'_> {
        Situation {
            signal: self.state.signal,
            has_button: self.has_button,
            awaited: self.state.awaited,
            next: &self.next,
            awaited_for: &self.awaited_for,
            is_in_doubt: self.state.is_in_doubt,
        }
    }
}

impl Station {
    /// Who is next, and whose exports are awaited.
    pub fn who_is_next(&self) -> WhoIsNext {
        let state = self.booth.state(self.now());
        let has_button = !self.config.buttons().is_empty();
        let captures = &self.booth.inner().captures;
        let (next, awaited_for) = (captures.next_ids(), captures.awaited_ids());
        WhoIsNext { state, has_button, next, awaited_for }
    }
}

impl Booth {
    /// The booth as the journal has it, at this time of the station's clock. `buttons` are the ports
    /// that buttons are on.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn open(
        journal: &Journal,
        rules: Rules,
        folders: usize,
        buttons: BTreeSet<&'static str>,
        now: Duration,
    ) -> Result<Booth, JournalError> {
        let boot = boot_id();
        let is_ours = |row: &CaptureRow| row.boot == boot && !boot.is_empty();
        // The machine was off: whatever a press had begun expires.
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
            journal.captures_of_before(&others, &kept, &boot, is_name_over)?;
        }
        let names = names.filter(|_| !is_name_over);
        let (next, unsure, unread) = names.map_or((None, Vec::new(), Vec::new()), |names| {
            (names.next, names.unsure, names.unread)
        });
        let ours = ours.into_iter().map(|row| row.capture);
        let waiting = kept.into_iter().chain(ours).collect();
        let taken = journal.captures_taken()?.into_iter();
        let taken = taken.filter_map(|row| match is_ours(&row) {
            true => Some(row.capture),
            false => carried_over(&row),
        });
        let mut captures = Captures::new(rules, waiting, next)
            .with_doubts(unsure, unread)
            .with_measuring(taken.collect(), now);
        if buttons.is_empty() {
            captures.hears(Duration::ZERO);
        }
        let inner = Inner {
            captures,
            next_number: journal.next_capture()?,
            away: buttons,
            in_work: BTreeSet::new(),
            orders: journal.orders_came()?,
            missed: !others.is_empty(),
            last: None,
        };
        let sights = vec![Sights::default(); folders];
        let glance = Glance { sights, last_opened: inner.last_opened() };
        let looks = (0..folders).map(|_| Arc::new(Notify::new())).collect();
        let signal = watch::Sender::new(Signal::Ready);
        let (inner, glance) = (Mutex::new(inner), Mutex::new(glance));
        Ok(Booth { inner, glance, signal, looks, boot })
    }

    /// Blocks while somebody writes to the journal.
    fn inner(&self) -> Locked<'_> {
        let inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        Locked { booth: self, inner }
    }

    fn glance(&self) -> MutexGuard<'_, Glance> {
        self.glance.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What the light shows, now and whenever it changes.
    pub fn signal(&self) -> watch::Receiver<Signal> {
        self.signal.subscribe()
    }

    /// What tells the export folder of this place to look at once.
    pub fn look(&self, place: usize) -> Arc<Notify> {
        self.looks.get(place).cloned().unwrap_or_default()
    }

    /// Holds the captures while an export is taken. Blocks.
    pub fn hold(&self) -> Held<'_> {
        Held { inner: self.inner() }
    }

    /// Notes what the looks at an export folder have found.
    pub fn looked(&self, place: usize, sights: Sights) {
        if let Some(known) = self.glance().sights.get_mut(place) {
            *known = sights;
        }
    }

    /// A scan ended, or needs a person; `now` is of the station's clock. Blocks.
    pub fn ended(&self, scan: &ScanId, outcome: Outcome, now: Duration) {
        let mut inner = self.inner();
        if inner.in_work.remove(scan) || outcome == Outcome::NeedsPerson {
            inner.last = Some((outcome, now));
        }
    }

    /// How the booth is; `now` is of the station's clock. Blocks.
    pub fn state(&self, now: Duration) -> BoothState {
        let inner = self.inner();
        let is_open = |capture: &&Capture| capture.state == CaptureState::Open;
        BoothState {
            signal: *self.signal.borrow(),
            awaited: inner.captures.waiting().iter().filter(is_open).count(),
            is_named: inner.captures.next().is_some(),
            is_in_doubt: inner.captures.is_in_doubt(now),
            orders_come_late: match inner.captures.orders_when() {
                OrdersWhen::BeforePress => orders_come_late(&inner.orders),
                OrdersWhen::AfterPress => None,
            },
        }
    }

    /// When the last capture was opened that waits; none while none does.
    pub fn last_opened(&self) -> Option<Duration> {
        self.glance().last_opened
    }

    /// What tells this start of the machine from another.
    pub fn boot(&self) -> &str {
        &self.boot
    }

    fn scene(&self, not_ready: bool) -> Scene {
        let inner = self.inner();
        let coming = self.glance().sights.iter().any(|folder| !folder.coming.is_empty());
        Scene {
            not_ready,
            missed: inner.missed,
            armed: inner.captures.is_armed(),
            busy: coming || !inner.in_work.is_empty(),
            last: inner.last,
        }
    }
}

impl Held<'_> {
    /// Which capture an export belongs to; its times are of the station's clock.
    pub fn judge(&self, content: &Content) -> Judged {
        self.inner.captures.judge_content(content)
    }

    /// The export stands in the journal, or its bytes in the spool with what it answers.
    pub fn answer(&mut self, judged: &Judged, scan: &ScanId, held: bool, now: Duration) {
        self.inner.captures.answer(judged, now);
        if *judged != Judged::Unpressed {
            self.inner.missed = false;
        }
        if !held {
            self.inner.in_work.insert(scan.clone());
        }
    }
}

/// Looks after captures and the light until it is asked to stop.
///
/// # Errors
/// Where a step panicked.
pub async fn worker(station: Arc<Station>, beat: Beat, mut stop: Stop) -> Result<(), JoinError> {
    let mut light = Light::new(station.now());
    let (mut not_ready, mut next_ready) = (false, station.now());
    while !stop.is_requested() {
        beat.beat();
        let (looked, asks) = (Arc::clone(&station), station.now() >= next_ready);
        let step = spawn_blocking(move || {
            let passed = looked.pass();
            let asked = asks.then(|| !Overview::take(&looked).complaints.is_empty());
            let scene = looked.booth.scene(asked.unwrap_or(not_ready));
            (passed, asked, scene)
        });
        let (passed, asked, scene) = step.await?;
        if let Err(error) = passed {
            station.check_corruption(&error);
            warn!(event = "journal-failed", error = chain(&error));
        }
        if let Some(asked) = asked {
            (not_ready, next_ready) = (asked, station.now() + READY);
        }
        let shown = light.show(&scene, station.now());
        station.booth.signal.send_if_modified(|signal| std::mem::replace(signal, shown) != shown);
        tokio::select! {
            () = stop.requested() => break,
            () = sleep(LIGHT) => {}
        }
    }
    Ok(())
}

/// What tells one start of the machine from another; empty where the system does not say, and then
/// every start of the station counts as one of the machine.
fn boot_id() -> String {
    let id = fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    id.trim().to_owned()
}

#[cfg(test)]
mod tests;
