//! A booth one of whose cameras is not aligned.

use super::*;

/// How many are drawn.
const DRAWS: u64 = 24;

/// A body of which one camera sees what faces it, and shows it too far out or in.
fn with_camera_off(mesh: &Mesh, chance: &mut Chance) -> Mesh {
    let cameras = 3 + chance.below(3);
    let (turn, half) = (chance.even(180.0_f64.to_radians()), std::f64::consts::PI / cameras as f64);
    let by_mm = (3.0 + chance.unit()) * if chance.below(2) == 0 { 1.0 } else { -1.0 };
    mesh.clone().with_camera_off(turn, half, by_mm)
}

#[test]
fn a_camera_that_is_3_mm_off_is_told_and_girths_lie_within_what_is_stated() {
    let (mut told, mut inside, mut girths) = (0, 0, 0);
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let sample = &SAMPLES[chance.below(2)];
        let mesh = with_camera_off(&sample.mesh, &mut chance);
        let noise_mm = 0.2 + 0.4 * chance.unit();
        let found = measured(&noisy(&mesh, noise_mm, &mut chance));
        if !is_told(&found, "views-apart") {
            continue;
        }
        told += 1;
        for (own, whole) in found.legs.iter().zip(&sample.truth.legs) {
            for level in [Level::B, Level::C, Level::D] {
                let of = |leg: &gaiter_leg::LegReport| {
                    leg.landmarks.iter().find(|landmark| landmark.level == level).cloned()
                };
                let (Some(own), Some(whole)) = (of(own), of(whole)) else { continue };
                assert!(own.doubts.iter().any(|doubt| doubt.code() == "views-apart"), "{seed}");
                let off_mm = (own.girth_tape_mm - whole.girth_tape_mm).abs();
                girths += 1;
                inside += u64::from(off_mm < 2.0 * own.girth_of_level_sd_mm + 1.0);
            }
        }
    }
    assert!(told * 10 >= DRAWS * 8, "{told} of {DRAWS} are told");
    assert!(inside * 100 >= girths * 90, "{inside} of {girths} girths are within what is stated");
}
