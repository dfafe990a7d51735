//! Fits of noisy grids.
#![allow(clippy::unwrap_used)]

use gaiter_spline::{
    GridData, GridDomain, GridMethod, GridSmoothing, Knots, SurfaceFit, fit_grid_by,
};
use nalgebra::{Point3, Vector3};
use support::chance::Chance;
use support::metric::{parameters, true_error};
use support::test_leg;

const WHOLE: GridDomain = GridDomain { along: [0.0, 1.0], around_from: 0.0, period: 1.0 };

/// The test leg's points moved along the horizontal part of its normal.
fn moved(mut by_mm: impl FnMut() -> f64) -> Vec<Point3<f64>> {
    let out = |point: &Point3<f64>| {
        let h = 1e-4;
        let slope = |axis: Vector3<f64>| {
            test_leg::outside_mm(&(point + h * axis)) - test_leg::outside_mm(&(point - h * axis))
        };
        Vector3::new(slope(Vector3::x()), slope(Vector3::y()), 0.0).normalize()
    };
    test_leg::grid().iter().map(|point| point + by_mm() * out(point)).collect()
}

fn fitted(points: &[Point3<f64>], method: &GridMethod) -> SurfaceFit {
    let (along, around) = parameters(points);
    fit_grid_by(&GridData { along: &along, around: &around, points }, &WHOLE, method).unwrap()
}

fn method(
    control_points: [usize; 2],
    knots: Knots,
    smoothing: GridSmoothing,
    robust: bool,
) -> GridMethod {
    GridMethod { control_points, knots, smoothing, robust, marks: [vec![], vec![]] }
}

fn noisy(sigma_mm: f64, seed: u64) -> Vec<Point3<f64>> {
    let mut chance = Chance(seed);
    moved(|| sigma_mm * chance.normal())
}

/// Noise of 0.5 mm, and one point in fifty 5 to 20 mm further out.
fn with_outliers(seed: u64) -> (Vec<Point3<f64>>, Vec<usize>) {
    let mut chance = Chance(seed);
    let mut outliers = Vec::new();
    let mut index = 0;
    let points = moved(|| {
        let noise = 0.5 * chance.normal();
        let outlier = chance.below(50) == 0;
        outliers.extend(outlier.then_some(index));
        index += 1;
        noise + if outlier { 12.5 + chance.even(7.5) } else { 0.0 }
    });
    (points, outliers)
}

#[test]
fn smoothing_beats_plain_least_squares_as_published() {
    // Mean error of plain and of smoothed adaptive fits in mm, noise of 0.5 mm: the reference's
    // table 4, one seed; the spread over seeds is 5 %.
    for (size, plain_mm, smooth_mm) in [([30, 24], 0.1467, 0.1178), ([40, 32], 0.1830, 0.1176)] {
        for seed in [1, 2, 3] {
            let points = noisy(0.5, seed);
            let error = |knots, smoothing| {
                let fit = fitted(&points, &method(size, knots, smoothing, false));
                true_error(&fit.surface)
            };
            let plain = error(Knots::Uniform, GridSmoothing::None);
            let smooth = error(Knots::Adaptive, GridSmoothing::Gcv);
            assert!((plain[0] / plain_mm - 1.0).abs() < 0.08, "{size:?} {seed}: {plain:?}");
            assert!((smooth[0] / smooth_mm - 1.0).abs() < 0.08, "{size:?} {seed}: {smooth:?}");
            assert!(smooth[2] < 1.5, "{size:?} {seed}: largest {} mm", smooth[2]);
        }
    }
}

#[test]
fn few_control_points_are_worth_polishing_under_noise() {
    let points = noisy(0.5, 4);
    let error = |knots| {
        let fit = fitted(&points, &method([20, 16], knots, GridSmoothing::Gcv, false));
        true_error(&fit.surface)[0]
    };
    // 0.1805 plain and 0.1576 adaptive in the reference.
    let (adaptive, polished) = (error(Knots::Adaptive), error(Knots::Polished));
    assert!(adaptive < 0.175 && polished < 0.125, "{adaptive} {polished}");
}

#[test]
fn the_noise_is_told() {
    for sigma_mm in [0.25, 1.0] {
        let wanted = method([40, 32], Knots::Adaptive, GridSmoothing::Gcv, false);
        let fit = fitted(&noisy(sigma_mm, 5), &wanted);
        // The standard error of a standard deviation of 5760 points is 1 %.
        assert!((fit.sigma_mm / sigma_mm - 1.0).abs() < 0.03, "{sigma_mm}: {}", fit.sigma_mm);
        assert!(fit.edf < 800.0 && fit.lambdas.iter().all(|lambda| *lambda > 1e-8));
    }
}

#[test]
fn clean_data_are_hardly_smoothed() {
    let smooth = method([30, 24], Knots::Adaptive, GridSmoothing::Gcv, false);
    let [mean, ..] = true_error(&fitted(&test_leg::grid(), &smooth).surface);
    // 0.0091 mm without smoothing.
    assert!(mean < 0.0095, "{mean}");
}

#[test]
fn outliers_are_found_and_left_out() {
    for seed in [1, 2] {
        let (points, outliers) = with_outliers(seed);
        let plain = fitted(&points, &method([30, 24], Knots::Uniform, GridSmoothing::None, false));
        let robust = fitted(&points, &method([30, 24], Knots::Adaptive, GridSmoothing::Gcv, true));
        assert!(plain.outliers.is_empty());
        let missed = outliers.iter().filter(|i| !robust.outliers.contains(i)).count();
        let wrong = robust.outliers.iter().filter(|i| !outliers.contains(i)).count();
        assert!(missed <= 3 && wrong <= 5, "{missed} missed, {wrong} wrong");
        let ([plain, ..], [mean, _, largest, _]) =
            (true_error(&plain.surface), true_error(&robust.surface));
        // The reference's Huber weights leave 0.156 mm, and 5.8 mm at the worst.
        assert!(plain > 0.4 && mean < 0.14 && largest < 1.5, "{plain} {mean} {largest}");
        assert!((robust.sigma_mm / 0.5 - 1.0).abs() < 0.08, "{}", robust.sigma_mm);
    }
}

#[test]
fn a_bump_is_no_outlier() {
    // The malleoli rise by 7 mm over two sections, which 20 rows of control points cannot follow.
    let robust = method([20, 16], Knots::Uniform, GridSmoothing::None, true);
    let fit = fitted(&noisy(0.5, 6), &robust);
    assert!(fit.outliers.len() <= 10, "{} points left out", fit.outliers.len());
    let largest = true_error(&fit.surface)[2];
    assert!(largest < 3.0, "{largest}");
}
