//! The normal equations of scattered data in a tensor-product basis, and their solution by
//! preconditioned conjugate gradients. Coefficients are matrices: around × along.

use nalgebra::DMatrix;

use super::circle::Circle;
use super::kronecker::Direction;
use super::preconditioner::{Evenly, Preconditioner};
use super::stencil::{REACH, System};
use crate::basis::{DEGREE, Row};

/// Conjugate gradients take no more steps than this; a usual leg needs 10 to 25, one with wide holes 80.
const STEPS_MAX: usize = 400;

/// The products of one function with those of itself and the three after it along, each with seven around.
type HalfStencil = [f64; (DEGREE + 1) * REACH];

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
            gram: vec![[0.0; (DEGREE + 1) * REACH]; height * width],
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

    /// Adds one datum. Everything is written out: these are two thirds of the work on a datum, and loops of
    /// four would double it.
    fn add(&mut self, (along, around): &(Row, Row), value: f64, weight: f64) {
        let width = self.circle.count();
        let (from, to) = (along.indices[0] * width, (along.indices[0] + 4) * width);
        let [a, b, c, d] = along.values;
        let products = [
            [a * a, a * b, a * c, a * d],
            [b * b, b * c, b * d, 0.0],
            [c * c, c * d, 0.0, 0.0],
            [d * d, 0.0, 0.0, 0.0],
        ];
        let data = Datum {
            columns: around.indices,
            values: around.values,
            products,
            pairs: around.values.map(|b| around.values.map(|d| weight * b * d)),
        };
        let (first, gram) = self.gram[from..to].split_at_mut(width);
        let (second, gram) = gram.split_at_mut(width);
        let (third, fourth) = gram.split_at_mut(width);
        data.add_to_row::<0>(first);
        data.add_to_row::<1>(second);
        data.add_to_row::<2>(third);
        data.add_to_row::<3>(fourth);
        let moments = self.moments.as_mut_slice()[from..to].chunks_exact_mut(width);
        for (moments, share) in moments.zip(along.values) {
            data.columns.iter().zip(data.values).for_each(|(column, own)| {
                moments[*column] += weight * value * share * own;
            });
        }
        for (own, products) in self.data_along[along.indices[0]..].iter_mut().zip(products) {
            own.iter_mut().zip(products).for_each(|(own, product)| *own += weight * product);
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
                    let own = &own[ahead * REACH..(ahead + 1) * REACH];
                    for (b, (own, penalty)) in own.iter().zip(penalty).enumerate() {
                        system.set([i, j], [ahead, b], own + penalty);
                    }
                }
            }
        }
        system
    }
}

/// What a datum adds to the Gram matrix.
struct Datum {
    /// Its functions around, with their values.
    columns: [usize; 4],
    values: [f64; 4],
    /// For each function along, its products with itself and those after it.
    products: [[f64; 4]; 4],
    /// For each function around, its weighted products with all four.
    pairs: [[f64; 4]; 4],
}

impl Datum {
    /// Adds to the entries of its function number `A` along.
    #[inline]
    fn add_to_row<const A: usize>(&self, row: &mut [HalfStencil]) {
        self.add_to::<A, 0>(&mut row[self.columns[0]]);
        self.add_to::<A, 1>(&mut row[self.columns[1]]);
        self.add_to::<A, 2>(&mut row[self.columns[2]]);
        self.add_to::<A, 3>(&mut row[self.columns[3]]);
    }

    /// … and number `B` around, whose products begin at the neighbour so far behind.
    #[inline]
    fn add_to<const A: usize, const B: usize>(&self, own: &mut HalfStencil) {
        let [a, b, c, d] = self.pairs[B];
        for (ahead, share) in self.products[A][..DEGREE + 1 - A].iter().enumerate() {
            let at = ahead * REACH + DEGREE - B;
            own[at] += share * a;
            own[at + 1] += share * b;
            own[at + 2] += share * c;
            own[at + 3] += share * d;
        }
    }
}

/// Adds `factor · values` without a temporary matrix.
fn axpy(to: &mut DMatrix<f64>, factor: f64, values: &DMatrix<f64>) {
    let both = to.as_mut_slice().iter_mut().zip(values.as_slice());
    both.for_each(|(to, value)| *to += factor * value);
}
