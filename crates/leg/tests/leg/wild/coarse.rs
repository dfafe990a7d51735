//! Few points: exporters that thin the mesh out, or give the mean of the points in each cell of space.

use std::collections::{BTreeMap, BTreeSet};

use super::*;

/// How many are drawn.
const DRAWS: u64 = 24;

/// A mesh with one point for each cell of this size: the mean of its points, or one of them.
fn thinned(mesh: &Mesh, cell_mm: f64, is_mean: bool, chance: &mut Chance) -> Mesh {
    let shift: [f64; 3] = std::array::from_fn(|_| cell_mm * chance.unit());
    let mut cells: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
    for (at, point) in mesh.points.iter().enumerate() {
        let cell =
            std::array::from_fn(|axis| ((point[axis] + shift[axis]) / cell_mm).floor() as i64);
        cells.entry(cell).or_default().push(at);
    }
    let mut own = vec![0; mesh.points.len()];
    let mut points = Vec::new();
    for members in cells.values() {
        members.iter().for_each(|at| own[*at] = points.len());
        let mean = |axis: usize| {
            members.iter().map(|at| mesh.points[*at][axis]).sum::<f64>() / members.len() as f64
        };
        let one = mesh.points[members[members.len() / 2]];
        points.push(if is_mean { [0, 1, 2].map(mean) } else { one });
    }
    let mut known = BTreeSet::new();
    let triangles = mesh.triangles.iter().map(|triangle| triangle.map(|corner| own[corner]));
    let is_new = |triangle: &[usize; 3]| {
        let mut corners = *triangle;
        corners.sort_unstable();
        corners[0] != corners[1] && corners[1] != corners[2] && known.insert(corners)
    };
    let triangles = triangles.filter(is_new).collect();
    Mesh { points, triangles }.kept(|_| true)
}

#[test]
fn girths_of_few_points_are_right_within_what_is_stated_and_that_they_are_few_is_told() {
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let (mesh, truth) = soles::drawn(&mut chance);
        // 7 000 to 15 000 points.
        let cell_mm = 12.0 + 4.0 * chance.unit();
        let is_mean = chance.below(2) == 0;
        let mesh = thinned(&mesh, cell_mm, is_mean, &mut chance);
        let found = measured(&mesh);
        let told = format!("{seed}: {} points, mean {is_mean}", mesh.points.len());
        assert!(is_told(&found, "coarse"), "{told}");
        for leg in &found.legs {
            let has = |level: Level| leg.landmarks.iter().any(|landmark| landmark.level == level);
            assert!([Level::B, Level::C, Level::D].into_iter().all(has), "{told}");
        }
        assert_eq!(found.legs.len(), 2, "{told}");
        assert_eq!(quietly_wrong(&found, truth), [], "{told}");
    }
}
