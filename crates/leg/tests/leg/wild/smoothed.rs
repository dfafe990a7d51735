//! Meshes that the scanner's software smoothed.

use super::*;

/// How many are drawn.
const DRAWS: u64 = 16;

/// A mesh each of whose points goes half the way to the mean of its neighbours, so many times.
fn smoothed(mesh: &Mesh, rounds: usize) -> Mesh {
    let mut edges: Vec<[usize; 2]> = mesh
        .triangles
        .iter()
        .flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]].map(|[p, q]| [*p.min(q), *p.max(q)]))
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let mut mesh = mesh.clone();
    for _ in 0..rounds {
        let mut sums = vec![([0.0; 3], 0.0); mesh.points.len()];
        for [a, b] in &edges {
            for [own, other] in [[*a, *b], [*b, *a]] {
                let (sum, count) = &mut sums[own];
                (0..3).for_each(|axis| sum[axis] += mesh.points[other][axis]);
                *count += 1.0;
            }
        }
        for (point, (sum, count)) in mesh.points.iter_mut().zip(sums) {
            if count > 0.0 {
                (0..3).for_each(|axis| point[axis] += 0.5 * (sum[axis] / count - point[axis]));
            }
        }
    }
    mesh
}

#[test]
fn a_mesh_that_was_smoothed_is_told_and_girths_lie_within_what_is_stated() {
    let (mut inside, mut girths) = (0, 0);
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let sample = &SAMPLES[chance.below(2)];
        let scanned = noisy(&sample.mesh, 0.8 * chance.unit(), &mut chance);
        let rounds = 6 + chance.below(24);
        let found = measured(&smoothed(&scanned, rounds));
        assert!(is_told(&found, "smoothed"), "{seed}: {rounds} rounds");
        for [own, truth] in pairs(&found, &sample.truth, &[Level::B, Level::C, Level::D]) {
            assert!(own.doubts.iter().any(|doubt| doubt.code() == "smoothed"), "{seed}");
            let off_mm = (own.girth_tape_mm - truth.girth_tape_mm).abs();
            girths += 1;
            inside += u64::from(off_mm < 2.5 * own.girth_of_level_sd_mm);
        }
    }
    assert!(inside * 100 >= girths * 90, "{inside} of {girths} girths are within what is stated");
}
