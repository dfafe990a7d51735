//! Smoothing of a grid by generalised cross-validation, one small eigenproblem per direction.
//!
//! With A, B the basis matrices of the rows and columns, the fit is C = (AᵀA + λa Ra)⁻¹ Aᵀ P B (BᵀB +
//! λb Rb)⁻¹. Generalised eigenvectors make AᵀA the identity and Ra diagonal, so that for any pair of
//! lambdas the fit, its degrees of freedom and its residual take only divisions.
//! Source of the score: Craven, Wahba 1979.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::basis::Basis;
use crate::least_squares::PENALISED;
use crate::normal::RIDGE;
use crate::penalty::roughness;
use crate::solve::Singular;

/// Added to the diagonal of a Gram matrix, relative to its mean.
const GRAM_RIDGE: f64 = 1e-11;

/// Range of the exponents of ten of the lambdas that are tried, relative to the median roughness,
/// and their number.
const SEARCH: [f64; 2] = [-7.0, 4.0];
const TRIED: usize = 25;

/// A roughness below this share of the largest is zero except for rounding.
const SMOOTH: f64 = 1e-9;

/// A direction of the grid.
#[derive(Debug, Clone)]
pub struct Spectrum {
    /// Orthonormal combinations of the basis functions' values, places × functions.
    combinations: DMatrix<f64>,
    /// Roughness of each combination, in the unit of [`crate::least_squares::LeastSquares`].
    roughness: Vec<f64>,
}

impl Spectrum {
    /// The spectrum for data at `places`.
    ///
    /// # Errors
    /// [`Singular`] if the positions leave the basis undetermined.
    pub fn new(basis: &Basis, places: &[f64]) -> Result<Spectrum, Singular> {
        let count = basis.count();
        let design = basis.design(places);
        let mut gram = design.tr_mul(&design);
        let trace = gram.trace();
        (0..count).for_each(|i| gram[(i, i)] += GRAM_RIDGE * trace / count as f64);
        let rough = roughness(basis, PENALISED);
        let scale = trace / rough.trace();
        let singular = Singular { row: 0, relative_pivot: 0.0 };
        let lower = gram.cholesky().ok_or(singular.clone())?.l();
        let inverse = lower.try_inverse().ok_or(singular)?;
        let eigen = SymmetricEigen::new(&inverse * rough.dense() * inverse.transpose());
        let roughness = eigen.eigenvalues.iter().map(|value| scale * value.max(0.0)).collect();
        let combinations = design * inverse.transpose() * eigen.eigenvectors;
        Ok(Spectrum { combinations, roughness })
    }

    /// The lambdas to try: only the ridge, then increasing values.
    fn lambdas(&self) -> Vec<f64> {
        let largest = self.roughness.iter().copied().fold(0.0, f64::max);
        let mut positive: Vec<f64> =
            self.roughness.iter().copied().filter(|rough| *rough > SMOOTH * largest).collect();
        positive.sort_by(f64::total_cmp);
        let median = positive.get(positive.len() / 2).copied().unwrap_or(1.0);
        let [from, to] = SEARCH;
        let exponent = |i: usize| from + (to - from) * i as f64 / (TRIED - 1) as f64;
        let tried = (0..TRIED).map(|i| 10.0_f64.powf(exponent(i)) / median);
        [RIDGE].into_iter().chain(tried.map(|lambda| lambda.max(RIDGE))).collect()
    }

    /// The share that each combination keeps at a lambda.
    fn kept(&self, lambda: f64) -> Vec<f64> {
        self.roughness.iter().map(|rough| 1.0 / (1.0 + lambda * rough)).collect()
    }
}

/// A choice of smoothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothest {
    /// Lambdas along and around.
    pub lambdas: [f64; 2],
    /// Effective degrees of freedom of the fit with them.
    pub edf: f64,
}

/// The pair of lambdas with the smallest score RSS / (m − edf)² for a grid of xyz triples, row-major.
pub fn best_by_gcv([along, around]: &[Spectrum; 2], values: &[f64]) -> Smoothest {
    let (rows, columns) = (along.combinations.nrows(), around.combinations.nrows());
    let data = (rows * columns) as f64;
    let (mut energy, mut outside) =
        (DMatrix::zeros(along.roughness.len(), around.roughness.len()), 0.0);
    for axis in 0..3 {
        let at = |i: usize, j: usize| values[3 * (i * columns + j) + axis];
        // Without the mean, so that a large offset does not hide small residuals.
        let mean = (0..rows * columns).map(|i| values[3 * i + axis]).sum::<f64>() / data;
        let grid = DMatrix::from_fn(rows, columns, |i, j| at(i, j) - mean);
        let projected = along.combinations.tr_mul(&grid) * &around.combinations;
        outside += grid.norm_squared() - projected.norm_squared();
        energy += projected.map(|value| value * value);
    }
    let score = |lambdas: [f64; 2]| {
        let (kept_along, kept_around) = (along.kept(lambdas[0]), around.kept(lambdas[1]));
        let edf = kept_along.iter().sum::<f64>() * kept_around.iter().sum::<f64>();
        let mut rss = outside.max(0.0);
        for (b, kept_b) in kept_around.iter().enumerate() {
            for (a, kept_a) in kept_along.iter().enumerate() {
                rss += energy[(a, b)] * (1.0 - kept_a * kept_b).powi(2);
            }
        }
        (rss / (data - edf).powi(2), Smoothest { lambdas, edf })
    };
    let around_lambdas = around.lambdas();
    let pairs = along.lambdas().into_iter();
    let pairs = pairs.flat_map(|a| around_lambdas.iter().map(move |b| [a, *b]));
    let scored = pairs.map(score).filter(|(score, _)| score.is_finite());
    let best = scored.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or_else(|| score([RIDGE; 2]).1, |(_, best)| best)
}
