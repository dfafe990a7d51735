//! Smoothing fit of a scalar function: penalised weighted least squares, with standard errors.

use super::basis::{Basis, DEGREE};
use super::normal::{Design, NormalEquations, RIDGE, Solution};
use super::solve::{Singular, Skyline};

/// The smoothing of a fit.
///
/// The penalty is the integral of the squared second derivative: straight lines (constants if
/// periodic) cost nothing, and gaps in the data are bridged as by a thin beam. Its factor lambda is
/// dimensionless: 1 makes the penalty's trace equal to that of the data, so it depends neither on
/// the number or unit of the data nor on the unit of the knots.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Smoothing {
    /// Plain least squares. A lambda of 1e-12 remains as a ridge, so that coefficients are
    /// determined even in gaps of the data.
    None,
    /// This lambda, at least 0; the ridge is its minimum.
    Fixed(f64),
    /// The lambda with the smallest generalised cross-validation score (Craven, Wahba 1979).
    /// Correct for independent errors; correlated ones are treated as signal.
    Gcv,
}

/// A fitted scalar function and its accuracy.
#[derive(Debug, Clone)]
pub struct Spline {
    /// The basis of the fit.
    pub basis: Basis,
    /// One coefficient for each function of the basis, in the unit of the data.
    pub coefficients: Vec<f64>,
    /// The lambda used, including the ridge; at least 1e-12.
    pub lambda: f64,
    /// Effective degrees of freedom: trace of the matrix that maps data to fitted values.
    pub edf: f64,
    /// Standard deviation of a datum of weight 1, √(weighted RSS / (m − edf)) over the m data of
    /// positive weight. Infinite if the data leave less than half a degree of freedom.
    pub sigma: f64,
    /// Weighted share of the data's variance that is explained; 1 for constant data.
    pub r2: f64,
    /// Weighted root mean square of the residuals.
    pub rms: f64,
    /// The inverse of the normal matrix, for overlapping functions.
    inverse: Skyline,
}

/// Residuals with fewer degrees of freedom than this give no information about the data's errors.
const LEAST_FREEDOM: f64 = 0.5;

/// Why data cannot be fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitFault {
    /// The numbers of abscissae, values and weights must be equal.
    #[error("{x} abscissae, {y} values and {weights} weights; they must be as many")]
    LengthsDiffer {
        /// Number of abscissae.
        x: usize,
        /// Number of values.
        y: usize,
        /// Number of weights.
        weights: usize,
    },
    /// A grid must have a point for each row and column.
    #[error("{points} points do not make a grid of {along} rows and {around} columns")]
    NoGrid {
        /// Number of points.
        points: usize,
        /// Number of rows.
        along: usize,
        /// Number of columns.
        around: usize,
    },
    /// A datum is infinite or NaN.
    #[error("datum {index} is not finite")]
    NotFinite {
        /// 0-based index of the first such datum.
        index: usize,
    },
    /// A weight is negative.
    #[error("datum {index} has the negative weight {weight}")]
    NegativeWeight {
        /// 0-based index of the first such datum.
        index: usize,
        /// Its weight.
        weight: f64,
    },
    /// A datum lies outside the domain of a clamped basis.
    #[error("datum {index} at {x} lies outside the domain {from} to {to}")]
    OutsideDomain {
        /// 0-based index of the first such datum.
        index: usize,
        /// Its abscissa.
        x: f64,
        /// Start of the domain.
        from: f64,
        /// End of the domain.
        to: f64,
    },
    /// The data of positive weight have fewer distinct abscissae than one cubic piece needs.
    #[error("data at {found} different places; a fit needs at least {needed}")]
    TooFewPlaces {
        /// Number of distinct abscissae.
        found: usize,
        /// Number needed.
        needed: usize,
    },
    /// Two neighbouring rows or columns lie at the same parameter or have the same points.
    #[error("{lines} {first} and {second} are the same")]
    Coincident {
        /// "rows" or "columns".
        lines: &'static str,
        /// 0-based, the one with the lower parameter.
        first: usize,
        /// 0-based, the other.
        second: usize,
    },
    /// A direction has fewer distinct positions than requested control points.
    #[error("{found} places {direction} for {needed} control points")]
    FewerThanControlPoints {
        /// "along" or "around".
        direction: &'static str,
        /// Number of rows or columns.
        found: usize,
        /// Number of requested control points.
        needed: usize,
    },
    /// A range without data that is too wide to be bridged, or lies at an end of the domain.
    #[error(
        "no data {direction} from {from} to {to}, which leaves {functions} functions without any"
    )]
    Gap {
        /// "along" or "around".
        direction: &'static str,
        /// The last position before the widest range, or the domain's end.
        from: f64,
        /// The first position after it.
        to: f64,
        /// Functions of equal spans without a datum of their own.
        functions: usize,
    },
    /// A mark, which must become a knot, lies outside the domain or is NaN.
    #[error("the mark {mark} lies outside the domain {from} to {to}")]
    MarkOutside {
        /// The mark.
        mark: f64,
        /// Start of the domain.
        from: f64,
        /// End of the domain.
        to: f64,
    },
    /// The domain and the requested control points do not form a basis.
    #[error(transparent)]
    Basis(#[from] super::basis::BasisFault),
    /// A fixed lambda is negative or not finite.
    #[error("lambda is {lambda}; it must be finite and not negative")]
    BadLambda {
        /// The lambda given.
        lambda: f64,
    },
    /// The data leave the function undetermined, even with the ridge.
    #[error(transparent)]
    Singular(#[from] Singular),
    /// The bases do not form a surface.
    #[error(transparent)]
    Surface(#[from] super::surface::SurfaceFault),
}

/// Fits a spline to the data `(x[i], y[i])` with relative inverse variances `weights[i]`.
///
/// Order and spacing of the data do not matter; a periodic basis wraps `x`. Gaps are bridged by the
/// penalty, or by the ridge if there is no penalty. Normal equations: The NURBS Book 9.4;
/// generalised cross-validation: Craven, Wahba 1979.
///
/// # Errors
/// A [`FitFault`]: different lengths, data that are not finite or (clamped) outside the domain by
/// more than rounding, negative weights, a lambda below 0, data of positive weight at fewer than 4
/// distinct abscissae.
pub fn fit(
    basis: &Basis,
    x: &[f64],
    y: &[f64],
    weights: &[f64],
    smoothing: Smoothing,
) -> Result<Spline, FitFault> {
    check(basis, x, y, weights)?;
    let design = Design::new(basis, x);
    let equations = NormalEquations::new(&design, y, weights);
    let solution = match smoothing {
        Smoothing::None => equations.solution(RIDGE)?,
        Smoothing::Fixed(lambda) => equations.solution(ridged(lambda)?)?,
        Smoothing::Gcv => equations.best_by_gcv()?,
    };
    Ok(with_statistics(basis, y, weights, solution))
}

/// Raises a given lambda to at least the ridge.
pub(super) fn ridged(lambda: f64) -> Result<f64, FitFault> {
    let usable = lambda.is_finite() && lambda >= 0.0;
    if usable { Ok(lambda.max(RIDGE)) } else { Err(FitFault::BadLambda { lambda }) }
}

impl Spline {
    /// The function at `x`; see [`Basis::rows`] for `x` outside the domain.
    pub fn value(&self, x: f64) -> f64 {
        self.basis.row(x).dot(&self.coefficients)
    }

    /// The function and its first three derivatives at `x`.
    pub fn derivatives(&self, x: f64) -> [f64; 4] {
        self.basis.rows(x).map(|row| row.dot(&self.coefficients))
    }

    /// Standard error of the `derivative` (0 to 3; beyond that 0) of the function at `x`:
    /// σ √(bᵀ (BᵀWB + λR)⁻¹ b), the Bayesian form, which includes the smoothing bias on average
    /// (Wahba 1983, Silverman 1985). Infinite where `sigma` is. 16 products.
    pub fn sd(&self, x: f64, derivative: usize) -> f64 {
        let Some(row) = self.basis.rows(x).get(derivative).copied() else { return 0.0 };
        let mut variance = 0.0;
        for (i, a) in row.indices.into_iter().zip(row.values) {
            for (j, b) in row.indices.into_iter().zip(row.values) {
                variance += a * b * self.inverse.entry(i, j);
            }
        }
        self.sigma * variance.max(0.0).sqrt()
    }
}

/// Coefficient of determination from the sums of squared residuals, of squared deviations from the
/// mean, and of squared values; 1 if the values differ only by rounding.
pub fn r2(residuals: f64, deviations: f64, values: f64) -> f64 {
    const ROUNDING: f64 = 1e-18;
    if deviations > ROUNDING * values { 1.0 - residuals / deviations } else { 1.0 }
}

/// The spline of a solution, with its quality statistics.
pub(super) fn with_statistics(
    basis: &Basis,
    y: &[f64],
    weights: &[f64],
    solution: Solution,
) -> Spline {
    let Solution { lambda, coefficients, inverse, edf, rss } = solution;
    let total: f64 = weights.iter().sum();
    let data = weights.iter().filter(|weight| **weight > 0.0).count() as f64;
    let mean = y.iter().zip(weights).map(|(y, weight)| weight * y).sum::<f64>() / total;
    let spread: f64 = y.iter().zip(weights).map(|(y, weight)| weight * (y - mean).powi(2)).sum();
    // For an interpolation, m − edf consists only of rounding errors and the effect of the ridge.
    let freedom = data - edf;
    let sigma = if freedom > LEAST_FREEDOM { (rss / freedom).sqrt() } else { f64::INFINITY };
    // Values that differ only by rounding count as constant.
    let r2 = r2(rss, spread, mean * mean * total);
    let rms = (rss / total).sqrt();
    Spline { basis: basis.clone(), coefficients, lambda, edf, sigma, r2, rms, inverse }
}

pub(super) fn check(basis: &Basis, x: &[f64], y: &[f64], weights: &[f64]) -> Result<(), FitFault> {
    if x.len() != y.len() || x.len() != weights.len() {
        return Err(FitFault::LengthsDiffer { x: x.len(), y: y.len(), weights: weights.len() });
    }
    let finite = |i: usize| x[i].is_finite() && y[i].is_finite() && weights[i].is_finite();
    if let Some(index) = (0..x.len()).find(|i| !finite(*i)) {
        return Err(FitFault::NotFinite { index });
    }
    if let Some(index) = weights.iter().position(|weight| *weight < 0.0) {
        return Err(FitFault::NegativeWeight { index, weight: weights[index] });
    }
    let weighty = x.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
    check_places(basis, x, &weighty.map(|(x, _)| *x).collect::<Vec<_>>())
}

/// Refuses abscissae `x` outside a clamped domain, which would otherwise be silently moved to its
/// end, and data at fewer than 4 distinct abscissae: the ridge leaves lines undetermined here and
/// parabolas in [`crate::grid::given`], so the data must determine them.
pub(super) fn check_places(basis: &Basis, x: &[f64], weighty: &[f64]) -> Result<(), FitFault> {
    let (from, to) = basis.domain();
    let rounding = 1e-9 * (to - from);
    let outside = |x: &f64| *x < from - rounding || *x > to + rounding;
    if let Some(index) = x.iter().position(outside).filter(|_| !basis.is_periodic()) {
        return Err(FitFault::OutsideDomain { index, x: x[index], from, to });
    }
    let mut sorted = weighty.to_vec();
    sorted.sort_by(f64::total_cmp);
    // Abscissae closer than this cannot determine a slope despite rounding.
    sorted.dedup_by(|next, last| *next - *last < 1e-6 * (to - from));
    let (found, needed) = (sorted.len(), DEGREE + 1);
    if found < needed { Err(FitFault::TooFewPlaces { found, needed }) } else { Ok(()) }
}
