//! Fits of noisy grids (nurbs.md 4).
#![allow(clippy::unwrap_used)]

#[path = "support/chance.rs"]
mod chance;
mod support;

use chance::Chance;
use gaiter::spline::{
    GridData, GridDomain, GridMethod, GridSmoothing, Knots, SurfaceFit, fit_grid_by,
};
use nalgebra::{Point3, Vector3};
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

#[test]
fn explore() {
    for sigma in [0.5, 1.0] {
        for size in [[20, 16], [30, 24], [40, 32]] {
            for (name, knots, smoothing) in [
                ("plain", Knots::Uniform, GridSmoothing::None),
                ("gcv uniform", Knots::Uniform, GridSmoothing::Gcv),
                ("gcv adaptive", Knots::Adaptive, GridSmoothing::Gcv),
                ("gcv polished", Knots::Polished, GridSmoothing::Gcv),
            ] {
                let found: Vec<_> = (1..=3)
                    .map(|seed| {
                        let mut chance = Chance(seed);
                        let points = moved(|| sigma * chance.normal());
                        let fit = fitted(&points, &method(size, knots, smoothing, false));
                        let e = true_error(&fit.surface);
                        format!(
                            "{:.4} {:.3} {:.2} {:.3} edf {:.0} sigma {:.3}",
                            e[0], e[1], e[2], e[3], fit.edf, fit.sigma_mm
                        )
                    })
                    .collect();
                println!("{sigma} {size:?} {name}: {found:#?}");
            }
        }
    }
}
#[test]
fn explore_outliers() {
    for size in [[20, 16], [30, 24], [40, 32]] {
        for (name, knots, smoothing, robust) in [
            ("plain", Knots::Uniform, GridSmoothing::None, false),
            ("robust uniform", Knots::Uniform, GridSmoothing::None, true),
            ("robust gcv uniform", Knots::Uniform, GridSmoothing::Gcv, true),
            ("robust gcv adaptive", Knots::Adaptive, GridSmoothing::Gcv, true),
            ("robust gcv polished", Knots::Polished, GridSmoothing::Gcv, true),
        ] {
            let found: Vec<_> = (1..=3)
                .map(|seed| {
                    let mut chance = Chance(seed);
                    let points = moved(|| {
                        let n = 0.5 * chance.normal();
                        if chance.below(50) == 0 { n + 12.5 + chance.even(7.5) } else { n }
                    });
                    let fit = fitted(&points, &method(size, knots, smoothing, robust));
                    let e = true_error(&fit.surface);
                    format!(
                        "{:.4} {:.3} {:.2} {:.3} edf {:.0} sigma {:.3} out {}",
                        e[0],
                        e[1],
                        e[2],
                        e[3],
                        fit.edf,
                        fit.sigma_mm,
                        fit.outliers.len()
                    )
                })
                .collect();
            println!("{size:?} {name}: {found:#?}");
        }
    }
}
