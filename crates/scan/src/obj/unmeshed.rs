//! Points that no face uses: strays of an exporter, which leaves them in, or skin whose faces were cut off.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

/// Width of a cell in mean edges of the mesh. A cell and its neighbours then hold some 90 points of a meshed skin.
const CELL_EDGES: f64 = 3.0;

/// The fewest unused points in a cell and its neighbours that may be skin: a patch of seven edges across. What is
/// smaller is no more than a hole.
const PATCH_POINTS_MIN: usize = 40;

/// A point of the skin lies at least this far from the next one, in mean edges. A stray near the skin lies nearer: in
/// a triangle of equal sides no point is further than 0.58 from a corner.
const SPACING_MIN_EDGES: f64 = 0.7;

/// A point of the skin lies in the plane of the next one, up to this share of its distance. A stray that is not near
/// a corner lies beside the skin.
const OFF_PLANE_MAX: f64 = 0.35;

/// A cell, counted from the origin along each axis.
type Cell = [i64; 3];

/// The points in a cell.
#[derive(Default, Clone)]
struct Held {
    used: Vec<u32>,
    unused: Vec<u32>,
}

/// How many unused points seem to be skin whose faces are missing: they lie together, or on the skin beside its points
/// and as far from them as these from one another. A stray lies alone, or beside the skin, or near one of its points.
/// `order` are the points that the triangles use, by the triangles' numbers for them.
pub(super) fn unmeshed_skin(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    order: &[u32],
) -> usize {
    let at = |number: u32| points[order[number as usize] as usize];
    let edges = triangles.iter().map(|&[first, second, _]| (at(second) - at(first)).norm());
    let edge = edges.sum::<f64>() / triangles.len() as f64;
    let normals = normals(points.len(), triangles, order, &at);
    let cells = cells(points, order, CELL_EDGES * edge);
    let count = cells.iter().filter(|(_, held)| !held.unused.is_empty()).map(|(cell, held)| {
        let around: Vec<&Held> = neighbours(cell).filter_map(|cell| cells.get(&cell)).collect();
        let used = || around.iter().flat_map(|held| &held.used);
        let unused: usize = around.iter().map(|held| held.unused.len()).sum();
        if unused >= PATCH_POINTS_MIN && unused > used().count() {
            return held.unused.len();
        }
        let is_beside = |own: &&u32| {
            let own = &points[**own as usize];
            let arm = |other: &u32| own - points[*other as usize];
            let nearest = used().min_by(|a, b| arm(a).norm().total_cmp(&arm(b).norm()));
            nearest.is_some_and(|nearest| {
                let arm = arm(nearest);
                let off = arm.dot(&normals[*nearest as usize]).abs();
                arm.norm() >= SPACING_MIN_EDGES * edge && off < OFF_PLANE_MAX * arm.norm()
            })
        };
        held.unused.iter().filter(is_beside).count()
    });
    count.sum()
}

/// Unit normals of the skin at its points, by the points' places in the file.
fn normals(
    count: usize,
    triangles: &[[u32; 3]],
    order: &[u32],
    at: &impl Fn(u32) -> Point3<f64>,
) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); count];
    for triangle in triangles {
        let [a, b, c] = triangle.map(at);
        let normal = (b - a).cross(&(c - a));
        triangle.iter().for_each(|corner| normals[order[*corner as usize] as usize] += normal);
    }
    normals.iter().map(|sum| sum.try_normalize(0.0).unwrap_or_default()).collect()
}

/// The points by cells of this width.
fn cells(points: &[Point3<f64>], order: &[u32], width: f64) -> BTreeMap<Cell, Held> {
    let mut is_used = vec![false; points.len()];
    order.iter().for_each(|number| is_used[*number as usize] = true);
    let mut cells: BTreeMap<Cell, Held> = BTreeMap::new();
    for ((point, is_used), number) in points.iter().zip(is_used).zip(0..) {
        let cell = std::array::from_fn(|axis| (point[axis] / width).floor() as i64);
        let held = cells.entry(cell).or_default();
        (if is_used { &mut held.used } else { &mut held.unused }).push(number);
    }
    cells
}

/// A cell and the 26 around it.
fn neighbours([x, y, z]: &Cell) -> impl Iterator<Item = Cell> {
    let [x, y, z] = [*x, *y, *z];
    (0..27).map(move |at| {
        [(x, at % 3), (y, at / 3 % 3), (z, at / 9)].map(|(of, step)| of.saturating_add(step - 1))
    })
}
