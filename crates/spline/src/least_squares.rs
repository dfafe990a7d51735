//! Penalised least squares in one direction, for any number of right-hand sides.

use crate::basis::{Basis, Row};
use crate::integrals::roughness;
use crate::solve::{Cholesky, Singular, Skyline};

/// The penalised derivative; with the third, missing data are bridged much as by a quintic.
const PENALISED: usize = 3;

/// Data at fixed positions in terms of a basis, with the factor of BᵀB plus the penalty.
pub struct LeastSquares {
    rows: Vec<Row>,
    factor: Cholesky,
    count: usize,
}

impl LeastSquares {
    /// The equations of data at `places` with the penalty `lambda` on the squared third derivative.
    /// Lambda is dimensionless: at 1 the penalty's trace equals that of the data.
    ///
    /// # Errors
    /// [`Singular`] if data and penalty leave a coefficient undetermined.
    pub fn new(basis: &Basis, places: &[f64], lambda: f64) -> Result<LeastSquares, Singular> {
        let rows: Vec<Row> = places.iter().map(|place| basis.row(*place)).collect();
        let mut gram = Skyline::zero(basis);
        for row in &rows {
            gram.add_square(row, 1.0);
        }
        let rough = roughness(basis, PENALISED);
        let factor = gram.plus(lambda * gram.trace() / rough.trace(), &rough).factor()?;
        Ok(LeastSquares { rows, factor, count: basis.count() })
    }

    /// The coefficients for each column of `values`, which has one row per position; row-major, one
    /// row per function.
    pub fn coefficients(&self, values: &[f64]) -> Vec<f64> {
        let width = values.len() / self.rows.len();
        let mut moments = vec![0.0; self.count * width];
        for (row, values) in self.rows.iter().zip(values.chunks_exact(width)) {
            for (index, weight) in row.indices.into_iter().zip(row.values) {
                let sums = &mut moments[index * width..(index + 1) * width];
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        self.factor.solve(&mut moments, width);
        moments
    }

    /// The residuals of `values`, in the same order.
    pub fn residuals(&self, values: &[f64]) -> Vec<f64> {
        let width = values.len() / self.rows.len();
        let coefficients = self.coefficients(values);
        let mut left = values.to_vec();
        for (row, left) in self.rows.iter().zip(left.chunks_exact_mut(width)) {
            for (index, weight) in row.indices.into_iter().zip(row.values) {
                let terms = &coefficients[index * width..(index + 1) * width];
                left.iter_mut().zip(terms).for_each(|(left, term)| *left -= weight * term);
            }
        }
        left
    }
}
