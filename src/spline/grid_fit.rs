//! The surface through a grid of points, with knots that it finds itself.

use nalgebra::Point3;

use super::basis::Basis;
use super::cross_validation::{Smoothest, Spectrum, best_by_gcv};
use super::distinct::check_lines;
use super::fit::FitFault;
use super::knot_choice::{Knots, Wish, chosen};
use super::knots::fine;
use super::normal::RIDGE;
use super::outliers::{Cleaned, cleaned};
use super::profiles::{Domain, Profiles};
use super::surface_fit::{
    GridData, SurfaceFit, check, flat, judged, residuals, solver, spread, surface,
};

/// How to fit a grid. Pairs are along and around.
#[derive(Debug, Clone, PartialEq)]
pub struct GridMethod {
    /// Rows and columns of control points, at least 4 each and at most as many as the data have.
    pub control_points: [usize; 2],
    /// Where the knots lie.
    pub knots: Knots,
    /// How noise is smoothed away.
    pub smoothing: GridSmoothing,
    /// Whether points far from the surface lose their weight.
    pub robust: bool,
    /// Parameters that are to be knots, such as anatomical sections: the nearest one is moved
    /// there.
    pub marks: [Vec<f64>; 2],
}

/// How a fit of a grid is to smooth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GridSmoothing {
    /// Plain least squares.
    None,
    /// The smoothing of least generalised cross-validation score, along and around by themselves;
    /// right for independent errors. The knots are then found in the smoothed data.
    Gcv,
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

/// Fits a surface as `method` says. See [`super::fit_grid`] for the equations.
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
    check_lines(&Profiles::along(data), &wishes[0])?;
    check_lines(&Profiles::around(data), &wishes[1])?;

    let equal = wishes.map(|wish| wish.domain.equal(wish.spans));
    let equal = [wishes[0].domain.basis(&equal[0])?, wishes[1].domain.basis(&equal[1])?];
    let first = without_outliers(data, data.points, &equal, method)?;
    let shape = denoised(&GridData { points: &first.points, ..*data }, &wishes, method)?;
    let shape = GridData { points: &shape, ..*data };
    let along = chosen(&Profiles::along(&shape), &wishes[0])?;
    let around = chosen(&Profiles::around(&shape), &wishes[1])?;

    let bases = [along.basis, around.basis];
    let Cleaned { points, outliers } = without_outliers(data, &first.points, &bases, method)?;
    let clean = GridData { points: &points, ..*data };
    let chosen = smoothest(&clean, &bases, method)?;
    let fit = solved(data, &clean, bases, &chosen, &outliers)?;
    let marks_missed = [along.missed, around.missed];
    Ok(SurfaceFit { knots: [along.used, around.used], marks_missed, outliers, ..fit })
}

/// The surface through the clean points, judged by the data without their outliers.
fn solved(
    data: &GridData,
    clean: &GridData,
    bases: [Basis; 2],
    smoothest: &Smoothest,
    outliers: &[usize],
) -> Result<SurfaceFit, FitFault> {
    let Smoothest { lambdas, edf } = *smoothest;
    let solver = solver(data, [&bases[0], &bases[1]], lambdas)?;
    let [along, around] = bases;
    let surface = surface(&solver, clean.points, along, around)?;
    let fit = judged(surface, data, &solver, lambdas);
    // The outliers lie on the surface and so add nothing to the clean points' residuals.
    let (rms_mm, _) = residuals(&fit.surface, clean);
    let sigma_mm = spread(rms_mm, data.points.len(), outliers.len(), edf);
    Ok(SurfaceFit { edf, sigma_mm, ..fit })
}

/// The smoothing that the method asks for.
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

/// The points without outliers, if the method asks for it, judged by the surface in these bases
/// with the smoothing that the points of an earlier round need.
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

/// The points by which knots are placed: those of a fine fit where noise is to be smoothed, which
/// knots would otherwise follow.
fn denoised(
    data: &GridData,
    wishes: &[Wish; 2],
    method: &GridMethod,
) -> Result<Vec<Point3<f64>>, FitFault> {
    if method.smoothing == GridSmoothing::None || method.knots == Knots::Uniform {
        return Ok(data.points.to_vec());
    }
    let [along, around] = wishes.map(|wish| wish.domain);
    let bases = [
        along.basis(&fine(data.along.len(), &along))?,
        around.basis(&fine(data.around.len(), &around))?,
    ];
    let smoothest = smoothest(data, &bases, method)?;
    let solver = solver(data, [&bases[0], &bases[1]], smoothest.lambdas)?;
    let [along, around] = bases;
    Ok(surface(&solver, data.points, along, around)?.grid(data.along, data.around))
}

/// What is asked of either direction.
pub(super) fn wishes<'a>(
    domain: &GridDomain,
    method: &'a GridMethod,
) -> Result<[Wish<'a>; 2], FitFault> {
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
