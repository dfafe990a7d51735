//! How far the surface reaches: the sections that it is laid through.

use super::section::{Outline, SPACING_MM};
use super::sections::Sections;

/// A section of which no more than this was not seen lends the surface what was, degrees.
const GAP_MAX_DEG: f64 = 180.0;

/// Skin of which nothing was seen for this length is not bridged, mm: a calf's girth may turn
/// within it.
const BAND_MAX_MM: f64 = 40.0;

/// The outlines of the longest part of the leg, among those that cover most of the heights, in
/// which no band of sections is missing; it begins with the highest section that is not above the
/// lower height. Ascending.
pub fn span(sections: &Sections, [low_mm, high_mm]: [f64; 2]) -> Vec<Outline> {
    let axis = &sections.axis;
    let height_mm = |outline: &Outline| axis.at(outline.along_mm, &outline.centre).z;
    let seen = sections.rows.iter().filter_map(|row| sections.outline(row, GAP_MAX_DEG));
    let seen: Vec<Outline> = seen.collect();
    let parts = seen.chunk_by(|low, high| high.along_mm - low.along_mm <= BAND_MAX_MM + SPACING_MM);
    let covered_mm = |part: &&[Outline]| {
        let (Some(first), Some(last)) = (part.first(), part.last()) else { return 0.0 };
        height_mm(last).min(high_mm) - height_mm(first).max(low_mm)
    };
    let Some(part) = parts.max_by(|a, b| covered_mm(a).total_cmp(&covered_mm(b))) else {
        return Vec::new();
    };
    let first = part.iter().rposition(|outline| height_mm(outline) <= low_mm).unwrap_or(0);
    part[first..].to_vec()
}
