//! When to try again: exponential with full jitter, so that attempts spread out and never stop.

use std::time::Duration;

/// The longest pause after the first failure.
const FIRST: Duration = Duration::from_secs(1);

/// The longest pause of all: a share that comes back is noticed within this time.
pub(crate) const CEILING: Duration = Duration::from_secs(300);

/// The shortest pause: full jitter may draw nearly zero, and a hot loop is useless.
const FLOOR: Duration = Duration::from_millis(200);

/// The pause after `failures` failures in a row, at least one. `chance` is uniform in [0, 1).
pub fn pause(failures: u32, chance: f64) -> Duration {
    let doublings = failures.saturating_sub(1).min(31);
    let longest = FIRST.saturating_mul(1 << doublings).min(CEILING);
    let chance = if chance > 0.0 { chance.min(1.0) } else { 0.0 };
    longest.mul_f64(chance).max(FLOOR)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_double_up_to_the_ceiling_and_stay_there() {
        let longest: Vec<u64> = (1..=11).map(|n| pause(n, 1.0).as_secs()).collect();
        assert_eq!(longest, [1, 2, 4, 8, 16, 32, 64, 128, 256, 300, 300]);
        assert_eq!(pause(u32::MAX, 1.0), CEILING);
    }

    #[test]
    fn the_jitter_is_full_but_never_a_hot_loop() {
        assert_eq!(pause(5, 0.5), Duration::from_secs(8));
        assert_eq!(pause(5, 0.0), FLOOR);
        assert_eq!(pause(0, f64::NAN), FLOOR);
    }
}
