//! Times that have passed, durations, sizes and figures in the words of a language.

use std::time::Duration;

use gaiter_language::Language;
use jiff::Timestamp;

/// The units of a duration from the largest on: seconds in one, and the text of a number of them.
const UNITS: [(u64, &str); 4] = [
    (86_400, "duration.days"),
    (3600, "duration.hours"),
    (60, "duration.minutes"),
    (1, "duration.seconds"),
];

/// How long ago a time was; `None` if it is in the future because the clock was set back.
pub fn age(since: Timestamp, now: Timestamp) -> Option<Duration> {
    Duration::try_from(now.duration_since(since)).ok()
}

/// How long ago a time was, in words that follow "for" or go before "ago".
pub fn ago(since: Timestamp, now: Timestamp, language: Language) -> String {
    let unknown = || language.text("duration.unknown").to_owned();
    age(since, now).map_or_else(unknown, |age| duration(age, language))
}

/// A duration in readable form, in the largest unit of which it has two or more, and without a fraction.
/// It follows "for" or "in", or goes before "ago".
pub fn duration(duration: Duration, language: Language) -> String {
    let seconds = duration.as_secs();
    let unit = UNITS.into_iter().find(|(length, _)| seconds >= 2 * length);
    match unit {
        Some((length, key)) => language.filled(key, &[("count", &(seconds / length))]),
        None if seconds == 1 => language.text("duration.second").to_owned(),
        None => language.filled("duration.seconds", &[("count", &seconds)]),
    }
}

/// Steps in which the time left is shown, seconds: a step that has begun counts. A screen reader reads out each.
const LEFT_STEP_S: u64 = 60;

/// Steps in which the last minute is shown, seconds.
const LAST_STEP_S: u64 = 20;

/// Time that is left, up to the end of the step that has begun.
pub fn stepped(left: Duration) -> Duration {
    let seconds = left.saturating_sub(Duration::from_nanos(1)).as_secs() + 1;
    let step = if seconds > LEFT_STEP_S { LEFT_STEP_S } else { LAST_STEP_S };
    Duration::from_secs(seconds.div_ceil(step) * step)
}

/// Time that is left at the most, in words that follow "for up to".
pub fn at_most(left: Duration, language: Language) -> String {
    match stepped(left).as_secs() {
        seconds if seconds < 60 => language.filled("duration.s", &[("count", &seconds)]),
        seconds => language.filled("duration.min", &[("count", &(seconds / 60))]),
    }
}

/// A size in bytes in readable form, in decimal units as disks are sold.
pub fn bytes(size: u64, language: Language) -> String {
    const UNITS: [(u64, &str); 3] = [(1_000_000_000, "GB"), (1_000_000, "MB"), (1000, "kB")];
    match UNITS.into_iter().find(|(length, _)| size >= *length) {
        Some((length, unit)) => {
            format!("{} {unit}", decimals(size as f64 / length as f64, 1, language))
        }
        None => format!("{size} B"),
    }
}

/// A figure with this many decimals and the decimal sign of a language.
pub fn decimals(value: f64, places: usize, language: Language) -> String {
    format!("{value:.places$}").replace('.', language.decimal_sign())
}

/// The same with its sign.
pub fn signed(value: f64, places: usize, language: Language) -> String {
    format!("{value:+.places$}").replace('.', language.decimal_sign())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_and_sizes_are_said_as_people_say_them() {
        let cases = [
            (0, "0 seconds", "0 Sekunden"),
            (1, "1 second", "1 Sekunde"),
            (90, "90 seconds", "90 Sekunden"),
            (119, "119 seconds", "119 Sekunden"),
            (120, "2 minutes", "2 Minuten"),
            (7199, "119 minutes", "119 Minuten"),
            (7200, "2 hours", "2 Stunden"),
            (200_000, "2 days", "2 Tagen"),
        ];
        for (seconds, english, german) in cases {
            let said = |language| duration(Duration::from_secs(seconds), language);
            assert_eq!([said(Language::En), said(Language::De)], [english, german]);
        }
        let said = |language| [999, 1500, 12_340_000_000].map(|size| bytes(size, language));
        assert_eq!(said(Language::En), ["999 B", "1.5 kB", "12.3 GB"]);
        assert_eq!(said(Language::De), ["999 B", "1,5 kB", "12,3 GB"]);
    }

    /// Failed while the last minute was shown as one.
    #[test]
    fn time_that_is_left_counts_down_to_its_end() {
        for (seconds, english) in [
            (301, "6 min"),
            (61, "2 min"),
            (60, "1 min"),
            (41, "1 min"),
            (40, "40 s"),
            (21, "40 s"),
            (20, "20 s"),
            (0, "20 s"),
        ] {
            let left = Duration::from_secs(seconds);
            assert_eq!(at_most(left, Language::En), english, "{seconds} s");
            assert_eq!(stepped(stepped(left)), stepped(left), "a step stays itself");
        }
    }

    #[test]
    fn a_time_in_the_future_was_an_unknown_time_ago() {
        let at = |second| Timestamp::from_second(second).unwrap();
        assert_eq!(ago(at(1), at(0), Language::En), "an unknown time");
        assert_eq!(ago(at(0), at(60), Language::En), "60 seconds");
    }
}
