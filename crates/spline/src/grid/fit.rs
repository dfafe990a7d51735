//! The surface through a grid of points, with knots chosen automatically.

use nalgebra::Point3;

use super::bridge::Bridged;
use super::cross_validation::{Smoothest, Spectrum, best_by_gcv};
use super::distinct::check_lines;
use super::given::{GridData, SurfaceFit, check, flat, judged, solver, surface};
use super::outliers::{Cleaned, cleaned};
use crate::basis::Basis;
use crate::fit::FitFault;
use crate::knots::adaptive::fine;
use crate::knots::choice::{chosen, equal_spans};
use crate::knots::profiles::Domain;
use crate::knots::request::{GridDomain, Knots, requests};
use crate::normal::RIDGE;

/// The method of a grid fit. Pairs are along and around.
#[derive(Debug, Clone, PartialEq)]
pub struct GridMethod {
    /// Rows and columns of control points, at least 4 each and at most the number of the data's.
    pub control_points: [usize; 2],
    /// The placement of the knots.
    pub knots: Knots,
    /// The smoothing of noise.
    pub smoothing: GridSmoothing,
    /// Whether points far from the surface lose their weight.
    pub robust: bool,
    /// Parameters that must be knots, such as anatomical sections: the nearest knot is moved there.
    pub marks: [Vec<f64>; 2],
}

/// The smoothing of a grid fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GridSmoothing {
    /// Plain least squares.
    None,
    /// The smoothing with the smallest generalised cross-validation score, independent along and
    /// around; correct for independent errors. The knots are then chosen for the smoothed data.
    Gcv,
}

/// Fits a surface by `method`. See [`crate::fit_grid`] for the equations.
///
/// Gaps of a few spans are bridged. Data with wider gaps are refused, as are data for which the
/// equations would give a meaningless surface.
///
/// # Errors
/// A [`FitFault`] with details: points that do not form a grid, are not finite or coincide; fewer
/// rows or columns than control points; a gap; a mark or a row outside the domain.
pub fn fit_grid_by(
    data: &GridData,
    domain: &GridDomain,
    method: &GridMethod,
) -> Result<SurfaceFit, FitFault> {
    check(data)?;
    let requests = requests(domain, method.control_points, method.knots, &method.marks)?;
    check_lines(&data.profiles_along(), &requests[0])?;
    check_lines(&data.profiles_around(), &requests[1])?;

    let equal = [equal_spans(data.along, &requests[0])?, equal_spans(data.around, &requests[1])?];

    let domains = requests.map(|request| request.domain);
    let whole = Bridged::new(data, domains, requests.map(|request| request.spans));
    let grid = whole.data();
    let first = without_outliers(&grid, grid.points, &equal, method)?;
    let shape = denoised(&GridData { points: &first.points, ..grid }, domains, method)?;
    let shape = GridData { points: &shape, ..grid };
    let along = chosen(&shape.profiles_along(), &requests[0])?;
    let around = chosen(&shape.profiles_around(), &requests[1])?;

    let bases = [along.basis, around.basis];
    let Cleaned { points, outliers } = without_outliers(&grid, &first.points, &bases, method)?;
    let clean = GridData { points: &points, ..grid };
    let Smoothest { lambdas, edf } = smoothest(&clean, &bases, method)?;
    let solver = solver(&clean, [&bases[0], &bases[1]], lambdas)?;
    let [basis_along, basis_around] = bases;
    let surface = surface(&solver, clean.points, basis_along, basis_around)?;
    let outliers = given(&outliers, grid.around.len(), data);
    Ok(SurfaceFit {
        knots: [along.used, around.used],
        marks_missed: [along.missed, around.missed],
        gaps: whole.gaps.clone(),
        ..judged(surface, data, &solver, lambdas, edf, outliers)
    })
}

/// Translates indices in a grid with appended lines to the given data; drops those in appended lines.
fn given(places: &[usize], columns: usize, data: &GridData) -> Vec<usize> {
    let places = places.iter().map(|place| (place / columns, place % columns));
    let within = places.filter(|(i, j)| *i < data.along.len() && *j < data.around.len());
    within.map(|(i, j)| i * data.around.len() + j).collect()
}

/// The smoothing requested by the method.
fn smoothest(
    data: &GridData,
    bases: &[Basis; 2],
    method: &GridMethod,
) -> Result<Smoothest, FitFault> {
    match method.smoothing {
        GridSmoothing::None => {
            let edf = (bases[0].count() * bases[1].count()) as f64;
            Ok(Smoothest { lambdas: [RIDGE; 2], edf })
        }
        GridSmoothing::Gcv => {
            let along = Spectrum::new(&bases[0], data.along)?;
            let around = Spectrum::new(&bases[1], data.around)?;
            Ok(best_by_gcv(&[along, around], &flat(data.points)))
        }
    }
}

/// The points without outliers, if requested by the method. They are judged by the surface in these
/// bases with the smoothing for the points of an earlier round.
fn without_outliers(
    data: &GridData,
    earlier: &[Point3<f64>],
    bases: &[Basis; 2],
    method: &GridMethod,
) -> Result<Cleaned, FitFault> {
    if !method.robust {
        return Ok(Cleaned { points: data.points.to_vec(), outliers: Vec::new() });
    }
    let bases_used = [&bases[0], &bases[1]];
    let smoothest = smoothest(&GridData { points: earlier, ..*data }, bases, method)?;
    let solver = solver(data, bases_used, smoothest.lambdas)?;
    Ok(cleaned(data, &solver, bases_used, earlier)?)
}

/// The points for placing the knots: from a fine fit if noise is to be smoothed, because knots
/// would otherwise follow the noise.
fn denoised(
    data: &GridData,
    [along, around]: [Domain; 2],
    method: &GridMethod,
) -> Result<Vec<Point3<f64>>, FitFault> {
    if method.smoothing == GridSmoothing::None || method.knots == Knots::Uniform {
        return Ok(data.points.to_vec());
    }
    let bases = [
        along.basis(&fine(data.along.len(), &along))?,
        around.basis(&fine(data.around.len(), &around))?,
    ];
    let smoothest = smoothest(data, &bases, method)?;
    let solver = solver(data, [&bases[0], &bases[1]], smoothest.lambdas)?;
    let [along, around] = bases;
    Ok(surface(&solver, data.points, along, around)?.grid(data.along, data.around))
}
