//! How long a surface takes to fit and to evaluate, on the test leg with 80 sections of 72 points:
//! `cargo bench --bench surface`.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

use divan::Bencher;
use gaiter_spline::{
    Basis, FitFault, GridData, GridDomain, GridMethod, Knots, Surface, SurfaceFit, fit_grid,
    fit_grid_by,
};
use nalgebra::Point3;
use support::chance::Chance;
use support::metric::parameters;
use support::test_leg;

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
        let (along, around) = parameters(&points);
        Leg { along, around, points }
    }

    fn data(&self) -> GridData<'_> {
        GridData { along: &self.along, around: &self.around, points: &self.points }
    }
}

fn plainly(leg: &Leg) -> Result<SurfaceFit, FitFault> {
    let along = Basis::uniform_clamped(0.0, 1.0, 27)?;
    let around = Basis::uniform_periodic(0.0, 1.0, 24)?;
    fit_grid(&leg.data(), along, around)
}

#[divan::bench]
fn a_plain_fit_of_a_grid(bencher: Bencher) {
    let leg = Leg::new();
    bencher.bench(|| plainly(&leg));
}

#[divan::bench]
fn b_adaptive_fit_of_a_grid(bencher: Bencher) {
    let leg = Leg::new();
    let domain = GridDomain { along: [0.0, 1.0], around_from: 0.0, period: 1.0 };
    let knots = Knots::Adaptive;
    let method = GridMethod { control_points: [30, 24], knots, marks: Vec::new() };
    bencher.bench(|| fit_grid_by(&leg.data(), &domain, &method));
}

fn surface() -> Surface {
    plainly(&Leg::new()).unwrap_or_else(|fault| stop(&fault)).surface
}

/// Places all over the surface.
fn places() -> Vec<(f64, f64)> {
    let mut chance = Chance(3);
    let mut place = |_| (0.5 * (1.0 + chance.even(1.0)), chance.even(1.0));
    (0..10_000).map(&mut place).collect()
}

/// At most 1 ms: 100 ns a point.
#[divan::bench]
fn c_ten_thousand_points_one_by_one(bencher: Bencher) {
    let (surface, places) = (surface(), places());
    bencher.bench(|| places.iter().map(|(u, v)| surface.point(*u, *v).x).sum::<f64>());
}

/// At most 1 ms: 100 ns a point.
#[divan::bench]
fn d_ten_thousand_points_as_a_grid(bencher: Bencher) {
    let surface = surface();
    let u: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i)).collect();
    let v: Vec<f64> = (0..100).map(|j| 0.01 * f64::from(j)).collect();
    bencher.bench(|| surface.grid(&u, &v));
}
