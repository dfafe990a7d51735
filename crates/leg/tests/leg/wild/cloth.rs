//! A bandage, a stocking or a sock over the skin.

use super::*;

/// How many are drawn of each kind.
const DRAWS: u64 = 24;

/// A cover of some thickness between two heights, on one leg or both; its edges are so wide, lean, and wave.
struct Cover {
    thick_mm: f64,
    between_mm: [f64; 2],
    edge_mm: f64,
    lean: [f64; 2],
    wave_mm: f64,
    legs: usize,
}

impl Cover {
    fn drawn(chance: &mut Chance) -> Cover {
        let (from_mm, length_mm) = (110.0 + 90.0 * chance.unit(), 110.0 + 100.0 * chance.unit());
        let between_mm = match chance.below(3) {
            0 => [from_mm, from_mm + length_mm],
            // A sock or a knee stocking, of which the upper edge is seen.
            1 => [f64::NEG_INFINITY, from_mm + length_mm],
            // Trousers.
            _ => [from_mm, f64::INFINITY],
        };
        Cover {
            thick_mm: 3.0 + 5.0 * chance.unit(),
            between_mm,
            edge_mm: 1.0 + 4.0 * chance.unit(),
            lean: [chance.even(0.08), chance.even(0.08)],
            wave_mm: chance.unit(),
            legs: chance.below(3),
        }
    }

    fn on(&self, mesh: &Mesh) -> Mesh {
        let middles = [1.0, -1.0].map(|sign| middle_of_leg(mesh, 220.0, sign));
        grown(mesh, |_, [x, y, z]| {
            let leg = usize::from(x < 0.0);
            // The hands of some bodies hang as low as the knees, further out.
            if self.legs == 1 - leg || x.abs() > 230.0 || y > 700.0 {
                return 0.0;
            }
            let arm = [x - middles[leg][0], z - middles[leg][1]];
            let wave_mm = self.wave_mm * (3.0 * arm[1].atan2(arm[0])).sin();
            let plane_mm = y - self.lean[0] * arm[0] - self.lean[1] * arm[1] - wave_mm;
            let step = |at_mm: f64| ((plane_mm - at_mm) / self.edge_mm + 0.5).clamp(0.0, 1.0);
            self.thick_mm * (step(self.between_mm[0]) - step(self.between_mm[1]))
        })
    }
}

#[test]
fn cloth_of_3_mm_and_more_is_told_and_no_girth_on_it_goes_without_a_doubt() {
    let (mut told, mut wrong) = (0, Vec::new());
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let sample = &SAMPLES[chance.below(2)];
        let cover = Cover::drawn(&mut chance);
        let noise_mm = 0.2 + 0.5 * chance.unit();
        let scan = noisy(&cover.on(&sample.mesh), noise_mm, &mut chance);
        let found = measured(&scan);
        told += u64::from(is_told(&found, "cloth"));
        let says_swollen = found.findings.iter().any(|finding| finding.code() == "legs-differ");
        assert!(!says_swollen, "{seed}: cloth is no swelling");
        for quiet in quietly_wrong(&found, &sample.truth) {
            wrong.push((seed, cover.thick_mm, cover.edge_mm, cover.between_mm, quiet));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
    assert!(told + 1 >= DRAWS, "{told} of {DRAWS} are told");
}

#[test]
fn a_cuff_of_fat_above_the_ankles_is_skin() {
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let sample = &SAMPLES[chance.below(2)];
        let (from_mm, grows_mm) = (95.0 + 40.0 * chance.unit(), 8.0 + 14.0 * chance.unit());
        let (over_mm, uneven) = (15.0 + 25.0 * chance.unit(), 0.3 * chance.unit());
        let cuffed = grown(&sample.mesh, |_, [x, y, z]| {
            if x.abs() > 230.0 || y > 500.0 {
                return 0.0;
            }
            let share = ((y - from_mm) / over_mm).clamp(0.0, 1.0);
            let gone = ((y - 320.0) / 120.0).clamp(0.0, 1.0);
            let round = |share: f64| share * share * (3.0 - 2.0 * share);
            let around = 1.0 + uneven * (z / 40.0).sin();
            grows_mm * around * round(share) * (1.0 - round(gone))
        });
        let noise_mm = 0.2 + 0.6 * chance.unit();
        let found = measured(&noisy(&cuffed, noise_mm, &mut chance));
        assert!(!is_told(&found, "cloth"), "{seed}: {grows_mm} mm from {from_mm} over {over_mm}");
    }
}
