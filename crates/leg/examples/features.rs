//! How stable the feature points are: every scan of a folder measured again with noise added along
//! its normals. `cargo run --release --example features -- FOLDER [SEEDS]`.
//!
//! The folder holds `NAME.obj` or `NAME.obj.gz`; a name with `zup` declares the up axis z. `found`:
//! the sections at the heights found in each measurement; `kept`: at the first one's heights.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use gaiter_leg::features::feature::features;
use gaiter_leg::frame::body::body;
use gaiter_leg::method::{SectionFit, Up};
use gaiter_leg::parting::segment::segment;
use gaiter_leg::sections::equidistant::sections;
use gaiter_leg::{Extraction, LegReport, Level, LevelSection, Method, Side, extract};
use gaiter_scan::{Format, Scan, read};
use support::noise::{Fate, quantile, roughened};

/// Standard deviations of the added noise, mm.
const NOISE_MM: [f64; 3] = [0.3, 0.5, 1.0];

/// Lowest section as a share of stature, as the leg report has it.
const LOWEST_STATURE_SHARE: f64 = 0.035;

const HEADER: &str = "\
| noise mm | level | heights | points a section | moved mm, median | 90 % | in standard errors, 68 % | \
vanished | invented | same labels |
|---|---|---|---|---|---|---|---|---|---|";

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: features FOLDER [SEEDS]")?;
    let seeds: u64 = std::env::args().nth(2).map_or(Ok(3), |text| text.parse())?;
    let mut fates = vec![Fate::default(); NOISE_MM.len() * Level::SOUGHT.len() * 2];
    for path in scans(Path::new(&folder))? {
        let up = if path.to_string_lossy().contains("zup") { Up::Z } else { Up::Y };
        follow(&scan_bytes(&path)?, &Method { up, ..Method::default() }, seeds, &mut fates)?;
    }
    let mut out = io::stdout().lock();
    writeln!(out, "{HEADER}")?;
    for (fates, noise_mm) in fates.chunks(Level::SOUGHT.len() * 2).zip(NOISE_MM) {
        let mut all = [Fate::default(), Fate::default()];
        for (fates, level) in fates.chunks(2).zip(Level::SOUGHT) {
            for ((fate, all), heights) in fates.iter().zip(&mut all).zip(["found", "kept"]) {
                write_row(&mut out, noise_mm, level.name(), heights, fate)?;
                all.join(fate);
            }
        }
        write_row(&mut out, noise_mm, "all", "found", &all[0])?;
        write_row(&mut out, noise_mm, "all", "kept", &all[1])?;
    }
    Ok(())
}

fn write_row(
    out: &mut impl Write,
    noise_mm: f64,
    level: &str,
    heights: &str,
    fate: &Fate,
) -> io::Result<()> {
    writeln!(
        out,
        "| {noise_mm} | {level} | {heights} | {:.1} | {:.2} | {:.1} | {:.2} | {:.1} % | {:.1} % | {:.0} % |",
        fate.counts[0] as f64 / fate.labels[1] as f64,
        quantile(&fate.moved_mm, 0.5),
        quantile(&fate.moved_mm, 0.9),
        quantile(&fate.moved_sd, 0.68),
        100.0 * fate.vanished(),
        100.0 * fate.invented(),
        100.0 * fate.labels[0] as f64 / fate.labels[1] as f64
    )
}

/// Measures one scan without and with noise.
fn follow(
    bytes: &[u8],
    method: &Method,
    seeds: u64,
    fates: &mut [Fate],
) -> Result<(), Box<dyn Error>> {
    let scan = read(bytes, Format::Obj)?;
    let first = extract(bytes, Format::Obj, method)?;
    for (group, noise_mm) in NOISE_MM.into_iter().enumerate() {
        for seed in 1..=seeds {
            let noisy = roughened(&scan, noise_mm / first.body.unit.in_mm(), seed);
            let bytes = obj(&noisy);
            let Ok(again) = extract(&bytes, Format::Obj, method) else { continue };
            for before in &first.legs {
                let Some(after) = leg(&again, before.side) else { continue };
                let kept = at_same_heights(&bytes, method, before, after)?;
                for at in &before.level_sections {
                    let level = Level::SOUGHT.iter().position(|level| *level == at.level);
                    let Some(level) = level else { continue };
                    let index = 2 * (group * Level::SOUGHT.len() + level);
                    for (kind, sections) in [&after.level_sections, &kept].into_iter().enumerate() {
                        if let Some(to) = sections.iter().find(|to| to.level == at.level) {
                            fates[index + kind].add(&at.section, &at.features, &to.features);
                        }
                    }
                }
            }
        }
    }
    Ok(())
}

fn leg(extraction: &Extraction, side: Side) -> Option<&LegReport> {
    extraction.legs.iter().find(|leg| leg.side == side)
}

/// The noisy leg's sections at the first leg's levels.
fn at_same_heights(
    bytes: &[u8],
    method: &Method,
    before: &LegReport,
    after: &LegReport,
) -> Result<Vec<LevelSection>, Box<dyn Error>> {
    let body = body(&read(bytes, Format::Obj)?, method)?;
    let cut = segment(&body)?;
    let leg = cut.legs.get(before.side).as_ref().ok_or("the leg is gone")?;
    let span_mm = [LOWEST_STATURE_SHARE * body.scale_mm, cut.crotch.height_mm];
    let span_mm = span_mm.map(|height_mm| after.axis.along_at_height(height_mm));
    let sections = sections(leg, after.axis.clone(), span_mm, SectionFit::Skin);
    let sections = sections.ok_or("no sections")?;
    let along_mm: Vec<f64> = before.level_sections.iter().map(|at| at.section.along_mm).collect();
    let levels = before.level_sections.iter().zip(sections.at(leg, &along_mm));
    let measured = levels.filter_map(|(at, section)| {
        let section = section?;
        let features = features(&sections.axis.plane(section.along_mm), &section);
        Some(LevelSection { level: at.level, section, scan: Vec::new(), features })
    });
    Ok(measured.collect())
}

/// The scans of a folder in the order of their names.
fn scans(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    let is_scan = |path: &PathBuf| {
        let name = path.to_string_lossy();
        name.ends_with(".obj") || name.ends_with(".obj.gz")
    };
    let mut found: Vec<PathBuf> =
        entries.into_iter().map(|entry| entry.path()).filter(is_scan).collect();
    found.sort();
    Ok(found)
}

fn scan_bytes(path: &Path) -> io::Result<Vec<u8>> {
    let bytes = fs::read(path)?;
    if !path.to_string_lossy().ends_with(".gz") {
        return Ok(bytes);
    }
    let mut unpacked = Vec::new();
    GzDecoder::new(bytes.as_slice()).read_to_end(&mut unpacked)?;
    Ok(unpacked)
}

/// A scan written as an export, every digit kept.
fn obj(scan: &Scan) -> Vec<u8> {
    let mut text = String::new();
    // Writing to a string cannot fail.
    for p in &scan.points {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in &scan.triangles {
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    text.into_bytes()
}
