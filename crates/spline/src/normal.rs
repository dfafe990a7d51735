//! The normal equations of a scalar fit, their solution at a given lambda, and the lambda with the
//! smallest generalised cross-validation score.

use std::collections::BTreeMap;

use super::basis::{Basis, Row};
use super::integrals::roughness;
use super::solve::trial::Trials;
use super::solve::{Cholesky, Singular, Skyline};

/// The relative lambda that remains if nothing is to be smoothed.
pub const RIDGE: f64 = 1e-12;

/// The derivative whose square is penalised.
const PENALISED: usize = 2;

/// The exponents of the lambdas that the search tries first, in half decades, from the ridge to
/// where even one wave around 60 intervals is flattened.
const SEARCH_HALF_DECADES: std::ops::RangeInclusive<i32> = -24..=16;

/// How often the search halves its step around the best lambda; the final step is 10^(1/16).
const SEARCH_HALVINGS: i32 = 3;

/// The score is meaningless if the fit nearly interpolates: at least this share of the data must
/// remain as degrees of freedom.
const LEAST_FREEDOM: f64 = 0.1;

/// The data's positions in terms of a basis; usable for any values and weights there.
pub struct Design {
    rows: Vec<Row>,
    /// The zero matrix of the basis.
    zero: Skyline,
    roughness: Skyline,
}

impl Design {
    /// The design for data at `x`, all of them finite.
    pub fn new(basis: &Basis, x: &[f64]) -> Design {
        Design {
            rows: x.iter().map(|x| basis.row(*x)).collect(),
            zero: Skyline::zero(basis),
            roughness: roughness(basis, PENALISED),
        }
    }

    /// The values of a spline with these coefficients at the data's positions.
    pub fn values(&self, coefficients: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|row| row.dot(coefficients)).collect()
    }
}

/// Weighted data in terms of a basis.
pub struct NormalEquations<'a> {
    design: &'a Design,
    y: &'a [f64],
    weights: &'a [f64],
    /// BᵀWB.
    gram: Skyline,
    /// BᵀWy.
    moments: Vec<f64>,
    /// The roughness matrix, scaled to the trace of `gram`.
    penalty: Skyline,
}

/// The fit at one lambda.
pub struct Solution {
    /// The relative lambda.
    pub lambda: f64,
    /// The coefficients.
    pub coefficients: Vec<f64>,
    /// The inverse of the normal matrix, for overlapping functions.
    pub inverse: Skyline,
    /// Effective degrees of freedom.
    pub edf: f64,
    /// Weighted sum of the squared residuals.
    pub rss: f64,
}

impl<'a> NormalEquations<'a> {
    /// The equations for one of `y` and `weights` per position of the design. All must be finite,
    /// and at least one weight positive.
    pub fn new(design: &'a Design, y: &'a [f64], weights: &'a [f64]) -> Self {
        let mut gram = design.zero.clone();
        let mut moments = vec![0.0; gram.size()];
        for ((row, y), weight) in design.rows.iter().zip(y).zip(weights) {
            gram.add_square(row, *weight);
            for (index, value) in row.indices.into_iter().zip(row.values) {
                moments[index] += weight * value * y;
            }
        }
        let scale = gram.trace() / design.roughness.trace();
        let penalty = design.zero.plus(scale, &design.roughness);
        NormalEquations { design, y, weights, gram, moments, penalty }
    }

    /// The factor and the coefficients at `lambda`, without the statistics needed to judge them.
    pub fn solved(&self, lambda: f64) -> Result<(Cholesky, Vec<f64>), Singular> {
        let factor = self.gram.plus(lambda, &self.penalty).factor()?;
        let mut coefficients = self.moments.clone();
        factor.solve(&mut coefficients, 1);
        Ok((factor, coefficients))
    }

    /// The fit at `lambda`.
    pub fn solution(&self, lambda: f64) -> Result<Solution, Singular> {
        let (factor, coefficients) = self.solved(lambda)?;
        let inverse = factor.into_inverse();
        let edf = inverse.trace_of_product(&self.gram);
        let rss = self.rss(&coefficients);
        Ok(Solution { lambda, coefficients, inverse, edf, rss })
    }

    /// The weighted sum of the squared residuals. Summed over the data: the quadratic form of the normal
    /// equations would lose a small sum to cancellation.
    fn rss(&self, coefficients: &[f64]) -> f64 {
        let squares = self.design.rows.iter().zip(self.y).zip(self.weights);
        let left = |((row, y), w): ((&Row, &f64), &f64)| w * (y - row.dot(coefficients)).powi(2);
        squares.map(left).sum()
    }

    /// The fit with the smallest score RSS / (m − edf)² (Craven, Wahba 1979).
    pub fn best_by_gcv(&self) -> Result<Solution, Singular> {
        let data = self.weights.iter().filter(|weight| **weight > 0.0).count() as f64;
        let mut trials = Trials::new(&self.gram, &self.penalty, &self.moments);
        let mut tried = |exponent: f64| {
            let lambda = 10.0_f64.powf(exponent);
            let (rss, edf) = match &mut trials {
                Some(trials) => trials.at(lambda).map(|(at, edf)| (self.rss(at), edf))?,
                None => self.solution(lambda).map(|solution| (solution.rss, solution.edf)).ok()?,
            };
            Some(Tried { exponent, rss, edf, score: score(rss, edf, data) })
        };
        let Some(mut best) = best_of_halves(&mut tried, data) else {
            // Every lambda leaves too few degrees of freedom, so the smoothest fit is used.
            return self.solution(10.0_f64.powf(0.5 * f64::from(*SEARCH_HALF_DECADES.end())));
        };
        for halving in 1..=SEARCH_HALVINGS {
            let step = 0.5 * 0.5_f64.powi(halving);
            let exponents = [best.exponent - step, best.exponent + step];
            let nearby = exponents.into_iter().filter_map(&mut tried);
            let better = |a: &Tried, b: &Tried| a.score.total_cmp(&b.score);
            if let Some(found) = nearby.min_by(better).filter(|found| found.score < best.score) {
                best = found;
            }
        }
        self.solution(10.0_f64.powf(best.exponent))
    }
}

/// One of the lambdas that were tried.
#[derive(Debug, Clone, Copy)]
struct Tried {
    /// Exponent of ten.
    exponent: f64,
    /// Weighted sum of the squared residuals.
    rss: f64,
    /// Effective degrees of freedom.
    edf: f64,
    /// Infinite if meaningless.
    score: f64,
}

/// The score of a fit to this number of data; infinite if it leaves too few degrees of freedom.
fn score(rss: f64, edf: f64, data: f64) -> f64 {
    let freedom = data - edf;
    if freedom < LEAST_FREEDOM * data {
        return f64::INFINITY;
    }
    rss / (freedom * freedom)
}

/// The fit with the smallest score among the lambdas of [`SEARCH_HALF_DECADES`], the smallest
/// lambda among equal scores; `None` if all scores are meaningless.
///
/// Both the residuals and the remaining degrees of freedom grow with lambda. So no score between
/// two lambdas is below the residuals at the lower one divided by the squared freedom at the higher
/// one, and most lambdas need not be tried.
fn best_of_halves(tried: &mut impl FnMut(f64) -> Option<Tried>, data: f64) -> Option<Tried> {
    let mut at = |half: i32| tried(0.5 * f64::from(half));
    let (from, to) = SEARCH_HALF_DECADES.into_inner();
    let mut known: BTreeMap<i32, Option<Tried>> = [(from, at(from)), (to, at(to))].into();
    let mut open = vec![[from, to]];
    while let Some([low, high]) = open.pop() {
        let of = |half: i32| known.get(&half).and_then(Option::as_ref);
        let best = known.values().flatten().map(|tried| tried.score).fold(f64::INFINITY, f64::min);
        let least = match (of(low), of(high)) {
            (Some(low), Some(high)) => {
                let freedom = data - high.edf;
                low.rss / (freedom * freedom)
            }
            // There is no lower bound next to a system that cannot be solved.
            _ => 0.0,
        };
        if high - low < 2 || least > best {
            continue;
        }
        let middle = low.midpoint(high);
        known.insert(middle, at(middle));
        open.extend([[low, middle], [middle, high]]);
    }
    let scored = known.into_values().flatten().filter(|tried| tried.score.is_finite());
    scored.min_by(|a, b| a.score.total_cmp(&b.score))
}
