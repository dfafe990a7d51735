//! The surface through a grid of points, with knots chosen automatically.

use super::bridge::Bridged;
use super::distinct::check_lines;
use super::given::{GridData, SurfaceFit, check, surface, with_statistics};
use crate::fit::FitFault;
use crate::knots::choice::{check_gaps, chosen};
use crate::knots::request::{GridDomain, Knots, requests};

/// The method of a grid fit.
#[derive(Debug, Clone, PartialEq)]
pub struct GridMethod {
    /// Rows and columns of control points, at least 4 each and at most the number of the data's.
    pub control_points: [usize; 2],
    /// The placement of the knots.
    pub knots: Knots,
    /// Parameters along that must be knots, such as anatomical sections: the nearest knot is moved
    /// there, unless a span would become too short.
    pub marks: Vec<f64>,
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
    check_gaps(data.along, &requests[0])?;
    check_gaps(data.around, &requests[1])?;

    let domains = requests.map(|request| request.domain);
    let whole = Bridged::new(data, domains, requests.map(|request| request.spans));
    let grid = whole.data();
    let along = chosen(&grid.profiles_along(), &requests[0])?;
    let around = chosen(&grid.profiles_around(), &requests[1])?;
    let surface = surface(&grid, along.basis, around.basis)?;
    Ok(with_statistics(surface, data, [along.used, around.used]))
}
