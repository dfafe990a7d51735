//! The lifecycle of a port: looked for, opened, settling, listened to, lost and looked for again,
//! without end; and how much of that is logged.

use std::time::Duration;

use serde::Serialize;

use crate::cause::Cause;

gaiter_record::word_enum! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize)]
    pub enum PortState as serde {
        /// It has not been looked for yet.
        #[default]
        NotLooked => "not_looked",
        /// It is not there.
        Absent => "absent",
        /// Another program uses it.
        Busy => "busy",
        /// The station's user may not open it.
        Denied => "denied",
        /// It is there but does not work.
        Failed => "failed",
        /// It has just been opened, and its input is not trusted yet.
        Settling => "settling",
        /// It is listened to.
        Open => "open",
        /// It is listened to, but its contact is closed for longer than anyone presses a button.
        Stuck => "stuck",
        /// Its driver does not return.
        Hung => "hung",
    }
}

impl PortState {
    /// Whether it is not listened to, and will not be in a moment.
    pub fn is_fault(self) -> bool {
        !matches!(self, PortState::NotLooked | PortState::Settling | PortState::Open)
    }
}

/// Why a port cannot be opened or listened to.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{why}")]
pub struct PortFault {
    pub kind: PortFaultKind,
    /// In words, without the port's path.
    pub why: Cause,
}

/// The kinds of faults, each with a state of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PortFaultKind {
    /// There is no such port, or it is gone.
    Absent,
    /// Another program uses it.
    Busy,
    /// The station's user may not open it.
    Denied,
    /// Anything else.
    Failed,
}

impl PortFaultKind {
    const fn state(self) -> PortState {
        match self {
            PortFaultKind::Absent => PortState::Absent,
            PortFaultKind::Busy => PortState::Busy,
            PortFaultKind::Denied => PortState::Denied,
            PortFaultKind::Failed => PortState::Failed,
        }
    }
}

/// The first pause before a port is tried again. A port that was just plugged in gets its group some 100
/// ms later; until then opening it is denied.
const FIRST_PAUSE: Duration = Duration::from_millis(50);

/// The longest pause: a port works within seconds after its cable is plugged in again.
const LONGEST_PAUSE: Duration = Duration::from_secs(3);

/// A port that was open for this long was sound: when it is lost, it is looked for again at once.
const SOUND: Duration = Duration::from_secs(10);

/// At most one log line in this time, however often a port comes and goes.
const LINE_EVERY: Duration = Duration::from_secs(60);

/// What to do with a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Want {
    Open,
    /// Leave it alone for this long.
    Wait(Duration),
    /// Listen, but do not trust the input for this long.
    Settle(Duration),
    Listen,
}

#[derive(Debug, Clone, Default)]
pub struct PortLifecycle {
    settle: Duration,
    state: PortState,
    why: Option<Cause>,
    /// Failed attempts to open it, in a row.
    failures: u32,
    next_try: Duration,
    opened: Duration,
    /// Since when it has not been sound.
    unsound_since: Option<Duration>,
    logged: Option<(PortState, Duration)>,
}

impl PortLifecycle {
    /// A port that is to be looked for from `now` on, and that settles for `settle` once it is open.
    pub fn new(settle: Duration, now: Duration) -> PortLifecycle {
        let (next_try, opened, unsound_since) = (now, now, Some(now));
        PortLifecycle { settle, next_try, opened, unsound_since, ..PortLifecycle::default() }
    }

    pub fn state(&self) -> PortState {
        self.state
    }

    /// Why it is not listened to.
    pub fn why(&self) -> Option<&Cause> {
        self.why.as_ref()
    }

    /// Since when it has not worked steadily.
    pub fn unsound_since(&self) -> Option<Duration> {
        self.unsound_since
    }

    /// What to do at `now`.
    pub fn wants(&self, now: Duration) -> Want {
        match self.state {
            PortState::Open | PortState::Stuck | PortState::Hung => Want::Listen,
            PortState::Settling => match (self.opened + self.settle).saturating_sub(now) {
                Duration::ZERO => Want::Listen,
                rest => Want::Settle(rest),
            },
            _ => match self.next_try.saturating_sub(now) {
                Duration::ZERO => Want::Open,
                rest => Want::Wait(rest),
            },
        }
    }

    /// It was opened at `now`.
    pub fn opened(&mut self, now: Duration) {
        self.state = PortState::Settling;
        self.why = None;
        self.opened = now;
    }

    /// It was listened to at `now`; `stuck` is whether its contact is stuck.
    pub fn listened(&mut self, stuck: bool, now: Duration) {
        self.state = if stuck { PortState::Stuck } else { PortState::Open };
        if stuck {
            self.unsound_since.get_or_insert(now);
        } else if now.saturating_sub(self.opened) >= SOUND {
            self.unsound_since = None;
            self.failures = 0;
        }
    }

    /// It could not be opened, or was lost.
    pub fn failed(&mut self, fault: &PortFault, now: Duration) {
        self.state = fault.kind.state();
        self.why = Some(fault.why.clone());
        self.unsound_since.get_or_insert(now);
        self.next_try = now + pause(self.failures);
        self.failures = self.failures.saturating_add(1);
    }

    /// The state to log now, if there is one: each state once, and not too often.
    pub fn state_to_log(&mut self, now: Duration) -> Option<PortState> {
        if matches!(self.state, PortState::NotLooked | PortState::Settling) {
            return None;
        }
        if let Some((logged, at)) = self.logged
            && (logged == self.state || now.saturating_sub(at) < LINE_EVERY)
        {
            return None;
        }
        self.logged = Some((self.state, now));
        Some(self.state)
    }
}

/// The pause after this many failures in a row.
fn pause(failures: u32) -> Duration {
    FIRST_PAUSE.saturating_mul(1 << failures.min(16)).min(LONGEST_PAUSE)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTLE: Duration = Duration::from_millis(500);

    fn fault(kind: PortFaultKind) -> PortFault {
        PortFault { kind, why: "No such file or directory".into() }
    }

    fn ms(time: u64) -> Duration {
        Duration::from_millis(time)
    }

    #[test]
    fn an_unplugged_port_is_tried_for_ever_and_told_of_once() {
        let mut lifecycle = PortLifecycle::new(SETTLE, ms(0));
        let (mut now, mut tries, mut lines) = (ms(0), 0, 0);
        while now < ms(3_600_000) {
            match lifecycle.wants(now) {
                Want::Open => {
                    lifecycle.failed(&fault(PortFaultKind::Absent), now);
                    tries += 1;
                }
                Want::Wait(pause) => now += pause,
                want => panic!("{want:?}"),
            }
            lines += usize::from(lifecycle.state_to_log(now).is_some());
        }
        assert_eq!((lifecycle.state(), lines), (PortState::Absent, 1));
        // 50, 100, … 1600 ms in six pauses, then every 3 s.
        assert_eq!(tries, 7 + (3_600_000 - 3150) / 3000);
        assert_eq!(lifecycle.unsound_since(), Some(ms(0)));
    }

    #[test]
    fn a_loose_cable_says_one_line_a_minute_and_is_not_tried_without_a_pause() {
        let mut lifecycle = PortLifecycle::new(ms(0), ms(0));
        let (mut now, mut opened, mut lines) = (ms(0), 0, 0);
        while now < ms(3_600_000) {
            match lifecycle.wants(now) {
                Want::Open => {
                    opened += 1;
                    lifecycle.opened(now);
                }
                Want::Wait(pause) => now += pause,
                _ => {
                    lifecycle.listened(false, now);
                    lines += usize::from(lifecycle.state_to_log(now).is_some());
                    now += ms(20);
                    lifecycle.failed(&fault(PortFaultKind::Failed), now);
                }
            }
            lines += usize::from(lifecycle.state_to_log(now).is_some());
        }
        assert!(lines <= 60, "{lines} lines");
        assert!(opened < 1300, "opened {opened} times");
        assert!(lifecycle.unsound_since().is_some(), "it never was sound");
    }

    #[test]
    fn a_port_that_was_sound_is_looked_for_at_once() {
        let mut lifecycle = PortLifecycle::new(SETTLE, ms(0));
        (0..9).for_each(|_| lifecycle.failed(&fault(PortFaultKind::Busy), ms(0)));
        assert_eq!(
            (lifecycle.state(), lifecycle.wants(ms(0))),
            (PortState::Busy, Want::Wait(LONGEST_PAUSE))
        );
        lifecycle.opened(ms(3000));
        assert_eq!(lifecycle.wants(ms(3100)), Want::Settle(ms(400)));
        assert_eq!(lifecycle.wants(ms(3500)), Want::Listen);
        lifecycle.listened(false, ms(3500));
        assert!(lifecycle.unsound_since().is_some());
        lifecycle.listened(false, ms(13_000));
        assert_eq!(lifecycle.unsound_since(), None);
        lifecycle.failed(&fault(PortFaultKind::Absent), ms(20_000));
        assert_eq!(lifecycle.wants(ms(20_000)), Want::Wait(FIRST_PAUSE));
        assert_eq!(lifecycle.unsound_since(), Some(ms(20_000)));
    }

    #[test]
    fn what_is_told_last_is_how_it_is() {
        let mut lifecycle = PortLifecycle::new(SETTLE, ms(0));
        lifecycle.failed(&fault(PortFaultKind::Denied), ms(0));
        assert_eq!(lifecycle.state_to_log(ms(0)), Some(PortState::Denied));
        lifecycle.opened(ms(100));
        lifecycle.listened(false, ms(600));
        assert_eq!(lifecycle.state_to_log(ms(59_999)), None);
        assert_eq!(lifecycle.state_to_log(ms(60_000)), Some(PortState::Open));
        assert_eq!(lifecycle.state_to_log(ms(600_000)), None);
    }

    #[test]
    fn every_state_has_a_word_of_its_own() {
        let mut words = PortState::ALL.map(PortState::word).to_vec();
        words.sort_unstable();
        words.dedup();
        assert_eq!(words.len(), PortState::ALL.len());
    }
}
