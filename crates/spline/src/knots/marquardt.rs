//! Nonlinear least squares for a few unknowns within symmetric bounds: Levenberg-Marquardt steps.

use nalgebra::{DMatrix, DVector};

/// Step of the forward differences; half of a double's digits.
const DIFFERENCE: f64 = 1e-7;

/// The first damping, relative to the largest squared column of the Jacobian.
const FIRST_DAMPING: f64 = 1e-3;

/// A step that does as well as expected reduces the damping by at most this factor (Nielsen 1999).
const EASED: f64 = 1.0 / 3.0;

/// A step that fails is retried with the damping raised by this factor, or growing powers of it, up
/// to this many times.
const RAISED: f64 = 2.0;
const TRIALS: i32 = 6;

/// A successful step is retried with twice, four times ... its length, up to this many times: each
/// try costs one evaluation, whereas the next step would cost one per unknown. The steps are too
/// short where residuals stay large, because their curvature is neglected.
const STRETCHES: i32 = 5;

/// A step that reduces the sum of squares by less than this share is the last one.
const ENOUGH: f64 = 1e-3;

/// Minimises the sum of squares of `residuals` starting from zero, with each unknown within
/// ±`reach`, in at most `budget` steps. Unknowns should have similar scales. A step to a point
/// where the residuals are `None` is rejected. Sources: Levenberg 1944, Marquardt 1963; the damping
/// by Nielsen, Damping Parameter in Marquardt's Method, 1999.
pub fn least_squares(
    residuals: impl Fn(&[f64]) -> Option<Vec<f64>>,
    reach: &[f64],
    budget: usize,
) -> Vec<f64> {
    let mut at = vec![0.0; reach.len()];
    let Some(mut left) = residuals(&at).map(DVector::from) else { return at };
    let mut damping = None;
    for _ in 0..budget {
        let Some(jacobian) = jacobian(&residuals, &at, reach, &left) else { break };
        let (gram, slope) = (jacobian.tr_mul(&jacobian), jacobian.tr_mul(&left));
        let before = left.norm_squared();
        let mut damped = damping.unwrap_or(FIRST_DAMPING * gram.diagonal().max());
        let taken = (0..TRIALS).find_map(|trial| {
            let step = step(&at, &gram, &slope, damped, reach)?;
            let expected = -(2.0 * slope.dot(&step) + step.dot(&(&gram * &step)));
            let taken = moved(&residuals, &at, &step, reach);
            let gain = taken.as_ref().map_or(-1.0, |(_, left)| before - left.norm_squared());
            if gain > 0.0 {
                damped *= (1.0 - (2.0 * gain / expected - 1.0).powi(3)).max(EASED);
                return taken.map(|taken| stretched(&residuals, &at, &step, reach, taken));
            }
            damped *= RAISED.powi(trial + 1);
            None
        });
        let Some(taken) = taken else { break };
        (at, left) = taken;
        damping = Some(damped);
        if before - left.norm_squared() < ENOUGH * before {
            break;
        }
    }
    at
}

/// A point and its residuals.
type Place = (Vec<f64>, DVector<f64>);

/// The point one step away, clamped to the bounds.
fn moved(
    residuals: &impl Fn(&[f64]) -> Option<Vec<f64>>,
    at: &[f64],
    step: &DVector<f64>,
    reach: &[f64],
) -> Option<Place> {
    let ends = at.iter().zip(step.iter()).zip(reach);
    let next: Vec<f64> =
        ends.map(|((at, step), reach)| (at + step).clamp(-reach, *reach)).collect();
    let left = residuals(&next)?;
    Some((next, DVector::from(left)))
}

/// The best of a step already taken and ever longer ones, up to the first that is worse.
fn stretched(
    residuals: &impl Fn(&[f64]) -> Option<Vec<f64>>,
    at: &[f64],
    step: &DVector<f64>,
    reach: &[f64],
    taken: Place,
) -> Place {
    let mut best = taken;
    for doublings in 1..=STRETCHES {
        let further = moved(residuals, at, &(step * 2.0_f64.powi(doublings)), reach);
        let lower = |(_, left): &Place| left.norm_squared() < best.1.norm_squared();
        match further.filter(lower) {
            Some(place) => best = place,
            None => break,
        }
    }
    best
}

/// The residuals' derivatives by finite differences, taken towards the middle of the bounds.
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

/// One damped step. Unknowns at a bound that the step would cross stay there, and the step of the
/// others is computed without them.
fn step(
    at: &[f64],
    gram: &DMatrix<f64>,
    slope: &DVector<f64>,
    damping: f64,
    reach: &[f64],
) -> Option<DVector<f64>> {
    let held = |i: usize| at[i].abs() >= reach[i] && at[i] * slope[i] < 0.0;
    let free: Vec<usize> = (0..at.len()).filter(|i| !held(*i)).collect();
    let system = DMatrix::from_fn(free.len(), free.len(), |a, b| {
        gram[(free[a], free[b])] + if a == b { damping } else { 0.0 }
    });
    let right = DVector::from_fn(free.len(), |a, _| -slope[free[a]]);
    let found = system.cholesky()?.solve(&right);
    let mut step = DVector::zeros(at.len());
    for (i, found) in free.into_iter().zip(found.iter()) {
        step[i] = (at[i] + found).clamp(-reach[i], reach[i]) - at[i];
    }
    Some(step)
}
