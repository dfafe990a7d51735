//! The keeper of the station, as a service manager is: starts it, again where it ends, reloads it, and
//! kills it now and then.

use std::sync::{Mutex, RwLock};
use std::time::{Duration, Instant};

use rig::Daemon;
use rustix::process::{Pid, Signal, kill_process};

use crate::chance::Chance;
use crate::field::{Field, Tail};
use crate::plan::{Event, weighed};

/// The pause before a station that ended by itself is started again.
const RESTART: Duration = Duration::from_millis(500);

/// `TimeoutStopSec` of the unit.
const STOP: Duration = Duration::from_secs(45);

/// What the keeper does to the station.
#[derive(Debug, Clone, Copy)]
pub enum Act {
    /// SIGHUP.
    Reload,
    /// SIGHUP twice, the second while the first may be on its way.
    ReloadTwice,
    /// SIGKILL, and a start.
    Kill,
    /// SIGTERM, and a start.
    Stop,
}

pub fn draw(chance: &mut Chance) -> Act {
    let acts = [(5, Act::Reload), (1, Act::ReloadTwice), (2, Act::Kill), (1, Act::Stop)];
    weighed(chance, &acts)
}

/// Which process it is, and whether it has said that it is ready.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Life {
    /// Grows with each start and each end.
    pub epoch: u32,
    /// None while there is none.
    pub pid: Option<u32>,
    pub is_ready: bool,
}

/// How often what has happened.
#[derive(Debug, Clone, Copy, Default)]
pub struct Count {
    pub reloads: usize,
    pub kills: usize,
    pub stops: usize,
    /// It ended by itself.
    pub ends: usize,
}

struct RunningStation {
    daemon: Daemon,
    said: Tail,
}

/// The keeper.
#[derive(Default)]
pub struct Keeper {
    held: Mutex<Option<RunningStation>>,
    /// Whoever holds it for reading knows that no station is on its way up.
    life: RwLock<Life>,
    /// Held while nobody may start, reload or end the station.
    calm: Mutex<()>,
    count: Mutex<Count>,
    restart_at: Mutex<Option<Instant>>,
}

impl Keeper {
    pub fn life(&self) -> Life {
        *self.life.read().unwrap()
    }

    pub fn count(&self) -> Count {
        *self.count.lock().unwrap()
    }

    fn note(&self, note: impl FnOnce(&mut Count)) {
        note(&mut self.count.lock().unwrap());
    }

    /// Does something that needs a station that is up, while none can come up.
    pub fn while_up<T>(&self, work: impl FnOnce(u32) -> T) -> Option<T> {
        let life = self.life.read().unwrap();
        life.pid.filter(|_| life.is_ready).map(work)
    }

    fn is(&self, change: impl FnOnce(&mut Life)) {
        let mut life = self.life.write().unwrap();
        life.epoch += 1;
        change(&mut life);
    }

    /// Starts the station.
    pub fn start(&self, field: &Field) {
        let mut held = self.held.lock().unwrap();
        let mut command = field.booth.command();
        if let Some(clock) = &field.clock {
            clock.lie_to(&mut command);
        }
        let said = Tail::from_now(&field.booth);
        let daemon = Daemon::start(command);
        self.is(|life| *life = Life { pid: Some(daemon.id()), is_ready: false, ..*life });
        *held = Some(RunningStation { daemon, said });
    }

    /// Kills it, does what must be done without it, and starts it.
    pub fn down(&self, field: &Field, work: impl FnOnce()) {
        let _calm = self.calm.lock().unwrap();
        self.end(Daemon::kill, work);
        self.start(field);
    }

    fn end(&self, end: impl FnOnce(Daemon), work: impl FnOnce()) {
        let mut held = self.held.lock().unwrap();
        self.is(|life| *life = Life { pid: None, is_ready: false, ..*life });
        if let Some(held) = held.take() {
            end(held.daemon);
        }
        *self.restart_at.lock().unwrap() = None;
        work();
    }

    /// Ends it and starts it anew, unless nobody may now.
    fn again(&self, field: &Field, how: &str, end: impl FnOnce(Daemon)) -> bool {
        let Ok(_calm) = self.calm.try_lock() else { return false };
        field.tell(how);
        self.end(end, || ());
        self.start(field);
        true
    }

    /// Does something while nobody starts, reloads or ends a station that is ready; says whether
    /// that could be had.
    pub fn in_calm(&self, field: &Field, work: impl FnOnce()) -> bool {
        let _calm = self.calm.lock().unwrap();
        let limit = Duration::from_secs(30);
        let had = field.wait_for(limit, || self.life().is_ready);
        if had {
            work();
        }
        had
    }

    /// Looks after the station: notes that it is ready, that it has ended, starts it again.
    pub fn look(&self, field: &Field) {
        let mut held = self.held.lock().unwrap();
        if let Some(now) = held.as_mut() {
            if now.said.lines().iter().any(|line| line.contains("station-ready"))
                && !self.life().is_ready
            {
                self.is(|life| life.is_ready = true);
                field.tell("the station is ready");
            }
            if now.daemon.has_ended()
                && let Some(ended) = held.take()
            {
                self.is(|life| *life = Life { pid: None, is_ready: false, ..*life });
                self.note(|count| count.ends += 1);
                let status = ended.daemon.stop();
                field.tell(format_args!("the station has ended by itself: {status}"));
                // 70 and 74 it says itself, with the reason.
                if !matches!(status.code(), Some(70 | 74)) {
                    field.fault(format_args!("the station ended with {status}"));
                }
                *self.restart_at.lock().unwrap() = Some(Instant::now() + RESTART);
            }
            return;
        }
        drop(held);
        let is_due = self.restart_at.lock().unwrap().is_some_and(|at| Instant::now() >= at);
        if is_due && let Ok(_calm) = self.calm.try_lock() {
            *self.restart_at.lock().unwrap() = None;
            self.start(field);
        }
    }

    fn hang_up(&self, field: &Field) {
        let Ok(_calm) = self.calm.try_lock() else { return field.tell("no SIGHUP now") };
        // Before it is ready a SIGHUP may end it: nobody listens yet.
        let hung_up = self.while_up(|pid| {
            let pid = Pid::from_raw(i32::try_from(pid).unwrap()).unwrap();
            kill_process(pid, Signal::HUP).is_ok()
        });
        if hung_up == Some(true) {
            self.note(|count| count.reloads += 1);
            field.tell("SIGHUP");
        }
    }

    /// Ends the station for good.
    pub fn stop(&self) -> Option<i32> {
        let held = self.held.lock().unwrap().take();
        self.is(|life| *life = Life { pid: None, is_ready: false, ..*life });
        held.and_then(|mut held| held.daemon.stop_within(STOP)).and_then(|ended| ended.code())
    }
}

/// Keeps the station until all is done.
pub fn keep(field: &Field, events: Vec<Event<Act>>) {
    let keeper = &field.keeper;
    let mut events = events.into_iter().peekable();
    while !field.is_done() {
        keeper.look(field);
        if let Some(event) = events.next_if(|event| field.elapsed() >= event.at)
            && field.goes_on()
        {
            perform(field, event.act);
        }
        let next = field.elapsed() + Duration::from_millis(50);
        if !field.wait_until(next) {
            field.wait_for(Duration::from_millis(50), || field.is_done());
        }
    }
}

fn perform(field: &Field, act: Act) {
    let keeper = &field.keeper;
    match act {
        Act::Reload => keeper.hang_up(field),
        Act::ReloadTwice => {
            keeper.hang_up(field);
            field.pass(Duration::from_millis(5));
            keeper.hang_up(field);
        }
        Act::Kill => {
            if keeper.again(field, "SIGKILL", Daemon::kill) {
                keeper.note(|count| count.kills += 1);
            }
        }
        // Before it is ready it does not heed SIGTERM as it should.
        Act::Stop if keeper.life().is_ready => {
            if keeper.again(field, "SIGTERM", |daemon| stopped(field, daemon)) {
                keeper.note(|count| count.stops += 1);
            }
        }
        Act::Stop => {}
    }
}

/// A stop ends in the time that the unit allows it.
fn stopped(field: &Field, mut daemon: Daemon) {
    let began = Instant::now();
    match daemon.stop_within(STOP) {
        Some(status) => field.tell(format_args!("ended with {status} in {:?}", began.elapsed())),
        None => field.fault(format_args!("the station did not stop within {STOP:?}")),
    }
}
