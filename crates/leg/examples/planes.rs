//! The planes of the tape beside each other on a folder of scans with truth:
//! `cargo run --release --example planes -- FOLDER`.
//!
//! The true girths are those of the plane of the tape, which `shank` looks for.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

#[path = "support/truth.rs"]
mod truth;

use std::error::Error;
use std::io::{self, Write};
use std::path::Path;

use gaiter_leg::method::{AxisFit, Tape};
use gaiter_leg::{Extraction, Level, Method, Refusal, Side, extract};
use gaiter_scan::Format;
use rayon::prelude::*;
use truth::{Case, cases, found};

/// The levels that are turning points of the girth.
const LEVELS: [Level; 3] = [Level::B, Level::C, Level::D];

/// The planes, by their words in the configuration.
const PLANES: [(&str, Tape); 3] = [
    ("`shank`", Tape::Shank),
    ("`leg`", Tape::Leg(AxisFit::Centroids)),
    ("`horizontal`", Tape::Horizontal),
];

/// An extraction for each plane.
type Measured = [Result<Extraction, Refusal>; PLANES.len()];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: planes FOLDER")?;
    let cases = cases(Path::new(&folder))?;
    let mut out = io::stdout().lock();
    let planes = PLANES.map(|(word, _)| word).join(" | ");
    let columns = LEVELS.map(|level| format!("{} true | {planes}", level.name()));
    writeln!(out, "| body, leg | {} |", columns.join(" | "))?;
    writeln!(out, "|---|{}", "---|".repeat(LEVELS.len() * (1 + PLANES.len())))?;
    let all: Vec<Measured> = cases.par_iter().map(measured).collect();
    for (case, measured) in cases.iter().zip(&all) {
        Side::BOTH.into_iter().try_for_each(|side| write_row(&mut out, case, side, measured))?;
    }
    Ok(())
}

fn measured(case: &Case) -> Measured {
    PLANES.map(|(_, tape)| {
        let method = Method { up: case.up, tape, ..Method::default() };
        extract(&case.bytes, Format::Obj, &method)
    })
}

/// The girths of a leg, mm.
fn write_row(out: &mut impl Write, case: &Case, side: Side, measured: &Measured) -> io::Result<()> {
    write!(out, "| {}, {} |", case.name, side.word())?;
    for level in LEVELS {
        let of_level = &case.truth["legs"][side.word()]["landmarks"][level.name()];
        write!(out, " {} |", cell(of_level["tape_mm"].as_f64()))?;
        for extraction in measured {
            write!(out, " {} |", cell(girth(extraction, side, level)))?;
        }
    }
    writeln!(out)
}

/// A measured girth, mm; none where the scan, the leg or the level is missing.
fn girth(extraction: &Result<Extraction, Refusal>, side: Side, level: Level) -> Option<f64> {
    let legs = &extraction.as_ref().ok()?.legs;
    let leg = legs.iter().find(|leg| leg.side == side)?;
    Some(found(leg, level)?.girth_tape_mm)
}

fn cell(girth_mm: Option<f64>) -> String {
    girth_mm.map_or("–".to_owned(), |mm| format!("{mm:.1}"))
}
