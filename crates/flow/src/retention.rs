//! How long data is kept after it is no longer needed, and whether the clock can be trusted for it.

use std::time::Duration;

use jiff::{SignedDuration, Timestamp};

/// How long each kind of data is kept; `None` means for ever.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Retention {
    /// The station's own copy of a scan, counted from the day its last record reached its store. Zero
    /// means that it is deleted with the receipt.
    pub spool: Duration,
    /// A refused scan and its reason, from the day it was refused.
    pub quarantine: Option<Duration>,
    /// What the journal knows about a scan whose records all reached their stores, from that day.
    pub journal: Option<Duration>,
}

/// Data that was last needed before this time is deleted now; `None` if it is kept. A clock that jumps
/// back causes no deletion.
pub fn before(kept: Option<Duration>, now: Timestamp) -> Option<Timestamp> {
    now.checked_sub(kept?).ok()
}

/// For so long after a start of the station, and after the wall clock was set, nothing is deleted by its
/// age: a clock that is wrong makes everything look old, and somebody may notice it meanwhile. A station
/// that is on for a working day still deletes.
const STEADY: Duration = Duration::from_hours(6);

/// A clock that is set by more than this was wrong. Drifting clocks are corrected by seconds, and summer
/// time has no effect: times are UTC.
const SET: SignedDuration = SignedDuration::from_hours(1);

/// The wall clock and the station's own clock at a start of the station, or when the wall clock was last
/// set.
#[derive(Debug, Clone, Copy, Default)]
pub struct WallClock(Option<(Timestamp, Duration)>);

impl WallClock {
    /// Whether the wall clock has gone as the station's own one for long enough to delete by it. Must be
    /// asked more often than once an hour, so that what is noted by a wrong clock is not taken for old.
    pub fn is_steady(&mut self, wall: Timestamp, own: Duration) -> bool {
        let (wall_then, own_then) = *self.0.get_or_insert((wall, own));
        let passed = own.saturating_sub(own_then);
        let by_own = SignedDuration::try_from(passed).unwrap_or(SignedDuration::MAX);
        if wall.duration_since(wall_then).saturating_sub(by_own).abs() > SET {
            self.0 = Some((wall, own));
            return false;
        }
        passed >= STEADY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Asks at this hour of the station's own clock, the wall clock being ahead by this many hours.
    fn is_steady_at(clock: &mut WallClock, hour: u32, ahead_h: i64) -> bool {
        let wall = Timestamp::from_second(1_800_000_000 + (i64::from(hour) + ahead_h) * 3600);
        clock.is_steady(wall.unwrap(), Duration::from_secs(u64::from(hour) * 3600))
    }

    #[test]
    fn nothing_is_deleted_by_a_clock_that_nobody_could_look_at_yet() {
        let mut clock = WallClock::default();
        let steady: Vec<bool> = (100..108).map(|hour| is_steady_at(&mut clock, hour, 0)).collect();
        assert_eq!(steady, [false, false, false, false, false, false, true, true]);
    }

    #[test]
    fn a_clock_that_was_set_is_not_believed_at_once_whichever_way() {
        for ahead_h in [-9000, -2, 2, 9000] {
            let mut clock = WallClock::default();
            assert!(!is_steady_at(&mut clock, 0, 0) && is_steady_at(&mut clock, 6, 0));
            assert!((7..13).all(|hour| !is_steady_at(&mut clock, hour, ahead_h)), "{ahead_h}");
            assert!(is_steady_at(&mut clock, 13, ahead_h), "{ahead_h}");
            assert!(!is_steady_at(&mut clock, 14, 0), "{ahead_h}: it was set right");
        }
    }

    #[test]
    fn what_is_kept_for_ever_is_never_let_go() {
        assert_eq!(before(None, Timestamp::MAX), None);
        let now = "2026-11-21T09:15:00Z".parse().unwrap();
        let hour = Some(Duration::from_secs(3600));
        assert_eq!(before(hour, now), Some("2026-11-21T08:15:00Z".parse().unwrap()));
        assert_eq!(before(Some(Duration::MAX), now), None);
    }
}
