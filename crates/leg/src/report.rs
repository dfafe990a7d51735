//! The report of one leg: every stage of the paper after its sections, from the girth curve to the surface.

use nalgebra::Point2;

use super::doubt::Doubt;
use super::finding::{Finding, What};
use super::level::{By, Level};
use super::measured::{LegReport, LevelSection};
use super::method::Tape;
use super::side::Side;
use super::{Body, Method};
use crate::comparison::volume::leg_volume;
use crate::disturbance::{Common, Disturbance};
use crate::features::feature::features;
use crate::levels::at_height::{AtHeight, at_heights, at_lengths, profile_heights_mm};
use crate::levels::foot::{Foot, foot};
use crate::levels::girth::GirthCurve;
use crate::levels::landmark::{Estimate, Landmark, is_plausible};
use crate::levels::level_reading::Ruler;
use crate::levels::search::{Levels, levels};
use crate::levels::thigh::{KNEE_STATURE_SHARE, g, knee_and_thigh};
use crate::levels::tilt;
use crate::parting::crotch::Crotch;
use crate::parting::filled::Patch;
use crate::parting::segment::Leg;
use crate::sectioned_leg::SectionedLeg;
use crate::sections::axis::LegAxis;
use crate::sections::axis_fit;
use crate::sections::axis_length::AxisLength;
use crate::sections::cloth::{Cloth, Cover};
use crate::sections::equidistant::Sections;
use crate::sections::section::Section;
use crate::surface::hole::Hole;
use crate::surface::nurbs::{LegSurface, Wanted, surface};
use crate::surface::shape::{Shape, on_planes};

/// The surface covers at least this much below B and above D, mm.
const SURFACE_MARGIN_MM: f64 = 20.0;

/// The surface begins here if B is absent, as a share of stature: above the malleoli.
const ANKLE_STATURE_SHARE: f64 = 0.06;

/// Above this bend of the knee, degrees, levels above C are in doubt: shank and thigh of straight legs stand at 2 to
/// 9°. Where knees were bent by 20 to 50°, D was 6 to 16 mm smaller than on the straight leg, B and C within 3 mm.
const BEND_DOUBT_DEG: f64 = 15.0;

/// Measures a leg whose sections are known; `common` is what disturbs both legs alike.
pub fn leg_report(
    of: SectionedLeg,
    body: &Body,
    crotch: &Crotch,
    common: &Common,
    method: &Method,
) -> (LegReport, Vec<Finding>) {
    let SectionedLeg { ref leg, ref filled, ref sections, ref curve, ref cloth, .. } = of;
    let scale_mm = body.scale_mm;
    let end_mm = leg.cut_mm.unwrap_or(crotch.height_mm);
    let mut measures = measures(leg, sections, curve, crotch, body, method);
    let bent = Some(Doubt::KneeBent { bend_deg: of.bend_deg() });
    let bent = bent.filter(|_| of.bend_deg() > BEND_DOUBT_DEG);
    measures.doubt_above_calf(bent);
    let across = measures.levels.found.iter_mut().filter(|landmark| landmark.level >= Level::B);
    let others = other_axes(leg, &sections.axis, body, end_mm, method.tape);
    tilt::complete(across, sections, curve, &others);
    let covers = covers(cloth, &sections.axis);
    covers.iter().for_each(|cover| measures.disturb(cover));
    let causes = common.known_causes();
    measures.doubt_uncertain_girths();
    causes.iter().for_each(|cause| measures.disturb(cause));
    for landmark in &mut measures.levels.found {
        landmark.height_sd_mm = landmark.height_sd_mm.hypot(body.floor_sd_mm);
    }
    let mut findings = Findings { side: leg.side, found: Vec::new() };
    for doubt in covers.iter().filter_map(|cover| cover.doubt).chain(bent) {
        findings.add(None, What::Doubtful(doubt));
    }
    findings.about_filled(filled);
    if let (Some(end_mm), true) = (leg.cut_mm, body.is_whole) {
        findings.add(None, What::LegCut { end_mm });
    }
    if let Some(why) = of.no_thigh {
        findings.add(None, What::ThighAxisMissing { why });
    }
    findings.about_levels(&measures.levels);
    let found = measures.levels.found.into_iter();
    let landmarks: Vec<Landmark> =
        found.filter(|landmark| is_plausible(landmark.girth_tape_mm)).collect();
    let wanted_mm = surface_heights_mm(&landmarks, scale_mm);
    let found = landmarks.iter().map(|landmark| (landmark.level, landmark.along_mm));
    let estimated = measures.estimates.iter().map(|estimate| (estimate.level, estimate.along_mm));
    let levels = found.chain(estimated).filter(|(level, _)| *level >= Level::B);
    let mut levels_mm: Vec<f64> = levels.map(|(_, along_mm)| along_mm).collect();
    levels_mm.sort_by(f64::total_cmp);
    let wanted = Wanted {
        height_mm: wanted_mm,
        levels_mm: &levels_mm,
        control_points: method.surface_control_points,
    };
    let surface = match surface(leg, sections, &wanted) {
        Ok(surface) => Some(surface),
        Err(none) => {
            findings.add(None, What::NoSurface(none));
            None
        }
    };
    if let Some(surface) = &surface {
        findings.about_extent(surface, wanted_mm);
        findings.about_holes(surface);
    }
    let volume = leg_volume(sections, curve, &landmarks);
    let mut at = at_heights(curve, &method.at_heights_mm, sections);
    let mut profile = at_heights(curve, &profile_heights_mm(curve), sections);
    let lengths = AxisLength::new(sections, scale_mm, method.tape);
    let mut along = at_lengths(curve, &lengths, sections);
    let at_heights = at.iter_mut().chain(&mut profile).map(|at| &mut at.found);
    for girth in at_heights.chain(along.iter_mut().map(|at| &mut at.found)).flatten() {
        let all = covers.iter().chain(&causes);
        all.for_each(|disturbance| disturbance.on_height(girth));
    }
    findings.about_heights(&at);
    let across = landmarks.iter().filter(|landmark| landmark.level >= Level::B);
    let along_mm: Vec<f64> = across.clone().map(|landmark| landmark.along_mm).collect();
    let at_levels = across.zip(sections.at(leg, &along_mm));
    let at_levels: Vec<(Level, Section)> =
        at_levels.filter_map(|(landmark, section)| Some((landmark.level, section?))).collect();
    let planes: Vec<&Section> = at_levels.iter().map(|(_, section)| section).collect();
    let scan = on_planes(&sections.axis, leg, &planes);
    let level_sections = at_levels.into_iter().zip(scan).map(|((level, section), scan)| {
        let features = features(&sections.axis.plane(section.along_mm), &section);
        LevelSection { level, section, scan, features }
    });
    let report = LegReport {
        side: leg.side,
        level_sections: level_sections.collect(),
        shape: Shape::new(leg, sections, surface.as_ref()),
        lengths,
        axis: of.sections.axis,
        landmarks,
        estimates: measures.estimates,
        foot: measures.foot,
        girth_curve: of.curve,
        surface,
        volume,
        at,
        profile,
        along,
    };
    (report, findings.found)
}

/// What covers a leg, as disturbances of its girths.
fn covers(cloth: &Cloth, axis: &LegAxis) -> Vec<Disturbance> {
    let disturbance = |cover: &Cover| {
        let height_mm = axis.at(cover.edge()?.along_mm, &Point2::origin()).z;
        Some(Disturbance::of_cloth(cover, height_mm))
    };
    cloth.covers.iter().filter_map(disturbance).collect()
}

/// The axes that a leg would have if the stature were smaller or larger by its standard error; none where
/// they do not depend on it.
fn other_axes(leg: &Leg, axis: &LegAxis, body: &Body, end_mm: f64, tape: Tape) -> Vec<LegAxis> {
    if tape != Tape::Shank {
        return Vec::new();
    }
    let shares = [1.0 - body.scale_sd_share, 1.0 + body.scale_sd_share];
    let other = |share: f64| axis_fit::for_stature(leg, axis, share * body.scale_mm, end_mm);
    shares.into_iter().filter_map(other).collect()
}

/// The measurements at the levels of a leg.
struct Measures {
    levels: Levels,
    estimates: Vec<Estimate>,
    foot: Option<Foot>,
}

/// A girth with a larger standard error than this is no figure to order by, mm: within two of them it may be
/// off by a centimetre, two steps of an order form.
const GIRTH_DOUBT_SD_MM: f64 = 5.0;

impl Measures {
    /// Adds a doubt to all levels whose girth is poorly determined.
    fn doubt_uncertain_girths(&mut self) {
        for landmark in &mut self.levels.found {
            let girth_sd_mm = match landmark.by {
                // Where it lies matters to nobody as long as the girth belongs to its height: on half of all legs the
                // place is uncertain by some centimetres, and people agree no better on it.
                By::Steepest => landmark.girth_sd_mm,
                _ => landmark.girth_of_level_sd_mm,
            };
            if girth_sd_mm > GIRTH_DOUBT_SD_MM {
                landmark.doubts.push(Doubt::GirthUncertain { girth_sd_mm });
            }
        }
    }

    /// Adds a doubt, if there is one, to all levels above the calf.
    fn doubt_above_calf(&mut self, doubt: Option<Doubt>) {
        let above = self.levels.found.iter_mut().filter(|landmark| landmark.level > Level::C);
        above.for_each(|landmark| landmark.doubts.extend(doubt));
    }

    /// Disturbs what lies within reach.
    fn disturb(&mut self, disturbance: &Disturbance) {
        self.levels.found.iter_mut().for_each(|landmark| disturbance.on_landmark(landmark));
        self.estimates.iter_mut().for_each(|estimate| disturbance.on_estimate(estimate));
    }
}

/// The levels of a leg from the foot to the groin, lowest first.
fn measures(
    leg: &Leg,
    sections: &Sections,
    curve: &GirthCurve,
    crotch: &Crotch,
    body: &Body,
    method: &Method,
) -> Measures {
    let scale_mm = body.scale_mm;
    let choices = method.levels;
    let mut levels = levels(curve, scale_mm, crotch.height_mm, choices.b1, sections);
    let ruler = Ruler { curve, sections };
    let g = g(&ruler, crotch, choices.g_below_crotch_mm);
    levels.found.extend(g.clone().filter(|_| crotch.is_seen()));
    for landmark in &mut levels.found {
        landmark.surface_length_mm = sections.surface_length_mm(landmark.along_mm);
    }
    let d = levels.found.iter().find(|landmark| landmark.level == Level::D);
    let stature_mm = [scale_mm, body.scale_sd_share * scale_mm];
    let mut estimates = knee_and_thigh(&ruler, crotch, choices.g_below_crotch_mm, d, stature_mm);
    estimates.extend(g.filter(|_| !crotch.is_seen()).map(Estimate::from));
    let foot = foot(leg, &sections.axis, scale_mm, method.fit);
    let (figures, a, y) = foot.map_or((None, None, None), |foot| (Some(foot.foot), foot.a, foot.y));
    levels.found.extend(y);
    estimates.extend(a);
    estimates.retain(|estimate| is_plausible(estimate.girth_tape_mm));
    levels.found.sort_by_key(|landmark| landmark.level);
    estimates.sort_by_key(|estimate| estimate.level);
    Measures { levels, estimates, foot: figures }
}

/// The heights that the surface must cover, mm.
fn surface_heights_mm(landmarks: &[Landmark], stature_mm: f64) -> [f64; 2] {
    let at = |level: Level| landmarks.iter().find(|l| l.level == level).map(|l| l.height_mm);
    let ankle_mm = ANKLE_STATURE_SHARE * stature_mm;
    let knee_mm = KNEE_STATURE_SHARE * stature_mm;
    [
        at(Level::B).map_or(ankle_mm, |height_mm| height_mm - SURFACE_MARGIN_MM),
        at(Level::D).map_or(knee_mm, |height_mm| height_mm + SURFACE_MARGIN_MM),
    ]
}

/// The findings of one leg, collected during its stages.
struct Findings {
    side: Side,
    found: Vec<Finding>,
}

impl Findings {
    fn add(&mut self, level: Option<Level>, what: What) {
        self.found.push(Finding { side: Some(self.side), level, what });
    }

    /// Findings for absent levels, and doubts about the others.
    fn about_levels(&mut self, levels: &Levels) {
        for level in Level::ALL {
            if let Some((_, absence)) = levels.absent.iter().find(|(absent, _)| *absent == level) {
                self.add(Some(level), What::LevelAbsent { why: *absence });
            }
            match levels.found.iter().find(|landmark| landmark.level == level) {
                Some(landmark) if !is_plausible(landmark.girth_tape_mm) => {
                    let girth_mm = landmark.girth_tape_mm;
                    self.add(Some(level), What::LevelImplausible { girth_mm });
                }
                Some(landmark) => {
                    landmark.doubts.iter().for_each(|d| self.add(Some(level), What::Doubtful(*d)));
                }
                None => {}
            }
        }
    }

    /// Findings for requested heights without a girth.
    fn about_heights(&mut self, at: &[AtHeight]) {
        for AtHeight { height_mm, found } in at {
            if let Err(why) = *found {
                self.add(None, What::HeightNotMeasured { height_mm: *height_mm, why });
            }
        }
    }

    /// A finding if the surface does not cover all of the wanted heights.
    fn about_extent(&mut self, surface: &LegSurface, wanted_mm: [f64; 2]) {
        let [from_mm, to_mm] = surface.height_mm;
        let [wanted_from_mm, wanted_to_mm] = wanted_mm;
        if from_mm > wanted_from_mm || to_mm < wanted_to_mm {
            self.add(None, What::SurfaceShort { from_mm, to_mm, wanted_from_mm, wanted_to_mm });
        }
    }

    /// A finding if the scanner's software closed holes.
    fn about_filled(&mut self, filled: &[Patch]) {
        let area = |patch: &&Patch| patch.area_mm2;
        let Some(largest) = filled.iter().max_by(|a, b| area(a).total_cmp(&area(b))) else {
            return;
        };
        let what = What::HolesFilled {
            count: filled.len(),
            length_mm: largest.height_mm[1] - largest.height_mm[0],
            width_mm: largest.width_mm,
            height_mm: largest.middle.z,
        };
        self.add(None, what);
    }

    /// A finding if the surface bridges holes.
    fn about_holes(&mut self, surface: &LegSurface) {
        let Some(largest) = surface.holes().first() else { return };
        let (height_mm, angle_deg) = surface.middle_of(largest);
        let Hole { length_mm, width_mm, .. } = *largest;
        let count = surface.holes().len();
        self.add(None, What::SurfaceHoles { count, length_mm, width_mm, height_mm, angle_deg });
    }
}
