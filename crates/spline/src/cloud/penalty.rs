//! The smoothing of a cloud fit along and around, and its choice by generalised cross-validation.
//!
//! The penalty is λu Ru ⊗ Mv + λv Mu ⊗ Rv, where R is the roughness and M the Gram matrix over the
//! domain. Generalised eigenvectors of (R, M) make it diagonal and, if points are spread evenly,
//! the data's own matrix too. Then a fit with any pair of lambdas takes only a division, and so do
//! its degrees of freedom and its residual.

use nalgebra::{DMatrix, SymmetricEigen};

use super::banded::{Banded, BandedCholesky};
use super::equations::CloudEquations;
use crate::basis::{Basis, DEGREE};
use crate::penalty::{mass, roughness};
use crate::solve::{Singular, Skyline};

/// The derivative whose square is penalised.
const PENALISED: usize = 3;

/// Exponents of ten of the lambdas that the search tries first, both along and around: from hardly
/// more than the ridge to where only the slowest waves remain.
const SEARCH_DECADES: std::ops::RangeInclusive<i32> = -9..=1;

/// One direction of the penalty.
#[derive(Debug, Clone)]
struct Direction {
    periodic: bool,
    mass: Skyline,
    rough: Skyline,
    /// Generalised eigenvectors U: Uᵀ M U = 1, Uᵀ R U = diag(eigenvalues).
    vectors: DMatrix<f64>,
    /// Uᵀ M, their inverse.
    inverse: DMatrix<f64>,
    /// Roughness of each eigenvector, scaled by tr M / tr R so that lambda is dimensionless.
    eigenvalues: Vec<f64>,
    /// tr M / tr R.
    unit: f64,
    length: f64,
}

/// The penalty of a cloud fit in both directions.
#[derive(Debug, Clone)]
pub struct Penalty {
    directions: [Direction; 2],
    /// Share of the surface with data.
    seen: f64,
}

impl Penalty {
    /// The penalty for surfaces in these bases, with data on a share `seen` of the surface.
    ///
    /// # Errors
    /// [`Singular`] if a basis' functions are indistinguishable in double precision.
    pub fn new(along: &Basis, around: &Basis, seen: f64) -> Result<Penalty, Singular> {
        Ok(Penalty { directions: [Direction::new(along)?, Direction::new(around)?], seen })
    }

    /// Factors the equations with the penalty.
    ///
    /// # Errors
    /// [`Singular`] if data and penalty leave coefficients undetermined.
    pub fn factor(
        &self,
        equations: &CloudEquations,
        lambdas: [f64; 2],
    ) -> Result<BandedCholesky, Singular> {
        let mut system = equations.gram.clone();
        self.add_to(&mut system, lambdas, equations.weight);
        system.factor()
    }

    /// Adds the penalty to equations of data with this total weight. A lambda of 1 makes the traces
    /// equal if the data are spread evenly.
    fn add_to(&self, system: &mut Banded, lambdas: [f64; 2], weight: f64) {
        let density = self.density(weight);
        let [along, around] = &self.directions;
        let [rows, columns] = [along.mass.size(), around.mass.size()];
        let factors = [lambdas[0] * along.unit, lambdas[1] * around.unit].map(|f| density * f);
        for i in 0..rows {
            for other_i in i.saturating_sub(DEGREE)..=i {
                let rough = factors[0] * along.rough.entry(i, other_i);
                let mass = factors[1] * along.mass.entry(i, other_i);
                for j in 0..columns {
                    for other_j in around.neighbours(j).filter(|k| other_i < i || *k <= j) {
                        let value = rough * around.mass.entry(j, other_j)
                            + mass * around.rough.entry(j, other_j);
                        system.add(i * columns + j, other_i * columns + other_j, value);
                    }
                }
            }
        }
    }

    /// The pair of lambdas with the smallest score.
    ///
    /// `coefficients` are any fit of these equations, with the weighted sum of squares `rss`. Where
    /// there are no points, the fit replaces them.
    pub fn best_by_gcv(
        &self,
        equations: &CloudEquations,
        coefficients: &[[f64; 2]],
        rss: f64,
    ) -> [f64; 2] {
        let (power, outside) = self.spectrum(equations, coefficients, rss);
        let score = |lambdas: [f64; 2]| {
            let (mut lost, mut edf) = (0.0, 0.0);
            self.each_kept(lambdas, |place, kept| {
                lost += power[place] * (1.0 - kept) * (1.0 - kept);
                edf += kept;
            });
            let freedom = (equations.weight - edf).max(1e-3 * equations.weight);
            (outside + lost) / (freedom * freedom)
        };
        let lambdas = |exponents: [f64; 2]| exponents.map(|e| 10.0_f64.powf(e));
        let judged = |exponents: [f64; 2]| (score(lambdas(exponents)), exponents);
        let better = |a: &(f64, [f64; 2]), b: &(f64, [f64; 2])| a.0.total_cmp(&b.0);
        let decades = || SEARCH_DECADES.map(f64::from);
        let coarse = decades().flat_map(|a| decades().map(move |b| [a, b]));
        let mut best = coarse.map(judged).min_by(better).map_or([0.0; 2], |(_, best)| best);
        for step in [0.5, 0.25, 0.125] {
            let offsets = [-step, 0.0, step];
            let near =
                offsets.into_iter().flat_map(|a| offsets.map(|b| [best[0] + a, best[1] + b]));
            best = near.map(judged).min_by(better).map_or(best, |(_, best)| best);
        }
        lambdas(best)
    }

    /// Degrees of freedom of a fit with these lambdas if the points were spread evenly.
    pub fn edf(&self, lambdas: [f64; 2]) -> f64 {
        let mut edf = 0.0;
        self.each_kept(lambdas, |_, kept| edf += kept);
        edf
    }

    /// The squared size of each pair of eigenvectors in the data, weighted like the data, and the
    /// sum of squares outside all of them.
    fn spectrum(
        &self,
        equations: &CloudEquations,
        coefficients: &[[f64; 2]],
        rss: f64,
    ) -> (DMatrix<f64>, f64) {
        let [along, around] = &self.directions;
        let (rows, columns) = (along.mass.size(), around.mass.size());
        let density = self.density(equations.weight) / self.seen;
        let image = equations.gram.product(coefficients);
        let mut power = DMatrix::zeros(rows, columns);
        let mut outside = rss;
        for axis in 0..2 {
            let matrix = |value: &dyn Fn(usize) -> f64| {
                DMatrix::from_fn(rows, columns, |i, j| value(i * columns + j))
            };
            let open = matrix(&|k| equations.moments[k][axis] - image[k][axis]);
            let open = along.vectors.tr_mul(&open) * &around.vectors / density;
            let held = matrix(&|k| coefficients[k][axis]);
            let held = &along.inverse * held * around.inverse.transpose();
            outside -= density * open.norm_squared();
            power += (held + open).map(|size| density * size * size);
        }
        // Rounding can give slightly negative values for data without noise.
        (power, outside.max(1e-12 * rss))
    }

    /// Calls `call` for each pair of eigenvectors with its indices and the share that a fit keeps
    /// of it.
    fn each_kept(&self, lambdas: [f64; 2], mut call: impl FnMut((usize, usize), f64)) {
        let [along, around] = &self.directions;
        // In the areas with data, the data are denser than on average.
        let lambdas = lambdas.map(|lambda| self.seen * lambda);
        for (b, rough_b) in around.eigenvalues.iter().enumerate() {
            let base = 1.0 + lambdas[1] * rough_b;
            for (a, rough_a) in along.eigenvalues.iter().enumerate() {
                call((a, b), 1.0 / (base + lambdas[0] * rough_a));
            }
        }
    }

    /// Weight of the data per unit of u and v.
    fn density(&self, weight: f64) -> f64 {
        weight / (self.directions[0].length * self.directions[1].length)
    }
}

impl Direction {
    fn new(basis: &Basis) -> Result<Direction, Singular> {
        let (mass, rough) = (mass(basis), roughness(basis, PENALISED));
        let unit = mass.trace() / rough.trace();
        let periodic = basis.is_periodic();
        let gram = mass.dense();
        let singular = Singular { row: 0, relative_pivot: 0.0 };
        let factor = gram.clone().cholesky().ok_or(singular.clone())?;
        let lower = factor.l().try_inverse().ok_or(singular)?;
        let eigen = SymmetricEigen::new(&lower * rough.dense() * lower.transpose());
        let vectors = lower.transpose() * &eigen.eigenvectors;
        let eigenvalues = eigen.eigenvalues.iter().map(|value| unit * value.max(0.0)).collect();
        let inverse = vectors.tr_mul(&gram);
        let (from, to) = basis.domain();
        let length = to - from;
        Ok(Direction { periodic, mass, rough, vectors, inverse, eigenvalues, unit, length })
    }

    fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> + use<> {
        neighbours(i, self.mass.size(), self.periodic)
    }
}

/// The functions that overlap with function `i` of a basis of `size`.
fn neighbours(i: usize, size: usize, periodic: bool) -> impl Iterator<Item = usize> {
    // With fewer than seven periodic functions, some would occur twice.
    let reach = if periodic { (2 * DEGREE + 1).min(size) } else { 2 * DEGREE + 1 };
    (0..reach).filter_map(move |step| {
        let shifted = i + size + step - DEGREE.min(size);
        if periodic {
            Some(shifted % size)
        } else {
            shifted.checked_sub(size).filter(|j| *j < size)
        }
    })
}
