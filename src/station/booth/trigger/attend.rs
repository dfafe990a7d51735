//! Attends one port forever: opens it, listens to it, writes to it, closes it and looks for it again.
//!
//! Nothing here knows which port this is or what time it is, so the same code attends real ports and
//! the ports that a test simulates.

use std::collections::BTreeMap;
use std::time::Duration;

use gaiter_flow::booth::{PortEvent, Signal};
use gaiter_flow::trigger::port_lifecycle::Want;
use gaiter_flow::trigger::{
    Input, InputDecoder, PortFault, PortFaultKind, PortLifecycle, PortState,
};

use super::port::{Port, PortOpener};

/// How long one read waits on a port that wakes its reader. Changes of the light and a stop of the
/// station are delayed by at most this time.
const LISTEN: Duration = Duration::from_millis(200);

/// How often a contact is sampled while nothing happens. After a change it is sampled again when the
/// bouncing should be over. A finger stays for 100 ms or more. Sampling every 20 ms cost half a percent
/// of a core on a busy machine, which is too much for a button. Waiting for the edge itself
/// (TIOCMIWAIT) is in no crate without unsafe code, and could not be interrupted.
pub const SAMPLE: Duration = Duration::from_millis(50);

/// How often to check that the port is still the one that its name refers to.
const IN_PLACE: Duration = Duration::from_secs(1);

/// How a port is attended.
#[derive(Debug, Clone)]
pub struct Manner {
    /// Input within this time after the port was opened is ignored.
    pub settle: Duration,
    /// It has a contact that must be sampled repeatedly.
    pub sampled: bool,
    /// What is written to it for each signal.
    pub say: BTreeMap<Signal, Vec<u8>>,
}

/// A port that is attended.
pub struct Attendant {
    manner: Manner,
    opener: Box<dyn PortOpener>,
    port: Option<Box<dyn Port>>,
    decoder: InputDecoder,
    lifecycle: PortLifecycle,
    sent: Option<Signal>,
    last_in_place: Duration,
    settling: bool,
    garbage: u64,
}

impl Attendant {
    /// Creates an attendant that looks for its port from `now` on.
    pub fn new(
        opener: Box<dyn PortOpener>,
        decoder: InputDecoder,
        manner: Manner,
        now: Duration,
    ) -> Attendant {
        let lifecycle = PortLifecycle::new(manner.settle, now);
        Attendant {
            manner,
            opener,
            port: None,
            decoder,
            lifecycle,
            sent: None,
            last_in_place: now,
            settling: false,
            garbage: 0,
        }
    }

    /// The state machine of the port.
    pub fn lifecycle(&mut self) -> &mut PortLifecycle {
        &mut self.lifecycle
    }

    /// How many bytes or keys had no meaning.
    pub fn garbage(&self) -> u64 {
        self.garbage
    }

    /// Does the next step, at most one open or one read. Returns how long there is nothing to do
    /// afterwards. `clock` is read again after anything that may have taken time.
    pub fn turn(
        &mut self,
        clock: &dyn Fn() -> Duration,
        signal: Signal,
        events: &mut Vec<PortEvent>,
    ) -> Duration {
        match self.lifecycle.wants(clock()) {
            Want::Wait(pause) => return pause,
            Want::Open => self.open(clock),
            Want::Settle(rest) => self.settle(rest, clock),
            Want::Listen => {
                if std::mem::take(&mut self.settling) {
                    self.decoder.settled();
                }
                self.send(signal);
                self.listen(clock, events);
            }
        }
        Duration::ZERO
    }

    fn open(&mut self, clock: &dyn Fn() -> Duration) {
        // The old port is closed first: while it is open, the system gives the next one another number.
        self.port = None;
        match self.opener.open() {
            Ok(port) => {
                self.port = Some(port);
                self.decoder.begin();
                (self.sent, self.settling, self.last_in_place) = (None, true, clock());
                self.lifecycle.opened(clock());
            }
            Err(fault) => self.lifecycle.failed(&fault, clock()),
        }
    }

    fn settle(&mut self, rest: Duration, clock: &dyn Fn() -> Duration) {
        match self.read(rest, clock) {
            // The state of the contact must be known, but nothing received now is a press.
            Ok(input) => drop(self.decoder.decode(&input, clock())),
            Err(fault) => self.lose(&fault, clock),
        }
        self.decoder.garbage();
    }

    fn listen(&mut self, clock: &dyn Fn() -> Duration, events: &mut Vec<PortEvent>) {
        let now = clock();
        if now.saturating_sub(self.last_in_place) >= IN_PLACE {
            self.last_in_place = now;
            if let Some(Err(fault)) = self.port.as_mut().map(|port| port.is_in_place()) {
                return self.lose(&fault, clock);
            }
        }
        match self.read(LISTEN, clock) {
            Ok(input) => {
                let now = clock();
                events.extend(self.decoder.decode(&input, now));
                self.garbage += self.decoder.garbage();
                self.lifecycle.listened(self.decoder.is_stuck(now), now);
            }
            Err(fault) => self.lose(&fault, clock),
        }
    }

    /// Reads, but only until something else is due.
    fn read(&mut self, most: Duration, clock: &dyn Fn() -> Duration) -> Result<Input, PortFault> {
        let most = if self.manner.sampled { most.min(SAMPLE) } else { most };
        let most = match self.decoder.due() {
            Some(due) => most.min(due.saturating_sub(clock())),
            None => most,
        };
        let closed = || PortFault { kind: PortFaultKind::Absent, why: "it is closed".into() };
        self.port.as_mut().map_or_else(|| Err(closed()), |port| port.read(most))
    }

    fn lose(&mut self, fault: &PortFault, clock: &dyn Fn() -> Duration) {
        self.port = None;
        self.lifecycle.failed(fault, clock());
    }

    /// Writes what belongs to the light's signal, once. A failed write is not a fault of the button: if
    /// the port is gone, the next read shows it.
    fn send(&mut self, signal: Signal) {
        if self.sent != Some(signal) {
            self.sent = Some(signal);
            if let (Some(bytes), Some(port)) = (self.manner.say.get(&signal), &mut self.port) {
                let _ = port.write(bytes);
            }
        }
    }

    pub fn state(&self) -> PortState {
        self.lifecycle.state()
    }
}
