//! Robust smoothing fit of a tensor-product spline to scattered data.
//!
//! Minimises Σ w (y − f)² + λu ∬ f_uu² + λv ∬ f_vv². The two lambdas are chosen by generalised
//! cross-validation on a grid of cells into which the data are averaged (`kronecker`); then the
//! equations of the scattered data themselves are solved (`equations`). Outliers lose their weight
//! over several rounds.

use nalgebra::DMatrix;

use super::Scatter;
use super::circle::Circle;
use super::equations::Equations;
use super::function::Tensor;
use super::kronecker::{Around, Direction, best_by_gcv};
use super::neighbours::Neighbours;
use crate::basis::{Basis, DEGREE, Row};
use crate::fit::FitFault;
use crate::robust::biweights;

/// A fitted function and its accuracy.
#[derive(Debug, Clone)]
pub struct TensorFit {
    /// The function.
    pub function: Tensor,
    /// The final weight of each datum, 0 to 1.
    pub weights: Vec<f64>,
    /// What the function leaves of each datum.
    pub residuals: Vec<f64>,
    /// Standard deviation of a datum, assuming normal errors.
    pub sigma: f64,
    /// Effective degrees of freedom.
    pub edf: f64,
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

/// Rounds of reweighting and choosing the smoothing; both converge to 1 % after three.
const ROUNDS: usize = 3;

/// Standard deviation of standard normal errors weighted by the biweights, which reduce large ones
/// (closed form for Tukey's constant 4.685).
const WEIGHTED_NORMAL_SD: f64 = 0.910;

/// Smoothing of the first round, relative to the median roughness: enough to bridge holes and make
/// outliers stand out.
const FIRST_SMOOTHING: f64 = 1.0;

/// Equations are solved until the function is off by no more than this, root mean square, in the unit of
/// the values (mm on a leg): in the rounds before the last one, of which only weights and smoothing remain …
const ROUGHLY: f64 = 1e-4;

/// … and in the last one.
const FINALLY: f64 = 1e-6;

/// Fits the function, with its angles around in this many equal pieces. Residuals of `least_scale` are never
/// outliers.
///
/// # Errors
/// A [`FitFault`] if there are too few data or pieces for a fit.
pub fn fit_scatter(
    data: &Scatter,
    along: Basis,
    pieces_around: usize,
    least_scale: f64,
) -> Result<TensorFit, FitFault> {
    let circle = Circle::new(pieces_around)?;
    let (found, needed) = (data.value.len(), along.count() + circle.count());
    if found < needed {
        return Err(FitFault::TooFewPlaces { found, needed });
    }
    let grid = Grid::new(&along, &circle.basis);
    let direction = Direction::new(&along, &middles(&grid.along))?;
    let around = Around::new(&circle);
    let rows: Vec<(Row, Row)> =
        data.u.iter().zip(data.v).map(|(u, v)| (along.row(*u), circle.basis.row(*v))).collect();
    let neighbours = Neighbours::new(data, &grid.along, &grid.around);
    let mut weights = vec![1.0; found];
    let mut lambdas = [direction.unit(), around.unit()].map(|unit| FIRST_SMOOTHING * unit);
    let mut equations = Equations::new(&rows, data.value, &weights, &direction, &circle);
    let mean = data.value.iter().sum::<f64>() / found as f64;
    let mut coefficients = equations.solved(lambdas, equations.constant(mean), ROUGHLY);
    let mut edf = 0.0;
    for round in 1..=ROUNDS {
        let residuals = residuals(&rows, data.value, &coefficients);
        weights = biweights(&neighbours.beside(&residuals, least_scale), least_scale);
        let (cells, seen) = grid.cells(&neighbours.cells, &residuals, &weights, &coefficients);
        (lambdas, edf) = best_by_gcv(&direction, &around, &circle, &cells, seen);
        equations = Equations::new(&rows, data.value, &weights, &direction, &circle);
        let off = if round < ROUNDS { ROUGHLY } else { FINALLY };
        coefficients = equations.solved(lambdas, coefficients, off);
    }
    let residuals = residuals(&rows, data.value, &coefficients);
    let rss: f64 = residuals.iter().zip(&weights).map(|(r, w)| w * r * r).sum();
    let freedom = weights.iter().sum::<f64>() - edf;
    let sigma = (rss / freedom.max(1.0)).sqrt() / WEIGHTED_NORMAL_SD;
    // If the data were spread evenly. Of all waves around only the constant has a mean.
    let share = 1.0 / (pieces_around as f64 * around.gram[0]);
    let base = 1.0 + lambdas[1] * around.eigenvalues[0];
    let density = equations.density();
    let variance = |rough: &f64| share / (base + lambdas[0] * rough) / density;
    let mean_variances = direction.eigenvalues.iter().map(variance).collect();
    drop(equations);
    let function = Tensor::new(along, circle.basis, coefficients.as_slice().to_vec());
    Ok(TensorFit { function, weights, residuals, sigma, edf, direction, mean_variances })
}

/// The data without a function, whose coefficients are around × along.
fn residuals(rows: &[(Row, Row)], values: &[f64], coefficients: &DMatrix<f64>) -> Vec<f64> {
    let (width, all) = (coefficients.nrows(), coefficients.as_slice());
    let value = |(along, around): &(Row, Row)| {
        let line = |i: usize| around.dot(&all[i * width..(i + 1) * width]);
        along.indices.into_iter().zip(along.values).map(|(i, share)| share * line(i)).sum::<f64>()
    };
    rows.iter().zip(values).map(|(row, y)| y - value(row)).collect()
}

/// Cells between the breakpoints of both bases.
struct Grid {
    along: Vec<f64>,
    around: Vec<f64>,
    /// The functions in the middles of the cells.
    rows_along: Vec<Row>,
    rows_around: Vec<Row>,
}

impl Grid {
    fn new(along: &Basis, around: &Basis) -> Grid {
        let cells_along = halved(along.breakpoints());
        let rows = |basis: &Basis, breakpoints: &[f64]| {
            middles(breakpoints).into_iter().map(|middle| basis.row(middle)).collect()
        };
        Grid {
            rows_along: rows(along, &cells_along),
            rows_around: rows(around, around.breakpoints()),
            along: cells_along,
            around: around.breakpoints().to_vec(),
        }
    }

    /// Cell averages (around × along), and the number of cells with data. An average is the fit at the
    /// cell's middle plus the weighted mean of the residuals in the cell, so the position of a datum within
    /// its cell makes no difference.
    fn cells(
        &self,
        cell_of: &[usize],
        residuals: &[f64],
        weights: &[f64],
        coefficients: &DMatrix<f64>,
    ) -> (DMatrix<f64>, usize) {
        let mut cells = self.values(coefficients);
        let mut sums = vec![(0.0, 0.0); cells.len()];
        for ((cell, residual), weight) in cell_of.iter().zip(residuals).zip(weights) {
            sums[*cell].0 += weight * residual;
            sums[*cell].1 += weight;
        }
        let mut seen = 0;
        for (cell, (sum, count)) in cells.iter_mut().zip(sums) {
            if count > 0.0 {
                *cell += sum / count;
                seen += 1;
            }
        }
        (cells, seen)
    }

    /// The values of a function in the middles of the cells; both around × along.
    fn values(&self, coefficients: &DMatrix<f64>) -> DMatrix<f64> {
        let mut values = Vec::with_capacity(self.rows_along.len() * self.rows_around.len());
        for along in &self.rows_along {
            let mut ring = vec![0.0; coefficients.nrows()];
            along.add_to(&mut ring, coefficients.as_slice());
            values.extend(self.rows_around.iter().map(|around| around.dot(&ring)));
        }
        DMatrix::from_vec(self.rows_around.len(), self.rows_along.len(), values)
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
