//! Points that no face uses: strays of an exporter, which leaves them in, or skin whose faces were cut off.

use std::collections::BTreeMap;

use nalgebra::Point3;

/// Width of a cell in mean edges of the mesh. A cell and its neighbours then hold some 90 points of a meshed skin.
const CELL_EDGES: f64 = 3.0;

/// The fewest unused points in a cell and its neighbours that may be skin: a patch of seven edges across. What is
/// smaller is no more than a hole.
const PATCH_POINTS_MIN: usize = 40;

/// A cell, counted from the origin along each axis.
type Cell = [i64; 3];

/// The points in a cell.
#[derive(Default, Clone, Copy)]
struct Counted {
    used: usize,
    unused: usize,
}

/// How many points lie in patches that no face covers: unused points, many of them around, and more than used ones.
/// A stray lies alone, or among points of the skin.
pub(super) fn in_bare_patches(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    order: &[u32],
) -> usize {
    let at = |number: u32| points[order[number as usize] as usize];
    let edges = triangles.iter().map(|&[first, second, _]| (at(second) - at(first)).norm());
    let width = CELL_EDGES * edges.sum::<f64>() / triangles.len() as f64;
    let cell = |point: &Point3<f64>| -> Cell {
        std::array::from_fn(|axis| (point[axis] / width).floor() as i64)
    };
    let mut is_used = vec![false; points.len()];
    order.iter().for_each(|number| is_used[*number as usize] = true);
    let mut cells: BTreeMap<Cell, Counted> = BTreeMap::new();
    for (point, is_used) in points.iter().zip(&is_used) {
        let counted = cells.entry(cell(point)).or_default();
        *if *is_used { &mut counted.used } else { &mut counted.unused } += 1;
    }
    let is_bare = |at: &Cell| {
        let around = neighbours(at).filter_map(|at| cells.get(&at).copied());
        let Counted { used, unused } = around.fold(Counted::default(), |all, of| Counted {
            used: all.used + of.used,
            unused: all.unused + of.unused,
        });
        unused >= PATCH_POINTS_MIN && unused > used
    };
    cells.iter().filter(|(at, of)| of.unused > 0 && is_bare(at)).map(|(_, of)| of.unused).sum()
}

/// A cell and the 26 around it.
fn neighbours([x, y, z]: &Cell) -> impl Iterator<Item = Cell> {
    let [x, y, z] = [*x, *y, *z];
    (0..27).map(move |at| {
        [(x, at % 3), (y, at / 3 % 3), (z, at / 9)].map(|(of, step)| of.saturating_add(step - 1))
    })
}
