//! One port, attended for ever: opened, listened to, spoken on, closed, looked for again.
//!
//! Nothing here knows which port it is or what time it is, so that the same code that attends the
//! real ones attends those that a test plays.

use std::collections::BTreeMap;
use std::time::Duration;

use super::port::{Port, PortOpener};
use crate::flow::booth::{Heard, Signal};
use crate::flow::trigger::port_lifecycle::Want;
use crate::flow::trigger::{FaultKind, Input, InputDecoder, PortFault, PortLifecycle, PortState};

/// How long a port that wakes its reader is listened to at one time: so late the light follows and
/// the station stops.
const LISTEN: Duration = Duration::from_millis(200);

/// How often a contact is looked at while nothing happens; once it is seen otherwise, also when its
/// bouncing should be over. A finger stays for 100 ms or more. Every 20 ms cost half a percent of a
/// core on a busy machine, more than a button should; waiting for the edge itself (TIOCMIWAIT) is in
/// no crate without unsafe code, and could not be ended.
pub const SAMPLE: Duration = Duration::from_millis(50);

/// How often it is looked whether the port is still the one that its name means.
const IN_PLACE: Duration = Duration::from_secs(1);

/// How a port is attended.
#[derive(Debug, Clone)]
pub struct Manner {
    /// What comes so soon after it was opened is not believed.
    pub settle: Duration,
    /// It has a contact that must be looked at again and again.
    pub sampled: bool,
    /// What is said on it.
    pub say: BTreeMap<Signal, Vec<u8>>,
}

/// A port that is attended.
pub struct Attendant {
    manner: Manner,
    opener: Box<dyn PortOpener>,
    port: Option<Box<dyn Port>>,
    decoder: InputDecoder,
    lifecycle: PortLifecycle,
    said: Option<Signal>,
    last_in_place: Duration,
    settling: bool,
    garbage: u64,
}

impl Attendant {
    /// A port that is looked for from `now` on.
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
            said: None,
            last_in_place: now,
            settling: false,
            garbage: 0,
        }
    }

    /// How the port is.
    pub fn lifecycle(&mut self) -> &mut PortLifecycle {
        &mut self.lifecycle
    }

    /// What came and meant nothing, bytes or keys.
    pub fn garbage(&self) -> u64 {
        self.garbage
    }

    /// Does what is to be done next; at most one opening, or one reading. Says how long nothing is
    /// to be done then. `clock` is asked again after whatever may have taken time.
    pub fn turn(
        &mut self,
        clock: &dyn Fn() -> Duration,
        signal: Signal,
        heard: &mut Vec<Heard>,
    ) -> Duration {
        match self.lifecycle.wants(clock()) {
            Want::Wait(pause) => return pause,
            Want::Open => self.open(clock),
            Want::Settle(rest) => self.settle(rest, clock),
            Want::Listen => {
                if std::mem::take(&mut self.settling) {
                    self.decoder.settled();
                }
                self.say(signal);
                self.listen(clock, heard);
            }
        }
        Duration::ZERO
    }

    fn open(&mut self, clock: &dyn Fn() -> Duration) {
        // The old one is closed first: while it is held, the system gives the next another number.
        self.port = None;
        match self.opener.open() {
            Ok(port) => {
                self.port = Some(port);
                self.decoder.begin();
                (self.said, self.settling, self.last_in_place) = (None, true, clock());
                self.lifecycle.opened(clock());
            }
            Err(fault) => self.lifecycle.failed(&fault, clock()),
        }
    }

    fn settle(&mut self, rest: Duration, clock: &dyn Fn() -> Duration) {
        match self.read(rest, clock) {
            // How the contact is must be known; what it and the line say is no press.
            Ok(input) => drop(self.decoder.hear(&input, clock())),
            Err(fault) => self.lose(&fault, clock),
        }
        self.decoder.garbage();
    }

    fn listen(&mut self, clock: &dyn Fn() -> Duration, heard: &mut Vec<Heard>) {
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
                heard.extend(self.decoder.hear(&input, now));
                self.garbage += self.decoder.garbage();
                self.lifecycle.listened(self.decoder.is_stuck(now), now);
            }
            Err(fault) => self.lose(&fault, clock),
        }
    }

    /// Reads for as long as nothing else is to be done.
    fn read(&mut self, most: Duration, clock: &dyn Fn() -> Duration) -> Result<Input, PortFault> {
        let most = if self.manner.sampled { most.min(SAMPLE) } else { most };
        let most = match self.decoder.due() {
            Some(due) => most.min(due.saturating_sub(clock())),
            None => most,
        };
        let closed = || PortFault { kind: FaultKind::Absent, why: "it is closed".into() };
        self.port.as_mut().map_or_else(|| Err(closed()), |port| port.read(most))
    }

    fn lose(&mut self, fault: &PortFault, clock: &dyn Fn() -> Duration) {
        self.port = None;
        self.lifecycle.failed(fault, clock());
    }

    /// Says what the light shows, once. That it could not be said is no fault of the button: one
    /// that is gone shows when it is listened to.
    fn say(&mut self, signal: Signal) {
        if self.said != Some(signal) {
            self.said = Some(signal);
            if let (Some(bytes), Some(port)) = (self.manner.say.get(&signal), &mut self.port) {
                let _ = port.write(bytes);
            }
        }
    }

    /// How the port is, for those who ask.
    pub fn state(&self) -> PortState {
        self.lifecycle.state()
    }
}
