//! The fit of a cloud: what it must give back exactly, its laws, and what it refuses.
#![allow(clippy::unwrap_used)]

use std::f64::consts::TAU;

use gaiter_spline::{
    Basis, CloudData, CloudFit, CloudMethod, CloudSmoothing, FitFault, Surface, fit_cloud,
};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use support::chance::Chance;

/// Height of the tubes, mm.
const HEIGHT_MM: f64 = 300.0;

/// Breakpoints along, 9 control rows; and around, 8 control columns, alike when turned round.
const ALONG: [f64; 7] = [0.0, 40.0, 90.0, 150.0, 190.0, 260.0, HEIGHT_MM];
const AROUND: [f64; 9] = [0.0, 0.1, 0.22, 0.38, 0.5, 0.62, 0.78, 0.9, 1.0];

fn bases() -> (Basis, Basis) {
    (Basis::clamped(&ALONG).unwrap(), Basis::periodic(&AROUND).unwrap())
}

/// A bumpy tube in these bases whose z is u.
fn tube() -> Surface {
    let (along, around) = bases();
    let (heights, turns) = (along.greville(), around.greville());
    let control = |k: usize| {
        let (i, j) = (k / 8, k % 8);
        let radius = 50.0 + 0.05 * heights[i] + 4.0 * ((3 * i * i + 5 * j + i * j) as f64).sin();
        let angle = TAU * turns[j];
        Point3::new(radius * angle.cos(), radius * angle.sin(), heights[i])
    };
    let points = (0..9 * 8).map(control).collect();
    Surface::new(along, around, points).unwrap()
}

/// `count` points of the tube with noise along the radius, and their places around.
fn scattered(count: usize, sigma_mm: f64, seed: u64) -> (Vec<Point3<f64>>, Vec<f64>) {
    let (tube, mut chance) = (tube(), Chance(seed));
    let draw = |_| {
        let (u, v) = (HEIGHT_MM * 0.5 * (1.0 + chance.even(1.0)), 0.5 * (1.0 + chance.even(1.0)));
        let point = tube.point(u, v);
        let out = Vector3::new(point.x, point.y, 0.0).normalize();
        (point + sigma_mm * chance.normal() * out, v)
    };
    (0..count).map(draw).unzip()
}

fn fitted(points: &[Point3<f64>], around: &[f64], method: &CloudMethod) -> CloudFit {
    let bases = bases();
    fit_cloud(&CloudData { points, around }, bases.0, bases.1, method).unwrap()
}

fn plain(smoothing: CloudSmoothing) -> CloudMethod {
    CloudMethod { smoothing, robust: false, least_scale_mm: 0.3 }
}

/// Largest distance of the control points of two surfaces.
fn apart(a: &Surface, b: &Surface) -> f64 {
    let pairs = a.control_points().iter().zip(b.control_points());
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn points_of_a_spline_surface_give_that_surface_back() {
    let (points, around) = scattered(2000, 0.0, 1);
    let none = fitted(&points, &around, &plain(CloudSmoothing::None));
    assert!(apart(&none.surface, &tube()) < 1e-5, "{}", apart(&none.surface, &tube()));
    let robust = fitted(&points, &around, &CloudMethod::default());
    assert!(apart(&robust.surface, &tube()) < 1e-2, "{}", apart(&robust.surface, &tube()));
    assert!(robust.weights.iter().all(|weight| *weight == 1.0));
    assert!(robust.sigma_mm < 1e-3 && robust.edf > 71.0);
}

#[test]
fn curves_of_constant_u_are_plane_sections_at_that_height() {
    let (points, around) = scattered(2000, 0.8, 2);
    let surface = fitted(&points, &around, &CloudMethod::default()).surface;
    for i in 0..=50 {
        let u = HEIGHT_MM * f64::from(i) / 50.0;
        assert!((surface.point(u, 0.37).z - u).abs() < 1e-12 * HEIGHT_MM);
    }
}

#[test]
fn sigma_tells_the_noise_robust_or_not() {
    let (points, around) = scattered(20_000, 0.8, 3);
    for method in [CloudMethod::default(), plain(CloudSmoothing::Gcv), plain(CloudSmoothing::None)]
    {
        let fit = fitted(&points, &around, &method);
        // The standard error of a standard deviation of 20 000 is 0.5 %.
        assert!((fit.sigma_mm / 0.8 - 1.0).abs() < 0.015, "{method:?} {}", fit.sigma_mm);
        assert!(apart(&fit.surface, &tube()) < 1.0, "{}", apart(&fit.surface, &tube()));
    }
}

#[test]
fn smoothed_without_end_a_tube_keeps_a_parabola_along_and_its_mean_around() {
    let (points, around) = scattered(5000, 0.0, 4);
    let fit = fitted(&points, &around, &plain(CloudSmoothing::Fixed([1e7; 2])));
    assert!((fit.edf - 3.0).abs() < 1e-2, "{}", fit.edf);
    for u in [10.0, 200.0] {
        assert!((fit.surface.point(u, 0.1) - fit.surface.point(u, 0.6)).norm() < 0.05);
    }
    let free = fitted(&points, &around, &plain(CloudSmoothing::None));
    assert!((free.edf - 72.0).abs() < 1e-3, "{}", free.edf);
}

#[test]
fn the_order_of_the_points_does_not_matter() {
    let (points, around) = scattered(3000, 0.5, 5);
    let turned = |v: &[f64]| v.iter().rev().copied().collect::<Vec<_>>();
    let backwards: Vec<_> = points.iter().rev().copied().collect();
    let one = fitted(&points, &around, &CloudMethod::default());
    let other = fitted(&backwards, &turned(&around), &CloudMethod::default());
    assert!(apart(&one.surface, &other.surface) < 1e-9);
    let weights = one.weights.iter().zip(turned(&other.weights));
    assert!(weights.clone().all(|(a, b)| (a - b).abs() < 1e-9));
    assert!(weights.into_iter().any(|(a, _)| *a < 1.0));
}

/// The fit of the points after `change`, which must be the changed fit; `turned` tells places around.
fn obeys(
    change: impl Fn(&Point3<f64>) -> Point3<f64>,
    turned: impl Fn(f64) -> f64,
    scale: f64,
    seed: u64,
) {
    let (mut points, around) = scattered(1500, 0.5, seed);
    points[7].x += 15.0;
    let one = fitted(&points, &around, &CloudMethod::default());
    let moved: Vec<_> = points.iter().map(&change).collect();
    let places: Vec<f64> = around.iter().map(|v| turned(*v)).collect();
    let heights = ALONG.map(|z| change(&Point3::new(0.0, 0.0, z)).z);
    let along = Basis::clamped(&heights).unwrap();
    let method = CloudMethod { least_scale_mm: 0.3 * scale, ..CloudMethod::default() };
    let data = CloudData { points: &moved, around: &places };
    let other = fit_cloud(&data, along, bases().1, &method).unwrap();
    for (u, v) in [(0.0, 0.0), (33.0, 0.95), (150.0, 0.4), (299.0, 0.6)] {
        let expected = change(&one.surface.point(u, v));
        let height = change(&Point3::new(0.0, 0.0, u)).z;
        let found = other.surface.point(height, turned(v));
        assert!((found - expected).norm() < 1e-8 * scale, "{found} {expected}");
    }
    assert!((other.sigma_mm / one.sigma_mm / scale - 1.0).abs() < 1e-9);
    assert!(other.weights.iter().zip(&one.weights).all(|(a, b)| (a - b).abs() < 1e-7));
    assert_eq!(other.weights[7], 0.0);
    assert!((other.edf - one.edf).abs() < 1e-6);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn a_moved_cloud_gives_the_moved_surface(x in -900.0..900.0, z in -900.0..900.0, seed in 0_u64..99) {
        obeys(|point| point + Vector3::new(x, -0.3 * x, z), |v| v + 3.0, 1.0, seed);
    }

    #[test]
    fn a_turned_cloud_gives_the_turned_surface(angle in -3.0..3.0_f64, seed in 0_u64..99) {
        let (sin, cos) = angle.sin_cos();
        let turn = |p: &Point3<f64>| Point3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z);
        obeys(turn, |v| v, 1.0, seed);
    }

    #[test]
    fn a_scaled_cloud_gives_the_scaled_surface(scale in 0.05..20.0_f64, seed in 0_u64..99) {
        obeys(|point| Point3::from(scale * point.coords), |v| v, scale, seed);
    }

    #[test]
    fn a_mirrored_cloud_gives_the_mirrored_surface(seed in 0_u64..99) {
        obeys(|p| Point3::new(p.x, -p.y, p.z), |v| -v, 1.0, seed);
    }
}

#[test]
fn every_point_twice_changes_nothing_but_the_count() {
    let (points, around) = scattered(2000, 0.5, 6);
    let twice = |v: &[f64]| [v, v].concat();
    for smoothing in [CloudSmoothing::None, CloudSmoothing::Fixed([1e-3, 1e-2])] {
        let method = CloudMethod { smoothing, ..CloudMethod::default() };
        let one = fitted(&points, &around, &method);
        let points = [points.clone(), points.clone()].concat();
        let both = fitted(&points, &twice(&around), &method);
        assert!(apart(&one.surface, &both.surface) < 1e-8);
    }
}

fn refused(points: &[Point3<f64>], around: &[f64], method: &CloudMethod) -> FitFault {
    let (along, rounds) = bases();
    fit_cloud(&CloudData { points, around }, along, rounds, method).map(|_| ()).unwrap_err()
}

#[test]
fn clouds_that_tell_no_surface_are_refused_with_the_reason() {
    let (points, around) = scattered(1000, 0.5, 7);
    let method = CloudMethod::default();
    let changed = |change: &dyn Fn(&mut Point3<f64>, &mut f64)| {
        let (mut points, mut around) = (points.clone(), around.clone());
        points.iter_mut().zip(&mut around).for_each(|(point, v)| change(point, v));
        refused(&points, &around, &method)
    };

    assert_eq!(
        refused(&points[1..], &around, &method),
        FitFault::PlacesDiffer { points: 999, around: 1000 }
    );
    let few = refused(&points[..71], &around[..71], &method);
    assert_eq!(few, FitFault::TooFewPoints { points: 71, control_points: 72 });
    assert_eq!(few.to_string(), "71 points for 72 control points, which need at least as many");
    assert_eq!(
        refused(&[], &[], &method),
        FitFault::TooFewPoints { points: 0, control_points: 72 }
    );

    let mut spoilt = points.clone();
    spoilt[13].y = f64::NAN;
    assert_eq!(refused(&spoilt, &around, &method), FitFault::NotFinite { index: 13 });
    let mut spoilt = around.clone();
    spoilt[14] = f64::INFINITY;
    assert_eq!(refused(&points, &spoilt, &method), FitFault::NotFinite { index: 14 });

    let one_place = FitFault::TooFewPlaces { found: 1, needed: 4 };
    let ring = |point: &mut Point3<f64>, _: &mut f64| point.z = 120.0;
    assert_eq!(changed(&ring), one_place);
    let line = |_: &mut Point3<f64>, v: &mut f64| *v = 3.25;
    assert_eq!(changed(&line), one_place);
    let same = |point: &mut Point3<f64>, v: &mut f64| (*point, *v) = (points[0], 0.2);
    assert_eq!(changed(&same), one_place);

    let raised = |point: &mut Point3<f64>, _: &mut f64| point.z += 1.0;
    let above = points.iter().position(|point| point.z > HEIGHT_MM - 1.0).unwrap();
    let x = points[above].z + 1.0;
    let outside = FitFault::OutsideDomain { index: above, x, from: 0.0, to: HEIGHT_MM };
    assert_eq!(changed(&raised), outside);

    // All points in the lower half, on one side, or in a ring of 30 mm.
    let half = |point: &mut Point3<f64>, _: &mut f64| point.z /= 2.0;
    assert_eq!(changed(&half), FitFault::TooLittleSeen { found: 120, of: 225, needed: 169 });
    let side = |_: &mut Point3<f64>, v: &mut f64| *v = 0.3 * *v + 0.1;
    assert_eq!(changed(&side), FitFault::TooLittleSeen { found: 75, of: 225, needed: 169 });
    let low = |point: &mut Point3<f64>, _: &mut f64| point.z /= 10.0;
    assert_eq!(changed(&low), FitFault::TooLittleSeen { found: 30, of: 225, needed: 169 });

    for lambda in [-1.0, f64::NAN] {
        let fault = refused(&points, &around, &plain(CloudSmoothing::Fixed([0.1, lambda])));
        assert!(matches!(fault, FitFault::BadLambda { .. }), "{fault}");
    }
    let wrong =
        fit_cloud(&CloudData { points: &points, around: &around }, bases().1, bases().1, &method);
    assert!(wrong.is_err());
}
