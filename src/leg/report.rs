//! The report of one leg: every stage of the paper in order, from the leg's skin to its surface.

use super::at_height::{AtHeight, at_heights};
use super::axis::{LegAxis, axis};
use super::crotch::Crotch;
use super::feature::{Feature, features};
use super::finding::{Finding, LegFault, What};
use super::girth::{GirthCurve, girth_curve};
use super::landmark::{Landmark, landmarks};
use super::level::Level;
use super::section::Section;
use super::sections::sections;
use super::segment::Leg;
use super::side::Side;
use super::surface::{LegSurface, surface};
use super::volume::{LegVolume, leg_volume};
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
    crotch: &Crotch,
    method: &Method,
) -> Result<(LegReport, Vec<Finding>), LegFault> {
    let (scale_mm, crotch_height_mm) = (body.scale_mm, crotch.height_mm);
    let axis = axis(leg, scale_mm, crotch_height_mm)?;
    let up_mm = |height_mm: f64| height_mm / axis.direction.z;
    let end_mm = leg.cut_mm.unwrap_or(crotch_height_mm);
    let span_mm = [up_mm(LOWEST_STATURE_SHARE * scale_mm), up_mm(end_mm)];
    let sections = sections(leg, axis, span_mm, method.fit).ok_or(LegFault::TooFewPoints)?;
    let curve = girth_curve(&sections, scale_mm).ok_or_else(|| {
        let measured = sections.rows.iter().filter(|row| row.section.is_some()).count();
        LegFault::TooFewSections { measured, planes: sections.rows.len() }
    })?;
    let near = |along_mm: f64| sections.nearest(along_mm);
    let mut found = landmarks(&curve, scale_mm, crotch_height_mm, near);
    for landmark in &mut found {
        landmark.height_sd_mm = landmark.height_sd_mm.hypot(body.floor_sd_mm);
    }
    let mut findings = Findings { side: leg.side, found: Vec::new() };
    if let (Some(end_mm), Some(_)) = (leg.cut_mm, body.stature_mm) {
        findings.add(None, What::LegCut { end_mm });
    }
    findings.about_levels(&found);
    let landmarks: Vec<Landmark> = found.into_iter().filter(Landmark::is_plausible).collect();
    let wanted_mm = surface_heights_mm(&landmarks, scale_mm, crotch_height_mm);
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
    let volume = leg_volume(&sections, &curve, &landmarks);
    let at = at_heights(&curve, &method.at_heights_mm, near);
    findings.about_heights(&at);
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
        volume,
        at,
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

    /// Heights that were asked for and have no girth.
    fn about_heights(&mut self, at: &[AtHeight]) {
        for AtHeight { height_mm, found } in at {
            if let Err(why) = *found {
                self.add(None, What::HeightNotMeasured { height_mm: *height_mm, why });
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
