//! The thread of one port: attends it, passes its input to the booth and its state to the board.

use std::sync::Arc;
use std::time::Duration;

use gaiter_flow::booth::PortEvent;
use gaiter_flow::facts::TriggerFacts;
use gaiter_flow::trigger::PortState;
use jiff::Timestamp;
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
    core.board.note(|facts| facts.triggers.insert(name, TriggerFacts::new(Timestamp::now())));
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
        for event in &events {
            booth.receive(event);
        }
        log(name, &mut attendant, clock());
        note(core, name, &mut attendant, &events);
        events.clear();
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

/// Notes on the board how a port is, and what it has received since the last note.
fn note(core: &Core, port: &'static str, attendant: &mut Attendant, events: &[PortEvent]) {
    let (garbage, now) = (attendant.garbage(), Timestamp::now());
    let lifecycle = attendant.lifecycle();
    core.board.note(|facts| {
        let known = facts.triggers.entry(port).or_insert_with(|| TriggerFacts::new(now));
        if known.state != lifecycle.state() {
            (known.state, known.since) = (lifecycle.state(), now);
        }
        known.why = lifecycle.why().cloned();
        match lifecycle.unsound_since() {
            Some(_) => _ = known.unsound_since.get_or_insert(now),
            None => known.unsound_since = None,
        }
        known.garbage = garbage;
        for event in events {
            match event {
                PortEvent::Press(_) => known.presses += 1,
                PortEvent::Named { .. } => known.ids += 1,
                PortEvent::Ordered { .. } | PortEvent::Unread | PortEvent::UnreadOrder { .. } => {}
            }
        }
    });
}
