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

#[derive(Default, Clone)]
struct CellPoints {
    used: Vec<u32>,
    unused: Vec<u32>,
}

/// How many points of a file that no triangle uses seem to be skin whose faces are missing: they lie together, or on
/// the skin beside its points and as far from them as these from one another. A stray lies alone, or beside the skin,
/// or near one of its points. `used` are the points of the triangles, `all` those of the file.
pub(super) fn unmeshed_skin(
    used: &[Point3<f64>],
    triangles: &[[u32; 3]],
    all: &[Point3<f64>],
) -> usize {
    let at = |number: u32| used[number as usize];
    let edges = triangles.iter().map(|&[first, second, _]| (at(second) - at(first)).norm());
    let edge = edges.sum::<f64>() / triangles.len() as f64;
    let normals = normals(used, triangles);
    let cells = cells(used, all, CELL_EDGES * edge);
    let count = cells.iter().filter(|(_, held)| !held.unused.is_empty()).map(|(cell, held)| {
        let around: Vec<&CellPoints> =
            neighbours(cell).filter_map(|cell| cells.get(&cell)).collect();
        let used = || around.iter().flat_map(|held| &held.used);
        let unused: usize = around.iter().map(|held| held.unused.len()).sum();
        if unused >= PATCH_POINTS_MIN && unused > used().count() {
            return held.unused.len();
        }
        let is_beside = |own: &&u32| {
            let own = &all[**own as usize];
            let arm = |other: &u32| own - at(*other);
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

/// Unit normals of the skin at its points.
fn normals(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| points[corner as usize]);
        let normal = (b - a).cross(&(c - a));
        triangle.iter().for_each(|corner| normals[*corner as usize] += normal);
    }
    normals.iter().map(|sum| sum.try_normalize(0.0).unwrap_or_default()).collect()
}

/// The points that triangles use, and the others of the file, by cells of this width. A point where a used one lies is
/// the same point.
fn cells(used: &[Point3<f64>], all: &[Point3<f64>], width: f64) -> BTreeMap<Cell, CellPoints> {
    let cell = |point: &Point3<f64>| -> Cell {
        std::array::from_fn(|axis| (point[axis] / width).floor() as i64)
    };
    let place = |point: &Point3<f64>| -> [u64; 3] {
        std::array::from_fn(|axis| (point[axis] + 0.0).to_bits())
    };
    let mut cells: BTreeMap<Cell, CellPoints> = BTreeMap::new();
    for (point, number) in used.iter().zip(0..) {
        cells.entry(cell(point)).or_default().used.push(number);
    }
    let mut places: Vec<_> = used.iter().map(place).collect();
    places.sort_unstable();
    for (point, number) in all.iter().zip(0..) {
        if places.binary_search(&place(point)).is_err() {
            cells.entry(cell(point)).or_default().unused.push(number);
        }
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
