//! A folder of scans with truth beside them, and how an extraction differs from it.
//!
//! The folder holds `NAME.obj` or `NAME.obj.gz`, and `NAME.truth.json` as `fixtures/README.md`
//! describes it.

// Each example uses its own part.
#![allow(dead_code)]

use std::error::Error;
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use gaiter_leg::method::Up;
use gaiter_leg::{Landmark, LegReport, Level};
use serde_json::Value;

/// An export and what is true of the body behind it.
pub struct Case {
    pub name: String,
    pub bytes: Vec<u8>,
    pub up: Up,
    pub truth: Value,
}

impl Case {
    /// Standard deviation of its noise, mm.
    pub fn noise_mm(&self) -> f64 {
        self.truth["defects"]["noise"].as_f64().unwrap_or(0.0)
    }

    /// What is true of a leg.
    pub fn leg(&self, leg: &LegReport) -> &Value {
        &self.truth["legs"][leg.side.word()]
    }
}

/// The cases of a folder in the order of their names.
pub fn cases(folder: &Path) -> Result<Vec<Case>, Box<dyn Error>> {
    let entries = fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    let paths = entries.into_iter().map(|entry| entry.path());
    let is_truth = |path: &PathBuf| path.to_string_lossy().ends_with(".truth.json");
    let mut truths: Vec<PathBuf> = paths.filter(is_truth).collect();
    truths.sort();
    truths.iter().map(|path| case(path)).collect()
}

fn case(truth_path: &Path) -> Result<Case, Box<dyn Error>> {
    let truth: Value = serde_json::from_slice(&fs::read(truth_path)?)?;
    let name = truth["name"].as_str().unwrap_or_default().to_owned();
    let up = if truth["up"] == "z" { Up::Z } else { Up::Y };
    let bytes = scan_bytes(truth_path, &name)?;
    Ok(Case { name, bytes, up, truth })
}

fn scan_bytes(truth_path: &Path, name: &str) -> io::Result<Vec<u8>> {
    // A name may have a dot.
    let plain = truth_path.with_file_name(format!("{name}.obj"));
    if plain.exists() {
        return fs::read(plain);
    }
    let packed = truth_path.with_file_name(format!("{name}.obj.gz"));
    let mut bytes = Vec::new();
    GzDecoder::new(fs::File::open(packed)?).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A level as it was measured.
pub fn found(leg: &LegReport, level: Level) -> Option<&Landmark> {
    leg.landmarks.iter().find(|landmark| landmark.level == level)
}

/// How a level of the record differs from the truth.
pub enum Compared {
    /// Both have it; errors of tape girth and height, measured minus true, mm.
    Errors { girth_mm: f64, height_mm: f64 },
    /// Neither has it.
    Absent,
    /// One has it, and either is right.
    Undecidable,
    /// The body has it and the record does not.
    Missed,
    /// The record has it and the body does not.
    Invented,
}

/// Compares a level; no leg has no level.
pub fn compared(leg: Option<&LegReport>, level: Level, truth: &Value) -> Compared {
    let landmark = &truth["landmarks"][level.name()];
    let undecidable = truth["undecidable"].as_array();
    let undecidable = undecidable.is_some_and(|list| list.iter().any(|l| l == level.name()));
    let found = leg.and_then(|leg| found(leg, level));
    match (found, landmark["tape_mm"].as_f64(), landmark["height_mm"].as_f64()) {
        (Some(found), Some(tape_mm), Some(height_mm)) => Compared::Errors {
            girth_mm: found.girth_tape_mm - tape_mm,
            height_mm: found.height_mm - height_mm,
        },
        (None, None, _) => Compared::Absent,
        _ if undecidable => Compared::Undecidable,
        (None, ..) => Compared::Missed,
        (Some(_), ..) => Compared::Invented,
    }
}

/// A column of a leg's true profile over the height above the floor, mm.
pub struct Profile(Vec<(f64, f64)>);

impl Profile {
    /// The column of this name.
    pub fn named(truth: &Value, name: &str) -> Profile {
        let column = |name: &str| truth["profile"][name].as_array().cloned().unwrap_or_default();
        let (heights, values) = (column("height_mm"), column(name));
        let pairs = heights.iter().zip(&values);
        Profile(pairs.filter_map(|(h, v)| Some((h.as_f64()?, v.as_f64()?))).collect())
    }

    /// The value at a height, between the two nearest rows; none outside them.
    pub fn at(&self, height_mm: f64) -> Option<f64> {
        let above = self.0.partition_point(|(height, _)| *height < height_mm);
        let [low, high] = self.0.get(above.checked_sub(1)?..=above)? else { return None };
        Some(low.1 + (high.1 - low.1) * (height_mm - low.0) / (high.0 - low.0))
    }
}

/// Median, 95th percentile and largest.
pub fn quantiles(errors: &[f64]) -> [f64; 3] {
    let mut sorted = errors.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let index = (share * sorted.len() as f64).ceil() as usize;
        sorted.get(index.saturating_sub(1)).copied().unwrap_or(f64::NAN)
    };
    [at(0.5), at(0.95), at(1.0)]
}
