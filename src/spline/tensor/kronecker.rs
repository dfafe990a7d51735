//! Smoothing on a full grid of cells, one small eigenproblem per direction: as
//! `grid/cross_validation`, with the two penalties added instead of multiplied.
//!
//! With A, B the basis matrices of the cells' rows and columns, generalised eigenvectors U of (R,
//! AᵀA) make AᵀA the identity and the roughness R diagonal. Then a fit with any pair of lambdas
//! takes only a division, and so do its degrees of freedom and its residual.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::spline::basis::Basis;
use crate::spline::penalty::roughness;
use crate::spline::solve::Singular;

/// The derivative whose square is penalised.
const PENALISED: usize = 2;

/// Added to the diagonal of a Gram matrix, relative to its mean, so that a range without cells does
/// not make it singular.
const RIDGE: f64 = 1e-9;

/// Exponents of ten of the lambdas that are tried, in half decades relative to the median eigenvalue,
/// along and around. At 0 the middle of the basis is halved; with much less smoothing around, a range
/// without data oscillates instead of being bridged, and its equations are close to singular.
const SEARCH_HALVES: [std::ops::RangeInclusive<i32>; 2] = [-2..=10, -1..=10];

/// One direction of the grid.
#[derive(Debug, Clone)]
pub struct Direction {
    /// Basis values at the cells' middles, cells × functions.
    pub design: DMatrix<f64>,
    /// Generalised eigenvectors, functions × functions: UᵀAᵀA U = 1, UᵀR U = diag(eigenvalues).
    pub vectors: DMatrix<f64>,
    /// Their transpose, stored so that products with it are fast.
    pub vectors_transposed: DMatrix<f64>,
    /// Roughness of each eigenvector, at least 0.
    pub eigenvalues: Vec<f64>,
    /// Gram matrix AᵀA with its ridge.
    pub gram: DMatrix<f64>,
    /// Roughness matrix.
    pub roughness: DMatrix<f64>,
}

impl Direction {
    /// The direction of a basis with cells at `middles`.
    ///
    /// # Errors
    /// [`Singular`] if the cells leave the basis undetermined.
    pub fn new(basis: &Basis, middles: &[f64]) -> Result<Direction, Singular> {
        let count = basis.count();
        let design = basis.design(middles);
        let rough = roughness(basis, PENALISED).dense();
        let mut gram = design.tr_mul(&design);
        let ridge = RIDGE * gram.trace() / count as f64;
        (0..count).for_each(|i| gram[(i, i)] += ridge);
        let singular = Singular { row: 0, relative_pivot: 0.0 };
        let factor = gram.clone().cholesky().ok_or(singular.clone())?;
        let inverse = factor.l().try_inverse().ok_or(singular)?;
        let eigen = SymmetricEigen::new(&inverse * &rough * inverse.transpose());
        let vectors = inverse.transpose() * &eigen.eigenvectors;
        let eigenvalues = eigen.eigenvalues.iter().map(|value| value.max(0.0)).collect();
        let vectors_transposed = vectors.transpose();
        Ok(Direction { design, vectors, vectors_transposed, eigenvalues, gram, roughness: rough })
    }

    /// The unit of lambda in the search: one over the median positive eigenvalue.
    pub fn unit(&self) -> f64 {
        let largest = self.eigenvalues.iter().copied().fold(0.0, f64::max);
        let mut positive: Vec<f64> =
            self.eigenvalues.iter().copied().filter(|value| *value > 1e-9 * largest).collect();
        positive.sort_by(f64::total_cmp);
        positive.get(positive.len() / 2).map_or(1.0, |median| 1.0 / median)
    }
}

/// The pair of lambdas with the smallest generalised cross-validation score for values on the
/// grid's cells, of which `seen` have data. Returns it with the degrees of freedom of that fit.
pub fn best_by_gcv(
    along: &Direction,
    around: &Direction,
    cells: &DMatrix<f64>,
    seen: usize,
) -> ([f64; 2], f64) {
    let projected =
        (&along.design * &along.vectors).tr_mul(cells) * &around.design * &around.vectors;
    let outside = cells.norm_squared() - projected.norm_squared();
    let height = along.eigenvalues.len();
    let score = |lambdas: [f64; 2]| {
        // Several sums in parallel, because a single one would wait for itself at every term.
        let (mut lost, mut kept) = (vec![0.0; height], vec![0.0; height]);
        for (rough_b, sizes) in around.eigenvalues.iter().zip(projected.as_slice().chunks(height)) {
            let base = 1.0 + lambdas[1] * rough_b;
            let sums = lost.iter_mut().zip(&mut kept);
            for (((lost, kept), rough_a), size) in sums.zip(&along.eigenvalues).zip(sizes) {
                let share = 1.0 / (base + lambdas[0] * rough_a);
                *lost += (size * (1.0 - share)).powi(2);
                *kept += share;
            }
        }
        let (rss, edf) = (outside.max(0.0) + lost.iter().sum::<f64>(), kept.iter().sum::<f64>());
        let freedom = (seen as f64 - edf).max(1e-3 * seen as f64);
        (rss / (freedom * freedom), edf)
    };
    let units = [along.unit(), around.unit()];
    let lambdas = |exponents: [f64; 2]| [0, 1].map(|d| units[d] * 10.0_f64.powf(exponents[d]));
    let judged = |exponents: [f64; 2]| (score(lambdas(exponents)).0, exponents);
    let better = |a: &(f64, [f64; 2]), b: &(f64, [f64; 2])| a.0.total_cmp(&b.0);
    let halves = |d: usize| SEARCH_HALVES[d].clone().map(|half| 0.5 * f64::from(half));
    let coarse = halves(0).flat_map(|a| halves(1).map(move |b| [a, b]));
    let mut best = coarse.map(judged).min_by(better).map_or([0.0; 2], |(_, best)| best);
    let least = [0, 1].map(|d: usize| 0.5 * f64::from(*SEARCH_HALVES[d].start()));
    for step in [0.25, 0.125] {
        let offsets = [-step, 0.0, step];
        let near = offsets.into_iter().flat_map(|a| offsets.map(|b| [best[0] + a, best[1] + b]));
        let near = near.map(|[a, b]| [a.max(least[0]), b.max(least[1])]);
        best = near.map(judged).min_by(better).map_or(best, |(_, best)| best);
    }
    let best = lambdas(best);
    (best, score(best).1)
}
