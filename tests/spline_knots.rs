//! Where the knots of a grid fit go, and what that is worth on the test leg (nurbs.md 3, 6.4).
#![allow(clippy::unwrap_used)]

mod support;

use gaiter::spline::{GridData, GridDomain, GridMethod, Knots, KnotsUsed, SurfaceFit, fit_grid_by};
use support::metric::{parameters, true_error};
use support::test_leg;

const WHOLE: GridDomain = GridDomain { along: [0.0, 1.0], around_from: 0.0, period: 1.0 };

fn fitted(control_points: [usize; 2], knots: Knots) -> SurfaceFit {
    let points = test_leg::grid();
    let (along, around) = parameters(&points);
    let data = GridData { along: &along, around: &around, points: &points };
    let method = GridMethod { control_points, knots, marks: [vec![], vec![]] };
    fit_grid_by(&data, &WHOLE, &method).unwrap()
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
fn polished_knots_keep_the_limits() {
    // Mean relative error in percent and largest error in mm; the reference's own polish reaches
    // 0.0835, 0.0089, 0.0030 % and 0.884, 0.124, 0.106 mm.
    for (control_points, percent, largest_mm) in
        [([20, 16], 0.0835, 0.95), ([30, 24], 0.0089, 0.15), ([40, 32], 0.0030, 0.106)]
    {
        let fit = fitted(control_points, Knots::Polished);
        assert_eq!(fit.knots, [KnotsUsed::Polished; 2]);
        let [_, _, largest, relative] = true_error(&fit.surface);
        println!("{} {:?}", fit.rms_mm, true_error(&fit.surface));
        assert!(relative < percent, "{control_points:?}: {relative} %");
        assert!(largest < largest_mm, "{control_points:?}: {largest} mm");
    }
}
