//! Where the knots of a grid fit go, and what that is worth on the test leg.
#![allow(clippy::unwrap_used)]

use gaiter_spline::{GridData, GridDomain, GridMethod, Knots, KnotsUsed, SurfaceFit, fit_grid_by};
use nalgebra::{Point3, Rotation3, Vector3};
use support::metric::{parameters, true_error};
use support::test_leg;

const WHOLE: GridDomain = GridDomain { along: [0.0, 1.0], around_from: 0.0, period: 1.0 };

fn plain(control_points: [usize; 2], knots: Knots) -> GridMethod {
    GridMethod { control_points, knots, marks: [vec![], vec![]] }
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
fn polished_knots_keep_the_limits() {
    // Mean relative error in percent and largest error in mm; the reference's own polish reaches
    // 0.0835, 0.0089, 0.0030 % and 0.884, 0.124, 0.106 mm.
    for (control_points, percent, largest_mm) in
        [([20, 16], 0.0835, 0.95), ([30, 24], 0.0089, 0.15), ([40, 32], 0.0030, 0.106)]
    {
        let fit = fitted(control_points, Knots::Polished);
        assert_eq!(fit.knots, [KnotsUsed::Polished; 2]);
        let [_, _, largest, relative] = true_error(&fit.surface);
        assert!(relative < percent, "{control_points:?}: {relative} %");
        assert!(largest < largest_mm, "{control_points:?}: {largest} mm");
    }
}

#[test]
fn the_seam_of_polished_knots_is_c2() {
    let fit = fitted([30, 24], Knots::Polished);
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
fn moves_along(moved: impl Fn(&Point3<f64>) -> Point3<f64>, knots: Knots, scale: f64) {
    let points = test_leg::grid();
    let method = plain([20, 16], knots);
    let before = fit_by(&points, &method).surface;
    let after = fit_by(&points.iter().map(&moved).collect::<Vec<_>>(), &method).surface;
    let bases = [(before.along(), after.along()), (before.around(), after.around())];
    for (before, after) in bases {
        for (a, b) in before.breakpoints().iter().zip(after.breakpoints()) {
            assert!((a - b).abs() < 1e-6, "{knots:?}: {a} {b}");
        }
    }
    for (before, after) in before.control_points().iter().zip(after.control_points()) {
        let missed = (moved(before) - after).norm() / scale;
        assert!(missed < 1e-3, "{knots:?}: {missed}");
    }
}

#[test]
fn turning_moving_and_scaling_the_leg_leaves_its_knots() {
    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    for knots in [Knots::Adaptive, Knots::Polished] {
        moves_along(|point| turn * point, knots, 1.0);
        moves_along(|point| point + Vector3::new(500.0, -200.0, 1000.0), knots, 1.0);
        moves_along(|point| point * 1000.0, knots, 1000.0);
    }
}

#[test]
fn starting_elsewhere_around_turns_the_surface() {
    let points = test_leg::grid();
    let (along, around) = parameters(&points);
    // The same columns, told from the 20th on, at the same parameters.
    let turned: Vec<_> =
        points.chunks(72).flat_map(|row| [&row[20..], &row[..20]].concat()).collect();
    let elsewhere = [&around[20..], &around[..20]].concat();
    let method = plain([30, 24], Knots::Polished);
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
    for knots in [Knots::Adaptive, Knots::Polished] {
        let fit = fit_grid_by(&data, &WHOLE, &plain([10, 12], knots)).unwrap();
        assert!(fit.max_mm < 0.02, "{knots:?}: {}", fit.max_mm);
        let spans = fit.surface.around().breakpoints().windows(2).map(|pair| pair[1] - pair[0]);
        assert!(spans.into_iter().all(|span| (0.04..0.16).contains(&span)), "{knots:?}");
    }
}

#[test]
fn marks_become_knots_and_cost_little() {
    // Heights of B, B1, C and D of the test leg and where its front and back are.
    let along = [112.8, 190.0, 308.8, 398.0].map(|z| z / test_leg::HEIGHT_MM);
    let around = [0.2, 0.7];
    for (knots, percent) in
        [(Knots::Uniform, 0.055), (Knots::Adaptive, 0.03), (Knots::Polished, 0.014)]
    {
        let marks = [along.to_vec(), around.to_vec()];
        let fit = fit_by(&test_leg::grid(), &GridMethod { marks, ..plain([30, 24], knots) });
        let has = |breakpoints: &[f64], mark: f64| {
            breakpoints.iter().any(|place| (place - mark).rem_euclid(1.0) < 1e-12)
        };
        assert!(fit.marks_missed.iter().all(Vec::is_empty), "{:?}", fit.marks_missed);
        assert!(
            along.iter().all(|mark| has(fit.surface.along().breakpoints(), *mark)),
            "{knots:?}"
        );
        let breakpoints = fit.surface.around().breakpoints();
        assert!(around.iter().all(|mark| has(breakpoints, *mark)), "{knots:?}: {breakpoints:?}");
        let [_, _, _, relative] = true_error(&fit.surface);
        assert!(relative < percent, "{knots:?}: {relative} %");
    }
}

#[test]
fn marks_too_close_are_told_and_leave_spans_whole() {
    let marks = [vec![0.5, 0.502, 0.504, 0.999], vec![]];
    let fit = fit_by(&test_leg::grid(), &GridMethod { marks, ..plain([30, 24], Knots::Uniform) });
    assert_eq!(fit.marks_missed[0], [0.502, 0.504, 0.999]);
    let mut spans = fit.surface.along().breakpoints().windows(2).map(|pair| pair[1] - pair[0]);
    assert!(spans.all(|span| span >= 0.25 / 27.0));
}
