//! Plain least-squares surface through a grid of points: two small solves, one per direction.

use nalgebra::Point3;

use crate::basis::Basis;
use crate::fit::{FitFault, check_places};
use crate::knots::choice::KnotsUsed;
use crate::knots::profiles::Profiles;
use crate::least_squares::LeastSquares;
use crate::normal::RIDGE;
use crate::surface::Surface;

/// Points on a grid of parameters.
#[derive(Debug, Clone, Copy)]
pub struct GridData<'a> {
    /// The parameter u of each row, within the domain of the basis along; in any order.
    pub along: &'a [f64],
    /// The parameter v of each column; wrapped; in any order.
    pub around: &'a [f64],
    /// The points, row-major, `along.len()` rows of `around.len()`, mm.
    pub points: &'a [Point3<f64>],
}

impl GridData<'_> {
    /// The lines along, one position per section.
    pub(crate) fn profiles_along(&self) -> Profiles {
        Profiles { places: self.along.to_vec(), values: flat(self.points) }
    }

    /// The sections, one position per column.
    pub(crate) fn profiles_around(&self) -> Profiles {
        let values = transposed(&flat(self.points), self.along.len(), self.around.len());
        Profiles { places: self.around.to_vec(), values }
    }
}

/// A fitted surface and its residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceFit {
    /// The surface.
    pub surface: Surface,
    /// Root mean square distance between the data and the surface at the data's own parameters, mm;
    /// an upper bound of the true distance.
    pub rms_mm: f64,
    /// The largest such distance, mm.
    pub max_mm: f64,
    /// The origin of the knots along and around.
    pub knots: [KnotsUsed; 2],
}

/// The tensor-product least-squares surface C = (AᵀA + ridge)⁻¹ Aᵀ P B (BᵀB + ridge)⁻¹.
///
/// The ridge, 1e-12 of the data's trace on the third derivative, keeps control points determined where
/// there are no data. If all data of a row have a z that is an affine function of u (planar sections, u
/// from their height), the control points' z are that function of the Greville abscissae, and the
/// surface's own sections at constant u are planar too. Normal equations: The NURBS Book 9.4.
///
/// # Errors
/// A [`FitFault`]: points that do not form a grid, data that are not finite, u outside the domain,
/// fewer than 4 different rows or columns, `along` not clamped or `around` not periodic, or a grid
/// that determines nothing.
pub fn fit_grid(data: &GridData, along: Basis, around: Basis) -> Result<SurfaceFit, FitFault> {
    check(data)?;
    check_places(&along, data.along, data.along)?;
    check_places(&around, data.around, data.around)?;
    let surface = surface(data, along, around)?;
    Ok(with_statistics(surface, data, [KnotsUsed::Given; 2]))
}

/// The surface of data that were checked.
pub fn surface(data: &GridData, along: Basis, around: Basis) -> Result<Surface, FitFault> {
    let lengthwise = LeastSquares::new(&along, data.along, RIDGE)?;
    let crosswise = LeastSquares::new(&around, data.around, RIDGE)?;
    let (rows, columns) = (along.count(), around.count());
    let by_row = lengthwise.coefficients(&flat(data.points));
    let by_column = crosswise.coefficients(&transposed(&by_row, rows, data.around.len()));
    Ok(Surface::new(along, around, points(&transposed(&by_column, columns, rows)))?)
}

/// The statistics of a surface fit for the data.
pub fn with_statistics(surface: Surface, data: &GridData, knots: [KnotsUsed; 2]) -> SurfaceFit {
    let fitted = surface.grid(data.along, data.around);
    let squares = fitted.iter().zip(data.points).map(|(a, b)| (a - b).norm_squared());
    let squares: Vec<f64> = squares.collect();
    let (count, sum) = (squares.len() as f64, squares.iter().sum::<f64>());
    SurfaceFit {
        surface,
        rms_mm: (sum / count).sqrt(),
        max_mm: squares.iter().copied().fold(0.0, f64::max).sqrt(),
        knots,
    }
}

/// The coordinates of points, one after the other.
pub fn flat(points: &[Point3<f64>]) -> Vec<f64> {
    points.iter().flat_map(|point| [point.x, point.y, point.z]).collect()
}

/// The points with these coordinates, one after the other.
pub fn points(values: &[f64]) -> Vec<Point3<f64>> {
    values.chunks_exact(3).map(|xyz| Point3::new(xyz[0], xyz[1], xyz[2])).collect()
}

/// A grid of xyz triples with rows and columns swapped.
pub fn transposed(values: &[f64], rows: usize, columns: usize) -> Vec<f64> {
    let places = (0..columns).flat_map(|j| (0..rows).map(move |i| 3 * (i * columns + j)));
    places.flat_map(|place| [values[place], values[place + 1], values[place + 2]]).collect()
}

pub fn check(data: &GridData) -> Result<(), FitFault> {
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
