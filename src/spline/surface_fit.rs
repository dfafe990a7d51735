//! Plain least-squares surface through a grid of points: two small solves, one a direction.

use nalgebra::Point3;

use super::basis::{Basis, Row};
use super::fit::{FitFault, check_places};
use super::normal::RIDGE;
use super::penalty::roughness;
use super::solve::{Cholesky, Singular, Skyline};
use super::surface::Surface;

/// The derivative that the ridge weighs, so that missing rows are bridged much as by a quintic.
const RIDGED: usize = 3;

/// Points on a grid of parameters.
#[derive(Debug, Clone, Copy)]
pub struct GridData<'a> {
    /// The parameter u of each row, within the domain of the basis along; any order.
    pub along: &'a [f64],
    /// The parameter v of each column; wrapped; any order.
    pub around: &'a [f64],
    /// The points, row-major, `along.len()` rows of `around.len()`, mm.
    pub points: &'a [Point3<f64>],
}

/// A fitted surface and what it leaves of the data.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceFit {
    /// The surface.
    pub surface: Surface,
    /// Root mean square distance between the data and the surface at their own parameters, mm; an
    /// upper bound of the distance proper.
    pub rms_mm: f64,
    /// The largest such distance, mm.
    pub max_mm: f64,
    /// The lesser [`Cholesky::smallest_pivot`] of both directions: near 1e-12 the grid does not
    /// determine all control points and the ridge chose among the solutions.
    pub smallest_pivot: f64,
}

/// The tensor-product least-squares surface C = (AᵀA + ridge)⁻¹ Aᵀ P B (BᵀB + ridge)⁻¹.
///
/// The ridge, 1e-12 of the data's trace on the third derivative, keeps control points determined
/// where no datum lies. Where all data of a row have z equal to an affine function of u (planar
/// sections, u from their height) the control points' z are that function of the Greville
/// abscissae, and the surface's own sections at constant u are planar too. Source: nurbs.md 6.2,
/// 6.6.
///
/// # Errors
/// A [`FitFault`]: points that make no grid, data not finite, u outside the domain, fewer than 4 different rows or columns, `along` not
/// clamped or `around` not periodic, or a grid that determines nothing.
pub fn fit_grid(data: &GridData, along: Basis, around: Basis) -> Result<SurfaceFit, FitFault> {
    check(data)?;
    check_places(&along, data.along, data.along)?;
    check_places(&around, data.around, data.around)?;
    let rows_along: Vec<Row> = data.along.iter().map(|u| along.row(*u)).collect();
    let rows_around: Vec<Row> = data.around.iter().map(|v| around.row(*v)).collect();
    let factor_along = factor(&along, &rows_along)?;
    let factor_around = factor(&around, &rows_around)?;

    let flat: Vec<f64> = data.points.iter().flat_map(|point| [point.x, point.y, point.z]).collect();
    let by_row = solved(&factor_along, &rows_along, &flat, along.count());
    let by_column = transposed(&by_row, along.count(), data.around.len());
    let by_column = solved(&factor_around, &rows_around, &by_column, around.count());
    let control = transposed(&by_column, around.count(), along.count());
    let control = control.chunks_exact(3).map(|xyz| Point3::new(xyz[0], xyz[1], xyz[2])).collect();
    let surface = Surface::new(along, around, control)?;

    let (rms_mm, max_mm) = residuals(&surface, data);
    let smallest_pivot = factor_along.smallest_pivot().min(factor_around.smallest_pivot());
    Ok(SurfaceFit { surface, rms_mm, max_mm, smallest_pivot })
}

/// The factor of BᵀB plus the ridge.
fn factor(basis: &Basis, rows: &[Row]) -> Result<Cholesky, Singular> {
    let mut gram = Skyline::zero(basis);
    for row in rows {
        gram.add_square(row, 1.0);
    }
    let ridge = roughness(basis, RIDGED);
    gram.plus(RIDGE * gram.trace() / ridge.trace(), &ridge).factor()
}

/// The `count` coefficients of each column of `values`, whose rows belong to `rows`.
fn solved(factor: &Cholesky, rows: &[Row], values: &[f64], count: usize) -> Vec<f64> {
    let width = values.len() / rows.len();
    let mut moments = vec![0.0; count * width];
    for (row, values) in rows.iter().zip(values.chunks_exact(width)) {
        for (index, weight) in row.indices.into_iter().zip(row.values) {
            let sums = &mut moments[index * width..(index + 1) * width];
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    factor.solve(&mut moments, width);
    moments
}

/// A grid of xyz triples with rows and columns exchanged.
fn transposed(values: &[f64], rows: usize, columns: usize) -> Vec<f64> {
    let places = (0..columns).flat_map(|j| (0..rows).map(move |i| 3 * (i * columns + j)));
    places.flat_map(|place| [values[place], values[place + 1], values[place + 2]]).collect()
}

/// Root mean square and largest distance between data and surface at the data's parameters.
fn residuals(surface: &Surface, data: &GridData) -> (f64, f64) {
    let fitted = surface.grid(data.along, data.around);
    let squares = fitted.iter().zip(data.points).map(|(a, b)| (a - b).norm_squared());
    let (sum, largest) = squares.fold((0.0, 0.0_f64), |(sum, max), s| (sum + s, max.max(s)));
    ((sum / data.points.len() as f64).sqrt(), largest.sqrt())
}

fn check(data: &GridData) -> Result<(), FitFault> {
    let (rows, columns, points) = (data.along.len(), data.around.len(), data.points.len());
    if points == 0 || points != rows * columns {
        return Err(FitFault::NoGrid { points, along: rows, around: columns });
    }
    let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
    let unusable = |index: &usize| {
        let (u, v) = (data.along[index / columns], data.around[index % columns]);
        !finite(&[u, v]) || !finite(data.points[*index].coords.as_slice())
    };
    match (0..points).find(unusable) {
        Some(index) => Err(FitFault::NotFinite { index }),
        None => Ok(()),
    }
}
