//! Readings at one position on a leg: girths and height from the girth curve, doubts from the skin
//! around it.

use super::extremum::root;
use super::girth::GirthCurve;
use super::landmark::Landmark;
use crate::doubt::Doubt;
use crate::level::{By, Level};
use crate::sections::equidistant::Sections;
use crate::sections::section::Section;

/// A gap in the skin wider than this is reported as a doubt, degrees.
pub(crate) const GAP_DOUBT_DEG: f64 = 30.0;

/// Points that scatter by more than this about the section do not form a single skin, mm: cloth, a
/// second layer, a patient who moved. Scanners scatter by 1 mm, poor ones by 1.5.
const SCATTER_DOUBT_MM: f64 = 2.0;

/// Skin that is longer than the tape by more than this share is folded, or is not skin.
const FOLDS_DOUBT_SHARE: f64 = 0.01;

/// Reads levels off a girth curve.
pub(crate) struct Ruler<'c> {
    pub curve: &'c GirthCurve,
    pub sections: &'c Sections,
}

impl Ruler<'_> {
    /// A level at a distance along the axis, with the standard errors of its height and of the girth as that of the
    /// level; `None` outside the measured sections.
    pub fn landmark(
        &self,
        level: Level,
        by: By,
        along_mm: f64,
        [height_sd_mm, girth_of_level_sd_mm]: [f64; 2],
    ) -> Option<Landmark> {
        let girth = self.curve.girth(along_mm);
        Some(Landmark {
            level,
            by,
            along_mm,
            height_mm: self.curve.height_mm(along_mm)?,
            surface_length_mm: None,
            girth_tape_mm: girth.tape_mm,
            girth_contour_mm: girth.contour_mm,
            height_sd_mm,
            girth_sd_mm: self.curve.tape_sd(along_mm, 0),
            girth_of_level_sd_mm,
            girth_per_deg_mm: None,
            doubts: doubts(self.curve, along_mm, self.sections),
        })
    }

    /// A level at a height above the floor with this standard error, mm; `None` outside the
    /// measured sections.
    pub fn at_height(
        &self,
        level: Level,
        by: By,
        height_mm: f64,
        height_sd_mm: f64,
    ) -> Option<Landmark> {
        let along_mm = self.along_mm(height_mm)?;
        let [_, slope, _, _] = self.curve.tape(along_mm);
        let of_level_mm = self.curve.tape_sd(along_mm, 0).hypot(slope * height_sd_mm);
        self.landmark(level, by, along_mm, [height_sd_mm, of_level_mm])
    }

    /// The distance along the axis at which the sections' centre has a given height; heights ascend
    /// along a leg.
    fn along_mm(&self, height_mm: f64) -> Option<f64> {
        let (low, high) = self.curve.domain();
        let above = |along_mm: f64| Some(self.curve.height_mm(along_mm)? - height_mm);
        let within = above(low)? <= 0.0 && above(high)? >= 0.0;
        within.then(|| root(|along_mm| above(along_mm).unwrap_or(0.0), low, high))
    }
}

/// The doubts about the skin at a distance along the axis, from the nearest section.
pub(crate) fn doubts(curve: &GirthCurve, along_mm: f64, sections: &Sections) -> Vec<Doubt> {
    let section = sections.nearest(along_mm).filter(|_| curve.is_seen(along_mm));
    section.map_or_else(|| vec![Doubt::NotSeen], section_doubts)
}

/// The doubts about a section.
pub(crate) fn section_doubts(section: &Section) -> Vec<Doubt> {
    let (gap_deg, rms_mm) = (section.largest_gap_deg, section.rms_mm);
    let excess = section.girth.contour_mm / section.girth.tape_mm - 1.0;
    let all = [
        (gap_deg > GAP_DOUBT_DEG, Doubt::Gap { gap_deg }),
        (rms_mm > SCATTER_DOUBT_MM, Doubt::Scatter { rms_mm }),
        (excess > FOLDS_DOUBT_SHARE, Doubt::Folds { percent: 100.0 * excess }),
    ];
    all.into_iter().filter(|(holds, _)| *holds).map(|(_, doubt)| doubt).collect()
}
