//! `measurements.csv`: one line a leg and level, for spreadsheets. RFC 4180, comma, point.

use super::schema::{EstimateFigures, LandmarkFigures, Record};
use crate::leg::Level;

const HEADER: &str = "leg,level,height_mm,along_axis_mm,girth_tape_mm,girth_contour_mm,\
                      height_sd_mm,girth_sd_mm,doubts,surface_length_mm,by\r\n";

/// All levels of the measured legs. The doubts of a level by proportion begin with `estimate`; the
/// figures of an absent level are empty and its doubts say `absent`.
pub fn measurements(record: &Record) -> String {
    let mut text = HEADER.to_owned();
    for leg in &record.legs {
        for level in Level::ALL.map(Level::name) {
            let found = leg.landmarks.get(level).map(present);
            let estimated = || leg.estimates.get(level).map(estimate);
            let cells = found.or_else(estimated).unwrap_or_else(absent);
            text.push_str(&format!("{},{level},{cells}\r\n", leg.side));
        }
    }
    text
}

fn present(landmark: &LandmarkFigures) -> String {
    format!(
        "{},{},{},{},{},{},{},{},{}",
        landmark.height_mm,
        landmark.along_axis_mm,
        landmark.girth_tape_mm,
        landmark.girth_contour_mm,
        known(landmark.height_sd_mm),
        known(landmark.girth_sd_mm),
        landmark.doubts.join(" "),
        known(landmark.surface_length_mm),
        landmark.by
    )
}

fn estimate(estimate: &EstimateFigures) -> String {
    let doubts = ["estimate"].into_iter().chain(estimate.doubts.iter().map(String::as_str));
    format!(
        "{},{},{},,{},{},{},,{}",
        estimate.height_mm,
        estimate.along_axis_mm,
        estimate.girth_tape_mm,
        known(estimate.height_sd_mm),
        known(estimate.girth_sd_mm),
        doubts.collect::<Vec<_>>().join(" "),
        estimate.by
    )
}

fn absent() -> String {
    ",,,,,,absent,,".to_owned()
}

/// A figure, or nothing where it is not known.
fn known(figure: Option<f64>) -> String {
    figure.map_or(String::new(), |figure| figure.to_string())
}
