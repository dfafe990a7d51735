//! `measurements.csv` for spreadsheets: one line per leg and level, and one per leg and requested
//! height. RFC 4180, comma, point.

use super::chart::AtFigures;
use super::rounding;
use super::schema::{EstimateFigures, LandmarkFigures, Record};
use crate::leg::Level;

const HEADER: &str = "leg,level,height_mm,along_axis_mm,girth_tape_mm,girth_contour_mm,\
                      height_sd_mm,girth_sd_mm,doubts,surface_length_mm,by\r\n";

/// All levels of the measured legs. The doubts of a level by proportion begin with `estimate`. An absent
/// level has no figures, and its doubts contain `absent`. The requested heights follow as levels
/// `at 10 cm`.
pub fn measurements(record: &Record) -> String {
    let mut text = HEADER.to_owned();
    for leg in &record.legs {
        for level in Level::ALL.map(Level::name) {
            let found = leg.landmarks.get(level).map(present);
            let estimated = || leg.estimates.get(level).map(estimate);
            let cells = found.or_else(estimated).unwrap_or_else(absent);
            text.push_str(&format!("{},{level},{cells}\r\n", leg.side));
        }
        for at in &leg.at {
            let level = format!("at {} cm", rounding::mm(at.height_mm / 10.0));
            text.push_str(&format!("{},{level},{}\r\n", leg.side, at_height(at)));
        }
    }
    text
}

/// A figure, or nothing if it is unknown.
fn judged(figure: Option<f64>) -> String {
    figure.map_or(String::new(), |figure| figure.to_string())
}

fn present(landmark: &LandmarkFigures) -> String {
    format!(
        "{},{},{},{},{},{},{},{},{}",
        landmark.height_mm,
        landmark.along_axis_mm,
        landmark.girth_tape_mm,
        landmark.girth_contour_mm,
        judged(landmark.height_sd_mm),
        judged(landmark.girth_sd_mm),
        landmark.doubts.join(" "),
        judged(landmark.surface_length_mm),
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
        judged(estimate.height_sd_mm),
        judged(estimate.girth_sd_mm),
        doubts.collect::<Vec<_>>().join(" "),
        estimate.by
    )
}

/// A requested height is exact, so its standard error stays empty.
fn at_height(at: &AtFigures) -> String {
    format!(
        "{},{},{},{},,{},{},,",
        at.height_mm,
        judged(at.along_axis_mm),
        judged(at.girth_tape_mm),
        judged(at.girth_contour_mm),
        judged(at.girth_sd_mm),
        at.doubts.join(" ")
    )
}

fn absent() -> String {
    ",,,,,,absent,,".to_owned()
}
