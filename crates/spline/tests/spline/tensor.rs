//! The robust fit of scattered data: known functions found again through noise, outliers and holes.

#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use gaiter_spline::{Basis, Scatter, TensorFit, fit_scatter};

/// Length of the domain along.
const LENGTH: f64 = 400.0;

/// Data that never lie closer to the fit than this are outliers.
const LEAST_SCALE: f64 = 0.1;

/// A tube that narrows, with an oval section that turns.
fn truth(u: f64, v: f64) -> f64 {
    50.0 + 8.0 * (u / 90.0).sin() + 3.0 * (2.0 * v + u / 150.0).cos()
}

/// A linear congruential generator (Knuth, MMIX).
struct Chance(u64);

impl Chance {
    fn unit(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

/// 4000 places where `seen` holds, with values of the truth and noise of standard deviation `sigma`.
fn data(sigma: f64, seen: impl Fn(f64, f64) -> bool) -> [Vec<f64>; 3] {
    let mut chance = Chance(3);
    let mut columns = [Vec::new(), Vec::new(), Vec::new()];
    while columns[0].len() < 4000 {
        let (u, v) = (LENGTH * chance.unit(), TAU * chance.unit() - PI);
        let value = truth(u, v) + sigma * chance.normal();
        if seen(u, v) {
            [u, v, value].into_iter().zip(&mut columns).for_each(|(x, column)| column.push(x));
        }
    }
    columns
}

fn fitted([u, v, value]: &[Vec<f64>; 3]) -> TensorFit {
    let along = Basis::uniform_clamped(0.0, LENGTH, 33).unwrap();
    fit_scatter(&Scatter { u, v, value }, along, 48, LEAST_SCALE).unwrap()
}

/// Root mean square and largest error on a grid of places off the breakpoints.
fn errors(fit: &TensorFit) -> (f64, f64) {
    let places = (0..60).flat_map(|i| (0..60).map(move |j| (f64::from(i), f64::from(j))));
    let places = places.map(|(i, j)| (LENGTH * (i + 0.5) / 60.0, TAU * (j + 0.5) / 60.0 - PI));
    let errors: Vec<f64> = places.map(|(u, v)| fit.function.value(u, v) - truth(u, v)).collect();
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    let largest = errors.iter().map(|error| error.abs()).fold(0.0, f64::max);
    ((squares / errors.len() as f64).sqrt(), largest)
}

#[test]
fn noise_is_averaged_away_and_told_by_sigma() {
    let fit = fitted(&data(0.5, |_, _| true));
    let (rms, _) = errors(&fit);
    // A function this smooth has far fewer degrees of freedom than the basis' 36 × 48.
    assert!(rms < 0.15, "{rms}");
    // What Tukey’s weights take from normal errors, √(E[w x²] / E[w]) = √(0.7578 / 0.9151), is given back.
    assert!((fit.sigma / 0.5 - 1.0).abs() < 0.05, "{}", fit.sigma);
    assert!(fit.edf < 400.0, "{}", fit.edf);
}

#[test]
fn without_noise_the_function_is_found_again() {
    let (rms, largest) = errors(&fitted(&data(0.0, |_, _| true)));
    assert!(rms < 0.01 && largest < 0.1, "{rms} {largest}");
}

#[test]
fn a_twentieth_of_outliers_changes_little() {
    let mut columns = data(0.5, |_, _| true);
    let plain = errors(&fitted(&columns)).0;
    columns[2].iter_mut().step_by(20).for_each(|value| *value += 15.0);
    let fit = fitted(&columns);
    let (rms, _) = errors(&fit);
    assert!(rms < 1.3 * plain, "{rms} after {plain}");
    assert!(fit.weights.iter().step_by(20).all(|weight| *weight == 0.0));
}

#[test]
fn a_hole_is_bridged_from_all_sides() {
    let hole = |u: f64, v: f64| !((150.0..200.0).contains(&u) && (0.5..1.3).contains(&v));
    let (_, largest) = errors(&fitted(&data(0.0, hole)));
    assert!(largest < 1.0, "{largest}");
}

#[test]
fn the_standard_error_of_the_mean_over_a_turn_is_that_of_repeated_noise() {
    let columns = data(0.0, |_, _| true);
    let mean = |fit: &TensorFit| {
        let coefficients = fit.function.around_at(200.0);
        coefficients.iter().sum::<f64>() / coefficients.len() as f64
    };
    let mut chance = Chance(11);
    let (mut means, mut stated) = (Vec::new(), 0.0);
    for _ in 0..24 {
        let mut noisy = columns.clone();
        noisy[2].iter_mut().for_each(|value| *value += 0.5 * chance.normal());
        let fit = fitted(&noisy);
        means.push(mean(&fit));
        stated += fit.mean_around_sd(200.0, 0) / 24.0;
    }
    let middle = means.iter().sum::<f64>() / 24.0;
    let spread = (means.iter().map(|mean| (mean - middle).powi(2)).sum::<f64>() / 23.0).sqrt();
    // 24 draws know a spread to 15 %; the Bayesian form includes smoothing bias and is larger.
    assert!((0.6..2.0).contains(&(stated / spread)), "{stated} stated, {spread} found");
}
