//! A level of a leg, either found or estimated.

use crate::doubt::Doubt;
use crate::level::{By, Level};

/// Plausible girths of legs, mm, from a small child's ankle to a thigh with elephantiasis; values
/// outside were not measured on a leg.
const GIRTH_MM: [f64; 2] = [90.0, 1200.0];

/// A level found on a leg.
#[derive(Debug, Clone, PartialEq)]
pub struct Landmark {
    /// Which level.
    pub level: Level,
    /// How it was found.
    pub by: By,
    /// Distance along the axis from the floor, mm.
    pub along_mm: f64,
    /// Vertical height of the section's centre above the floor, mm.
    pub height_mm: f64,
    /// Length from the floor along the skin of the leg's medial side, mm; `None` on the foot.
    pub surface_length_mm: Option<f64>,
    /// Girth over the convex hull, mm.
    pub girth_tape_mm: f64,
    /// Girth along the skin, mm.
    pub girth_contour_mm: f64,
    /// Standard error of the height, mm.
    pub height_sd_mm: f64,
    /// Standard error of the tape girth at this height, mm: however uncertain it is where the level lies, this girth
    /// belongs to this height.
    pub girth_sd_mm: f64,
    /// Standard error of the tape girth as that of the level, mm: with what the uncertain height adds where the
    /// girth changes along the leg.
    pub girth_of_level_sd_mm: f64,
    /// How much the tape girth changes at most with a tilt of the tape, mm per degree; `None` if unknown.
    pub girth_per_deg_mm: Option<f64>,
    /// What a reader must know before using it.
    pub doubts: Vec<Doubt>,
}

/// Whether a leg can have this girth.
pub(crate) fn is_plausible(girth_mm: f64) -> bool {
    (GIRTH_MM[0]..=GIRTH_MM[1]).contains(&girth_mm)
}

/// A level estimated by proportion, because the skin does not show it: a fallback, not a landmark.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Which level.
    pub level: Level,
    /// The proportion.
    pub by: By,
    /// Distance of the section's centre from the floor along the leg's axis, mm.
    pub along_mm: f64,
    /// Its vertical height above the floor, mm.
    pub height_mm: f64,
    /// Girth over the convex hull, mm.
    pub girth_tape_mm: f64,
    /// Standard error of the height, mm: the variation of the proportion among people.
    pub height_sd_mm: f64,
    /// Standard error of the tape girth at this height, mm.
    pub girth_sd_mm: f64,
    /// Standard error of the tape girth as that of the level, mm: with what the uncertain height adds.
    pub girth_of_level_sd_mm: f64,
    /// What a reader must know before using it.
    pub doubts: Vec<Doubt>,
}

impl From<Landmark> for Estimate {
    fn from(place: Landmark) -> Estimate {
        let Landmark { level, by, along_mm, height_mm, girth_tape_mm, .. } = place;
        let Landmark { height_sd_mm, girth_sd_mm, girth_of_level_sd_mm, doubts, .. } = place;
        Estimate {
            level,
            by,
            along_mm,
            height_mm,
            girth_tape_mm,
            height_sd_mm,
            girth_sd_mm,
            girth_of_level_sd_mm,
            doubts,
        }
    }
}
