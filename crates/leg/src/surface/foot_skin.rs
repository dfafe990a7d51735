//! The skin below the lowest section, for pictures only: the foot is no tube, so rows of sections cannot
//! show it. It is the scan's own triangles, coarsened by merging the points of each cell of a cube
//! lattice (Rossignac and Borrel 1993).

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use crate::parting::segment::Leg;
use crate::sections::plane_frame::PlaneFrame;
use crate::sections::slice::EDGE_MAX_MM;

/// Edge of a cell, mm. It resolves toes, and a foot has about a thousand points.
const CELL_MM: f64 = 7.0;

/// The foot reaches this far above the lowest section, mm, so that no gap is seen between them.
const OVERLAP_MM: f64 = 3.0;

/// A coarse mesh; its triangles are wound like those of the scan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FootSkin {
    /// The points, body frame, mm.
    pub points: Vec<Point3<f64>>,
    /// Three different indices into the points each.
    pub triangles: Vec<[u16; 3]>,
}

impl FootSkin {
    /// The skin of a leg below a plane; `None` for a point cloud, which has no triangles, and for more
    /// points than indices can count.
    pub fn new(leg: &Leg, below: &PlaneFrame) -> Option<FootSkin> {
        let foot = leg.mesh.part(|facet| {
            facet.longest_edge_mm() <= EDGE_MAX_MM && below.above(&facet.middle()) <= OVERLAP_MM
        });
        let coarse = coarsened(foot.points(), foot.triangles())?;
        (!coarse.triangles.is_empty()).then_some(coarse)
    }
}

/// One point for each cell that holds points: their mean. A triangle stays if its corners lie in three
/// cells.
fn coarsened(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Option<FootSkin> {
    let cell = |point: &Point3<f64>| <[i32; 3]>::from(point.coords.map(whole_cells));
    let mut cells: BTreeMap<[i32; 3], (Vector3<f64>, usize)> = BTreeMap::new();
    for point in points {
        let (sum, count) = cells.entry(cell(point)).or_default();
        *sum += point.coords;
        *count += 1;
    }
    if cells.len() > usize::from(u16::MAX) {
        return None;
    }
    let index: BTreeMap<[i32; 3], u16> = cells.keys().copied().zip(0..).collect();
    let mut kept: Vec<[u16; 3]> = triangles
        .iter()
        .map(|corners| corners.map(|corner| index[&cell(&points[corner as usize])]))
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .map(|corners| {
            // The least first: triangles that have become the same are then equal.
            let least = (0..3).min_by_key(|at| corners[*at]).unwrap_or(0);
            [0, 1, 2].map(|at| corners[(least + at) % 3])
        })
        .collect();
    kept.sort_unstable();
    kept.dedup();
    let mean = |(sum, count): &(Vector3<f64>, usize)| Point3::from(sum / *count as f64);
    Some(FootSkin { points: cells.values().map(mean).collect(), triangles: kept })
}

fn whole_cells(mm: f64) -> i32 {
    (mm / CELL_MM).floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of `n` by `n` points, `mm` apart, with two triangles for each cell, wound to face up.
    fn square(n: u32, mm: f64) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
        let place = |at| Point3::new(f64::from(at % n) * mm, f64::from(at / n) * mm, 0.0);
        let cells = (0..n - 1).flat_map(|y| (0..n - 1).map(move |x| y * n + x));
        let halves = cells.flat_map(|at| [[at, at + 1, at + n + 1], [at, at + n + 1, at + n]]);
        ((0..n * n).map(place).collect(), halves.collect())
    }

    #[test]
    fn a_coarse_skin_keeps_place_and_winding_with_a_fraction_of_the_points() {
        let (points, triangles) = square(71, 1.0);
        let coarse = coarsened(&points, &triangles).unwrap();
        assert_eq!(coarse.points.len(), 11 * 11);
        let mut area = Vector3::zeros();
        for corners in &coarse.triangles {
            let [a, b, c] = corners.map(|corner| coarse.points[usize::from(corner)]);
            let twice = (b - a).cross(&(c - a));
            assert!(twice.z >= 0.0, "{corners:?}");
            area += twice / 2.0;
        }
        // From the middle of the first cell to the last point, which has a cell of its own.
        assert!((area.z - 67.0 * 67.0).abs() < 1e-6, "{area}");
    }

    #[test]
    fn what_shrinks_to_a_line_is_left_out_and_a_triangle_comes_once() {
        let (points, _) = square(4, 1.0);
        assert_eq!(coarsened(&points, &[[0, 1, 5]]).unwrap().triangles, [[0_u16; 3]; 0]);
        let far = [[0.0, 0.0], [10.0, 0.0], [0.0, 10.0], [10.1, 0.1]];
        let far = far.map(|[x, y]| Point3::new(x, y, 1.0));
        let twice = coarsened(&far, &[[0, 1, 2], [3, 2, 0]]).unwrap();
        assert_eq!((twice.points.len(), twice.triangles.len()), (3, 1));
    }
}
