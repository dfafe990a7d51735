//! Smoothing on a full grid of cells, one small eigenproblem per direction: as
//! `grid/cross_validation`, with the two penalties added instead of multiplied.
//!
//! With A, B the basis matrices of the cells' rows and columns, generalised eigenvectors U of (R,
//! AᵀA) make AᵀA the identity and the roughness R diagonal. Then a fit with any pair of lambdas
//! takes only a division, and so do its degrees of freedom and its residual.

use nalgebra::{DMatrix, SymmetricEigen};

use super::circle::Circle;
use crate::spline::basis::Basis;
use crate::spline::penalty::roughness;
use crate::spline::solve::Singular;

/// The derivative whose square is penalised.
pub const PENALISED: usize = 2;

/// Added to the diagonal of a Gram matrix, relative to its mean, so that a range without cells does
/// not make it singular.
pub const RIDGE: f64 = 1e-9;

/// Exponents of ten of the lambdas that are tried, in half decades relative to the median eigenvalue,
/// along and around. At 0 the middle of the basis is halved; with much less smoothing around, a range
/// without data oscillates instead of being bridged, and its equations are close to singular.
const SEARCH_HALVES: [std::ops::RangeInclusive<i32>; 2] = [-2..=10, -1..=10];

/// The direction along.
#[derive(Debug, Clone)]
pub struct Direction {
    /// Basis values at the cells' middles, cells × functions.
    pub design: DMatrix<f64>,
    /// Generalised eigenvectors, functions × functions: UᵀAᵀA U = 1, UᵀR U = diag(eigenvalues).
    pub vectors: DMatrix<f64>,
    /// Roughness of each eigenvector, at least 0.
    pub eigenvalues: Vec<f64>,
    /// Gram matrix AᵀA with its ridge.
    pub gram: DMatrix<f64>,
    /// Roughness matrix.
    pub roughness: DMatrix<f64>,
    /// The eigenvectors at the cells' middles, cells × functions.
    at_cells: DMatrix<f64>,
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
        let at_cells = &design * &vectors;
        Ok(Direction { design, vectors, eigenvalues, gram, roughness: rough, at_cells })
    }

    /// See [`unit`].
    pub fn unit(&self) -> f64 {
        unit(self.eigenvalues.iter().copied())
    }
}

/// The smoothing around: for each wave number, how much of a wave the cells see, and its roughness.
#[derive(Debug, Clone)]
pub struct Around {
    /// The Gram matrix's eigenvalue.
    pub gram: Vec<f64>,
    /// Roughness relative to that, at least 0.
    pub eigenvalues: Vec<f64>,
    /// The share of a wave that its values in the middles of the pieces show; the rest is the ridge.
    seen: Vec<f64>,
    /// Number of waves with this number.
    multiplicities: Vec<usize>,
}

impl Around {
    /// The waves of a circle.
    pub fn new(circle: &Circle) -> Around {
        let gram = circle.eigenvalues(&circle.gram);
        let rough = circle.eigenvalues(&circle.roughness);
        let eigenvalues = rough.iter().zip(&gram).map(|(rough, gram)| (rough / gram).max(0.0));
        let ridge = RIDGE / (1.0 + RIDGE) * circle.gram[0];
        Around {
            eigenvalues: eigenvalues.collect(),
            seen: gram.iter().map(|gram| (1.0 - ridge / gram).max(0.0)).collect(),
            multiplicities: (0..gram.len()).map(|k| circle.multiplicity(k)).collect(),
            gram,
        }
    }

    /// See [`unit`].
    pub fn unit(&self) -> f64 {
        let waves = self.eigenvalues.iter().zip(&self.multiplicities);
        unit(waves.flat_map(|(value, count)| std::iter::repeat_n(*value, *count)))
    }
}

/// The unit of lambda in the search: one over the median positive eigenvalue.
fn unit(eigenvalues: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = eigenvalues.clone().fold(0.0, f64::max);
    let mut positive: Vec<f64> = eigenvalues.filter(|value| *value > 1e-9 * largest).collect();
    positive.sort_by(f64::total_cmp);
    positive.get(positive.len() / 2).map_or(1.0, |median| 1.0 / median)
}

/// Values on the grid's cells, as far as a fit with any lambdas depends on them.
struct Projected {
    /// For each wave number, and each eigenvector along, the square of its part in the values.
    squares: Vec<Vec<f64>>,
    /// The square of what no function of the basis has.
    outside: f64,
}

impl Projected {
    /// The parts of cells, around × along.
    fn of(cells: &DMatrix<f64>, along: &Direction, around: &Around, circle: &Circle) -> Projected {
        let waves = circle.waves(&(cells * &along.at_cells));
        let (half, frequencies) = (circle.count() / 2, around.seen.len());
        let mut squares = vec![vec![0.0; waves.ncols()]; frequencies];
        for (place, wave) in waves.column_iter().enumerate() {
            for (row, value) in wave.iter().enumerate() {
                let frequency = if row < frequencies { row } else { row - half };
                squares[frequency][place] += around.seen[frequency] * value * value;
            }
        }
        let inside: f64 = squares.iter().flatten().sum();
        Projected { squares, outside: (cells.norm_squared() - inside).max(0.0) }
    }
}

/// The pair of lambdas with the smallest generalised cross-validation score for values on the
/// grid's cells (around × along), of which `seen` have data. Returns it with the degrees of freedom of
/// that fit.
pub fn best_by_gcv(
    along: &Direction,
    around: &Around,
    circle: &Circle,
    cells: &DMatrix<f64>,
    seen: usize,
) -> ([f64; 2], f64) {
    let Projected { squares, outside } = Projected::of(cells, along, around, circle);
    let height = along.eigenvalues.len();
    let score = |lambdas: [f64; 2]| {
        // Several sums in parallel, because a single one would wait for itself at every term.
        let (mut lost, mut kept) = (vec![0.0; height], vec![0.0; height]);
        let waves = around.eigenvalues.iter().zip(&around.multiplicities);
        for ((rough_b, count), squares) in waves.zip(&squares) {
            let (base, count) = (1.0 + lambdas[1] * rough_b, *count as f64);
            let sums = lost.iter_mut().zip(&mut kept);
            for (((lost, kept), rough_a), square) in sums.zip(&along.eigenvalues).zip(squares) {
                let share = 1.0 / (base + lambdas[0] * rough_a);
                *lost += square * (1.0 - share) * (1.0 - share);
                *kept += count * share;
            }
        }
        let (rss, edf) = (outside + lost.iter().sum::<f64>(), kept.iter().sum::<f64>());
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
