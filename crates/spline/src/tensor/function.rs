//! A scalar function of two variables: clamped cubic along, periodic cubic around.

use crate::basis::Basis;

/// A tensor-product spline f(u, v).
#[derive(Debug, Clone)]
pub struct Tensor {
    along: Basis,
    around: Basis,
    /// Row-major, `along.count()` rows of `around.count()`.
    coefficients: Vec<f64>,
}

impl Tensor {
    /// A function in these bases; the number of `coefficients` must be the product of their counts.
    pub fn new(along: Basis, around: Basis, coefficients: Vec<f64>) -> Tensor {
        debug_assert_eq!(coefficients.len(), along.count() * around.count());
        Tensor { along, around, coefficients }
    }

    /// The basis along, clamped.
    pub fn along(&self) -> &Basis {
        &self.along
    }

    /// The basis around, periodic.
    pub fn around(&self) -> &Basis {
        &self.around
    }

    /// The value at (u, v); see [`Basis::rows`] for positions outside the domain.
    pub fn value(&self, u: f64, v: f64) -> f64 {
        let (along, around) = (self.along.row(u), self.around.row(v));
        let width = self.around.count();
        let line = |i: usize| around.dot(&self.coefficients[i * width..(i + 1) * width]);
        along.indices.into_iter().zip(along.values).map(|(i, share)| share * line(i)).sum()
    }

    /// The coefficients of the periodic function of v at one u.
    pub fn around_at(&self, u: f64) -> Vec<f64> {
        let mut coefficients = vec![0.0; self.around.count()];
        self.add_around_at(u, &mut coefficients);
        coefficients
    }

    /// Adds the coefficients of the periodic function of v at one u to as many values.
    pub fn add_around_at(&self, u: f64, coefficients: &mut [f64]) {
        self.along.row(u).add_to(coefficients, &self.coefficients);
    }
}
