//! When a scan was taken, as far as the station can know.

use jiff::{SignedDuration, Timestamp};

use gaiter_record::{Acquired, AcquiredFrom};

/// 2000-01-01: an earlier file time comes from a clock that was never set.
const EARLIEST: i64 = 946_684_800;

/// How far a scanner's clock may run ahead of ours before its time is not trusted.
const AHEAD: SignedDuration = SignedDuration::from_hours(24);

/// The time of the press that the scan answered; otherwise the file's own time, if plausible; otherwise
/// the time at which the station first saw the file.
pub fn acquired(
    pressed_at: Option<Timestamp>,
    file_time: Option<Timestamp>,
    first_seen: Timestamp,
) -> Acquired {
    if let Some(at) = pressed_at {
        return Acquired::new(at, AcquiredFrom::Press);
    }
    let plausible =
        |at: &Timestamp| at.as_second() >= EARLIEST && at.duration_since(first_seen) <= AHEAD;
    match file_time.filter(plausible) {
        Some(at) => Acquired::new(at, AcquiredFrom::FileTime),
        None => Acquired::new(first_seen, AcquiredFrom::Unknown),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> Timestamp {
        text.parse().unwrap()
    }

    #[test]
    fn a_plausible_file_time_is_believed() {
        let seen = at("2026-11-21T09:15:00Z");
        let file = at("2026-11-21T09:14:58Z");
        let expected = Acquired::new(file, AcquiredFrom::FileTime);
        assert_eq!(acquired(None, Some(file), seen), expected);
    }

    #[test]
    fn the_time_of_a_clock_that_was_never_set_is_not() {
        let seen = at("2026-11-21T09:15:00Z");
        let expected = Acquired::new(seen, AcquiredFrom::Unknown);
        for file in [None, Some(at("1970-01-01T00:00:00Z")), Some(at("2026-11-22T09:15:01Z"))] {
            assert_eq!(acquired(None, file, seen), expected);
        }
    }

    #[test]
    fn the_press_is_the_best_that_is_known() {
        let (press, seen) = (at("2026-11-21T09:14:00Z"), at("2026-11-21T09:15:00Z"));
        let expected = Acquired::new(press, AcquiredFrom::Press);
        assert_eq!(acquired(Some(press), Some(seen), seen), expected);
    }
}
