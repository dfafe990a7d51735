//! What is measured on one leg, as data.

use super::level::Level;
use super::side::Side;
use crate::leg::comparison::volume::LegVolume;
use crate::leg::features::feature::Feature;
use crate::leg::levels::at_height::AtHeight;
use crate::leg::levels::foot::Foot;
use crate::leg::levels::girth::GirthCurve;
use crate::leg::levels::landmark::{Estimate, Landmark};
use crate::leg::sections::axis::LegAxis;
use crate::leg::sections::section::Section;
use crate::leg::surface::nurbs::LegSurface;
use crate::leg::surface::shape::{OnPlane, Shape};

/// Everything measured on one leg.
#[derive(Debug, Clone)]
pub struct LegReport {
    /// Whose leg.
    pub side: Side,
    /// The leg's axis and the frame of its sections.
    pub axis: LegAxis,
    /// Levels found, lowest first; absent ones are not here.
    pub landmarks: Vec<Landmark>,
    /// Levels that only a proportion gives, lowest first.
    pub estimates: Vec<Estimate>,
    /// The foot, where it is seen from heel to toes.
    pub foot: Option<Foot>,
    /// Girth over height.
    pub girth_curve: GirthCurve,
    /// The section at each level found from the ankle up, with its feature points.
    pub level_sections: Vec<LevelSection>,
    /// The surface, where enough of the leg is seen.
    pub surface: Option<LegSurface>,
    /// Its shape, for pictures.
    pub shape: Shape,
    /// Volumes.
    pub volume: LegVolume,
    /// Girths at the heights that were asked for.
    pub at: Vec<AtHeight>,
}

/// The section at a level and what was found on it.
#[derive(Debug, Clone)]
pub struct LevelSection {
    /// Which level.
    pub level: Level,
    /// The section at the level's own height.
    pub section: Section,
    /// The scan's own points on its plane, for pictures.
    pub scan: Vec<OnPlane>,
    /// P1, P2, … in order around from the front.
    pub features: Vec<Feature>,
}
