//! Lengths along the skin of a leg's medial side, where fitters place the tape.

use std::f64::consts::FRAC_PI_2;

use crate::sections::equidistant::Sections;
use crate::sections::section::Section;

/// The medial side as an angle around a section.
const MEDIAL: f64 = -FRAC_PI_2;

/// Length from the floor to a level along the medial skin, mm: straight lines from section to
/// section, across any gaps, and straight down from the lowest section, because the tape hangs
/// beside the foot there. `None` outside the measured sections.
pub(crate) fn surface_length_mm(sections: &Sections, along_mm: f64) -> Option<f64> {
    let measured = sections.rows.iter().filter_map(|row| row.section.as_ref());
    let point = |section: &Section| section.point(&sections.axis.plane(section.along_mm), MEDIAL);
    let mut below = measured.clone().next().filter(|section| section.along_mm <= along_mm)?;
    let mut length_mm = point(below).z;
    for section in measured.skip(1) {
        let step_mm = (point(section) - point(below)).norm();
        if section.along_mm >= along_mm {
            let share = (along_mm - below.along_mm) / (section.along_mm - below.along_mm);
            return Some(length_mm + share * step_mm);
        }
        length_mm += step_mm;
        below = section;
    }
    None
}
