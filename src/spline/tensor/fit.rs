//! Robust smoothing fit of a tensor-product spline to scattered data.
//!
//! Minimises Σ w (y − f)² + λu ∬ f_uu² + λv ∬ f_vv². The two lambdas are chosen by generalised
//! cross-validation on a grid of cells into which the data are averaged (`kronecker`); then the
//! equations of the scattered data themselves are solved (`equations`). Outliers lose their weight
//! over several rounds.

use nalgebra::{DMatrix, DVector};

use super::equations::Equations;
use super::function::Tensor;
use super::kronecker::{Direction, best_by_gcv};
use super::neighbours::Neighbours;
use super::scatter::{Scatter, place};
use crate::spline::basis::{Basis, DEGREE, Row};
use crate::spline::fit::FitFault;
use crate::spline::robust::biweights;

/// A fitted function and its accuracy.
#[derive(Debug, Clone)]
pub struct TensorFit {
    /// The function.
    pub function: Tensor,
    /// The final weight of each datum, 0 to 1.
    pub weights: Vec<f64>,
    /// Standard deviation of a datum, assuming normal errors.
    pub sigma: f64,
    /// Effective degrees of freedom.
    pub edf: f64,
    /// Smoothing along and around, relative to the roughness on the grid of cells.
    pub lambdas: [f64; 2],
    /// The direction along.
    direction: Direction,
    /// For each of its eigenvectors the variance of the mean over a turn, for σ² = 1.
    mean_variances: Vec<f64>,
}

impl TensorFit {
    /// Standard error of the mean over one turn, or of one of its derivatives along (0 to 3), at
    /// `u`, if the data were spread evenly: the Bayesian form, σ² bᵀ(AᵀA ⊗ BᵀB + penalty)⁻¹ b.
    pub fn mean_around_sd(&self, u: f64, derivative: usize) -> f64 {
        let row = self.function.along().rows(u)[derivative.min(DEGREE)];
        let vectors = &self.direction.vectors;
        let variance = |(k, variance): (usize, &f64)| {
            let terms = row.indices.into_iter().zip(row.values);
            let size: f64 = terms.map(|(i, value)| value * vectors[(i, k)]).sum();
            size * size * variance
        };
        let variance: f64 = self.mean_variances.iter().enumerate().map(variance).sum();
        self.sigma * variance.sqrt()
    }
}

/// For each eigenvector along, its contribution to the variance of the mean over one turn, if the
/// data, of this weight per cell and of variance 1, were spread evenly.
fn mean_variances([along, around]: &[Direction; 2], lambdas: [f64; 2], density: f64) -> Vec<f64> {
    // All basis functions around have the same shape, so the mean over a turn weights them equally.
    let count = around.gram.nrows();
    let mean = around.vectors.tr_mul(&DVector::from_element(count, 1.0 / count as f64));
    let one = |rough_a: &f64| {
        let share = |(share, rough_b): (&f64, &f64)| {
            share * share / (1.0 + lambdas[0] * rough_a + lambdas[1] * rough_b)
        };
        mean.iter().zip(&around.eigenvalues).map(share).sum::<f64>() / density
    };
    along.eigenvalues.iter().map(one).collect()
}

/// Rounds of reweighting and choosing the smoothing; both converge to 1 % after three.
const ROUNDS: usize = 3;

/// Standard deviation of standard normal errors weighted by the biweights, which reduce large ones
/// (closed form for Tukey's constant 4.685).
const WEIGHTED_NORMAL_SD: f64 = 0.910;

/// Smoothing of the first round, relative to the median roughness: enough to bridge holes and make
/// outliers stand out.
const FIRST_SMOOTHING: f64 = 1.0;

/// Fits the function. Residuals of `least_scale` are never outliers.
///
/// # Errors
/// A [`FitFault`] if there are too few data for a fit.
pub fn fit_scatter(
    data: &Scatter,
    along: Basis,
    around: Basis,
    least_scale: f64,
) -> Result<TensorFit, FitFault> {
    let (found, needed) = (data.value.len(), along.count() + around.count());
    if found < needed {
        return Err(FitFault::TooFewPlaces { found, needed });
    }
    let grid = Grid { along: halved(along.breakpoints()), around: around.breakpoints().to_vec() };
    let directions = [
        Direction::new(&along, &middles(&grid.along))?,
        Direction::new(&around, &middles(&grid.around))?,
    ];
    let rows: Vec<(Row, Row)> =
        data.u.iter().zip(data.v).map(|(u, v)| (along.row(*u), around.row(*v))).collect();
    let neighbours = Neighbours::of(data, &grid.along, &grid.around);
    let mut weights = vec![1.0; found];
    let mut lambdas = [0, 1].map(|d: usize| FIRST_SMOOTHING * directions[d].unit());
    let mut equations = Equations::new(&rows, data.value, &weights, &directions);
    let mut coefficients = equations.solved(lambdas, equations.zero());
    let mut edf = 0.0;
    for _ in 0..ROUNDS {
        let residuals = residuals(&rows, data.value, &coefficients);
        weights = biweights(&neighbours.beside(&residuals, least_scale), least_scale);
        let (cells, seen) = grid.cells(data, &residuals, &weights, &coefficients, &directions);
        (lambdas, edf) = best_by_gcv(&directions[0], &directions[1], &cells, seen);
        equations = Equations::new(&rows, data.value, &weights, &directions);
        coefficients = equations.solved(lambdas, coefficients);
    }
    let left = residuals(&rows, data.value, &coefficients);
    let rss: f64 = left.iter().zip(&weights).map(|(r, w)| w * r * r).sum();
    let freedom = weights.iter().sum::<f64>() - edf;
    let sigma = (rss / freedom.max(1.0)).sqrt() / WEIGHTED_NORMAL_SD;
    let by_rows = coefficients.transpose().as_slice().to_vec();
    let function = Tensor::new(along, around, by_rows);
    let mean_variances = mean_variances(&directions, lambdas, equations.density());
    let [direction, _] = directions;
    Ok(TensorFit { function, weights, sigma, edf, lambdas, direction, mean_variances })
}

fn residuals(rows: &[(Row, Row)], values: &[f64], coefficients: &DMatrix<f64>) -> Vec<f64> {
    let value = |(along, around): &(Row, Row)| {
        let mut sum = 0.0;
        for (i, a) in along.indices.into_iter().zip(along.values) {
            for (j, b) in around.indices.into_iter().zip(around.values) {
                sum += a * b * coefficients[(i, j)];
            }
        }
        sum
    };
    rows.iter().zip(values).map(|(row, y)| y - value(row)).collect()
}

/// Cells between the breakpoints of both bases.
struct Grid {
    along: Vec<f64>,
    around: Vec<f64>,
}

impl Grid {
    /// Cell averages, and the number of cells with data. An average is the fit at the cell's middle
    /// plus the weighted mean of the residuals in the cell, so the position of a datum within its
    /// cell makes no difference.
    fn cells(
        &self,
        data: &Scatter,
        residuals: &[f64],
        weights: &[f64],
        coefficients: &DMatrix<f64>,
        [along, around]: &[Direction; 2],
    ) -> (DMatrix<f64>, usize) {
        let mut cells = &along.design * coefficients * around.design.transpose();
        let mut sums: DMatrix<f64> = DMatrix::zeros(cells.nrows(), cells.ncols());
        let mut counts: DMatrix<f64> = DMatrix::zeros(cells.nrows(), cells.ncols());
        let period = self.around[self.around.len() - 1] - self.around[0];
        for (((u, v), residual), weight) in data.u.iter().zip(data.v).zip(residuals).zip(weights) {
            let home = self.around[0] + (v - self.around[0]).rem_euclid(period);
            let cell = (place(&self.along, *u), place(&self.around, home));
            sums[cell] += weight * residual;
            counts[cell] += weight;
        }
        let mut seen = 0;
        for ((cell, sum), count) in cells.iter_mut().zip(sums.iter()).zip(counts.iter()) {
            if *count > 0.0 {
                *cell += sum / count;
                seen += 1;
            }
        }
        (cells, seen)
    }
}

/// Breakpoints with the middle of each interval inserted: a clamped basis has three more functions
/// than intervals, which one cell per interval could not distinguish.
fn halved(breakpoints: &[f64]) -> Vec<f64> {
    let last = breakpoints.last().copied();
    let pairs = breakpoints.windows(2);
    pairs.flat_map(|pair| [pair[0], (pair[0] + pair[1]) / 2.0]).chain(last).collect()
}

fn middles(breakpoints: &[f64]) -> Vec<f64> {
    breakpoints.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).collect()
}
