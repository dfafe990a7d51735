//! Smoothing on a full grid of cells by generalised cross-validation, one small eigenproblem per
//! direction; the penalties of the two directions are added.
//!
//! With A, B the basis matrices of the cells' rows and columns, generalised eigenvectors U of (R,
//! AᵀA) make AᵀA the identity and the roughness R diagonal. Then a fit with any pair of lambdas
//! takes only a division, and so do its degrees of freedom and its residual.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use nalgebra::{DMatrix, SymmetricEigen};

use super::circle::{Circle, PENALISED, RIDGE};
use crate::basis::Basis;
use crate::integrals::roughness;
use crate::solve::Singular;

/// Exponents of ten of the lambdas that are tried, in half decades relative to the median eigenvalue,
/// along and around. At 0 the middle of the basis is halved; with much less smoothing around, a range
/// without data oscillates instead of being bridged, and its equations are close to singular.
const SEARCH_HALVES: [RangeInclusive<i32>; 2] = [-2..=10, -1..=10];

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

/// What a fit with any lambdas depends on of values on the grid's cells, around × along: for each wave number, and
/// each eigenvector along, the square of its part in them.
fn squared_parts(
    cells: &DMatrix<f64>,
    along: &Direction,
    around: &Around,
    circle: &Circle,
) -> Vec<Vec<f64>> {
    let waves = circle.waves(&(cells * &along.at_cells));
    let (half, frequencies) = (circle.count() / 2, around.seen.len());
    let mut squares = vec![vec![0.0; waves.ncols()]; frequencies];
    for (place, wave) in waves.column_iter().enumerate() {
        for (row, value) in wave.iter().enumerate() {
            let frequency = if row < frequencies { row } else { row - half };
            squares[frequency][place] += around.seen[frequency] * value * value;
        }
    }
    squares
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
    let squares = squared_parts(cells, along, around, circle);
    // The square of what no function of the basis has.
    let outside = (cells.norm_squared() - squares.iter().flatten().sum::<f64>()).max(0.0);
    let height = along.eigenvalues.len();
    let fitted = |lambdas: [f64; 2]| {
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
        (outside + lost.iter().sum::<f64>(), kept.iter().sum::<f64>())
    };
    let units = [along.unit(), around.unit()];
    let lambdas = |exponents: [f64; 2]| [0, 1].map(|d| units[d] * 10.0_f64.powf(exponents[d]));
    let tried = |exponents: [f64; 2]| {
        let (rss, edf) = fitted(lambdas(exponents));
        Tried { exponents, score: rss / freedom(seen, edf).powi(2), rss, edf }
    };
    let mut best = best_of_halves(&|halves| tried(halves.map(|half| 0.5 * f64::from(half))), seen);
    let least = [0, 1].map(|d: usize| 0.5 * f64::from(*SEARCH_HALVES[d].start()));
    for step in [0.25, 0.125] {
        let offsets = [-step, 0.0, step];
        let [a, b] = best.exponents;
        let near = offsets.into_iter().flat_map(|da| offsets.map(|db| [a + da, b + db]));
        let near = near.map(|[a, b]| [a.max(least[0]), b.max(least[1])]);
        best = near.map(tried).min_by(Tried::better).unwrap_or(best);
    }
    (lambdas(best.exponents), best.edf)
}

/// A pair of lambdas that was tried.
#[derive(Debug, Clone, Copy)]
struct Tried {
    /// Exponents of ten, relative to the units.
    exponents: [f64; 2],
    score: f64,
    rss: f64,
    edf: f64,
}

impl Tried {
    fn better(&self, other: &Tried) -> std::cmp::Ordering {
        self.score.total_cmp(&other.score)
    }
}

/// The pair of half decades with the smallest score, of `seen` cells with data.
///
/// Residuals grow with both lambdas, and so do the remaining degrees of freedom. So no score within a range
/// of pairs is below the residuals at its lower end divided by the squared freedom at its upper end, and most
/// pairs need not be tried.
fn best_of_halves(tried: &impl Fn([i32; 2]) -> Tried, seen: usize) -> Tried {
    let [(a0, a1), (b0, b1)] = SEARCH_HALVES.map(RangeInclusive::into_inner);
    let mut known: BTreeMap<[i32; 2], Tried> = BTreeMap::new();
    let mut best = tried([a0, b0]);
    known.insert([a0, b0], best);
    let mut open = vec![[[a0, b0], [a1, b1]]];
    while let Some([low, high]) = open.pop() {
        let [at_low, at_high] = [low, high].map(|at| *known.entry(at).or_insert_with(|| tried(at)));
        for found in [at_low, at_high] {
            best = if found.score < best.score { found } else { best };
        }
        let least = at_low.rss / freedom(seen, at_high.edf).powi(2);
        let lengths = [0, 1].map(|d: usize| high[d] - low[d]);
        let longer = usize::from(lengths[1] > lengths[0]);
        if least > best.score || lengths[longer] == 0 {
            continue;
        }
        // Two parts that share no pair.
        let middle = low[longer] + lengths[longer] / 2;
        let (mut end, mut start) = (high, low);
        (end[longer], start[longer]) = (middle, middle + 1);
        open.extend([[start, high], [low, end]]);
    }
    best
}

/// The degrees of freedom that are left; a fit that nearly interpolates has a share of a thousandth.
fn freedom(seen: usize, edf: f64) -> f64 {
    (seen as f64 - edf).max(1e-3 * seen as f64)
}
