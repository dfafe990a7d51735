//! How long a surface takes to fit and to evaluate, on the test leg with 80 sections of 72 points,
//! or with 100 000 points anywhere:
//! `cargo bench --bench surface`.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

use std::f64::consts::TAU;

use divan::Bencher;
use gaiter_spline::{
    Basis, CloudData, CloudFit, CloudMethod, FitFault, GridData, GridDomain, GridMethod, Knots,
    SurfaceFit, fit_cloud, fit_grid, fit_grid_by, mean_chord_parameters,
};
use nalgebra::Point3;
use support::chance::Chance;
use support::cloud::Faults;
use support::{cloud, test_leg};

fn main() {
    divan::main();
}

/// A benchmark without its input is worth nothing.
fn stop(fault: &dyn std::fmt::Display) -> ! {
    std::process::exit(fault.to_string().len().clamp(1, 100) as i32)
}

/// The points with their parameters along and around.
struct Leg {
    along: Vec<f64>,
    around: Vec<f64>,
    points: Vec<Point3<f64>>,
}

impl Leg {
    fn new() -> Leg {
        let points = test_leg::grid();
        let around = mean_chord_parameters(&points, test_leg::GRID_COLUMNS);
        let around = around.unwrap_or_else(|fault| stop(&fault));
        let rows = points.chunks_exact(test_leg::GRID_COLUMNS);
        let along = rows.map(|row| row[0].z / test_leg::HEIGHT_MM).collect();
        Leg { along, around, points }
    }

    fn data(&self) -> GridData<'_> {
        GridData { along: &self.along, around: &self.around, points: &self.points }
    }
}

#[divan::bench]
fn a_plain_fit_of_a_grid(bencher: Bencher) {
    let leg = Leg::new();
    bencher.bench(|| {
        let along = Basis::uniform_clamped(0.0, 1.0, 27).unwrap_or_else(|fault| stop(&fault));
        let around = Basis::uniform_periodic(0.0, 1.0, 24).unwrap_or_else(|fault| stop(&fault));
        fit_grid(&leg.data(), along, around)
    });
}

fn by_itself(leg: &Leg, knots: Knots) -> Result<SurfaceFit, FitFault> {
    let domain = GridDomain { along: [0.0, 1.0], around_from: 0.0, period: 1.0 };
    let method = GridMethod { control_points: [30, 24], knots, marks: [vec![], vec![]] };
    fit_grid_by(&leg.data(), &domain, &method)
}

#[divan::bench]
fn b_adaptive_fit_of_a_grid(bencher: Bencher) {
    let leg = Leg::new();
    bencher.bench(|| by_itself(&leg, Knots::Adaptive));
}

#[divan::bench]
fn c_polished_fit_of_a_grid(bencher: Bencher) {
    let leg = Leg::new();
    bencher.bench(|| by_itself(&leg, Knots::Polished));
}

/// 100 000 points with noise of 0.5 mm, 2 % of them outliers, and their places around.
fn scan() -> (Vec<Point3<f64>>, Vec<f64>) {
    let points = cloud::cloud(100_000, Faults { sigma_mm: 0.5, outliers: 0.02 }, 2).points;
    let turn = |point: &Point3<f64>| {
        let (cx, cy) = test_leg::center(point.z);
        (point.y - cy).atan2(point.x - cx) / TAU
    };
    let around = points.iter().map(turn).collect();
    (points, around)
}

fn fitted(points: &[Point3<f64>], around: &[f64]) -> Result<CloudFit, FitFault> {
    let along = Basis::uniform_clamped(0.0, test_leg::HEIGHT_MM, 27)?;
    let rounds = Basis::uniform_periodic(0.0, 1.0, 24)?;
    fit_cloud(&CloudData { points, around }, along, rounds, &CloudMethod::default())
}

/// The choice of smoothing and the rounds against outliers included: at most 80 ms on one core.
#[divan::bench]
fn d_fit_of_a_cloud(bencher: Bencher) {
    let (points, around) = scan();
    bencher.bench(|| fitted(&points, &around));
}

/// Places all over the surface.
fn places() -> Vec<(f64, f64)> {
    let mut chance = Chance(3);
    let mut place = |_| (400.0 * (1.0 + chance.even(1.0)), chance.even(1.0));
    (0..10_000).map(&mut place).collect()
}

/// At most 1 ms: 100 ns a point.
#[divan::bench]
fn e_ten_thousand_points_one_by_one(bencher: Bencher) {
    let (points, around) = scan();
    let fit = fitted(&points, &around).unwrap_or_else(|fault| stop(&fault));
    let (surface, places) = (fit.surface, places());
    bencher.bench(|| places.iter().map(|(u, v)| surface.point(*u, *v).x).sum::<f64>());
}

/// At most 1 ms: 100 ns a point.
#[divan::bench]
fn f_ten_thousand_points_as_a_grid(bencher: Bencher) {
    let (points, around) = scan();
    let surface = fitted(&points, &around).unwrap_or_else(|fault| stop(&fault)).surface;
    let u: Vec<f64> = (0..100).map(|i| 8.0 * f64::from(i)).collect();
    let v: Vec<f64> = (0..100).map(|j| 0.01 * f64::from(j)).collect();
    bencher.bench(|| surface.grid(&u, &v));
}
