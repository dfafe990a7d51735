//! What a strip of skin that nobody saw costs, on a folder of scans with truth beside them:
//! `cargo run --release --example strips -- FOLDER`.
//!
//! The inner skin of both legs is taken out of each scan, from ankle to crotch, as wide as touching
//! thighs or a shadowed calf hide it.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

#[path = "support/truth.rs"]
mod truth;

use std::error::Error;
use std::io::{self, Write};
use std::path::Path;

use gaiter_leg::{Extraction, Level, Method, Side, extract};
use gaiter_scan::{Format, read};
use support::strip::without_strip;
use support::writers::obj;
use truth::{Case, Compared, cases, compared, found, quantiles};

/// Widths of the strip, degrees as seen from the middle of the leg.
const WIDTHS_DEG: [f64; 6] = [0.0, 40.0, 60.0, 80.0, 110.0, 140.0];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: strips FOLDER")?;
    let cases = cases(Path::new(&folder))?;
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "| strip | girths at B, C, D: median mm | 95 % mm | within two standard errors | refused, missed |"
    )?;
    writeln!(out, "|---|---|---|---|---|")?;
    for width_deg in WIDTHS_DEG {
        let (mut errors, mut covered, mut lost) = (Vec::new(), 0, 0);
        for case in &cases {
            let method = Method { up: case.up, ..Method::default() };
            let whole = extract(&case.bytes, Format::Obj, &method)?;
            let scan = without_strip(&read(&case.bytes, Format::Obj)?, &whole, width_deg);
            let Ok(extraction) = extract(&obj(&scan), Format::Obj, &method) else {
                lost += 6;
                continue;
            };
            for (error_mm, sd_mm) in girths(case, &extraction, &mut lost) {
                errors.push(error_mm);
                covered += usize::from(error_mm <= 2.0 * sd_mm);
            }
        }
        let [median, p95, _] = quantiles(&errors);
        let count = errors.len();
        writeln!(out, "| {width_deg}° | {median:.2} | {p95:.2} | {covered} of {count} | {lost} |")?;
    }
    Ok(())
}

/// Errors and standard errors of girths at B, C and D, mm; counts those that are missing.
fn girths(case: &Case, extraction: &Extraction, lost: &mut usize) -> Vec<(f64, f64)> {
    let mut all = Vec::new();
    for side in Side::BOTH {
        let leg = extraction.legs.iter().find(|leg| leg.side == side);
        let truth = &case.truth["legs"][side.word()];
        for level in [Level::B, Level::C, Level::D] {
            match compared(leg, level, truth) {
                Compared::Errors { girth_mm, .. } => {
                    let landmark = leg.and_then(|leg| found(leg, level));
                    all.extend(landmark.map(|at| (girth_mm.abs(), at.girth_sd_mm)));
                }
                Compared::Missed => *lost += 1,
                _ => {}
            }
        }
    }
    all
}
