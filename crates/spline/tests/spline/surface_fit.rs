//! The plain tensor-product fit against the reference figures of the test leg.
#![allow(clippy::unwrap_used)]

use gaiter_spline::{Basis, FitFault, GridData, Surface, SurfaceFit, fit_grid};
use nalgebra::Point3;
use support::metric::{parameters, true_error};
use support::test_leg;

#[test]
fn the_test_leg_is_the_one_of_the_reference() {
    let radii = [
        (0.0, 0.0, 40.9713444445),
        (200.0, 0.0, 41.1322191962),
        (185.0, 62.0, 42.4908991454),
        (352.0, 52.0, 44.0333203053),
        (270.0, 70.0, 42.4681113019),
        (100.0, 230.0, 56.5965898016),
        (235.0, 290.0, 74.7071405278),
        (305.0, 318.0, 70.9866731699),
        (90.0, 462.0, 69.7800756684),
        (150.0, 520.0, 64.0946471160),
        (200.0, 800.0, 85.4554863566),
    ];
    for (degrees, z, radius) in radii {
        let found = test_leg::radius_mm(f64::to_radians(degrees), z);
        assert!((found - radius).abs() < 6e-11, "{degrees}° {z} mm: {found}");
    }
    let calf = test_leg::point(235.0_f64.to_radians(), 290.0);
    assert!((calf - Point3::new(-33.43252464, -72.16170428, 290.0)).norm() < 1e-8, "{calf}");
    let girths =
        [(0.0, 264.895), (100.0, 222.321), (300.0, 424.431), (430.0, 370.213), (800.0, 525.744)];
    for (z, girth) in girths {
        let found = test_leg::circumference(z);
        assert!((found - girth).abs() < 6e-4, "{z} mm: {found}");
    }
}

fn fitted(rows: usize, columns: usize) -> SurfaceFit {
    let points = test_leg::grid();
    let (along, around) = parameters(&points);
    let data = GridData { along: &along, around: &around, points: &points };
    let basis_along = Basis::uniform_clamped(0.0, 1.0, rows - 3).unwrap();
    let basis_around = Basis::uniform_periodic(0.0, 1.0, columns).unwrap();
    fit_grid(&data, basis_along, basis_around).unwrap()
}

#[test]
fn plain_fits_leave_the_published_residuals() {
    for (rows, columns, rms_mm) in [(20, 16, 0.24733), (30, 24, 0.10018), (40, 32, 0.04739)] {
        let fit = fitted(rows, columns);
        assert!((fit.rms_mm - rms_mm).abs() < 6e-6, "{rows}x{columns}: {}", fit.rms_mm);
        assert!(fit.max_mm > 3.0 * fit.rms_mm && fit.max_mm < 30.0 * fit.rms_mm);
    }
}

#[test]
fn plain_fits_have_the_published_true_errors() {
    let published = [
        (20, 16, [0.1403, 0.2235, 2.27, 0.2504]),
        (30, 24, [0.0273, 0.0862, 1.39, 0.0546]),
        (40, 32, [0.0090, 0.0392, 0.75, 0.0199]),
    ];
    for (rows, columns, expected) in published {
        let found = true_error(&fitted(rows, columns).surface);
        for ((found, expected), digit) in found.iter().zip(expected).zip([1e-4, 1e-4, 1e-2, 1e-4]) {
            assert!((found - expected).abs() < 0.6 * digit, "{rows}x{columns}: {found} {expected}");
        }
    }
}

#[test]
fn plain_fits_have_the_published_girth_errors() {
    for (rows, columns, percent) in [(20, 16, 0.241), (30, 24, 0.055), (40, 32, 0.033)] {
        let surface = fitted(rows, columns).surface;
        let girth = |z: f64, corners: u32| {
            let v: Vec<f64> = (0..corners).map(|j| f64::from(j) / f64::from(corners)).collect();
            // Iso-parameter curves are the horizontal sections: see the next test.
            let ring = surface.grid(&[z / test_leg::HEIGHT_MM], &v);
            ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| (b - a).norm()).sum::<f64>()
        };
        let error = |z: f64| {
            let (fine, coarse) = (girth(z, 288), girth(z, 144));
            ((fine + (fine - coarse) / 3.0) / test_leg::circumference(z) - 1.0).abs()
        };
        let heights = (0..100).map(|i| 4.0 + 8.0 * f64::from(i));
        let found = heights.map(error).sum::<f64>();
        assert!((found - percent).abs() < 6e-4, "{rows}x{columns}: {found} %");
    }
}

#[test]
fn planar_sections_stay_planar() {
    let surface = fitted(30, 24).surface;
    let greville = surface.along().greville();
    for (i, row) in surface.control_points().chunks(24).enumerate() {
        let height = test_leg::HEIGHT_MM * greville[i];
        assert!(row.iter().all(|point| (point.z - height).abs() < 1e-8), "{i}: {row:?} {height}");
    }
    for (u, v) in [(0.1, 0.3), (0.55, 0.99)] {
        assert!((surface.point(u, v).z - test_leg::HEIGHT_MM * u).abs() < 1e-9);
    }
}

#[test]
fn a_surface_is_fitted_back_from_its_own_points() {
    let along = Basis::clamped(&[0.0, 0.2, 0.3, 0.7, 1.0]).unwrap();
    let around = Basis::periodic(&[0.1, 0.2, 0.5, 0.6, 0.8, 1.1]).unwrap();
    let control: Vec<_> = (0..35)
        .map(|k| f64::from(k * k))
        .map(|k| Point3::new((0.7 * k).sin(), (1.1 * k).cos(), (0.3 * k).sin()))
        .collect();
    let truth = Surface::new(along.clone(), around.clone(), control).unwrap();
    let u: Vec<f64> = (0..25).map(|i| f64::from(i) / 24.0).collect();
    // More than one turn, and not in order.
    let v: Vec<f64> = (0..31).map(|j| 0.37 * f64::from(j)).collect();
    let points = truth.grid(&u, &v);
    let fit =
        fit_grid(&GridData { along: &u, around: &v, points: &points }, along, around).unwrap();
    assert!(fit.max_mm < 1e-8 && fit.rms_mm < fit.max_mm, "{}", fit.max_mm);
    for (found, expected) in fit.surface.control_points().iter().zip(truth.control_points()) {
        assert!((found - expected).norm() < 1e-7, "{found} {expected}");
    }
}

/// The test leg without the rows from 0.45 to 0.55 of its height.
fn leg_with_a_hole() -> (Vec<f64>, Vec<f64>, Vec<Point3<f64>>) {
    let points = test_leg::grid();
    let (along, around) = parameters(&points);
    let rows = points.chunks(test_leg::GRID_COLUMNS).zip(along);
    let kept = rows.filter(|(_, u)| !(0.45..0.55).contains(u));
    let (kept, along): (Vec<_>, Vec<_>) = kept.unzip();
    (along, around, kept.concat())
}

#[test]
fn the_ridge_carries_the_surface_over_missing_rows() {
    let (along, around, points) = leg_with_a_hole();
    let data = GridData { along: &along, around: &around, points: &points };
    let bases = || {
        let along = Basis::uniform_clamped(0.0, 1.0, 57).unwrap();
        (along, Basis::uniform_periodic(0.0, 1.0, 24).unwrap())
    };
    let fit = fit_grid(&data, bases().0, bases().1).unwrap();
    assert!(fit.rms_mm < 0.2, "{}", fit.rms_mm);
    assert!(fit.surface.control_points().iter().all(|point| point.coords.norm() < 2000.0));
}

#[test]
fn a_quartic_along_survives_missing_rows() {
    let skin = |u: f64, v: f64| {
        let (radius, angle) = (50.0 + 40.0 * u.powi(4), std::f64::consts::TAU * v);
        Point3::new(radius * angle.cos(), radius * angle.sin(), 400.0 * u)
    };
    let u: Vec<f64> = (0..60).map(|i| f64::from(i) / 59.0).collect();
    let u: Vec<f64> = u.into_iter().filter(|u| !(0.4..0.6).contains(u)).collect();
    let v: Vec<f64> = (0..48).map(|j| f64::from(j) / 48.0).collect();
    let points: Vec<_> = u.iter().flat_map(|u| v.iter().map(|v| skin(*u, *v))).collect();
    let along = Basis::uniform_clamped(0.0, 1.0, 30).unwrap();
    let around = Basis::uniform_periodic(0.0, 1.0, 48).unwrap();
    let fit =
        fit_grid(&GridData { along: &u, around: &v, points: &points }, along, around).unwrap();
    for v in [0.0, 0.25, 0.5] {
        let missed = (fit.surface.point(0.5, v) - skin(0.5, v)).norm();
        // A ridge on the second derivative would bridge with a cubic and miss 0.004 mm.
        assert!(missed < 1e-3, "{v}: {missed}");
    }
}

#[test]
fn data_that_make_no_surface_are_refused() {
    let (along, around, points) = leg_with_a_hole();
    let refused = |u: &[f64], points: &[Point3<f64>]| {
        let bases = (Basis::uniform_clamped(0.0, 1.0, 9), Basis::uniform_periodic(0.0, 1.0, 9));
        let data = GridData { along: u, around: &around, points };
        fit_grid(&data, bases.0.unwrap(), bases.1.unwrap()).unwrap_err()
    };
    let rows = along.len();
    assert_eq!(
        refused(&along, &points[1..]),
        FitFault::NoGrid { points: 72 * rows - 1, along: rows, around: 72 }
    );
    assert_eq!(refused(&[], &[]), FitFault::NoGrid { points: 0, along: 0, around: 72 });
    let mut holed = points.clone();
    holed[100].z = f64::INFINITY;
    assert_eq!(refused(&along, &holed), FitFault::NotFinite { index: 100 });
    let beyond: Vec<f64> = along.iter().map(|u| u + 0.5).collect();
    assert!(matches!(
        refused(&beyond, &points),
        FitFault::OutsideDomain { from: 0.0, to: 1.0, .. }
    ));
    assert_eq!(refused(&vec![0.5; rows], &points), FitFault::TooFewPlaces { found: 1, needed: 4 });
}
