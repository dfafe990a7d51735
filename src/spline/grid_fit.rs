//! The surface through a grid of points, with knots that it finds itself.

use super::distinct::check_lines;
use super::fit::FitFault;
use super::knot_choice::{Knots, Wish, chosen};
use super::profiles::{Domain, Profiles};
use super::surface_fit::{GridData, SurfaceFit, check, fit_grid};

/// How to fit a grid. Pairs are along and around.
#[derive(Debug, Clone, PartialEq)]
pub struct GridMethod {
    /// Rows and columns of control points, at least 4 each and at most as many as the data have.
    pub control_points: [usize; 2],
    /// Where the knots lie.
    pub knots: Knots,
    /// Parameters that are to be knots, such as anatomical sections: the nearest one is moved
    /// there.
    pub marks: [Vec<f64>; 2],
}

/// Where the surface's parameters live.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridDomain {
    /// First and last parameter along.
    pub along: [f64; 2],
    /// Where a turn around starts, unless knots are polished or marked; then the knots say.
    pub around_from: f64,
    /// The period around.
    pub period: f64,
}

/// Fits a surface as `method` says. See [`fit_grid`] for the equations.
///
/// Gaps of a few spans are bridged; data that leave more open are refused, as are data that would
/// only make a surface by solving nonsense.
///
/// # Errors
/// A [`FitFault`] with the figures: points that make no grid, are not finite or coincide; fewer
/// rows or columns than control points; a gap; a mark or a row outside the domain.
pub fn fit_grid_by(
    data: &GridData,
    domain: &GridDomain,
    method: &GridMethod,
) -> Result<SurfaceFit, FitFault> {
    check(data)?;
    let wishes = wishes(domain, method)?;
    let profiles = [Profiles::along(data), Profiles::around(data)];
    for (profiles, wish) in profiles.iter().zip(&wishes) {
        check_lines(profiles, wish)?;
    }
    let along = chosen(&profiles[0], &wishes[0])?;
    let around = chosen(&profiles[1], &wishes[1])?;
    let fit = fit_grid(data, along.basis, around.basis)?;
    let marks_missed = [along.missed, around.missed];
    Ok(SurfaceFit { knots: [along.used, around.used], marks_missed, ..fit })
}

/// What is asked of either direction.
fn wishes<'a>(domain: &GridDomain, method: &'a GridMethod) -> Result<[Wish<'a>; 2], FitFault> {
    let [from, to] = domain.along;
    let along = Domain { from, to, periodic: false };
    let (from, to) = (domain.around_from, domain.around_from + domain.period);
    let around = Domain { from, to, periodic: true };
    let wish = |i: usize, direction, domain: Domain, spans: usize| {
        let marks = method.marks[i].as_slice();
        let Domain { from, to, periodic } = domain;
        let outside = |mark: &&f64| !mark.is_finite() || !periodic && !(from..=to).contains(*mark);
        match marks.iter().find(outside) {
            Some(&mark) => Err(FitFault::MarkOutside { direction, mark, from, to }),
            None => Ok(Wish { direction, domain, spans, knots: method.knots, marks }),
        }
    };
    let spans = method.control_points[0].saturating_sub(3);
    Ok([wish(0, "along", along, spans)?, wish(1, "around", around, method.control_points[1])?])
}
