//! The measurements of one leg, as data.

use super::level::Level;
use super::side::Side;
use crate::comparison::volume::LegVolume;
use crate::features::feature::Feature;
use crate::levels::at_height::{AtHeight, AtLength};
use crate::levels::foot::Foot;
use crate::levels::girth::GirthCurve;
use crate::levels::landmark::{Estimate, Landmark};
use crate::sections::axis::LegAxis;
use crate::sections::axis_length::AxisLength;
use crate::sections::section::Section;
use crate::surface::nurbs::LegSurface;
use crate::surface::shape::{OnPlane, Shape};

/// All measurements of one leg.
#[derive(Debug, Clone)]
pub struct LegReport {
    /// Whose leg.
    pub side: Side,
    /// The leg's axis and the frame of its sections.
    pub axis: LegAxis,
    /// Distances along it, as records state them.
    pub lengths: AxisLength,
    /// Levels found, lowest first; absent ones are not included.
    pub landmarks: Vec<Landmark>,
    /// Levels known only by proportion, lowest first.
    pub estimates: Vec<Estimate>,
    /// The foot, if it was seen from heel to toes.
    pub foot: Option<Foot>,
    /// Girth over height.
    pub girth_curve: GirthCurve,
    /// The section at each level found from the ankle up, with its feature points.
    pub level_sections: Vec<LevelSection>,
    /// The surface, if enough of the leg was seen.
    pub surface: Option<LegSurface>,
    /// Its shape, for pictures.
    pub shape: Shape,
    /// Volumes.
    pub volume: LegVolume,
    /// Girths at the requested heights.
    pub at: Vec<AtHeight>,
    /// Girths at the heights at which both legs are compared, lowest first.
    pub profile: Vec<AtHeight>,
    /// Girths at the lengths along the axis at which scans of different days are compared, lowest first.
    pub along: Vec<AtLength>,
}

/// The section at a level and its features.
#[derive(Debug, Clone)]
pub struct LevelSection {
    /// Which level.
    pub level: Level,
    /// The section at the level's own height.
    pub section: Section,
    /// The scan's own points on its plane, for pictures.
    pub scan: Vec<OnPlane>,
    /// P1, P2, … in order around the section from the front.
    pub features: Vec<Feature>,
}
