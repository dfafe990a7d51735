//! Bare point clouds: their distinct points, the spacing of these, and fragments without triangles
//! to identify them.

use nalgebra::Point3;

use super::union_find::DisjointSets;
use crate::statistics::median;

/// Points at which the spacing is sampled; their median is accurate to some percent.
const SAMPLES: usize = 64;

/// The distance to the third nearest neighbour is about the spacing, 1/√density, both in a regular
/// grid (1.0) and among random points (0.94).
const NEIGHBOUR: usize = 3;

/// Side of the cells that connect points, in spacings: among random points 2 % of such cells on the
/// skin are empty, which separates nothing.
const CELL_SPACINGS: f64 = 2.0;

/// A cell of space.
type Cell = [i64; 3];

/// The distinct points, ordered by their coordinates. The order and the multiplicity of points in a
/// cloud carry no information: a cloud made from triangles has each corner six times.
pub fn places(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let mut places = points.to_vec();
    places.sort_unstable_by(|p, q| {
        p.x.total_cmp(&q.x).then_with(|| p.y.total_cmp(&q.y)).then_with(|| p.z.total_cmp(&q.z))
    });
    places.dedup();
    places
}

/// Distance of neighbouring points, in the unit of the points; 0 where there are fewer than four.
pub fn spacing(points: &[Point3<f64>]) -> f64 {
    let stride = points.len().div_ceil(SAMPLES).max(1);
    let found = points
        .iter()
        .step_by(stride)
        .filter_map(|sample| {
            let mut nearest = [f64::INFINITY; NEIGHBOUR + 1];
            for point in points {
                let far = (point - sample).norm_squared();
                if far < nearest[NEIGHBOUR] {
                    nearest[NEIGHBOUR] = far;
                    nearest.sort_by(f64::total_cmp);
                }
            }
            nearest[NEIGHBOUR].is_finite().then(|| nearest[NEIGHBOUR].sqrt())
        })
        .collect();
    median(found).unwrap_or(0.0)
}

/// For each point the index of the point that represents its connected group; points are connected
/// through touching cells.
pub fn roots(points: &[Point3<f64>], spacing: f64) -> Vec<u32> {
    let side = (CELL_SPACINGS * spacing).max(f64::MIN_POSITIVE);
    let cell = |p: &Point3<f64>| -> Cell { [0, 1, 2].map(|axis| (p[axis] / side).floor() as i64) };
    let mut by_cell: Vec<(Cell, u32)> = points.iter().map(cell).zip(0..).collect();
    by_cell.sort_unstable();
    let mut sets = DisjointSets::new(points.len());
    for own in by_cell.chunk_by(|a, b| a.0 == b.0) {
        let (place, first) = own[0];
        own[1..].iter().for_each(|&(_, other)| sets.join(first, other));
        for of in cells_after(place) {
            let at = by_cell.partition_point(|entry| entry.0 < of);
            if let Some(&(found, other)) = by_cell.get(at)
                && found == of
            {
                sets.join(first, other);
            }
        }
    }
    (0..points.len() as u32).map(|point| sets.root(point)).collect()
}

/// The 13 of the 26 surrounding cells that come after this one in order.
fn cells_after([x, y, z]: Cell) -> impl Iterator<Item = Cell> {
    (14..27).map(move |at| {
        [(x, at / 9), (y, at / 3 % 3), (z, at % 3)].map(|(own, step)| own.saturating_add(step - 1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(count: i32, step: f64, height: f64) -> impl Iterator<Item = Point3<f64>> {
        let line = move |i: i32| (0..count).map(move |j| (i, j));
        (0..count)
            .flat_map(line)
            .map(move |(i, j)| Point3::new(step * f64::from(i), step * f64::from(j), height))
    }

    #[test]
    fn a_grid_s_spacing_is_its_step_whatever_the_unit() {
        for step in [0.006, 1.0, 6.0] {
            let points: Vec<_> = sheet(40, step, 0.0).collect();
            assert!((spacing(&points) / step - 1.0).abs() < 1e-9, "{step}");
        }
        assert_eq!(spacing(&[Point3::origin(); 3]), 0.0);
    }

    #[test]
    fn places_are_the_same_in_whatever_order_and_number_the_points_come() {
        let points: Vec<_> = sheet(20, 6.0, 1.5).collect();
        let often: Vec<_> = points.iter().rev().flat_map(|point| [*point; 6]).collect();
        assert_eq!(places(&often), places(&points));
        assert_eq!(places(&often).len(), points.len());
    }

    #[test]
    fn sheets_four_cells_apart_are_two_and_a_sheet_is_one() {
        let points: Vec<_> = sheet(20, 6.0, 0.0).chain(sheet(20, 6.0, 48.0)).collect();
        let mut found = roots(&points, 6.0);
        assert!(found[..400].iter().all(|root| *root == found[0]));
        assert!(found[400..].iter().all(|root| *root == found[400]));
        found.dedup();
        assert_eq!(found.len(), 2);
    }
}
