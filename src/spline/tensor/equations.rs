//! The normal equations of scattered data in a tensor-product basis, and their solution by
//! preconditioned conjugate gradients.

use nalgebra::DMatrix;

use super::kronecker::Direction;
use crate::spline::basis::{DEGREE, Row};

/// Functions of one direction that overlap with one: itself and three to either side.
const REACH: usize = 2 * DEGREE + 1;

/// Conjugate gradients end when the residual has fallen to this share of the right-hand side …
const SOLVED: f64 = 1e-9;

/// … or after so many steps; a usual leg needs 20 to 40, one with wide holes 100.
const STEPS_MAX: usize = 400;

/// (BᵀWB + penalty) c = BᵀWy, coefficients as a matrix: along × around.
pub struct Equations<'a> {
    directions: &'a [Direction; 2],
    /// For each coefficient its 7 × 7 neighbours', row-major.
    gram: Vec<[f64; REACH * REACH]>,
    moments: DMatrix<f64>,
    /// Weight of the data per cell of the grid.
    density: f64,
}

impl<'a> Equations<'a> {
    /// The equations of data at `rows` with these values and weights.
    pub fn new(
        rows: &[(Row, Row)],
        values: &[f64],
        weights: &[f64],
        directions: &'a [Direction; 2],
    ) -> Equations<'a> {
        let [height, width] = [0, 1].map(|d| directions[d].gram.nrows());
        let mut gram = vec![[0.0; REACH * REACH]; height * width];
        let mut moments = DMatrix::zeros(height, width);
        for (((along, around), value), weight) in rows.iter().zip(values).zip(weights) {
            if *weight == 0.0 {
                continue;
            }
            for (a, (i, share_a)) in along.indices.into_iter().zip(along.values).enumerate() {
                for (b, (j, share_b)) in around.indices.into_iter().zip(around.values).enumerate() {
                    let share = weight * share_a * share_b;
                    moments[(i, j)] += share * value;
                    let own = &mut gram[i * width + j];
                    for (c, other_a) in along.values.into_iter().enumerate() {
                        let line = (c + DEGREE - a) * REACH + DEGREE - b;
                        for (d, other_b) in around.values.into_iter().enumerate() {
                            own[line + d] += share * other_a * other_b;
                        }
                    }
                }
            }
        }
        let cells = directions[0].design.nrows() * directions[1].design.nrows();
        let density = weights.iter().sum::<f64>() / cells as f64;
        Equations { directions, gram, moments, density }
    }

    /// The coefficients with this smoothing, from a first guess.
    pub fn solved(&self, lambdas: [f64; 2], guess: DMatrix<f64>) -> DMatrix<f64> {
        let system = self.penalised(lambdas);
        let mut solution = guess;
        let mut residual = &self.moments - self.product(&system, &solution);
        let enough = SOLVED * self.moments.norm();
        let mut smoothed = self.evenly_solved(lambdas, &residual);
        let mut step = smoothed.clone();
        let mut size = residual.dot(&smoothed);
        for _ in 0..STEPS_MAX {
            if residual.norm() <= enough {
                break;
            }
            let image = self.product(&system, &step);
            let length = size / step.dot(&image);
            solution += &step * length;
            residual -= image * length;
            smoothed = self.evenly_solved(lambdas, &residual);
            let next = residual.dot(&smoothed);
            step = &smoothed + step * (next / size);
            size = next;
        }
        solution
    }

    /// The zero coefficients.
    pub fn zero(&self) -> DMatrix<f64> {
        DMatrix::zeros(self.moments.nrows(), self.moments.ncols())
    }

    /// Weight of the data per cell.
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Gram matrix and penalty, λu Ru ⊗ BᵀB + λv AᵀA ⊗ Rv, in the neighbours' form.
    fn penalised(&self, lambdas: [f64; 2]) -> Vec<[f64; REACH * REACH]> {
        let [along, around] = self.directions;
        let [height, width] = [along.gram.nrows(), around.gram.nrows()];
        let mut system = self.gram.clone();
        for i in 0..height {
            for j in 0..width {
                for a in neighbours_along(i, height) {
                    let other_i = i + a - DEGREE;
                    for b in 0..REACH {
                        let other_j = (j + width + b - DEGREE) % width;
                        let rough =
                            lambdas[0] * along.roughness[(i, other_i)] * around.gram[(j, other_j)]
                                + lambdas[1]
                                    * along.gram[(i, other_i)]
                                    * around.roughness[(j, other_j)];
                        system[i * width + j][a * REACH + b] += self.density * rough;
                    }
                }
            }
        }
        system
    }

    /// The system's product with coefficients.
    fn product(&self, system: &[[f64; REACH * REACH]], of: &DMatrix<f64>) -> DMatrix<f64> {
        let (height, width) = of.shape();
        let mut product = DMatrix::zeros(height, width);
        // Rows padded by the wrapped neighbours make the inner loop one run of seven.
        let padded: Vec<f64> = (0..height)
            .flat_map(|i| (0..width + 2 * DEGREE).map(move |j| (i, (j + width - DEGREE) % width)))
            .map(|place| of[place])
            .collect();
        let line = width + 2 * DEGREE;
        for i in 0..height {
            for j in 0..width {
                let own = &system[i * width + j];
                let mut sum = 0.0;
                for a in neighbours_along(i, height) {
                    let from = (i + a - DEGREE) * line + j;
                    let values = &padded[from..from + REACH];
                    let factors = &own[a * REACH..(a + 1) * REACH];
                    sum += factors.iter().zip(values).map(|(f, x)| f * x).sum::<f64>();
                }
                product[(i, j)] = sum;
            }
        }
        product
    }

    /// The solution if the data were spread evenly over the cells.
    fn evenly_solved(&self, lambdas: [f64; 2], of: &DMatrix<f64>) -> DMatrix<f64> {
        let [along, around] = self.directions;
        let mut projected = &along.vectors_transposed * of * &around.vectors;
        for (b, rough_b) in around.eigenvalues.iter().enumerate() {
            for (a, rough_a) in along.eigenvalues.iter().enumerate() {
                let size = 1.0 + lambdas[0] * rough_a + lambdas[1] * rough_b;
                projected[(a, b)] /= self.density * size;
            }
        }
        &along.vectors * projected * &around.vectors_transposed
    }
}

/// Places in the neighbours' form that lie within the matrix.
fn neighbours_along(i: usize, height: usize) -> std::ops::Range<usize> {
    DEGREE.saturating_sub(i)..REACH.min(height + DEGREE - i)
}
