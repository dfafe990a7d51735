//! The accuracy table of a folder of scans with truth beside them:
//! `cargo run --release --example accuracy -- FOLDER`.
//!
//! The folder holds `NAME.obj` or `NAME.obj.gz`, and `NAME.truth.json` as `fixtures/README.md`
//! describes it. Errors are measured minus true; B1's figure is the true slope at the reported
//! height as a share of the largest.

use std::error::Error;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use gaiter::leg::method::Up;
use gaiter::leg::{Extraction, Landmark, LegReport, Level, Method, extract};
use gaiter::scan::Format;
use serde_json::Value;

const HEADER: &str = "\
| scan | leg | B mm | at | C mm | at | D mm | at | B1 slope | R² curve | R² sections | \
surface to sections | to points |
|---|---|---|---|---|---|---|---|---|---|---|---|---|";

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: accuracy FOLDER")?;
    let mut out = io::stdout().lock();
    writeln!(out, "{HEADER}")?;
    for truth_path in truths(Path::new(&folder))? {
        let truth: Value = serde_json::from_slice(&fs::read(&truth_path)?)?;
        let name = truth["name"].as_str().unwrap_or_default().to_owned();
        let up = if truth["up"] == "z" { Up::Z } else { Up::Y };
        let bytes = scan_bytes(&truth_path.with_file_name(&name))?;
        match extract(&bytes, Format::Obj, &Method { up, ..Method::default() }) {
            Ok(extraction) => write_rows(&mut out, &name, &extraction, &truth)?,
            Err(refusal) => writeln!(out, "| {name} | refused: {refusal} |")?,
        }
    }
    Ok(())
}

/// The truth files of a folder in the order of their names.
fn truths(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    let paths = entries.into_iter().map(|entry| entry.path());
    let is_truth = |path: &PathBuf| path.to_string_lossy().ends_with(".truth.json");
    let mut found: Vec<PathBuf> = paths.filter(is_truth).collect();
    found.sort();
    Ok(found)
}

fn scan_bytes(stem: &Path) -> io::Result<Vec<u8>> {
    let plain = stem.with_extension("obj");
    if plain.exists() {
        return fs::read(plain);
    }
    let mut bytes = Vec::new();
    GzDecoder::new(fs::File::open(stem.with_extension("obj.gz"))?).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn write_rows(
    out: &mut impl Write,
    name: &str,
    extraction: &Extraction,
    truth: &Value,
) -> io::Result<()> {
    for leg in &extraction.legs {
        let true_leg = &truth["legs"][leg.side.word()];
        write!(out, "| {name} | {} |", leg.side.word())?;
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

fn found(leg: &LegReport, level: Level) -> Option<&Landmark> {
    leg.landmarks.iter().find(|landmark| landmark.level == level)
}

/// Error of the tape girth and of the height, or how truth and record differ about the level.
fn errors(leg: &LegReport, level: Level, truth: &Value) -> String {
    let landmark = &truth["landmarks"][level.name()];
    let undecidable = truth["undecidable"].as_array();
    let undecidable = undecidable.is_some_and(|list| list.iter().any(|l| l == level.name()));
    match (found(leg, level), landmark["tape_mm"].as_f64(), landmark["height_mm"].as_f64()) {
        (Some(found), Some(tape_mm), Some(height_mm)) => {
            format!("{:+.2} | {:+.1}", found.girth_tape_mm - tape_mm, found.height_mm - height_mm)
        }
        (None, None, _) => "absent | ".to_owned(),
        _ if undecidable => "undecidable | ".to_owned(),
        (None, ..) => "missed | ".to_owned(),
        (Some(_), ..) => "invented | ".to_owned(),
    }
}

/// The true slope at the reported B1 as a share of the largest.
fn slope_share(leg: &LegReport, truth: &Value) -> String {
    let largest = truth["landmarks"]["B1"]["slope"].as_f64();
    let (Some(b1), Some(largest)) = (found(leg, Level::B1), largest) else {
        return "-".to_owned();
    };
    let column = |name: &str| truth["profile"][name].as_array().cloned().unwrap_or_default();
    let rows: Vec<(f64, f64)> = column("height_mm")
        .iter()
        .zip(&column("slope"))
        .filter_map(|(height, slope)| Some((height.as_f64()?, slope.as_f64()?)))
        .collect();
    let above = rows.partition_point(|(height, _)| *height < b1.height_mm);
    match rows.get(above.saturating_sub(1)..=above) {
        Some([low, high]) => {
            let share = (b1.height_mm - low.0) / (high.0 - low.0);
            format!("{:.1} %", 100.0 * (low.1 + share * (high.1 - low.1)) / largest)
        }
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
