//! The time by which old data is deleted. A wall clock that has jumped ahead makes everything look old;
//! deletions caused by such a jump wait until the station has run for a day, in which someone may notice
//! and correct the clock.

use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use serde::{Deserialize, Serialize};

/// A clock that is set by more than this has jumped. Drifting clocks are corrected by seconds, and
/// summer time has no effect: times are UTC.
const JUMP: SignedDuration = SignedDuration::from_hours(1);

/// How long deletions caused by a jump wait, while the station runs.
const WAIT: Duration = Duration::from_hours(24);

/// The wall clock, and the jumps ahead that are not trusted yet.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct TrustedTime {
    seen: Option<Seen>,
    /// How long the station has been running in total.
    running: Duration,
    ahead: Vec<Jump>,
}

/// The clocks at one moment.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seen {
    /// The wall clock.
    pub wall: Timestamp,
    /// The machine's clock since its start.
    pub since_boot: Duration,
    /// Identifies this start of the machine.
    pub boot: String,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Jump {
    by: SignedDuration,
    /// How long the station had been running in total.
    at: Duration,
}

impl Seen {
    fn is_same_start(&self, now: &Seen) -> bool {
        self.boot == now.boot && !now.boot.is_empty()
    }

    /// The time that is known to have passed.
    fn until(&self, now: &Seen) -> Duration {
        let before = if self.is_same_start(now) { self.since_boot } else { Duration::ZERO };
        now.since_boot.saturating_sub(before)
    }

    /// How far the wall clock has moved beyond that.
    fn jump(&self, now: &Seen) -> SignedDuration {
        let passed = SignedDuration::try_from(self.until(now)).unwrap_or(SignedDuration::MAX);
        now.wall.duration_since(self.wall).saturating_sub(passed)
    }
}

impl TrustedTime {
    /// The state at this moment. `ran` is whether the station has been running since the last one. While
    /// the machine is off, nothing measures how much time passes, so that counts as a jump, too.
    pub fn at(mut self, now: Seen, ran: bool) -> TrustedTime {
        if let Some(seen) = &self.seen {
            if ran && seen.is_same_start(&now) {
                self.running += seen.until(&now);
            }
            let by = seen.jump(&now);
            if by > JUMP {
                self.ahead.push(Jump { by, at: self.running });
            } else if by < -JUMP {
                self.goes_back(by);
            }
        }
        let running = self.running;
        self.ahead.retain(|jump| running < jump.at + WAIT);
        self.seen = Some(now);
        self
    }

    /// Whether the clock has jumped since the last moment.
    pub fn is_jump(&self, now: &Seen) -> bool {
        self.seen.as_ref().is_some_and(|seen| seen.jump(now).abs() > JUMP)
    }

    /// The clock was set back: that undoes the latest jumps ahead.
    fn goes_back(&mut self, mut by: SignedDuration) {
        while let Some(jump) = self.ahead.last_mut() {
            jump.by = jump.by.saturating_add(by);
            if jump.by > SignedDuration::ZERO {
                return;
            }
            by = jump.by;
            self.ahead.pop();
        }
    }

    /// The trusted time; `None` before the first moment.
    pub fn now(&self) -> Option<Timestamp> {
        let ahead = self.ahead.iter().map(|jump| jump.by);
        let ahead = ahead.fold(SignedDuration::ZERO, SignedDuration::saturating_add);
        self.seen.as_ref()?.wall.checked_sub(ahead).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOUR: u64 = 3600;
    const DAY: u64 = 24 * HOUR;

    fn wall(second: u64) -> Timestamp {
        Timestamp::from_second(1_800_000_000 + second.cast_signed()).unwrap()
    }

    fn seen(wall_s: u64, since_boot_s: u64, boot: &str) -> Seen {
        let since_boot = Duration::from_secs(since_boot_s);
        Seen { wall: wall(wall_s), since_boot, boot: boot.to_owned() }
    }

    /// Runs the station from `from` on, an hour at a time.
    fn run(time: TrustedTime, from: Seen, hours: u64) -> (TrustedTime, Seen) {
        let hour = Duration::from_secs(HOUR);
        (0..hours).fold((time, from), |(time, last), _| {
            let wall = last.wall.checked_add(hour).unwrap();
            let next = Seen { wall, since_boot: last.since_boot + hour, boot: last.boot };
            (time.at(next.clone(), true), next)
        })
    }

    #[test]
    fn a_clock_that_goes_as_time_does_is_believed() {
        let start = seen(0, 60, "a");
        let (time, last) = run(TrustedTime::default().at(start.clone(), false), start, 100);
        assert_eq!(time.now(), Some(last.wall));
        // The station was stopped for a week, and the machine went on.
        let later = seen(100 * HOUR + 7 * DAY, 60 + 100 * HOUR + 7 * DAY, "a");
        assert_eq!(time.at(later.clone(), false).now(), Some(later.wall));
    }

    #[test]
    fn what_a_jump_ahead_makes_due_waits_for_a_day_of_running() {
        let start = seen(0, 60, "a");
        let time = TrustedTime::default().at(start, false);
        let jumped = seen(400 * DAY + HOUR, 60 + HOUR, "a");
        let time = time.at(jumped.clone(), true);
        assert_eq!(time.now(), Some(wall(HOUR)));
        let (time, last) = run(time, jumped, 23);
        assert_eq!(time.now(), Some(wall(24 * HOUR)));
        let (time, last) = run(time, last, 1);
        assert_eq!(time.now(), Some(last.wall));
    }

    #[test]
    fn a_clock_that_is_set_right_again_is_believed_at_once() {
        let start = seen(0, 60, "a");
        let time = TrustedTime::default().at(start, false);
        let time = time.at(seen(400 * DAY + HOUR, 60 + HOUR, "a"), true);
        let time = time.at(seen(2 * HOUR, 60 + 2 * HOUR, "a"), true);
        assert_eq!(time.now(), Some(wall(2 * HOUR)));
        // A clock that is only set back makes nothing due.
        let time = time.at(seen(0, 60 + 3 * HOUR, "a"), true);
        assert_eq!(time.now(), Some(wall(0)));
    }

    #[test]
    fn a_night_in_which_the_machine_is_off_is_believed_after_some_days() {
        let mut time = TrustedTime::default().at(seen(0, 60, "0"), false);
        let mut lag = Vec::new();
        for day in 0..10 {
            // Eight hours on, sixteen off.
            let morning = seen(day * DAY, 60, &day.to_string());
            time = time.at(morning.clone(), false);
            let (evening, last) = run(time, morning, 8);
            lag.push(last.wall.duration_since(evening.now().unwrap()).as_hours());
            time = evening;
        }
        assert_eq!(lag[0], 0);
        assert!(lag.iter().all(|hours| *hours <= 3 * 16), "{lag:?}");
    }

    #[test]
    fn a_machine_whose_clock_failed_while_it_was_off_lets_nothing_go_on_its_first_day() {
        let time = TrustedTime::default().at(seen(0, 60, "a"), false);
        let time = time.at(seen(400 * DAY, 30, "b"), false);
        assert!(time.now().unwrap() <= wall(60));
    }
}
