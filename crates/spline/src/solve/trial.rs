//! What a lambda is judged by, the coefficients and the effective degrees of freedom: one pass down the band and
//! one up, without a factor or an inverse that outlives them.

use super::{DEGREE, Skyline, band, large_enough};

/// The equations (gram + λ penalty) c = moments of a clamped basis, to be solved at many λ.
#[derive(Debug)]
pub struct Trials<'a> {
    moments: &'a [f64],
    /// Rows of the Gram matrix; below the last, [`DEGREE`] rows of zeros.
    gram: Vec<band::Row>,
    penalty: Vec<band::Row>,
    /// Rows of the factor at the last λ; above and below, [`DEGREE`] rows of the identity.
    factor: Vec<FactorRow>,
    coefficients: Vec<f64>,
}

/// A row of the factors L D Lᵀ.
#[derive(Debug, Clone, Copy)]
struct FactorRow {
    /// Entries of L left of its diagonal, which is 1; the nearest first.
    left: [f64; DEGREE],
    /// The reciprocal of the entry of D.
    per_pivot: f64,
    /// The right-hand side after the rows above.
    value: f64,
}

const IDENTITY: FactorRow = FactorRow { left: [0.0; DEGREE], per_pivot: 1.0, value: 0.0 };

impl<'a> Trials<'a> {
    /// The equations; `None` of a periodic basis, whose matrices are not banded.
    pub fn new(gram: &Skyline, penalty: &Skyline, moments: &'a [f64]) -> Option<Trials<'a>> {
        let size = gram.size();
        let rows = |of: &Skyline| (0..size).map(|i| of.band_row(i)).collect::<Vec<_>>();
        (gram.full_from == size).then(|| {
            let mut gram = rows(gram);
            gram.resize(size + DEGREE, [0.0; DEGREE + 1]);
            let factor = vec![IDENTITY; size + 2 * DEGREE];
            let coefficients = vec![0.0; size];
            Trials { moments, gram, penalty: rows(penalty), factor, coefficients }
        })
    }

    /// The coefficients at `lambda`, and the trace of the inverse times the Gram matrix, the effective degrees
    /// of freedom; `None` if the equations are singular.
    ///
    /// Source: Golub, Van Loan, Matrix Computations, 4.1 and 4.3 (factors of a band); Takahashi, Fagan, Chin 1973
    /// (the inverse within the band).
    pub fn at(&mut self, lambda: f64) -> Option<(&[f64], f64)> {
        let matrices = self.gram.iter().zip(&self.penalty).zip(self.moments);
        let mut above = [IDENTITY; DEGREE];
        for (i, ((gram, penalty), moment)) in matrices.enumerate() {
            let entries = std::array::from_fn(|k| gram[k] + lambda * penalty[k]);
            let (row, relative_pivot) = reduced(entries, *moment, &above);
            large_enough(i, relative_pivot).ok()?;
            self.factor[i + DEGREE] = row;
            above = [row, above[0], above[1]];
        }
        let freedom = self.upwards();
        Some((&self.coefficients, freedom))
    }

    /// The coefficients and the inverse from the last row to the first; returns the trace.
    fn upwards(&mut self) -> f64 {
        // The inverse among the three rows below, and the coefficients there.
        let [mut z11, mut z21, mut z31, mut z22, mut z32, mut z33] = [0.0; 6];
        let [mut c1, mut c2, mut c3] = [0.0; DEGREE];
        let mut trace = 0.0;
        let rows = self.factor[DEGREE..].windows(DEGREE + 1).zip(self.gram.windows(DEGREE + 1));
        for ((rows, gram), coefficient) in rows.zip(&mut self.coefficients).rev() {
            let ([own, first, second, third], [diagonal, near, next, far]) = (rows, gram) else {
                continue;
            };
            let (l1, l2, l3) = (first.left[0], second.left[1], third.left[2]);
            let z1 = -(l1 * z11 + l2 * z21 + l3 * z31);
            let z2 = -(l1 * z21 + l2 * z22 + l3 * z32);
            let z3 = -(l1 * z31 + l2 * z32 + l3 * z33);
            let z0 = own.per_pivot - (l1 * z1 + l2 * z2 + l3 * z3);
            let beside = z1 * near[DEGREE - 1] + z2 * next[DEGREE - 2] + z3 * far[DEGREE - 3];
            trace += z0 * diagonal[DEGREE] + 2.0 * beside;
            let c0 = own.value * own.per_pivot - (l1 * c1 + l2 * c2 + l3 * c3);
            *coefficient = c0;
            [z33, z32, z31, z22, z21, z11] = [z22, z21, z2, z11, z1, z0];
            [c3, c2, c1] = [c2, c1, c0];
        }
        trace
    }
}

/// The next row of the factors from the matrix's own, and the three rows above, the nearest first; with the
/// share of the diagonal entry that is left.
#[inline]
fn reduced(
    [third, second, first, diagonal]: band::Row,
    moment: f64,
    [near, next, far]: &[FactorRow; DEGREE],
) -> (FactorRow, f64) {
    let second = second - third * next.left[0];
    let first = first - (third * near.left[1] + second * near.left[0]);
    let left = [first * near.per_pivot, second * next.per_pivot, third * far.per_pivot];
    let pivot = diagonal - (third * left[2] + second * left[1] + first * left[0]);
    let value = moment - (left[0] * near.value + left[1] * next.value + left[2] * far.value);
    let relative_pivot = if diagonal > 0.0 { pivot / diagonal } else { 0.0 };
    (FactorRow { left, per_pivot: 1.0 / pivot, value }, relative_pivot)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Basis;
    use crate::integrals::{mass, roughness};

    #[test]
    fn a_trial_finds_the_coefficients_and_the_trace_of_dense_algebra() {
        let breakpoints: Vec<f64> = (0..12).map(|i| f64::from(i * i) / 7.0).collect();
        let basis = Basis::clamped(&breakpoints).unwrap();
        let (gram, penalty) = (mass(&basis), roughness(&basis, 2));
        let moments: Vec<f64> = (0..gram.size()).map(|i| f64::from(i as u32 % 5) - 1.5).collect();
        let mut trials = Trials::new(&gram, &penalty, &moments).unwrap();
        for lambda in [1e-6, 1e-2, 30.0] {
            let whole = gram.dense() + lambda * penalty.dense();
            let inverse = whole.try_inverse().unwrap();
            let expected = &inverse * nalgebra::DVector::from_column_slice(&moments);
            let (coefficients, freedom) = trials.at(lambda).unwrap();
            for (found, expected) in coefficients.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0));
            }
            let expected = (inverse * gram.dense()).trace();
            assert!((freedom - expected).abs() < 1e-9 * expected, "{freedom} {expected}");
        }
    }

    #[test]
    fn singular_equations_and_a_periodic_basis_have_no_trial() {
        let basis = Basis::uniform_clamped(0.0, 9.0, 9).unwrap();
        let rough = roughness(&basis, 2);
        let moments = vec![1.0; rough.size()];
        let mut trials = Trials::new(&Skyline::zero(&basis), &rough, &moments).unwrap();
        assert!(trials.at(1.0).is_none());
        let around = Basis::uniform_periodic(0.0, 9.0, 9).unwrap();
        let rough = roughness(&around, 2);
        assert!(Trials::new(&rough, &rough, &moments).is_none());
    }
}
