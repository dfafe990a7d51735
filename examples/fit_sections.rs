//! Fits a closed surface to sections, says how well, and writes it for a CAD system.
//!
//! `cargo run --release --example fit_sections -- FILE [ALONG AROUND] [OUT.step]`
//!
//! FILE is a table `section,x,y,z` with one line a point, mm: sections from one end to the other,
//! each with as many points in order around, the first of each on the same line along. ALONG and
//! AROUND are the numbers of control points, 30 and 24 where nobody says.

#![allow(clippy::print_stdout, clippy::unwrap_used, clippy::expect_used)]

#[path = "support/section_table.rs"]
mod section_table;

use std::fs;

use gaiter::cad::step::{StepHeader, tube};
use gaiter::spline::{GridDomain, GridMethod, GridSmoothing, Knots, Surface, fit_grid_by};
use nalgebra::{Point3, distance};
use section_table::SectionTable;

/// Points of the polygon that tells a section's length.
const SIDES: usize = 720;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let path = words.first().expect("the path of a table of sections");
    let counts: Vec<usize> = words[1..].iter().filter_map(|word| word.parse().ok()).collect();
    let control_points = [counts.first().map_or(30, |n| *n), counts.get(1).map_or(24, |n| *n)];
    let table = fs::read_to_string(path).expect("the table can be read");
    let table = SectionTable::parse(&table).unwrap_or_else(|line| panic!("line {line}: no point"));

    let method = GridMethod {
        control_points,
        knots: Knots::Polished,
        smoothing: GridSmoothing::None,
        robust: false,
        marks: [vec![], vec![]],
    };
    let domain = GridDomain { along: [0.0, 1.0], around_from: 0.0, period: 1.0 };
    let grid = table.grid().unwrap_or_else(|fault| panic!("{fault}"));
    let fit = fit_grid_by(&grid.data(), &domain, &method).unwrap_or_else(|fault| panic!("{fault}"));

    println!(
        "{} x {} points, {} x {} control points",
        grid.along.len(),
        grid.around.len(),
        control_points[0],
        control_points[1]
    );
    println!("knots {:?}, rms {:.4} mm, largest {:.4} mm", fit.knots, fit.rms_mm, fit.max_mm);
    println!("section,girth_mm,rms_mm");
    for (i, (u, section)) in grid.along.iter().zip(grid.sections()).enumerate() {
        let fitted = fit.surface.grid(&[*u], &grid.around);
        let squares = section.iter().zip(&fitted).map(|(a, b)| (a - b).norm_squared());
        let rms = (squares.sum::<f64>() / section.len() as f64).sqrt();
        println!("{i},{:.3},{rms:.4}", girth_mm(&fit.surface, *u));
    }
    if let Some(out) = words[1..].iter().find(|word| word.ends_with(".step")) {
        let name = StepHeader { file_name: out, product: "surface", time_stamp: "" };
        fs::write(out, tube(&fit.surface, &name)).expect("the file can be written");
    }
}

/// The length of the surface's closed curve at one place along.
fn girth_mm(surface: &Surface, u: f64) -> f64 {
    let (from, to) = surface.around().domain();
    let v = |side: usize| from + (to - from) * side as f64 / SIDES as f64;
    let ring: Vec<Point3<f64>> = surface.grid(&[u], &(0..SIDES).map(v).collect::<Vec<_>>());
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| distance(a, b)).sum()
}
