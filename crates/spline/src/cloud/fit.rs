//! Robust smoothing fit of a surface to a cloud of points around a tube along z.
//!
//! u is the height: the control points' z are the Greville abscissae, so that S_z = u everywhere
//! and curves of constant u are the plane sections; x and y are fitted. Minimises Σ
//! w |S − P|² + λu ∬ |S_uuu|² + λv ∬ |S_vvv|². Outliers lose their weight over several rounds,
//! first some of it, then all (`cloud/weights`).

use nalgebra::Point3;

use super::cells::Cells;
use super::equations::CloudEquations;
use super::penalty::Penalty;
use super::weights::{FADED_NORMAL_SD, Fading, weights_of};
use crate::basis::{Basis, DEGREE};
use crate::fit::FitFault;
use crate::surface::Surface;

/// A cloud of points and their positions around.
#[derive(Debug, Clone, Copy)]
pub struct CloudData<'a> {
    /// The points; z within the domain of the basis along.
    pub points: &'a [Point3<f64>],
    /// The parameter v of each point; wrapped.
    pub around: &'a [f64],
}

/// The smoothing of a cloud fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CloudSmoothing {
    /// Only as much as is needed to bridge areas without points.
    None,
    /// These lambdas along and around, at least 0. At 1, penalty and data have equal traces.
    Fixed([f64; 2]),
    /// The lambdas with the smallest generalised cross-validation score (Craven, Wahba 1979).
    Gcv,
}

/// The method of a cloud fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CloudMethod {
    /// The smoothing.
    pub smoothing: CloudSmoothing,
    /// Whether outliers lose their weight.
    pub robust: bool,
    /// Residuals of this standard deviation, mm, are never outliers, so that perfect points are not
    /// rejected where the surface cannot follow them.
    pub least_scale_mm: f64,
}

impl Default for CloudMethod {
    /// For scanned skin: smoothing by cross-validation, robust, a scale of at least 0.3 mm.
    fn default() -> CloudMethod {
        CloudMethod { smoothing: CloudSmoothing::Gcv, robust: true, least_scale_mm: 0.3 }
    }
}

/// A surface fitted to a cloud, with the statistics of the fit.
#[derive(Debug, Clone)]
pub struct CloudFit {
    /// The surface, u in mm.
    pub surface: Surface,
    /// The final weight of each point, 0 to 1.
    pub weights: Vec<f64>,
    /// Smoothing used, along and around.
    pub lambdas: [f64; 2],
    /// Effective degrees of freedom of each coordinate, at most the number of control points.
    pub edf: f64,
    /// Standard deviation of the points' horizontal distance from the surface, mm, assuming a
    /// normal distribution.
    pub sigma_mm: f64,
}

/// Minimum smoothing, even if none is requested.
const LEAST_LAMBDA: f64 = 1e-10;

/// Smoothing before the right amount is known: holes are bridged and outliers stand out, but bumps
/// as wide as a few intervals remain.
const FIRST_LAMBDA: f64 = 1e-5;

/// Rounds with Huber's weights: an outlier has no more influence than a point at the edge of the
/// others. The unweighted first fit may be off by a millimetre.
const HUBER_ROUNDS: usize = 2;

/// Rounds after them, in which outliers lose all weight.
const WHOLE_ROUNDS: usize = 2;

/// Rounds of choosing the smoothing when the weights stay 1.
const PLAIN_ROUNDS: usize = 1;

/// Minimum and maximum number of regions, along and around, that are checked for points. Between
/// these limits the number gives each region four points if they are spread evenly, so hardly any
/// region is empty by chance.
const REGIONS: [f64; 2] = [4.0, 24.0];

/// Share of regions that must hold a point. With a quarter of a leg missing, the rest is still reliable
/// and only the gap is invented; with half of it missing, most of the surface would be invented.
const SEEN_SHARE: f64 = 0.75;

/// How far rounding may put a point outside the domain, as a share of its length.
const ROUNDING: f64 = 1e-9;

/// Positions closer than this share of the domain count as one.
const LEAST_STEP: f64 = 1e-6;

/// Fits the surface over `along` (of z) and `around` (of v).
///
/// # Errors
/// A [`FitFault`]: a point or position that is not finite or lies outside the domain, different
/// lengths, fewer points than control points, fewer than 4 different heights or positions around,
/// more than a quarter of the surface without points, bases that do not form a surface.
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

/// The surface with these coefficients for x and y, and with z equal to u.
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

/// Refuses positions of which fewer than four are far enough apart to determine a slope despite
/// rounding.
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
