//! The extent of the surface: the sections that it passes through.

use crate::sections::equidistant::Sections;
use crate::sections::section::{Outline, Section};

/// A section that is not measured still contributes its seen part to the surface, unless its gap is
/// wider than this, degrees.
const BRIDGED_GAP_DEG: f64 = 180.0;

/// A band longer than this without a measured section is not bridged, mm, because the girth of a
/// calf may have an extremum within it.
const BAND_MAX_MM: f64 = 40.0;

/// The outlines, ascending, of the part of the leg that covers most of the heights and has no
/// longer band without a measured section. The part begins with the highest section that is not
/// above the lower height.
pub fn span(sections: &Sections, [low_mm, high_mm]: [f64; 2]) -> Vec<Outline> {
    let measured = sections.rows.iter().filter_map(|row| row.section.as_ref());
    let measured: Vec<&Section> = measured.collect();
    let parts = measured.chunk_by(|low, high| high.along_mm - low.along_mm <= BAND_MAX_MM);
    let covered_mm = |part: &&[&Section]| {
        let (Some(first), Some(last)) = (part.first(), part.last()) else { return 0.0 };
        last.height_mm.min(high_mm) - first.height_mm.max(low_mm)
    };
    let Some(part) = parts.max_by(|a, b| covered_mm(a).total_cmp(&covered_mm(b))) else {
        return Vec::new();
    };
    let first = part.iter().rposition(|section| section.height_mm <= low_mm).unwrap_or(0);
    let (from_mm, to_mm) = (part[first].along_mm, part[part.len() - 1].along_mm);
    let rows = sections.rows.iter().filter(|row| (from_mm..=to_mm).contains(&row.along_mm));
    rows.filter_map(|row| sections.outline(row, BRIDGED_GAP_DEG)).collect()
}
