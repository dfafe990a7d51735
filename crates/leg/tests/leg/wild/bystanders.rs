//! A stick, a pole of the booth or a helper's arm beside a leg.

use super::*;

/// How many are drawn.
const DRAWS: u64 = 16;

/// Something long beside a leg: a stick or a pole from the floor up, or an arm that reaches in from the side.
fn beside(mesh: &Mesh, chance: &mut Chance) -> (Mesh, String) {
    let sign = if chance.below(2) == 0 { 1.0 } else { -1.0 };
    let is_arm = chance.below(3) == 0;
    let y_mm = 260.0 + 160.0 * chance.unit();
    let outer = mesh.points.iter().filter(|p| {
        p[0] * sign > 5.0 && p[0].abs() < 230.0 && (p[1] < 450.0) && (is_arm || p[1] > 90.0)
    });
    let outer = outer.filter(|p| !is_arm || (p[1] - y_mm).abs() < 50.0);
    let reach = outer.map(|p| p[0] * sign).fold(0.0, f64::max);
    let gap_mm = 1.0 + 20.0 * chance.unit();
    let radius_mm = if is_arm { 32.0 + 12.0 * chance.unit() } else { 9.0 + 16.0 * chance.unit() };
    let z = middle_of_leg(mesh, y_mm, sign)[1] + chance.even(25.0);
    let lean = chance.even(0.04).abs();
    let thing = if is_arm {
        // Lying along x, from beside the calf outwards and upwards.
        Mesh::column([0.0, 0.0], radius_mm, 0.0, 420.0).moved(|[x, y, dz]| {
            [
                sign * (reach + gap_mm + radius_mm + 0.9 * y - 0.4 * x),
                y_mm + 0.4 * y + 0.9 * x,
                z + dz,
            ]
        })
    } else {
        let x = sign * (reach + gap_mm + radius_mm);
        let height_mm = 500.0 + 600.0 * chance.unit();
        Mesh::column([x, z], radius_mm, 0.0, height_mm)
            .moved(|[x, y, z]| [x + sign * lean * y, y, z])
    };
    let told = format!("{sign}, arm {is_arm}, {gap_mm} mm beside, radius {radius_mm}");
    (mesh.clone().and(thing), told)
}

#[test]
fn what_stands_beside_a_leg_never_enters_its_girths() {
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let sample = &SAMPLES[chance.below(2)];
        let (mesh, told) = beside(&sample.mesh, &mut chance);
        let found = measured(&mesh);
        for (own, whole) in found.legs.iter().zip(&sample.truth.legs) {
            for level in [Level::B, Level::C, Level::D] {
                let [own, whole] = [own, whole].map(|leg| {
                    leg.landmarks.iter().find(|landmark| landmark.level == level).unwrap()
                });
                let off_mm = own.girth_tape_mm - whole.girth_tape_mm;
                assert!(off_mm.abs() < 0.5, "{seed}: {told}: {:?} {off_mm}", own.level);
            }
        }
        assert!(!is_told(&found, "views-apart"), "{seed}: {told}");
    }
}
