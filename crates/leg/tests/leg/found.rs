//! What was found on a body and on its legs, picked out of an extraction.

#![allow(clippy::unwrap_used, clippy::panic)]

use gaiter_leg::features::feature::Feature;
use gaiter_leg::{Extraction, Landmark, LegReport, Level, Method, extract};
use gaiter_scan::Format;

/// The turning points of the girth.
pub const B_C_D: [Level; 3] = [Level::B, Level::C, Level::D];

/// What is measured on an export.
#[track_caller]
pub fn extraction_of(bytes: &[u8], method: &Method) -> Extraction {
    extract(bytes, Format::Obj, method).unwrap()
}

/// The levels that were found, lowest first.
pub fn levels(leg: &LegReport) -> Vec<Level> {
    leg.landmarks.iter().map(|at| at.level).collect()
}

/// A level that must have been found.
#[track_caller]
pub fn landmark(leg: &LegReport, level: Level) -> &Landmark {
    let found = leg.landmarks.iter().find(|at| at.level == level);
    let Some(found) = found else { panic!("{} has no {}", leg.side.word(), level.name()) };
    found
}

/// A standard error, which must be known.
#[track_caller]
pub fn known_mm(sd_mm: f64) -> f64 {
    assert!(sd_mm.is_finite(), "a standard error is not known");
    sd_mm
}

/// The feature points of all sections.
pub fn features(leg: &LegReport) -> impl Iterator<Item = &Feature> {
    leg.level_sections.iter().flat_map(|at| &at.features)
}
