//! The normal equations of scattered data in a tensor-product basis, and their solution by
//! preconditioned conjugate gradients.

use nalgebra::DMatrix;

use super::kronecker::Direction;
use crate::spline::basis::{DEGREE, Row};

/// Number of functions in one direction that overlap with a given one: itself and three on each side.
const REACH: usize = 2 * DEGREE + 1;

/// Conjugate gradients stop when the residual has fallen to this share of the right-hand side …
const SOLVED: f64 = 1e-9;

/// … or after this many steps; a usual leg needs 20 to 40, one with wide holes 100.
const STEPS_MAX: usize = 400;

/// (BᵀWB + penalty) c = BᵀWy, coefficients as a matrix: along × around.
pub struct Equations<'a> {
    directions: &'a [Direction; 2],
    /// For each coefficient, the entries of its 7 × 7 neighbours, row-major.
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

    /// The coefficients with this smoothing, starting from an initial guess.
    pub fn solved(&self, lambdas: [f64; 2], guess: DMatrix<f64>) -> DMatrix<f64> {
        let (system, kept) = (self.penalised(lambdas), self.evenly_kept(lambdas));
        let mut solution = guess;
        let mut residual = &self.moments - system.product(&solution);
        let enough = SOLVED * self.moments.norm();
        let mut smoothed = self.evenly_solved(&kept, &residual);
        let mut step = smoothed.clone();
        let mut size = residual.dot(&smoothed);
        for _ in 0..STEPS_MAX {
            if residual.norm() <= enough {
                break;
            }
            let image = system.product(&step);
            let length = size / step.dot(&image);
            axpy(&mut solution, length, &step);
            axpy(&mut residual, -length, &image);
            smoothed = self.evenly_solved(&kept, &residual);
            let next = residual.dot(&smoothed);
            let turned = next / size;
            let both = step.as_mut_slice().iter_mut().zip(smoothed.as_slice());
            both.for_each(|(step, smoothed)| *step = smoothed + turned * *step);
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

    /// Gram matrix and penalty, λu Ru ⊗ BᵀB + λv AᵀA ⊗ Rv.
    fn penalised(&self, lambdas: [f64; 2]) -> System {
        let [along, around] = self.directions;
        let [height, width] = [along.gram.nrows(), around.gram.nrows()];
        let mut system = System::zero(height, width);
        let of_neighbours = |matrix: &DMatrix<f64>| -> Vec<[f64; REACH]> {
            let neighbour = |j: usize, b: usize| matrix[(j, (j + width + b - DEGREE) % width)];
            (0..width).map(|j| std::array::from_fn(|b| neighbour(j, b))).collect()
        };
        let (gram, rough) = (of_neighbours(&around.gram), of_neighbours(&around.roughness));
        for i in 0..height {
            for a in neighbours_along(i, height) {
                let other_i = i + a - DEGREE;
                let bend_along = self.density * lambdas[0] * along.roughness[(i, other_i)];
                let bend_around = self.density * lambdas[1] * along.gram[(i, other_i)];
                for j in 0..width {
                    let own = &self.gram[i * width + j][a * REACH..(a + 1) * REACH];
                    let (factors, lane) = system.factors_of(i, j);
                    let factors = &mut factors[a * REACH..(a + 1) * REACH];
                    let parts = factors.iter_mut().zip(own).zip(gram[j].iter().zip(&rough[j]));
                    for ((lanes, own), (gram, rough)) in parts {
                        lanes[lane] = own + bend_along * gram + bend_around * rough;
                    }
                }
            }
        }
        system
    }

    /// The share of each pair of eigenvectors that the solution keeps if the data are spread evenly.
    fn evenly_kept(&self, lambdas: [f64; 2]) -> DMatrix<f64> {
        let [along, around] = self.directions.each_ref().map(|direction| &direction.eigenvalues);
        DMatrix::from_fn(along.len(), around.len(), |a, b| {
            1.0 / (self.density * (1.0 + lambdas[0] * along[a] + lambdas[1] * around[b]))
        })
    }

    /// The solution if the data were spread evenly over the cells.
    fn evenly_solved(&self, kept: &DMatrix<f64>, of: &DMatrix<f64>) -> DMatrix<f64> {
        let [along, around] = self.directions;
        let mut projected = &along.vectors_transposed * of * &around.vectors;
        projected.component_mul_assign(kept);
        &along.vectors * projected * &around.vectors_transposed
    }
}

/// Offsets of neighbours that lie within the matrix.
fn neighbours_along(i: usize, height: usize) -> std::ops::Range<usize> {
    DEGREE.saturating_sub(i)..REACH.min(height + DEGREE - i)
}

/// Number of coefficients that a product processes in parallel: as many as fit in the registers.
const LANES: usize = 8;

/// A matrix between coefficients and their 7 × 7 neighbours, arranged for fast multiplication.
struct System {
    height: usize,
    width: usize,
    /// For each run of [`LANES`] coefficients of a row, and each neighbour, their factors; 0 for
    /// neighbours outside the matrix and for the padding of the last run.
    factors: Vec<[[f64; LANES]; REACH * REACH]>,
}

impl System {
    fn zero(height: usize, width: usize) -> System {
        let factors = vec![[[0.0; LANES]; REACH * REACH]; height * width.div_ceil(LANES)];
        System { height, width, factors }
    }

    /// The factors of the run that contains a coefficient, and the coefficient's lane.
    fn factors_of(&mut self, i: usize, j: usize) -> (&mut [[f64; LANES]], usize) {
        let run = i * self.width.div_ceil(LANES) + j / LANES;
        (&mut self.factors[run], j % LANES)
    }

    /// The product with coefficients.
    fn product(&self, of: &DMatrix<f64>) -> DMatrix<f64> {
        let (height, width) = (self.height, self.width);
        let runs = width.div_ceil(LANES);
        // With rows of zeros above and below, and each row padded by its wrapped neighbours, every
        // run of neighbours exists and needs no bounds check.
        let line = runs * LANES + 2 * DEGREE;
        let mut padded = vec![0.0; (height + 2 * DEGREE) * line];
        for place in 0..width + 2 * DEGREE {
            let column = (place + width - DEGREE) % width * height;
            let column = of.as_slice()[column..column + height].iter();
            let places = padded[DEGREE * line + place..].iter_mut().step_by(line);
            places.zip(column).for_each(|(padded, value)| *padded = *value);
        }
        let mut product = DMatrix::zeros(height, width);
        for (index, factors) in self.factors.iter().enumerate() {
            let (i, from) = (index / runs, index % runs * LANES);
            let mut sums = [0.0; LANES];
            for (a, line_of_factors) in factors.chunks_exact(REACH).enumerate() {
                let start = (i + a) * line + from;
                let values = &padded[start..start + REACH - 1 + LANES];
                for (factors, values) in line_of_factors.iter().zip(values.windows(LANES)) {
                    for ((sum, factor), value) in sums.iter_mut().zip(factors).zip(values) {
                        *sum += factor * value;
                    }
                }
            }
            let places = product.as_mut_slice()[from * height + i..].iter_mut().step_by(height);
            places.zip(sums).for_each(|(product, sum)| *product = sum);
        }
        product
    }
}

/// Adds `factor · values` without a temporary matrix.
fn axpy(to: &mut DMatrix<f64>, factor: f64, values: &DMatrix<f64>) {
    let both = to.as_mut_slice().iter_mut().zip(values.as_slice());
    both.for_each(|(to, value)| *to += factor * value);
}
