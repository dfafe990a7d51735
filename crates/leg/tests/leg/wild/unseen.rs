//! A side of a shank that no camera saw over a length: dark ink, a shiny dressing.

use super::*;

/// How many are drawn.
const DRAWS: u64 = 24;

#[test]
fn levels_above_an_unseen_side_of_a_shank_are_measured() {
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let sample = &SAMPLES[chance.below(2)];
        let sign = if chance.below(2) == 0 { 1.0 } else { -1.0 };
        let from_mm = 140.0 + 120.0 * chance.unit();
        let to_mm = from_mm + 60.0 + 80.0 * chance.unit();
        let (turn, half) =
            (chance.even(std::f64::consts::PI), (50.0 + 25.0 * chance.unit()).to_radians());
        let middles: Vec<[f64; 2]> =
            (0..60).map(|step| middle_of_leg(&sample.mesh, 10.0 * f64::from(step), sign)).collect();
        let is_seen = |[x, y, z]: [f64; 3]| {
            if x * sign < 5.0 || x.abs() > 230.0 || !(from_mm..to_mm).contains(&y) {
                return true;
            }
            let middle = middles[(y / 10.0) as usize];
            let off = (z - middle[1]).atan2(x - middle[0]) - turn;
            off.sin().atan2(off.cos()).abs() > half
        };
        let noise_mm = 0.6 * chance.unit();
        let scan = noisy(&sample.mesh.clone().kept(is_seen), noise_mm, &mut chance);
        let found = measured(&scan);
        let told = format!("{seed}: {sign} from {from_mm} to {to_mm}, {turn} ± {half}");
        assert!(!found.findings.iter().any(|finding| finding.code() == "leg-cut"), "{told}");
        for leg in &found.legs {
            assert!(leg.landmarks.iter().any(|landmark| landmark.level == Level::D), "{told}");
        }
        assert_eq!(quietly_wrong(&found, &sample.truth), [], "{told}");
    }
}
