//! The thread of one port: attends it, passes its input to the booth and its state to the board.

use std::sync::Arc;
use std::time::Duration;

use gaiter_flow::booth::PortEvent;
use gaiter_flow::facts::TriggerFacts;
use gaiter_flow::trigger::PortState;
use jiff::{SignedDuration, Timestamp};
use tokio::sync::oneshot;
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::timeout;
use tracing::{info, warn};

use super::{Attendant, Attended};
use crate::station::booth::Booth;
use crate::station::core::Core;
use crate::station::runtime::{ASLEEP, Heartbeat, Stop};
use crate::station::share::stall::{DEADLINE, StepCounter, patiently};

/// The longest sleep of the thread before it checks whether to stop.
const NAP: Duration = Duration::from_millis(200);

/// How long a stop waits for the port to close, so that the next run finds it free. A port that hangs
/// in its driver is left alone.
const CLOSING: Duration = Duration::from_secs(2);

/// Attends a port until it is asked to stop.
///
/// # Errors
/// If the thread panicked.
pub async fn worker(
    booth: Arc<Booth>,
    port: Attended,
    beat: Heartbeat,
    mut stop: Stop,
) -> Result<(), JoinError> {
    let (core, name) = (Arc::clone(booth.core()), port.name);
    let (open, closed) = oneshot::channel::<()>();
    let (theirs, asked) = (Arc::clone(&booth), stop.clone());
    let work = move |counter: &StepCounter| {
        attend(&theirs, port, &asked, counter);
        drop(open);
    };
    let hangs = || {
        warn!(event = "trigger-hung", port = name);
        let hung = Arc::clone(&booth);
        drop(spawn_blocking(move || hung.port(name, false)));
        core.board.note(|facts| {
            if let Some(known) = facts.triggers.get_mut(name) {
                let now = Timestamp::now();
                (known.state, known.since) = (PortState::Hung, now);
                known.unsound_since.get_or_insert(now);
            }
        });
    };
    let beats = || beat.beat();
    if patiently(DEADLINE, &mut stop, work, beats, hangs).await?.is_none() {
        // Both results are fine: the other end is dropped when the port is closed.
        let _ = timeout(CLOSING, closed).await;
    }
    Ok(())
}

fn attend(booth: &Booth, port: Attended, stop: &Stop, counter: &StepCounter) {
    let Attended { name, opener, decoder, manner } = port;
    let core = booth.core();
    let signal = booth.signal();
    let clock = || core.now();
    let mut attendant = Attendant::new(opener, decoder, manner, clock());
    let mut noted = Noted::new(name);
    let mut events = Vec::new();
    let (mut was_open, mut listens_since) = (None, clock());
    while !stop.is_requested() {
        counter.step();
        let showing = *signal.borrow();
        let pause = attendant.turn(&clock, showing, &mut events);
        if was_open == Some(true) && clock().saturating_sub(listens_since) > ASLEEP {
            // Other ports may have been read since, and what was received here now may be older.
            booth.note_sleep();
            was_open = None;
        }
        // A gap ends before what is received after it.
        let is_open = attendant.state() == PortState::Open;
        if was_open != Some(is_open) {
            was_open = Some(is_open);
            booth.port(name, is_open);
        }
        // A journal that is slow to take the input keeps this port waiting: that counts as a sleep.
        listens_since = clock();
        for event in events.drain(..) {
            noted.count(&event);
            booth.receive(&event);
        }
        log(name, &mut attendant, clock());
        noted.note(core, &mut attendant);
        if !pause.is_zero() {
            std::thread::sleep(pause.min(NAP));
        }
    }
}

/// Logs each change once, at a limited rate.
fn log(port: &'static str, attendant: &mut Attendant, now: Duration) {
    let Some(state) = attendant.lifecycle().state_to_log(now) else { return };
    let event = match state {
        PortState::NotLooked | PortState::Settling | PortState::Open => "trigger-open",
        PortState::Absent => "trigger-absent",
        PortState::Busy => "trigger-busy",
        PortState::Denied => "trigger-denied",
        PortState::Failed => "trigger-failed",
        PortState::Stuck => "trigger-stuck",
        PortState::Hung => "trigger-hung",
    };
    match (state, attendant.lifecycle().why()) {
        (PortState::Open, _) => info!(event, port),
        (_, why) => warn!(event, port, why = why.map(ToString::to_string)),
    }
}

/// What was last noted about a port on the board.
struct Noted {
    name: &'static str,
    facts: TriggerFacts,
    /// `unsound_since` on the station's clock; the board's time is computed from it.
    unsound_since: Option<Duration>,
}

impl Noted {
    fn new(name: &'static str) -> Noted {
        Noted { name, facts: TriggerFacts::new(Timestamp::now()), unsound_since: None }
    }

    fn count(&mut self, event: &PortEvent) {
        match event {
            PortEvent::Press(_) => self.facts.presses += 1,
            PortEvent::Named { .. } => self.facts.ids += 1,
            PortEvent::Ordered { .. } | PortEvent::Unread | PortEvent::UnreadOrder { .. } => {}
        }
    }

    /// Notes the port's state.
    fn note(&mut self, core: &Core, attendant: &mut Attendant) {
        let known = &mut self.facts;
        known.garbage = attendant.garbage();
        let lifecycle = attendant.lifecycle();
        if known.state != lifecycle.state() {
            (known.state, known.since) = (lifecycle.state(), Timestamp::now());
        }
        known.why = lifecycle.why().cloned();
        if self.unsound_since != lifecycle.unsound_since() {
            self.unsound_since = lifecycle.unsound_since();
            known.unsound_since = self.unsound_since.map(|since| {
                let age = SignedDuration::try_from(core.now().saturating_sub(since));
                let now = Timestamp::now();
                age.ok().and_then(|age| now.checked_sub(age).ok()).unwrap_or(now)
            });
        }
        core.board.note(|facts| facts.triggers.insert(self.name, known.clone()));
    }
}
