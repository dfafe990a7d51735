//! Robust smoothing fit: data far from the curve lose their weight.

use super::basis::Basis;
use super::fit::{FitFault, Spline, check, ridged, with_statistics};
use super::normal::{Design, NormalEquations};

/// Tukey's constant: residuals beyond this many standard deviations have no weight. 95 % efficiency
/// with normal errors (Huber, Robust Statistics, 1981).
pub(super) const TUKEY: f64 = 4.685;

/// Factor from median absolute deviation to standard deviation, for normal errors.
const MAD_TO_SD: f64 = 1.4826;

/// Maximum number of reweighting rounds.
const ROUNDS_MAX: usize = 8;

/// Weights that change by less than this have converged.
const SETTLED: f64 = 0.02;

/// A robust fit and the final weight of each datum.
#[derive(Debug, Clone)]
pub struct Robust {
    /// The fit with these weights.
    pub spline: Spline,
    /// One weight per datum, 0 to 1.
    pub weights: Vec<f64>,
}

/// Fits a spline with Tukey's biweights, found by repeated fits with the same relative `lambda`
/// (see [`super::Smoothing::Fixed`]). Residuals of `least_scale`, in the unit of the data, are
/// never outliers, so that perfect data are not rejected because of their rounding.
///
/// # Errors
/// As for [`super::fit()`]; also if the outliers leave too few data.
pub fn robust_fit(
    basis: &Basis,
    x: &[f64],
    y: &[f64],
    lambda: f64,
    least_scale: f64,
) -> Result<Robust, FitFault> {
    let lambda = ridged(lambda)?;
    let mut weights = vec![1.0; y.len()];
    check(basis, x, y, &weights)?;
    let design = Design::new(basis, x);
    for _ in 0..ROUNDS_MAX {
        let (_, coefficients) = NormalEquations::new(&design, y, &weights).solved(lambda)?;
        let fitted = design.values(&coefficients);
        let residuals: Vec<f64> = y.iter().zip(&fitted).map(|(y, fit)| y - fit).collect();
        let next = biweights(&residuals, least_scale);
        let moved = weights.iter().zip(&next).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        weights = next;
        if moved < SETTLED {
            break;
        }
    }
    check(basis, x, y, &weights)?;
    let solution = NormalEquations::new(&design, y, &weights).solution(lambda)?;
    Ok(Robust { spline: with_statistics(basis, y, &weights, solution), weights })
}

/// The standard deviation of normal errors whose absolute values have the same median as the
/// residuals', at least `least`. There must be at least one residual.
pub(super) fn scale(residuals: &[f64], least: f64) -> f64 {
    let mut sizes: Vec<f64> = residuals.iter().map(|residual| residual.abs()).collect();
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    (MAD_TO_SD * *median).max(least)
}

/// Tukey's weights of residuals, scaled by their median absolute deviation.
pub fn biweights(residuals: &[f64], least_scale: f64) -> Vec<f64> {
    let reach = TUKEY * scale(residuals, least_scale);
    residuals.iter().map(|residual| (1.0 - (residual / reach).powi(2)).max(0.0).powi(2)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_tenth_of_outliers_changes_nothing() {
        let basis = Basis::uniform_periodic(0.0, TAU, 24).unwrap();
        let x: Vec<f64> = (0..200).map(|i| TAU * f64::from(i) / 200.0).collect();
        let truth = |x: f64| 50.0 + 5.0 * (2.0 * x).cos();
        let mut y: Vec<f64> = x.iter().map(|x| truth(*x)).collect();
        (0..200).step_by(10).for_each(|i| y[i] += 20.0);
        let fit = robust_fit(&basis, &x, &y, 1e-6, 0.01).unwrap();
        let worst = x.iter().map(|x| (fit.spline.value(*x) - truth(*x)).abs()).fold(0.0, f64::max);
        assert!(worst < 0.01, "{worst}");
        assert!((0..200).step_by(10).all(|i| fit.weights[i] == 0.0));
    }

    #[test]
    fn perfect_data_keep_all_their_weight() {
        let basis = Basis::uniform_periodic(0.0, TAU, 24).unwrap();
        let x: Vec<f64> = (0..100).map(|i| TAU * f64::from(i) / 100.0).collect();
        let fit = robust_fit(&basis, &x, &[40.0; 100], 0.0, 0.01).unwrap();
        assert!(fit.weights.iter().all(|weight| *weight > 0.999));
    }
}
