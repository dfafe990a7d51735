//! `measurements.csv`: one line a leg and level, for spreadsheets. RFC 4180, comma, point.

use super::schema::{LandmarkFigures, Record};
use crate::leg::Level;

const HEADER: &str = "leg,level,height_mm,along_axis_mm,girth_tape_mm,girth_contour_mm,\
                      height_sd_mm,girth_sd_mm,doubts\r\n";

/// All levels of the measured legs; the figures of an absent level are empty and its doubts say
/// `absent`.
pub fn measurements(record: &Record) -> String {
    let mut text = HEADER.to_owned();
    for leg in &record.legs {
        for level in Level::ALL.map(Level::name) {
            let cells = leg.landmarks.get(level).map_or_else(absent, present);
            text.push_str(&format!("{},{level},{cells}\r\n", leg.side));
        }
    }
    text
}

fn present(landmark: &LandmarkFigures) -> String {
    let judged = |sd: Option<f64>| sd.map_or(String::new(), |sd| sd.to_string());
    format!(
        "{},{},{},{},{},{},{}",
        landmark.height_mm,
        landmark.along_axis_mm,
        landmark.girth_tape_mm,
        landmark.girth_contour_mm,
        judged(landmark.height_sd_mm),
        judged(landmark.girth_sd_mm),
        landmark.doubts.join(" ")
    )
}

fn absent() -> String {
    ",,,,,,absent".to_owned()
}
