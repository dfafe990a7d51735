//! Nonlinear least squares for a few unknowns within symmetric bounds: Levenberg-Marquardt steps.

use nalgebra::{DMatrix, DVector};

/// Step of the forward differences; half the digits of a double.
const DIFFERENCE: f64 = 1e-7;

/// The first damping, relative to the largest squared column of the Jacobian.
const FIRST_DAMPING: f64 = 1e-3;

/// How a step that succeeds eases the damping, and one that fails raises it.
const EASED: f64 = 0.2;
const RAISED: f64 = 4.0;

/// A step that takes less than this share of the sum of squares is the last one.
const ENOUGH: f64 = 1e-5;

/// Minimises the sum of squares of `residuals` from zero on, each unknown within ±`reach`, with at
/// most `budget` steps. Unknowns should be scaled alike. Where the residuals are None a step is not
/// taken. Source: Levenberg 1944, Marquardt 1963; unknowns at their bound are held there.
pub fn least_squares(
    residuals: impl Fn(&[f64]) -> Option<Vec<f64>>,
    reach: &[f64],
    budget: usize,
) -> Vec<f64> {
    let mut at = vec![0.0; reach.len()];
    let Some(mut left) = residuals(&at).map(DVector::from) else { return at };
    let mut damping = None;
    let mut slopes = None;
    for _ in 0..budget {
        let (gram, slope) = match slopes.take() {
            Some(known) => known,
            None => match jacobian(&residuals, &at, reach, &left) {
                Some(jacobian) => (jacobian.tr_mul(&jacobian), jacobian.tr_mul(&left)),
                None => return at,
            },
        };
        let damped = damping.unwrap_or(FIRST_DAMPING * gram.diagonal().max());
        let next = stepped(&at, &gram, &slope, damped, reach);
        let found = next.and_then(|next| Some((residuals(&next).map(DVector::from)?, next)));
        match found.filter(|(next, _)| next.norm_squared() < left.norm_squared()) {
            Some((next, place)) => {
                let gained = 1.0 - next.norm_squared() / left.norm_squared();
                (left, at) = (next, place);
                damping = Some(EASED * damped);
                if gained < ENOUGH {
                    break;
                }
            }
            None => {
                damping = Some(RAISED * damped);
                slopes = Some((gram, slope));
            }
        }
    }
    at
}

/// The residuals' derivatives by differences, taken towards the middle of the bounds.
fn jacobian(
    residuals: &impl Fn(&[f64]) -> Option<Vec<f64>>,
    at: &[f64],
    reach: &[f64],
    here: &DVector<f64>,
) -> Option<DMatrix<f64>> {
    let mut jacobian = DMatrix::zeros(here.len(), at.len());
    for (unknown, reach) in reach.iter().enumerate() {
        let step = if at[unknown] > 0.0 { -DIFFERENCE } else { DIFFERENCE } * reach;
        let mut aside = at.to_vec();
        aside[unknown] += step;
        jacobian.set_column(unknown, &((DVector::from(residuals(&aside)?) - here) / step));
    }
    Some(jacobian)
}

/// The place after one damped step. Unknowns at a bound that the step would cross stay there, and
/// the others' step is found again without them.
fn stepped(
    at: &[f64],
    gram: &DMatrix<f64>,
    slope: &DVector<f64>,
    damping: f64,
    reach: &[f64],
) -> Option<Vec<f64>> {
    let held = |i: usize| at[i].abs() >= reach[i] && at[i] * slope[i] < 0.0;
    let free: Vec<usize> = (0..at.len()).filter(|i| !held(*i)).collect();
    let system = DMatrix::from_fn(free.len(), free.len(), |a, b| {
        gram[(free[a], free[b])] + if a == b { damping } else { 0.0 }
    });
    let right = DVector::from_fn(free.len(), |a, _| -slope[free[a]]);
    let step = system.cholesky()?.solve(&right);
    let mut next = at.to_vec();
    for (i, step) in free.into_iter().zip(step.iter()) {
        next[i] = (next[i] + step).clamp(-reach[i], reach[i]);
    }
    Some(next)
}
