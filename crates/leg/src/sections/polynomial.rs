//! The paper's section curve: radius over angle in (−π, π] as a polynomial of order 15.
//!
//! In Legendre's basis on θ/π, because the powers of θ have a condition number of 2·10⁸. Not
//! periodic: the two ends at the seam at ±180° match only as well as the fit makes them, and a gap
//! in the points makes it oscillate. Kept because it is the paper's method.

use std::f64::consts::{PI, TAU};

use nalgebra::{DMatrix, DVector};

/// Order of the polynomial (paper 1.1).
pub(super) const ORDER: usize = 15;

/// Singular values below this share of the largest count as zero; the basis is orthogonal, so they
/// occur only if whole ranges of angle have no points.
const RANK_TOLERANCE: f64 = 1e-10;

/// Radius over angle as a polynomial of order 15.
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomial {
    /// Coefficients of the Legendre polynomials of order 0 to 15 in θ/π, mm.
    coefficients: Vec<f64>,
}

/// Least squares through (θ, r); `None` for fewer points than coefficients.
pub(crate) fn fit(angles: &[f64], radii_mm: &[f64]) -> Option<Polynomial> {
    if angles.len() <= ORDER {
        return None;
    }
    let rows: Vec<[f64; ORDER + 1]> = angles.iter().map(|angle| legendre(angle / PI)[0]).collect();
    let design = DMatrix::from_fn(rows.len(), ORDER + 1, |row, column| rows[row][column]);
    let svd = design.svd(true, true);
    let tolerance = RANK_TOLERANCE * svd.singular_values.max();
    let solution = svd.solve(&DVector::from_column_slice(radii_mm), tolerance).ok()?;
    Some(Polynomial { coefficients: solution.iter().copied().collect() })
}

impl Polynomial {
    /// Radius and its first two derivatives with respect to the angle (radians). Angles outside
    /// [−π, π] are wrapped into it, because outside the polynomial is metres away from any skin.
    pub fn derivatives(&self, angle: f64) -> [f64; 3] {
        let home = if angle.abs() > PI { angle - TAU * (angle / TAU).round() } else { angle };
        let values = legendre(home / PI);
        let sum = |order: usize| -> f64 {
            self.coefficients.iter().zip(values[order]).map(|(c, value)| c * value).sum()
        };
        [sum(0), sum(1) / PI, sum(2) / (PI * PI)]
    }
}

/// Legendre polynomials of order 0 to 15 and their first two derivatives, by Bonnet's recursion
/// and the recursion P'(n+1) = P'(n−1) + (2n+1) P(n).
fn legendre(x: f64) -> [[f64; ORDER + 1]; 3] {
    let mut p = [[0.0; ORDER + 1]; 3];
    (p[0][0], p[0][1], p[1][1]) = (1.0, x, 1.0);
    for n in 1..ORDER {
        let order = n as f64;
        p[0][n + 1] = ((2.0 * order + 1.0) * x * p[0][n] - order * p[0][n - 1]) / (order + 1.0);
        p[1][n + 1] = p[1][n - 1] + (2.0 * order + 1.0) * p[0][n];
        p[2][n + 1] = p[2][n - 1] + (2.0 * order + 1.0) * p[1][n];
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_of_order_15_is_found_again_with_its_derivatives() {
        let truth = |t: f64| {
            let x = t / PI;
            [
                30.0 + x - 2.0 * x.powi(15),
                (1.0 - 30.0 * x.powi(14)) / PI,
                -420.0 * x.powi(13) / PI / PI,
            ]
        };
        let angles: Vec<f64> = (0..200).map(|i| -PI + PI * f64::from(i) / 100.0).collect();
        let radii: Vec<f64> = angles.iter().map(|t| truth(*t)[0]).collect();
        let polynomial = fit(&angles, &radii).unwrap();
        for angle in [-3.0, -1.0, 0.0, 0.5, 2.9] {
            for (found, expected) in polynomial.derivatives(angle).iter().zip(truth(angle)) {
                assert!((found - expected).abs() < 1e-8, "{angle}: {found} for {expected}");
            }
        }
    }

    #[test]
    fn a_whole_turn_more_or_less_is_the_same_direction() {
        let angles: Vec<f64> = (0..200).map(|i| -PI + PI * f64::from(i) / 100.0).collect();
        let radii: Vec<f64> = angles.iter().map(|t| 40.0 + 3.0 * (2.0 * t).cos()).collect();
        let polynomial = fit(&angles, &radii).unwrap();
        for angle in [-3.0, -1.0, 0.5, 2.9] {
            let [radius, ..] = polynomial.derivatives(angle);
            for turned in [angle - TAU, angle + TAU] {
                let [found, ..] = polynomial.derivatives(turned);
                assert!((found - radius).abs() < 1e-9, "{turned}: {found} for {radius}");
            }
        }
    }

    #[test]
    fn sixteen_coefficients_need_sixteen_points() {
        assert_eq!(fit(&[0.0; 15], &[1.0; 15]), None);
    }
}
