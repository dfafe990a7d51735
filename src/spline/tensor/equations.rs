//! The normal equations of scattered data in a tensor-product basis, and their solution by
//! preconditioned conjugate gradients. Coefficients are matrices: around × along.

use nalgebra::DMatrix;

use super::circle::Circle;
use super::kronecker::Direction;
use super::preconditioner::{Evenly, Preconditioner};
use super::stencil::{REACH, System};
use crate::spline::basis::{DEGREE, Row};

/// Conjugate gradients take no more steps than this; a usual leg needs 10 to 25, one with wide holes 80.
const STEPS_MAX: usize = 400;

/// The products of one function with those of itself and the three after it along, each with seven around.
type HalfStencil = [[f64; REACH]; DEGREE + 1];

/// (BᵀWB + penalty) c = BᵀWy.
pub struct Equations<'a> {
    along: &'a Direction,
    circle: &'a Circle,
    /// For each coefficient, along by along, the entries of itself and of its neighbours ahead; the others
    /// follow by symmetry.
    gram: Vec<HalfStencil>,
    moments: DMatrix<f64>,
    /// Gram matrix of the data along, for each function itself and the three after it.
    data_along: Vec<[f64; DEGREE + 1]>,
    /// Weight of all data.
    weight: f64,
}

impl<'a> Equations<'a> {
    /// The equations of data at `rows` (along, around) with these values and weights.
    pub fn new(
        rows: &[(Row, Row)],
        values: &[f64],
        weights: &[f64],
        along: &'a Direction,
        circle: &'a Circle,
    ) -> Equations<'a> {
        let (height, width) = (along.gram.nrows(), circle.count());
        let mut equations = Equations {
            along,
            circle,
            gram: vec![[[0.0; REACH]; DEGREE + 1]; height * width],
            moments: DMatrix::zeros(width, height),
            data_along: vec![[0.0; DEGREE + 1]; height],
            weight: weights.iter().sum(),
        };
        for ((row, value), weight) in rows.iter().zip(values).zip(weights) {
            if *weight > 0.0 {
                equations.add(row, *value, *weight);
            }
        }
        equations
    }

    /// Adds one datum.
    fn add(&mut self, (along, around): &(Row, Row), value: f64, weight: f64) {
        let width = self.circle.count();
        let first = along.indices[0];
        // Around, the products of each function with all four, shifted to its place among the seven.
        let pairs = around.values.map(|b| around.values.map(|d| weight * b * d));
        for (a, share_a) in along.values.into_iter().enumerate() {
            let line = (first + a) * width;
            for (j, share_b) in around.indices.into_iter().zip(around.values) {
                self.moments.as_mut_slice()[line + j] += weight * share_a * share_b * value;
            }
            for (ahead, share_c) in along.values[a..].iter().enumerate() {
                let share = share_a * share_c;
                self.data_along[first + a][ahead] += weight * share;
                for (b, (j, pairs)) in around.indices.into_iter().zip(pairs).enumerate() {
                    let own = &mut self.gram[line + j][ahead][DEGREE - b..][..DEGREE + 1];
                    own.iter_mut().zip(pairs).for_each(|(own, pair)| *own += share * pair);
                }
            }
        }
    }

    /// The coefficients with this smoothing, starting from an initial guess. The steps end when the
    /// function is off by no more than `off`, root mean square over the data, as the preconditioner sees it.
    pub fn solved(&self, lambdas: [f64; 2], guess: DMatrix<f64>, off: f64) -> DMatrix<f64> {
        let system = self.penalised(lambdas);
        let pieces = self.circle.count() as f64;
        let data = self.data_along.iter().map(|own| own.map(|entry| entry / pieces));
        let evenly = Evenly {
            along: self.along,
            circle: self.circle,
            data: data.collect(),
            density: self.density(),
            lambdas,
        };
        let preconditioner = Preconditioner::new(evenly, &system.diagonal());
        let mut solution = guess;
        let mut residual = &self.moments - system.product(&solution);
        let mut smoothed = preconditioner.solved(&residual);
        let mut step = smoothed.clone();
        // The energy of the error: the weighted squares of what the function is off.
        let mut energy = residual.dot(&smoothed);
        for _ in 0..STEPS_MAX {
            if energy <= off * off * self.weight {
                break;
            }
            let image = system.product(&step);
            let length = energy / step.dot(&image);
            axpy(&mut solution, length, &step);
            axpy(&mut residual, -length, &image);
            smoothed = preconditioner.solved(&residual);
            let next = residual.dot(&smoothed);
            let turned = next / energy;
            let both = step.as_mut_slice().iter_mut().zip(smoothed.as_slice());
            both.for_each(|(step, smoothed)| *step = smoothed + turned * *step);
            energy = next;
        }
        solution
    }

    /// The coefficients of a constant function.
    pub fn constant(&self, value: f64) -> DMatrix<f64> {
        DMatrix::from_element(self.moments.nrows(), self.moments.ncols(), value)
    }

    /// Weight of the data per cell.
    pub fn density(&self) -> f64 {
        self.weight / (self.along.design.nrows() * self.circle.count()) as f64
    }

    /// Gram matrix and penalty, λu Ru ⊗ BᵀB + λv AᵀA ⊗ Rv.
    fn penalised(&self, lambdas: [f64; 2]) -> System {
        let (along, width) = (self.along, self.circle.count());
        let height = along.gram.nrows();
        let mut system = System::zero(height, width);
        let stencil = |of: &[f64; DEGREE + 1]| -> [f64; REACH] {
            std::array::from_fn(|place| of[place.abs_diff(DEGREE)])
        };
        let (gram, rough) = (stencil(&self.circle.gram), stencil(&self.circle.roughness));
        for i in 0..height {
            for ahead in 0..=DEGREE.min(height - 1 - i) {
                let bend_along = self.density() * lambdas[0] * along.roughness[(i + ahead, i)];
                let bend_around = self.density() * lambdas[1] * along.gram[(i + ahead, i)];
                let penalty: [f64; REACH] =
                    std::array::from_fn(|b| bend_along * gram[b] + bend_around * rough[b]);
                for (j, own) in self.gram[i * width..(i + 1) * width].iter().enumerate() {
                    for (b, (own, penalty)) in own[ahead].iter().zip(penalty).enumerate() {
                        system.set([i, j], [ahead, b], own + penalty);
                    }
                }
            }
        }
        system
    }
}

/// Adds `factor · values` without a temporary matrix.
fn axpy(to: &mut DMatrix<f64>, factor: f64, values: &DMatrix<f64>) {
    let both = to.as_mut_slice().iter_mut().zip(values.as_slice());
    both.for_each(|(to, value)| *to += factor * value);
}
