//! Connected shells of the mesh: the body in one or more large ones, and small fragments, which are
//! specks in the air or pieces of the floor.

use gaiter_scan::Scan;

use super::point_cloud;
use super::union_find::DisjointSets;

/// A shell with fewer than this share of all points is a fragment. Body parts that scanners export
/// as separate shells have 4 % or more; floor pieces and specks 0.3 % or less.
const FRAGMENT_MAX_SHARE: f64 = 0.005;

/// All shells that are not fragments: their triangles in the given order, the points that these use, and how many shells
/// there are. For a bare cloud, the points in large connected groups, ordered by their coordinates.
pub fn without_fragments(scan: &Scan) -> (Scan, usize) {
    let count = scan.points.len();
    if scan.triangles.is_empty() {
        let places = point_cloud::places(&scan.points);
        let roots = point_cloud::roots(&places, point_cloud::spacing(&places));
        let (large, shells) = large(&roots);
        let points = places.iter().zip(0..).filter(|(_, index)| large(*index));
        let points = points.map(|(place, _)| *place).collect();
        return (Scan { points, triangles: Vec::new() }, shells);
    }
    let roots = connected(count, &scan.triangles);
    let (large, shells) = large(&roots);
    let kept = scan.triangles.iter().filter(|corners| large(corners[0]));
    let (triangles, used) = renumbered(count, kept.copied().collect());
    let points = used.into_iter().map(|point| scan.points[point as usize]).collect();
    (Scan { points, triangles }, shells)
}

/// Whether a point belongs to a shell that is not a fragment, and the number of these; `roots` gives each point's shell.
fn large(roots: &[u32]) -> (impl Fn(u32) -> bool, usize) {
    let mut sizes = vec![0usize; roots.len()];
    roots.iter().for_each(|&root| sizes[root as usize] += 1);
    let least = FRAGMENT_MAX_SHARE * roots.len() as f64;
    let shells = sizes.iter().filter(|size| **size as f64 > least).count();
    (move |point| sizes[roots[point as usize] as usize] as f64 > least, shells)
}

/// For each point the index of the point that represents its shell.
pub(crate) fn connected(count: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut shells = DisjointSets::new(count);
    for &[a, b, c] in triangles {
        shells.join(a, b);
        shells.join(b, c);
    }
    (0..count as u32).map(|point| shells.root(point)).collect()
}

/// The triangles with renumbered points, and the old indices of these points in the order in which the
/// triangles use them.
pub fn renumbered(point_count: usize, mut triangles: Vec<[u32; 3]>) -> (Vec<[u32; 3]>, Vec<u32>) {
    const UNUSED: u32 = u32::MAX;
    let mut numbers = vec![UNUSED; point_count];
    let mut used = Vec::new();
    for corner in triangles.iter_mut().flatten() {
        let number = &mut numbers[*corner as usize];
        if *number == UNUSED {
            *number = used.len() as u32;
            used.push(*corner);
        }
        *corner = *number;
    }
    (triangles, used)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn a_speck_goes_with_its_points_and_two_large_shells_stay() {
        let strip = |first: u32, count: u32| (first..first + count).map(|i| [i, i + 1, i + 2]);
        let points: Vec<Point3<f64>> =
            (0..1007).map(|i| Point3::new(f64::from(i), 0.0, 0.0)).collect();
        let mut triangles: Vec<_> = strip(0, 500).chain(strip(505, 500)).collect();
        let both = Scan {
            points: points[..502].iter().chain(&points[505..]).copied().collect(),
            triangles: strip(0, 500).chain(strip(502, 500)).collect(),
        };
        triangles.insert(0, [502, 503, 504]);
        assert_eq!(without_fragments(&Scan { points, triangles }), (both, 2));
    }
}
