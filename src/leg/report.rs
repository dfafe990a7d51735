//! The report of one leg: every stage of the paper in order, from the leg's skin to its surface.

use super::axis::{LegAxis, axis, principal_axis};
use super::feature::{Feature, features};
use super::finding::{Finding, LegFault, What};
use super::girth::{GirthCurve, girth_curve};
use super::landmark::{Landmark, landmarks};
use super::level::Level;
use super::method::AxisFit;
use super::section::Section;
use super::sections::sections;
use super::segment::{Leg, Side};
use super::surface::{LegSurface, surface};
use super::{Body, Method};

/// The surface covers at least this much below B and above D, mm.
const SURFACE_MARGIN_MM: f64 = 20.0;

/// Where D is absent the surface reaches the knee: mid-patella as a share of the crotch's height
/// (ANSUR II, 0.575 ± 0.014).
const KNEE_CROTCH_SHARE: f64 = 0.575;

/// Where B is absent the surface begins above the malleoli, as a share of stature.
const ANKLE_STATURE_SHARE: f64 = 0.06;

/// The lowest section, as a share of stature: above the instep, below every malleolus.
const LOWEST_STATURE_SHARE: f64 = 0.035;

/// Everything measured on one leg.
#[derive(Debug, Clone)]
pub struct LegReport {
    /// Whose leg.
    pub side: Side,
    /// The leg's axis and the frame of its sections.
    pub axis: LegAxis,
    /// Levels found, lowest first; absent ones are not here.
    pub landmarks: Vec<Landmark>,
    /// Girth over height.
    pub girth_curve: GirthCurve,
    /// The section at each level found, with its feature points.
    pub level_sections: Vec<LevelSection>,
    /// The surface, where enough of the leg is seen.
    pub surface: Option<LegSurface>,
}

/// The section at a level and what was found on it.
#[derive(Debug, Clone)]
pub struct LevelSection {
    /// Which level.
    pub level: Level,
    /// The section at the level's own height.
    pub section: Section,
    /// P1, P2, … in order around from the front.
    pub features: Vec<Feature>,
}

/// Measures one leg.
///
/// # Errors
/// A [`LegFault`] where the leg has no axis or hardly any closed section.
pub fn leg_report(
    leg: &Leg,
    body: &Body,
    crotch_height_mm: f64,
    method: &Method,
) -> Result<(LegReport, Vec<Finding>), LegFault> {
    let axis = match method.axis {
        AxisFit::Centroids => axis(leg, body.stature_mm, crotch_height_mm)?,
        AxisFit::Principal => principal_axis(leg, crotch_height_mm)?,
    };
    let up_mm = |height_mm: f64| height_mm / axis.direction.z;
    let span_mm = [up_mm(LOWEST_STATURE_SHARE * body.stature_mm), up_mm(crotch_height_mm)];
    let sections = sections(leg, axis, span_mm, method.fit).ok_or(LegFault::TooFewPoints)?;
    let curve = girth_curve(&sections, body.stature_mm).ok_or_else(|| {
        let measured = sections.rows.iter().filter(|row| row.section.is_some()).count();
        LegFault::TooFewSections { measured, planes: sections.rows.len() }
    })?;
    let near = |along_mm: f64| sections.nearest(along_mm);
    let found = landmarks(&curve, body.stature_mm, crotch_height_mm, near);
    let mut findings = Findings { side: leg.side, found: Vec::new() };
    findings.about_levels(&found);
    let landmarks: Vec<Landmark> = found.into_iter().filter(Landmark::is_plausible).collect();
    let wanted_mm = surface_heights_mm(&landmarks, body.stature_mm, crotch_height_mm);
    let surface = match surface(leg, &sections, wanted_mm) {
        Ok(surface) => Some(surface),
        Err(what) => {
            findings.add(None, what);
            None
        }
    };
    if let Some(surface) = &surface {
        findings.about_extent(surface, wanted_mm);
    }
    let along_mm: Vec<f64> = landmarks.iter().map(|landmark| landmark.along_mm).collect();
    let at_levels = landmarks.iter().zip(sections.at(leg, &along_mm));
    let level_sections = at_levels.filter_map(|(landmark, section)| {
        let section = section?;
        let features = features(&sections.axis, &section);
        Some(LevelSection { level: landmark.level, section, features })
    });
    let report = LegReport {
        side: leg.side,
        level_sections: level_sections.collect(),
        axis: sections.axis,
        landmarks,
        girth_curve: curve,
        surface,
    };
    Ok((report, findings.found))
}

/// The heights between which the surface must lie, mm.
fn surface_heights_mm(landmarks: &[Landmark], stature_mm: f64, crotch_height_mm: f64) -> [f64; 2] {
    let at = |level: Level| landmarks.iter().find(|l| l.level == level).map(|l| l.height_mm);
    let ankle_mm = ANKLE_STATURE_SHARE * stature_mm;
    let knee_mm = KNEE_CROTCH_SHARE * crotch_height_mm;
    [
        at(Level::B).map_or(ankle_mm, |height_mm| height_mm - SURFACE_MARGIN_MM),
        at(Level::D).map_or(knee_mm, |height_mm| height_mm + SURFACE_MARGIN_MM),
    ]
}

/// The findings of one leg, collected as its stages pass.
struct Findings {
    side: Side,
    found: Vec<Finding>,
}

impl Findings {
    fn add(&mut self, level: Option<Level>, what: What) {
        self.found.push(Finding { side: Some(self.side), level, what });
    }

    /// Levels that are absent and doubts about those that are not.
    fn about_levels(&mut self, landmarks: &[Landmark]) {
        for level in Level::ALL {
            match landmarks.iter().find(|landmark| landmark.level == level) {
                None => self.add(Some(level), What::LevelAbsent),
                Some(landmark) if !landmark.is_plausible() => {
                    let girth_mm = landmark.girth_tape_mm;
                    self.add(Some(level), What::LevelImplausible { girth_mm });
                }
                Some(landmark) => {
                    landmark.doubts.iter().for_each(|d| self.add(Some(level), What::Doubtful(*d)));
                }
            }
        }
    }

    /// A surface that lacks a part of the wanted heights.
    fn about_extent(&mut self, surface: &LegSurface, wanted_mm: [f64; 2]) {
        let [from_mm, to_mm] = surface.height_mm;
        let [wanted_from_mm, wanted_to_mm] = wanted_mm;
        if from_mm > wanted_from_mm || to_mm < wanted_to_mm {
            self.add(None, What::SurfaceShort { from_mm, to_mm, wanted_from_mm, wanted_to_mm });
        }
    }
}
