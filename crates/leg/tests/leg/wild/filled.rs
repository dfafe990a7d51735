//! Holes that the scanner's software closed with a membrane.

use super::*;

/// How many are drawn.
const DRAWS: u64 = 24;

/// Rounds in which a membrane settles between its borders.
const ROUNDS: usize = 400;

/// A body with a hole on a leg, drawn and closed by a membrane: each point within is the mean of its neighbours.
fn with_membrane(mesh: &Mesh, chance: &mut Chance) -> (Mesh, String) {
    let sign = if chance.below(2) == 0 { 1.0 } else { -1.0 };
    let (y_mm, turn) = (110.0 + 250.0 * chance.unit(), chance.even(std::f64::consts::PI));
    let half_mm = [30.0 + 40.0 * chance.unit(), 18.0 + 25.0 * chance.unit()];
    let middle = middle_of_leg(mesh, y_mm, sign);
    let direction = [turn.cos(), turn.sin()];
    let is_in = |[x, y, z]: [f64; 3]| {
        let arm = [x - middle[0], z - middle[1]];
        let (out, aside) = (
            arm[0] * direction[0] + arm[1] * direction[1],
            arm[1] * direction[0] - arm[0] * direction[1],
        );
        let off = ((y - y_mm) / half_mm[0]).hypot(aside / half_mm[1]);
        x * sign > 5.0 && out > 0.0 && arm[0].hypot(arm[1]) < 110.0 && off < 1.0
    };
    let inside: Vec<bool> = mesh.points.iter().map(|point| is_in(*point)).collect();
    let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); mesh.points.len()];
    for [a, b, c] in &mesh.triangles {
        for (own, other) in [(a, b), (b, c), (c, a)] {
            neighbours[*own].push(*other);
            neighbours[*other].push(*own);
        }
    }
    let mut mesh = mesh.clone();
    for _ in 0..ROUNDS {
        for own in (0..mesh.points.len()).filter(|own| inside[*own]) {
            let count = neighbours[own].len() as f64;
            mesh.points[own] = std::array::from_fn(|axis| {
                neighbours[own].iter().map(|at| mesh.points[*at][axis]).sum::<f64>() / count
            });
        }
    }
    (mesh, format!("{sign} at {y_mm}, {turn}, {half_mm:?}"))
}

#[test]
fn no_girth_across_a_membrane_goes_without_a_doubt() {
    let (mut told, mut wrong) = (0, Vec::new());
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let sample = &SAMPLES[chance.below(2)];
        let noise_mm = 0.2 + 0.6 * chance.unit();
        let scanned = noisy(&sample.mesh, noise_mm, &mut chance);
        let (mesh, what) = with_membrane(&scanned, &mut chance);
        let found = measured(&mesh);
        told += u64::from(is_told(&found, "holes-filled"));
        let quiet = quietly_wrong(&found, &sample.truth);
        wrong.extend(quiet.into_iter().map(|quiet| (seed, what.clone(), quiet)));
    }
    assert!(wrong.is_empty(), "{wrong:?}");
    assert!(told * 10 >= DRAWS * 9, "{told} of {DRAWS} are told");
}
