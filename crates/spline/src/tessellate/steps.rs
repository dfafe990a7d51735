//! How finely a tube must be divided so that its triangles stay within the tolerance.
//!
//! Between two knots along and two around, the surface is one bicubic patch. A triangle with its
//! corners on the patch, right-angled in the parameters with legs of `1/n` along and `1/m` around
//! (in units of the patch), is nowhere further from it than `(U/n² + 2W/(nm) + V/m²) / 8`, where U,
//! W and V bound the patch's second derivatives (Filip, Magedson, Markot 1986). The differences of
//! the patch's Bézier points bound these derivatives.

use nalgebra::Vector3;

use crate::basis::Basis;
use crate::surface::Surface;

/// The number of steps for each span between knots, along and around: integers of at least 1, stored as floats, so
/// that an absurd count does not overflow before it is refused.
///
/// Because 2W/(nm) ≤ W/n² + W/m², the bound splits into one term along and one around. Half of
/// the tolerance for each gives the fewest triangles.
pub fn steps(surface: &Surface, tolerance_mm: f64) -> [Vec<f64>; 2] {
    let ones = |basis: &Basis| vec![1.0_f64; basis.breakpoints().len() - 1];
    let [mut along, mut around] = [surface.along(), surface.around()].map(ones);
    let steps = |bend_mm: f64| (bend_mm / 8.0 / (0.5 * tolerance_mm)).sqrt().ceil();
    for (i, along) in along.iter_mut().enumerate() {
        for (j, around) in around.iter_mut().enumerate() {
            let [uu, uv, vv] = bends(&bezier(surface, i, j));
            *along = along.max(steps(uu + uv));
            *around = around.max(steps(vv + uv));
        }
    }
    [along, around]
}

/// The Bézier points of the patch on span `i` along and `j` around, mm, rows along.
fn bezier(surface: &Surface, i: usize, j: usize) -> [[Vector3<f64>; 4]; 4] {
    let rows = |basis: &Basis, span: usize| {
        let (a, b) = (basis.breakpoints()[span], basis.breakpoints()[span + 1]);
        [[a, a, a], [a, a, b], [a, b, b], [b, b, b]].map(|polar| basis.blossom(span, polar))
    };
    let (along, around) = (rows(surface.along(), i), rows(surface.around(), j));
    let columns = surface.around().count();
    along.map(|row| {
        around.map(|column| {
            let mut sum = Vector3::zeros();
            for (i, a) in row.indices.into_iter().zip(row.values) {
                for (j, b) in column.indices.into_iter().zip(column.values) {
                    sum += a * b * surface.control_points()[i * columns + j].coords;
                }
            }
            sum
        })
    })
}

/// Bounds of ∂²P/∂u², ∂²P/∂u∂v and ∂²P/∂v² on a patch with parameters from 0 to 1, mm.
fn bends(patch: &[[Vector3<f64>; 4]; 4]) -> [f64; 3] {
    let largest =
        |rows: usize, columns: usize, difference: &dyn Fn(usize, usize) -> Vector3<f64>| {
            let places = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
            places.map(|(i, j)| difference(i, j).norm()).fold(0.0, f64::max)
        };
    let uu = |i: usize, j: usize| patch[i + 2][j] - 2.0 * patch[i + 1][j] + patch[i][j];
    let vv = |i: usize, j: usize| patch[i][j + 2] - 2.0 * patch[i][j + 1] + patch[i][j];
    let uv =
        |i: usize, j: usize| patch[i + 1][j + 1] - patch[i + 1][j] - patch[i][j + 1] + patch[i][j];
    // The second derivative of a cubic is 3 · 2 times the second differences of its Bézier points,
    // a mixed one 3 · 3 times the mixed ones.
    [6.0 * largest(2, 4, &uu), 9.0 * largest(3, 3, &uv), 6.0 * largest(4, 2, &vv)]
}
