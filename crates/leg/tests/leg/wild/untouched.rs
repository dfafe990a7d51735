//! Nothing is told of a scan to which nothing happened.

use super::*;

/// How many are drawn.
const DRAWS: u64 = 24;

#[test]
fn nothing_is_told_of_untouched_bodies_whatever_their_noise_and_density() {
    let codes = [
        "cloth",
        "views-apart",
        "smoothed",
        "holes-filled",
        "crown-not-seen",
        "facing-by-calves",
        "coarse",
        "foot-forward",
        "knee-bent",
    ];
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let sample = &SAMPLES[chance.below(2)];
        let noise_mm = 1.3 * chance.unit();
        let found = measured(&noisy(&sample.mesh, noise_mm, &mut chance));
        let told: Vec<&str> = codes.into_iter().filter(|code| is_told(&found, code)).collect();
        assert!(told.is_empty(), "{seed}, {noise_mm} mm: {told:?}");
        assert_eq!(quietly_wrong(&found, &sample.truth), [], "{seed}, {noise_mm} mm");
    }
}
