//! The surface through a cloud of points, with knots chosen automatically as for a grid (`knots`).
//!
//! Arbitrarily placed points do not show how a line along or around bends. So a first, smoothed fit
//! with many uniform knots is sampled on a grid; the knots are chosen for that grid, and then the
//! points themselves are fitted with them.

use super::fit::{CloudData, CloudFit, CloudMethod, fit_cloud};
use crate::basis::Basis;
use crate::fit::FitFault;
use crate::grid::GridData;
use crate::knots::choice::{Choice, chosen};
use crate::knots::request::{GridDomain, Knots, requests};

/// The requested knots of the surface through a cloud. Pairs are along and around.
#[derive(Debug, Clone, PartialEq)]
pub struct CloudKnots {
    /// Rows and columns of control points, at least 4 each, and together at most the number of points.
    pub control_points: [usize; 2],
    /// The placement of the knots.
    pub knots: Knots,
    /// Parameters that must be knots: heights, and positions around.
    pub marks: [Vec<f64>; 2],
}

/// Control points along and around of the first fit, if there are enough points.
const FIRST: [usize; 2] = [48, 36];

/// Points needed for each control point of the first fit; with fewer points it gets fewer control
/// points, so that noise does not influence the knots.
const POINTS_EACH: usize = 4;

/// Minimum number of control points of the first fit, along and around.
const FIRST_LEAST: [usize; 2] = [12, 9];

/// Lines of the grid on which the first fit is sampled; those along include both ends.
const LOOKED_AT: [usize; 2] = [80, 72];

/// Fits a surface to a cloud with the control points, knots and marks of `knots`.
///
/// # Errors
/// A [`FitFault`] as from [`fit_cloud`]; also for marks outside the domain.
pub fn fit_cloud_by(
    data: &CloudData,
    domain: &GridDomain,
    knots: &CloudKnots,
    method: &CloudMethod,
) -> Result<CloudFit, FitFault> {
    let CloudKnots { control_points, knots, ref marks } = *knots;
    let requests = requests(domain, control_points, knots, marks)?;
    let (points, needed) = (data.points.len(), control_points[0].saturating_mul(control_points[1]));
    if points < needed {
        return Err(FitFault::TooFewPoints { points, control_points: needed });
    }
    let [rows, columns] = first_control_points(points);
    let [from, to] = domain.along;
    let along = Basis::uniform_clamped(from, to, rows.saturating_sub(3))?;
    let around = Basis::uniform_periodic(domain.around_from, domain.period, columns)?;
    let first = fit_cloud(data, along, around, method)?;

    let [rows, columns] = LOOKED_AT;
    let along = |i: usize| from + (to - from) * i as f64 / (rows - 1) as f64;
    let along: Vec<f64> = (0..rows).map(along).collect();
    let around = |j: usize| domain.around_from + domain.period * j as f64 / columns as f64;
    let around: Vec<f64> = (0..columns).map(around).collect();
    let grid = first.surface.grid(&along, &around);
    // The first fit smooths the noise away, so its grid has none.
    let grid = GridData { along: &along, around: &around, points: &grid };
    let Choice { basis: along, .. } = chosen(&grid.profiles_along(), &requests[0])?;
    let Choice { basis: around, .. } = chosen(&grid.profiles_around(), &requests[1])?;
    fit_cloud(data, along, around, method)
}

/// Control points of the first fit for a number of points.
fn first_control_points(points: usize) -> [usize; 2] {
    let wanted = (POINTS_EACH * FIRST[0] * FIRST[1]) as f64;
    let share = (points as f64 / wanted).sqrt().min(1.0);
    [0, 1].map(|d| ((share * FIRST[d] as f64) as usize).max(FIRST_LEAST[d]))
}
