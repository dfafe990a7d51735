//! Fits a closed surface to sections, says how well, and writes it for a CAD system.
//!
//! `cargo run --release --example fit_sections -- FILE [ALONG AROUND] [OUT.step]`
//!
//! FILE is a table `section,x,y,z` with one line a point, mm: sections from one end to the other,
//! each with as many points in order around, the first of each on the same line along. ALONG and
//! AROUND are the numbers of control points, 30 and 24 where nobody says.

#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_types,
    clippy::print_stderr,
    clippy::print_stdout
)]

#[path = "support/section_table.rs"]
mod section_table;

use std::error::Error;
use std::fs;
use std::process::ExitCode;

use gaiter_cad::step::{self, Schema};
use gaiter_cad::{FileHeader, Shape};
use gaiter_spline::{GridDomain, GridMethod, Knots, SurfaceFit, fit_grid_by};
use section_table::{Grid, SectionTable};

/// What was asked for on the command line.
struct Wanted {
    path: String,
    control_points: [usize; 2],
    out: Option<String>,
}

const USAGE: &str = "usage: fit_sections FILE [ALONG AROUND] [OUT.step]";

impl Wanted {
    fn from_words(mut words: Vec<String>) -> Option<Wanted> {
        let out = words.pop_if(|word| word.ends_with(".step"));
        let control_points = match &words[..] {
            [_] => [30, 24],
            [_, along, around] => [along.parse().ok()?, around.parse().ok()?],
            _ => return None,
        };
        Some(Wanted { path: words.swap_remove(0), control_points, out })
    }
}

fn main() -> ExitCode {
    let wanted = Wanted::from_words(std::env::args().skip(1).collect());
    match wanted.ok_or_else(|| USAGE.into()).and_then(|wanted| run(&wanted)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => {
            eprintln!("{fault}");
            ExitCode::FAILURE
        }
    }
}

fn run(wanted: &Wanted) -> Result<(), Box<dyn Error>> {
    let Wanted { path, control_points, out } = wanted;
    let table = fs::read_to_string(path).map_err(|fault| format!("{path}: {fault}"))?;
    let table = SectionTable::parse(&table).map_err(|fault| format!("{path}: {fault}"))?;
    let grid = table.grid();
    let knots = Knots::Adaptive;
    let method = GridMethod { control_points: *control_points, knots, marks: Vec::new() };
    let domain = GridDomain { along: [0.0, 1.0], around_from: 0.0, period: 1.0 };
    let fit = fit_grid_by(&grid.data(), &domain, &method)?;
    report(&grid, &fit);
    if let Some(out) = out {
        let header = FileHeader { file_name: out, product: "surface" };
        let step = step::write(&fit.surface, Shape::Tube, Schema::Ap214, &header)?;
        fs::write(out, step).map_err(|fault| format!("{out}: {fault}"))?;
    }
    Ok(())
}

fn report(grid: &Grid, fit: &SurfaceFit) {
    let (along, around) = (fit.surface.along().count(), fit.surface.around().count());
    let (rows, columns) = (grid.along.len(), grid.around.len());
    println!("{rows} x {columns} points, {along} x {around} control points");
    println!("knots {:?}, rms {:.4} mm, largest {:.4} mm", fit.knots, fit.rms_mm, fit.max_mm);
    println!("section,girth_mm,rms_mm");
    for (i, (u, section)) in grid.along.iter().zip(grid.sections()).enumerate() {
        let fitted = fit.surface.grid(&[*u], &grid.around);
        let squares = section.iter().zip(&fitted).map(|(a, b)| (a - b).norm_squared());
        let rms = (squares.sum::<f64>() / section.len() as f64).sqrt();
        println!("{i},{:.3},{rms:.4}", fit.surface.girth_mm(*u));
    }
}
