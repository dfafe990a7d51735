//! Merges coincident points, so that touching triangles are connected.
//!
//! Triangle soups repeat every corner, and exporters repeat points along texture seams. The shells
//! of the body are distinguished by the points that their triangles share.

use std::cmp::Ordering;

use nalgebra::Point3;

use super::Scan;

/// Points and triangles as in the file.
pub(super) type Unwelded = (Vec<Point3<f64>>, Vec<[u32; 3]>);

/// The mesh after merging points with exactly the same coordinates and removing triangles that use
/// a point twice and points that no triangle uses. The order of points and triangles is kept.
///
/// If no triangle remains, the points are unchanged: a bare point cloud.
pub(super) fn welded((points, mut triangles): Unwelded) -> Scan {
    let firsts = first_at_each_place(&points);
    let has_merged = (0..).zip(&firsts).any(|(number, first)| number != *first);
    triangles.retain_mut(|triangle| {
        if has_merged {
            *triangle = triangle.map(|corner| firsts[corner as usize]);
        }
        let [a, b, c] = *triangle;
        a != b && b != c && c != a
    });
    if triangles.is_empty() {
        return Scan { points, triangles };
    }
    without_unused(points, triangles, firsts)
}

/// For each point the index of the first point at the same position.
///
/// The points are grouped by a hash of their position, which is much faster than sorting them by the
/// position itself; points with equal hashes are then sorted by position.
fn first_at_each_place(points: &[Point3<f64>]) -> Vec<u32> {
    let mut firsts: Vec<u32> = (0..points.len() as u32).collect();
    // Upper half: hash; lower half: index.
    let keyed = points.iter().zip(0_u64..).map(|(point, number)| hash(point) << 32 | number);
    let mut keys: Vec<u64> = keyed.collect();
    keys.sort_unstable();
    let place = |key: u64| points[key as u32 as usize];
    for alike in keys.chunk_by_mut(|a, b| a >> 32 == b >> 32).filter(|alike| alike.len() > 1) {
        alike.sort_unstable_by(|&a, &b| {
            let [a_at, b_at] = [place(a), place(b)];
            let by_axis = (0..3).map(|axis| (a_at[axis] + 0.0).total_cmp(&(b_at[axis] + 0.0)));
            by_axis.fold(Ordering::Equal, Ordering::then).then(a.cmp(&b))
        });
        for same in alike.chunk_by(|&a, &b| place(a) == place(b)) {
            same.iter().for_each(|&key| firsts[key as u32 as usize] = same[0] as u32);
        }
    }
    firsts
}

/// A 32-bit hash that is equal for equal positions; +0 and −0 are equal (after Fx, rustc's hash).
fn hash(point: &Point3<f64>) -> u64 {
    const MIX: u64 = 0x517c_c1b7_2722_0a95;
    let mixed = point.iter().fold(0, |hash: u64, value| {
        (hash.rotate_left(23) ^ (value + 0.0).to_bits()).wrapping_mul(MIX)
    });
    mixed >> 32
}

/// Removes the points that no triangle uses. `numbers` is reused for the new indices.
fn without_unused(
    mut points: Vec<Point3<f64>>,
    mut triangles: Vec<[u32; 3]>,
    mut numbers: Vec<u32>,
) -> Scan {
    const UNUSED: u32 = u32::MAX;
    numbers.fill(UNUSED);
    for triangle in &triangles {
        triangle.iter().for_each(|&corner| numbers[corner as usize] = 0);
    }
    if !numbers.contains(&UNUSED) {
        return Scan { points, triangles };
    }
    let kept = numbers.iter_mut().filter(|number| **number != UNUSED);
    (0..).zip(kept).for_each(|(new, number)| *number = new);
    let mut number = numbers.iter();
    points.retain(|_| number.next() != Some(&UNUSED));
    for triangle in &mut triangles {
        *triangle = triangle.map(|corner| numbers[corner as usize]);
    }
    Scan { points, triangles }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64) -> Point3<f64> {
        Point3::new(x, 1.0, 2.0)
    }

    #[test]
    fn coincident_points_become_the_first_of_them() {
        let points = vec![at(5.0), at(1.0), at(2.0), at(1.0), at(3.0), at(2.0)];
        let scan = welded((points, vec![[0, 1, 2], [3, 5, 4]]));
        assert_eq!(scan.points, [at(5.0), at(1.0), at(2.0), at(3.0)]);
        assert_eq!(scan.triangles, [[0, 1, 2], [1, 2, 3]]);
    }

    #[test]
    fn the_two_zeros_are_one_place() {
        let points = vec![at(0.0), at(1.0), at(2.0), at(-0.0)];
        let scan = welded((points, vec![[0, 1, 2], [3, 2, 1]]));
        assert_eq!(scan.triangles, [[0, 1, 2], [0, 2, 1]]);
    }

    #[test]
    fn triangles_without_area_and_points_without_triangle_go() {
        let points = vec![at(9.0), at(0.0), at(1.0), at(2.0), at(1.0)];
        let scan = welded((points, vec![[2, 3, 4], [1, 2, 3]]));
        assert_eq!(scan.points, [at(0.0), at(1.0), at(2.0)]);
        assert_eq!(scan.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn without_a_triangle_all_points_stay() {
        let points = vec![at(1.0), at(1.0), at(2.0)];
        let scan = welded((points.clone(), vec![[0, 1, 2]]));
        assert_eq!(scan, Scan { points, triangles: vec![] });
    }
}
