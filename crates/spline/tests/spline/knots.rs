//! Where the knots of a grid fit go, and what that is worth on the test leg.
#![allow(clippy::unwrap_used)]

use gaiter_spline::{GridData, GridDomain, GridMethod, Knots, KnotsUsed, SurfaceFit, fit_grid_by};
use nalgebra::{Point3, Rotation3, Vector3};
use support::metric::{parameters, true_error};
use support::test_leg;

const WHOLE: GridDomain = GridDomain { along: [0.0, 1.0], around_from: 0.0, period: 1.0 };

fn plain(control_points: [usize; 2], knots: Knots) -> GridMethod {
    GridMethod { control_points, knots, marks: Vec::new() }
}

/// The fit to points with the clean test leg's parameters.
fn fit_by(points: &[Point3<f64>], method: &GridMethod) -> SurfaceFit {
    let (along, around) = parameters(&test_leg::grid());
    let data = GridData { along: &along, around: &around, points };
    fit_grid_by(&data, &WHOLE, method).unwrap()
}

fn fitted(control_points: [usize; 2], knots: Knots) -> SurfaceFit {
    fit_by(&test_leg::grid(), &plain(control_points, knots))
}

#[test]
fn adaptive_knots_lie_where_the_reference_has_them() {
    let along = [
        0.022044, 0.043204, 0.063617, 0.083910, 0.105201, 0.130066, 0.162154, 0.203555, 0.245025,
        0.286657, 0.330693, 0.376897, 0.418941, 0.453169, 0.481805, 0.507857, 0.534077, 0.561610,
        0.591197, 0.623906, 0.661796, 0.707297, 0.757120, 0.810362, 0.869103, 0.932542,
    ];
    let around = [
        0.043331, 0.086129, 0.126370, 0.165074, 0.202051, 0.238889, 0.277303, 0.317050, 0.358445,
        0.398502, 0.436218, 0.474665, 0.518028, 0.568050, 0.618007, 0.663981, 0.706002, 0.746056,
        0.787697, 0.832170, 0.876916, 0.919017, 0.959128,
    ];
    let fit = fitted([30, 24], Knots::Adaptive);
    assert_eq!(fit.knots, [KnotsUsed::Adaptive; 2]);
    let bases = [fit.surface.along(), fit.surface.around()];
    for (basis, expected) in bases.into_iter().zip([&along[..], &around[..]]) {
        let found = &basis.breakpoints()[1..=expected.len()];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
    }
}

#[test]
fn adaptive_knots_reach_the_published_figures() {
    let published = [
        ([20, 16], 0.16209, [0.0916, 0.1472, 1.429, 0.1649]),
        ([30, 24], 0.02027, [0.0091, 0.0169, 0.281, 0.0168]),
        ([40, 32], 0.00496, [0.0021, 0.0054, 0.106, 0.0039]),
    ];
    for (control_points, rms_mm, expected) in published {
        let fit = fitted(control_points, Knots::Adaptive);
        assert!((fit.rms_mm - rms_mm).abs() < 6e-6, "{control_points:?}: {}", fit.rms_mm);
        let found = true_error(&fit.surface);
        for ((found, expected), digit) in found.iter().zip(expected).zip([1e-4, 1e-4, 1e-3, 1e-4]) {
            assert!(
                (found - expected).abs() < 0.6 * digit,
                "{control_points:?}: {found} {expected}"
            );
        }
    }
}

#[test]
fn knots_that_serve_worse_than_equal_ones_are_not_used() {
    // The reference: with 11 x 8 control points 0.822 mm with equal spans and 1.209 mm
    // with adaptive ones.
    let even = fitted([11, 8], Knots::Uniform);
    assert_eq!(even.knots, [KnotsUsed::Uniform; 2]);
    let even_mm = true_error(&even.surface)[0];
    assert!((even_mm / 0.822 - 1.0).abs() < 0.02, "{even_mm} mm");
    let fit = fitted([11, 8], Knots::Adaptive);
    let mm = true_error(&fit.surface)[0];
    assert_eq!(fit.knots, [KnotsUsed::UniformInstead, KnotsUsed::Adaptive]);
    assert_eq!(fit.surface.along(), even.surface.along());
    assert!(fit.rms_mm <= even.rms_mm && mm < even_mm, "{mm} mm");
}

#[test]
fn the_seam_of_adaptive_knots_is_c2() {
    let fit = fitted([30, 24], Knots::Adaptive);
    let (from, to) = fit.surface.around().domain();
    let step = 1e-9;
    for u in [0.0, 0.13, 0.5, 0.77, 1.0] {
        let here = fit.surface.derivatives(u, from);
        let there = fit.surface.derivatives(u, to - step);
        assert!((here.point - there.point).norm() < 1e-5);
        // The third derivative times the step, some 1e5 mm, is the largest difference there is.
        assert!((here.dv - there.dv).norm() < 1e-3 * here.dv.norm(), "{u}");
        assert!((here.dvv - there.dvv).norm() < 1e-3 * here.dvv.norm().max(1e3), "{u}");
    }
    assert_eq!(fit.surface.point(0.3, from), fit.surface.point(0.3, to));
}

/// Knots agree and control points are the original ones moved.
fn moves_along(moved: impl Fn(&Point3<f64>) -> Point3<f64>, scale: f64) {
    let points = test_leg::grid();
    let method = plain([20, 16], Knots::Adaptive);
    let before = fit_by(&points, &method).surface;
    let after = fit_by(&points.iter().map(&moved).collect::<Vec<_>>(), &method).surface;
    let bases = [(before.along(), after.along()), (before.around(), after.around())];
    for (before, after) in bases {
        for (a, b) in before.breakpoints().iter().zip(after.breakpoints()) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }
    for (before, after) in before.control_points().iter().zip(after.control_points()) {
        let missed = (moved(before) - after).norm() / scale;
        assert!(missed < 1e-3, "{missed}");
    }
}

#[test]
fn turning_moving_and_scaling_the_leg_leaves_its_knots() {
    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    moves_along(|point| turn * point, 1.0);
    moves_along(|point| point + Vector3::new(500.0, -200.0, 1000.0), 1.0);
    moves_along(|point| point * 1000.0, 1000.0);
}

#[test]
fn starting_elsewhere_around_turns_the_surface() {
    let points = test_leg::grid();
    let (along, around) = parameters(&points);
    // The same columns, told from the 20th on, at the same parameters.
    let turned: Vec<_> =
        points.chunks(72).flat_map(|row| [&row[20..], &row[..20]].concat()).collect();
    let elsewhere = [&around[20..], &around[..20]].concat();
    let method = plain([30, 24], Knots::Adaptive);
    let here = fit_by(&points, &method).surface;
    let data = GridData { along: &along, around: &elsewhere, points: &turned };
    let there = fit_grid_by(&data, &WHOLE, &method).unwrap().surface;
    for k in 0..40 {
        let (u, v) = (f64::from(k) / 39.0, 0.37 * f64::from(k));
        assert!((here.point(u, v) - there.point(u, v)).norm() < 1e-4, "{u} {v}");
    }
}

#[test]
fn a_cylinder_needs_no_knots_anywhere_in_particular() {
    let points: Vec<_> = (0..20)
        .flat_map(|i| (0..36).map(move |j| (f64::from(i), f64::from(j).to_radians() * 10.0)))
        .map(|(z, angle)| Point3::new(40.0 * angle.cos(), 40.0 * angle.sin(), 10.0 * z))
        .collect();
    let along: Vec<f64> = (0..20).map(|i| f64::from(i) / 19.0).collect();
    let around: Vec<f64> = (0..36).map(|j| f64::from(j) / 36.0).collect();
    let data = GridData { along: &along, around: &around, points: &points };
    let fit = fit_grid_by(&data, &WHOLE, &plain([10, 12], Knots::Adaptive)).unwrap();
    assert!(fit.max_mm < 0.02, "{}", fit.max_mm);
    let mut spans = fit.surface.around().breakpoints().windows(2).map(|pair| pair[1] - pair[0]);
    assert!(spans.all(|span| (0.04..0.16).contains(&span)));
}

fn fit_marked(marks: Vec<f64>, knots: Knots) -> SurfaceFit {
    fit_by(&test_leg::grid(), &GridMethod { marks, ..plain([30, 24], knots) })
}

/// Whether a parameter along is a knot.
fn is_knot(fit: &SurfaceFit, mark: f64) -> bool {
    fit.surface.along().breakpoints().iter().any(|place| (place - mark).abs() < 1e-12)
}

#[test]
fn marks_become_knots_and_cost_little() {
    // Heights of B, B1, C and D of the test leg.
    let along = [112.8, 190.0, 308.8, 398.0].map(|z| z / test_leg::HEIGHT_MM);
    for (knots, percent) in [(Knots::Uniform, 0.06), (Knots::Adaptive, 0.03)] {
        let fit = fit_marked(along.to_vec(), knots);
        assert!(along.iter().all(|mark| is_knot(&fit, *mark)), "{knots:?}");
        let [_, _, _, relative] = true_error(&fit.surface);
        assert!(relative < percent, "{knots:?}: {relative} %");
    }
}

#[test]
fn marks_too_close_become_no_knots_and_leave_spans_whole() {
    let marks = [0.5, 0.502, 0.504, 0.999];
    let fit = fit_marked(marks.to_vec(), Knots::Uniform);
    assert_eq!(marks.map(|mark| is_knot(&fit, mark)), [true, false, false, false]);
    let mut spans = fit.surface.along().breakpoints().windows(2).map(|pair| pair[1] - pair[0]);
    assert!(spans.all(|span| span >= 0.25 / 27.0));
}
