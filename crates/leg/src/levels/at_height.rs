//! Girths at requested heights, as clinics chart them: every 10 cm above the floor, for example,
//! independent of the levels of the leg. And at fixed lengths along the leg, for comparing scans of
//! different days: there they do not depend on how the leg was held.

use super::girth::GirthCurve;
use super::level_reading::doubts;
use crate::doubt::Doubt;
use crate::sections::axis_length::AxisLength;
use crate::sections::equidistant::Sections;
use crate::sections::section::{Girth, SPACING_MM};
use crate::statistics::range;

/// The result at a requested height.
#[derive(Debug, Clone, PartialEq)]
pub struct AtHeight {
    /// The requested height of the section's centre above the floor, mm.
    pub height_mm: f64,
    /// The girth there, or the reason why there is none.
    pub found: Result<HeightGirth, NoGirth>,
}

/// The girth at a height.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightGirth {
    /// Distance of the section along the axis from the floor, mm.
    pub along_mm: f64,
    /// Girth over the convex hull, mm.
    pub girth_tape_mm: f64,
    /// Girth along the skin, mm.
    pub girth_contour_mm: f64,
    /// Standard error of the tape girth, mm.
    pub girth_sd_mm: f64,
    /// What a reader must know before using it.
    pub doubts: Vec<Doubt>,
}

/// The result at a fixed length along the leg's axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AtLength {
    /// The length along the axis from the floor, mm, as records state it.
    pub length_mm: f64,
    /// Height of the section's centre above the floor, mm; `None` if it was not measured.
    pub height_mm: Option<f64>,
    /// The girth there, or the reason why there is none.
    pub found: Result<HeightGirth, NoGirth>,
}

coded_enum! {
    /// Why there is no girth at a height.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum NoGirth {
        /// The leg was not measured at this height.
        Outside {
            /// Lowest height, mm.
            from_mm: f64,
            /// Highest height, mm.
            to_mm: f64,
        } => "outside-girths",
        /// The sections around it are open.
        NotSeen => "skin-not-seen",
    }
}

/// Distance of the heights, and of the lengths, at which legs are compared, mm: the usual step of tables
/// by hand.
pub const PROFILE_STEP_MM: f64 = 40.0;

/// The heights above the floor at which both legs are compared, mm: multiples of [`PROFILE_STEP_MM`] where
/// sections of the leg were measured.
pub(crate) fn profile_heights_mm(curve: &GirthCurve) -> Vec<f64> {
    let [low, high] = range(curve.rows.iter().filter_map(|row| Some(row.measured?.0)));
    let steps = |mm: f64| (mm / PROFILE_STEP_MM).max(0.0);
    let (first, last) = (steps(low).ceil() as u32, steps(high).floor() as u32);
    (first..=last).map(|step| PROFILE_STEP_MM * f64::from(step)).collect()
}

/// The girths at heights above the floor, mm, in the order of the request.
pub fn at_heights(curve: &GirthCurve, heights_mm: &[f64], sections: &Sections) -> Vec<AtHeight> {
    let one = |&height_mm: &f64| {
        let along_mm = along_mm(curve, height_mm);
        let found = along_mm.and_then(|along_mm| girth_at(curve, along_mm, sections));
        AtHeight { height_mm, found }
    };
    heights_mm.iter().map(one).collect()
}

/// The girths at multiples of [`PROFILE_STEP_MM`] along the leg's axis, over the range of the curve.
pub(crate) fn at_lengths(
    curve: &GirthCurve,
    lengths: &AxisLength,
    sections: &Sections,
) -> Vec<AtLength> {
    let (from_mm, to_mm) = curve.domain();
    let steps = |along_mm: f64| lengths.at(along_mm) / PROFILE_STEP_MM;
    let (first, last) = (steps(from_mm).ceil() as u32, steps(to_mm).floor() as u32);
    let one = |step: u32| {
        let length_mm = PROFILE_STEP_MM * f64::from(step);
        let along_mm = lengths.along_at(length_mm);
        let found = girth_at(curve, along_mm, sections);
        let height_mm = found.as_ref().ok().and_then(|_| curve.height_mm(along_mm));
        AtLength { length_mm, height_mm, found }
    };
    (first..=last).map(one).collect()
}

/// The girth at a distance along the axis.
fn girth_at(
    curve: &GirthCurve,
    along_mm: f64,
    sections: &Sections,
) -> Result<HeightGirth, NoGirth> {
    let doubts = doubts(curve, along_mm, sections);
    // The curve bridges such gaps; a level there may be reported with a doubt, a charted girth may not.
    if doubts.contains(&Doubt::NotSeen) {
        return Err(NoGirth::NotSeen);
    }
    let Girth { tape_mm, contour_mm } = curve.girth(along_mm);
    Ok(HeightGirth {
        along_mm,
        girth_tape_mm: tape_mm,
        girth_contour_mm: contour_mm,
        girth_sd_mm: curve.tape_sd(along_mm, 0),
        doubts,
    })
}

/// The distance along the axis at which the section's centre has a given height.
fn along_mm(curve: &GirthCurve, height_mm: f64) -> Result<f64, NoGirth> {
    let (from, to) = curve.domain();
    let measured = curve.rows.iter().filter(|row| (from..=to).contains(&row.along_mm));
    let measured: Vec<[f64; 2]> =
        measured.filter_map(|row| Some([row.along_mm, row.measured?.0])).collect();
    let around =
        measured.windows(2).find(|pair| pair[0][1] <= height_mm && height_mm <= pair[1][1]);
    let Some(&[[low, low_height], [high, high_height]]) = around.and_then(|pair| pair.as_array())
    else {
        let height = |row: Option<&[f64; 2]>| row.map_or(0.0, |row| row[1]);
        let (from_mm, to_mm) = (height(measured.first()), height(measured.last()));
        return Err(NoGirth::Outside { from_mm, to_mm });
    };
    if high - low > 1.5 * SPACING_MM {
        return Err(NoGirth::NotSeen);
    }
    let rise = high_height - low_height;
    let share = if rise > 0.0 { (height_mm - low_height) / rise } else { 0.0 };
    Ok(low + share * (high - low))
}
