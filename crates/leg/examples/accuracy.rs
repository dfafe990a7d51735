//! The accuracy table of a folder of scans with truth beside them:
//! `cargo run --release --example accuracy -- FOLDER`.
//!
//! Errors are measured minus true; B1's figure is the true slope at the reported height as a share
//! of the largest. A second table says whether all scans together keep the limits.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

#[path = "support/curve.rs"]
mod curve;
#[path = "support/limits.rs"]
mod limits;
#[path = "support/truth.rs"]
mod truth;

use std::error::Error;
use std::io::{self, Write};
use std::path::Path;

use gaiter_leg::{Extraction, LegReport, Level, Method, extract};
use gaiter_scan::Format;
use limits::Limits;
use serde_json::Value;
use truth::{Case, Compared, Profile, cases, compared, found};

const HEADER: &str = "\
| scan | leg | B mm | at | C mm | at | D mm | at | B1 slope | R² curve | R² sections | \
surface to sections | to points |
|---|---|---|---|---|---|---|---|---|---|---|---|---|";

const ABOUT_LIMITS: &str = "
All together, absolute errors. Allowed are 0.3 mm + 0.8 × the scan's noise of girth, and 5 mm of \
height or as far as the girth is flat within 0.5 mm. From 10 mm below B to 20 mm above D, and at B1, \
the girth is compared with the true one at the same height, and 1.5 mm of height are allowed besides. \
The offset is the vertical shift that fits the curve best. G is compared with the girth 50 mm below \
the true crotch.
";

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: accuracy FOLDER")?;
    let mut out = io::stdout().lock();
    let mut limits = Limits::default();
    writeln!(out, "{HEADER}")?;
    for case in cases(Path::new(&folder))? {
        match extract(&case.bytes, Format::Obj, &Method { up: case.up, ..Method::default() }) {
            Ok(extraction) => {
                write_rows(&mut out, &case, &extraction)?;
                limits.measured(&case, &extraction);
            }
            Err(refusal) => {
                writeln!(out, "| {} | refused: {refusal} |", case.name)?;
                limits.refused();
            }
        }
    }
    writeln!(out, "{ABOUT_LIMITS}")?;
    write!(out, "{limits}")?;
    Ok(())
}

fn write_rows(out: &mut impl Write, case: &Case, extraction: &Extraction) -> io::Result<()> {
    for leg in &extraction.legs {
        let true_leg = case.leg(leg);
        write!(out, "| {} | {} |", case.name, leg.side.word())?;
        for level in [Level::B, Level::C, Level::D] {
            write!(out, " {} |", errors(leg, level, true_leg))?;
        }
        let sought = leg.level_sections.iter().filter(|at| Level::SOUGHT.contains(&at.level));
        let section_r2 = sought.map(|at| at.section.r2);
        writeln!(
            out,
            " {} | {:.5} | {:.4} | {} |",
            slope_share(leg, true_leg),
            leg.girth_curve.r2(),
            section_r2.fold(f64::INFINITY, f64::min),
            surface(leg)
        )?;
    }
    Ok(())
}

/// Error of the tape girth and of the height, or how truth and record differ about the level.
fn errors(leg: &LegReport, level: Level, truth: &Value) -> String {
    match compared(Some(leg), level, truth) {
        Compared::Errors { girth_mm, height_mm } => format!("{girth_mm:+.2} | {height_mm:+.1}"),
        Compared::Absent => "absent | ".to_owned(),
        Compared::Undecidable => "undecidable | ".to_owned(),
        Compared::Missed => "missed | ".to_owned(),
        Compared::Invented => "invented | ".to_owned(),
    }
}

/// The true slope at the reported B1 as a share of the largest.
fn slope_share(leg: &LegReport, truth: &Value) -> String {
    let largest = truth["landmarks"]["B1"]["slope"].as_f64();
    let slope =
        found(leg, Level::B1).and_then(|b1| Profile::named(truth, "slope").at(b1.height_mm));
    match (slope, largest) {
        (Some(slope), Some(largest)) => format!("{:.1} %", 100.0 * slope / largest),
        _ => "-".to_owned(),
    }
}

/// Mean relative errors of the surface.
fn surface(leg: &LegReport) -> String {
    leg.surface.as_ref().map_or("- | -".to_owned(), |surface| {
        let percent = |error: f64| format!("{:.3} %", 100.0 * error);
        let sections = percent(surface.to_sections.mean_relative);
        format!("{sections} | {}", percent(surface.to_points.mean_relative))
    })
}
