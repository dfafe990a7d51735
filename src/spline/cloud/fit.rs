//! Robust smoothing fit of a surface to a cloud of points around a tube that stands along z.
//!
//! u is the height: the control points' z are the Greville abscissae, so that S_z = u everywhere
//! and curves of constant u are the plane sections; x and y are what is fitted (nurbs.md 6.2).
//! Minimises Σ w |S − P|² + λu ∬ |S_uuu|² + λv ∬ |S_vvv|². Outliers lose their weight round by
//! round, first some of it, then all (nurbs.md 6.8).

use nalgebra::Point3;

use super::cells::Cells;
use super::equations::CloudEquations;
use super::penalty::Penalty;
use super::weights::{FADED_NORMAL_SD, Fading, weights_of};
use crate::spline::basis::{Basis, DEGREE};
use crate::spline::fit::FitFault;
use crate::spline::surface::Surface;

/// A cloud of points and where each lies around.
#[derive(Debug, Clone, Copy)]
pub struct CloudData<'a> {
    /// The points; z within the domain of the basis along.
    pub points: &'a [Point3<f64>],
    /// The parameter v of each point; wrapped.
    pub around: &'a [f64],
}

/// How much a cloud fit may smooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CloudSmoothing {
    /// As little as leaves places without points bridged.
    None,
    /// These lambdas along and around, at least 0. At 1 penalty and data have the same trace.
    Fixed([f64; 2]),
    /// The lambdas of least generalised cross-validation score (Craven, Wahba 1979).
    Gcv,
}

/// How a cloud is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CloudMethod {
    /// How much is smoothed.
    pub smoothing: CloudSmoothing,
    /// Whether outliers lose their weight.
    pub robust: bool,
    /// Residuals of this standard deviation, mm, are never outliers, so that perfect points do not
    /// throw out what the surface cannot follow.
    pub least_scale_mm: f64,
}

impl Default for CloudMethod {
    /// For scanned skin: smoothing by cross-validation, robust, a scale of at least 0.3 mm.
    fn default() -> CloudMethod {
        CloudMethod { smoothing: CloudSmoothing::Gcv, robust: true, least_scale_mm: 0.3 }
    }
}

/// A surface fitted to a cloud, and what it made of the points.
#[derive(Debug, Clone)]
pub struct CloudFit {
    /// The surface, u in mm.
    pub surface: Surface,
    /// The weight that each point kept, 0 to 1.
    pub weights: Vec<f64>,
    /// Smoothing used, along and around.
    pub lambdas: [f64; 2],
    /// Effective degrees of freedom of each coordinate, at most the number of control points.
    pub edf: f64,
    /// Standard deviation of the points' horizontal distance from the surface, mm, were it normal.
    pub sigma_mm: f64,
}

/// Smoothing that remains where none is wanted.
const LEAST_LAMBDA: f64 = 1e-10;

/// Smoothing before it is known how much is right: holes are bridged and outliers stand out, yet
/// bumps as wide as a few intervals stay.
const FIRST_LAMBDA: f64 = 1e-5;

/// Rounds with Huber's weights: an outlier pulls no more than a point at the rim of the others. The
/// first fit, without weights, may lie a millimetre off.
const HUBER_ROUNDS: usize = 2;

/// Rounds after them in which outliers lose all weight.
const WHOLE_ROUNDS: usize = 2;

/// Rounds of choosing the smoothing where weights stay 1.
const PLAIN_ROUNDS: usize = 1;

/// The fewest and the most regions each way in which points are looked for; between them so many
/// that four points fall in one if they are spread evenly, and hardly any stays empty by chance.
const REGIONS: [f64; 2] = [4.0, 24.0];

/// Regions that must hold a point. With a quarter of a leg missing the rest can still be told; what
/// lies in the gap is invention, and with half of it missing most of the surface would be.
const SEEN_SHARE: f64 = 0.75;

/// How far outside the domain rounding may put a point, as a share of its length.
const ROUNDING: f64 = 1e-9;

/// Places nearer to each other than this share of the domain count as one.
const LEAST_STEP: f64 = 1e-6;

/// Fits the surface over `along` (of z) and `around` (of v).
///
/// # Errors
/// A [`FitFault`]: a point or place not finite or outside the domain, lengths that differ, fewer
/// points than control points, points at fewer than 4 different heights or places around, more
/// than a quarter of the surface without points, bases that make no surface.
pub fn fit_cloud(
    data: &CloudData,
    along: Basis,
    around: Basis,
    method: &CloudMethod,
) -> Result<CloudFit, FitFault> {
    check(data, [&along, &around])?;
    let cells = Cells::new(data.points, data.around, [&along, &around]);
    let counts = [along.count(), around.count()];
    let seen = seen(data, [&along, &around])?;
    let penalty = Penalty::new(&along, &around, seen)?;
    let (rounds, mut lambdas) = match method.smoothing {
        CloudSmoothing::None => (0, [LEAST_LAMBDA; 2]),
        CloudSmoothing::Fixed(lambdas) => (0, checked(lambdas)?),
        CloudSmoothing::Gcv => (PLAIN_ROUNDS, [FIRST_LAMBDA; 2]),
    };
    let rounds = if method.robust { HUBER_ROUNDS + WHOLE_ROUNDS } else { rounds };

    let mut weights = vec![1.0; data.points.len()];
    let mut equations = CloudEquations::new(&cells, &weights, counts);
    let mut coefficients = equations.moments.clone();
    penalty.factor(&equations, lambdas)?.solve(&mut coefficients);
    let mut squares = cells.squares(&coefficients, counts[1]);
    for round in 0..rounds {
        if method.robust {
            let fading = if round < HUBER_ROUNDS { Fading::Huber } else { Fading::Whole };
            weights = weights_of(&squares, method.least_scale_mm, fading);
            equations = CloudEquations::new(&cells, &weights, counts);
        }
        if method.smoothing == CloudSmoothing::Gcv {
            let rss = weighted(&squares, &weights);
            lambdas = penalty.best_by_gcv(&equations, &coefficients, rss);
        }
        coefficients.clone_from(&equations.moments);
        penalty.factor(&equations, lambdas)?.solve(&mut coefficients);
        squares = cells.squares(&coefficients, counts[1]);
    }

    let edf = penalty.edf(lambdas);
    let freedom = (equations.weight - edf).max(1.0);
    let given_back = if method.robust { FADED_NORMAL_SD } else { 1.0 };
    let sigma_mm = (weighted(&squares, &weights) / freedom).sqrt() / given_back;
    let surface = standing(along, around, &coefficients)?;
    let weights = cells.in_cloud_order(&weights);
    Ok(CloudFit { surface, weights, lambdas, edf, sigma_mm })
}

/// The surface whose x and y have these coefficients and whose z is u.
fn standing(along: Basis, around: Basis, xy: &[[f64; 2]]) -> Result<Surface, FitFault> {
    let heights = along.greville();
    let columns = around.count();
    let control = |(k, [x, y]): (usize, &[f64; 2])| Point3::new(*x, *y, heights[k / columns]);
    let control = xy.iter().enumerate().map(control).collect();
    Ok(Surface::new(along, around, control)?)
}

fn weighted(squares: &[f64], weights: &[f64]) -> f64 {
    squares.iter().zip(weights).map(|(square, weight)| square * weight).sum()
}

/// The share of equal regions of the surface that hold a point.
fn seen(data: &CloudData, [along, around]: [&Basis; 2]) -> Result<f64, FitFault> {
    let sides = ((data.points.len() as f64).sqrt() / 2.0).clamp(REGIONS[0], REGIONS[1]).floor();
    let side = |basis: &Basis, place: f64| {
        let (from, to) = basis.domain();
        let share = (basis.wrapped(place) - from) / (to - from);
        ((sides * share) as usize).min(sides as usize - 1)
    };
    let mut holds = vec![false; (sides * sides) as usize];
    for (point, v) in data.points.iter().zip(data.around) {
        holds[side(along, point.z) * sides as usize + side(around, *v)] = true;
    }
    let (found, of) = (holds.iter().filter(|holds| **holds).count(), holds.len());
    let needed = (SEEN_SHARE * of as f64).ceil() as usize;
    if found < needed {
        return Err(FitFault::TooLittleSeen { found, of, needed });
    }
    Ok(found as f64 / of as f64)
}

fn checked(lambdas: [f64; 2]) -> Result<[f64; 2], FitFault> {
    match lambdas.into_iter().find(|lambda| !lambda.is_finite() || *lambda < 0.0) {
        Some(lambda) => Err(FitFault::BadLambda { lambda }),
        None => Ok(lambdas.map(|lambda| lambda.max(LEAST_LAMBDA))),
    }
}

fn check(data: &CloudData, [along, around]: [&Basis; 2]) -> Result<(), FitFault> {
    let (points, places) = (data.points.len(), data.around.len());
    if points != places {
        return Err(FitFault::PlacesDiffer { points, around: places });
    }
    let finite = |(point, v): (&Point3<f64>, &f64)| {
        v.is_finite() && point.iter().all(|value| value.is_finite())
    };
    if let Some(index) = data.points.iter().zip(data.around).position(|datum| !finite(datum)) {
        return Err(FitFault::NotFinite { index });
    }
    let control_points = along.count() * around.count();
    if points < control_points {
        return Err(FitFault::TooFewPoints { points, control_points });
    }
    let (from, to) = along.domain();
    let heights = || data.points.iter().map(|point| point.z);
    let rounding = ROUNDING * (to - from);
    let outside = |z: f64| z < from - rounding || z > to + rounding;
    if let Some((index, x)) = heights().enumerate().find(|(_, z)| outside(*z)) {
        return Err(FitFault::OutsideDomain { index, x, from, to });
    }
    different(heights(), to - from)?;
    let (from, to) = around.domain();
    different(data.around.iter().map(|v| around.wrapped(*v)), to - from)
}

/// Refuses places of which fewer than four differ by what could hold a slope against rounding.
fn different(places: impl Iterator<Item = f64>, length: f64) -> Result<(), FitFault> {
    let mut known: Vec<f64> = Vec::new();
    for place in places {
        if known.iter().all(|known| (known - place).abs() > LEAST_STEP * length) {
            known.push(place);
        }
        if known.len() > DEGREE {
            return Ok(());
        }
    }
    Err(FitFault::TooFewPlaces { found: known.len(), needed: DEGREE + 1 })
}
