//! How long a surface takes to fit, on the test leg with 80 sections of 72 points:
//! `cargo bench --bench surface`.

#[path = "../tests/support/test_leg.rs"]
mod test_leg;

use divan::Bencher;
use gaiter::spline::{
    Basis, FitFault, GridData, GridDomain, GridMethod, Knots, SurfaceFit, fit_grid, fit_grid_by,
    mean_chord_parameters,
};
use nalgebra::Point3;

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
