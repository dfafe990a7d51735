//! Skin with many small holes: dark hair, ink, shine.

use super::*;

/// How many are drawn.
const DRAWS: u64 = 12;

/// This share of the triangles is missing.
const MISSING_SHARE: f64 = 0.30;

/// Radii of the holes, mm.
const RADIUS_MM: [f64; 2] = [2.5, 12.5];

/// A mesh with round holes anywhere.
fn with_holes(mesh: &Mesh, chance: &mut Chance) -> Mesh {
    let middle = |triangle: &[usize; 3]| -> [f64; 3] {
        let of =
            |axis: usize| triangle.iter().map(|corner| mesh.points[*corner][axis]).sum::<f64>();
        [0, 1, 2].map(|axis| of(axis) / 3.0)
    };
    let mut triangles: Vec<([f64; 3], [usize; 3])> =
        mesh.triangles.iter().map(|triangle| (middle(triangle), *triangle)).collect();
    triangles.sort_by(|(p, _), (q, _)| p[1].total_cmp(&q[1]));
    let mut is_missing = vec![false; triangles.len()];
    let mut missing = 0_usize;
    while (missing as f64) < MISSING_SHARE * triangles.len() as f64 {
        let hole = triangles[chance.below(triangles.len())].0;
        let radius_mm = RADIUS_MM[0] + (RADIUS_MM[1] - RADIUS_MM[0]) * chance.unit();
        let first = triangles.partition_point(|(at, _)| at[1] < hole[1] - radius_mm);
        let last = triangles.partition_point(|(at, _)| at[1] <= hole[1] + radius_mm);
        for own in (first..last).filter(|own| !is_missing[*own]).collect::<Vec<_>>() {
            let far = (0..3).map(|axis| (triangles[own].0[axis] - hole[axis]).powi(2)).sum::<f64>();
            is_missing[own] = far < radius_mm.powi(2);
            missing += usize::from(is_missing[own]);
        }
    }
    let seen = triangles.iter().zip(&is_missing).filter(|(_, is_missing)| !**is_missing);
    let triangles = seen.map(|((_, triangle), _)| *triangle).collect();
    Mesh { points: mesh.points.clone(), triangles }.kept(|_| true)
}

#[test]
fn a_third_of_the_skin_may_be_missing_in_small_holes() {
    let never = ["holes-filled", "views-apart", "cloth", "coarse", "floor-uneven", "feet-cut"];
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let (mesh, truth) = soles::drawn(&mut chance);
        let found = measured(&with_holes(&mesh, &mut chance));
        for leg in &found.legs {
            let has = |level: Level| leg.landmarks.iter().any(|landmark| landmark.level == level);
            assert!([Level::B, Level::C, Level::D].into_iter().all(has), "{seed}");
        }
        assert_eq!(found.legs.len(), 2, "{seed}");
        let told: Vec<&str> = never.into_iter().filter(|code| is_told(&found, code)).collect();
        assert!(told.is_empty(), "{seed}: {told:?}");
        assert_eq!(quietly_wrong(&found, truth), [], "{seed}");
        assert_eq!(soles::off_in_height(&found, truth, 5.0), [], "{seed}");
    }
}
