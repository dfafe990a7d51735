//! What makes girths wrong over a part of a leg, or all of it, by more than the skin's points show.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use crate::comparison::seams::Seams;
use crate::doubt::Doubt;
use crate::levels::at_height::HeightGirth;
use crate::levels::landmark::{Estimate, Landmark};
use crate::parting::segment::Leg;
use crate::sections::cloth::Cover;
use crate::side::Sides;

/// Cloth changes sections up to this far beyond its edge, mm: two of the curve's pieces.
const CLOTH_REACH_MM: f64 = 25.0;

/// A girth that is disturbed by a larger standard error than this is in doubt, mm: it then may be off by half a
/// centimetre.
const DOUBT_SD_MM: f64 = 2.0;

/// Points that are further apart are coarse, mm: those of usual exports of 56 000 points are 6 mm apart, of 15 000
/// points 10 mm, of 8 000 points 13.5 mm.
const COARSE_SPACING_MM: f64 = 9.5;

/// What coarse points add to the standard error of a girth, as a share of their squared distance over the girth. A
/// chord of that length would take off four times as much, of which most is given back. On 36 bodies of 8 000 to
/// 17 000 points, thinned or averaged by cells, this share makes 96 % right within two standard errors.
const COARSE_SD_SHARE: f64 = 1.3;

/// The uncertainty of a figure is shown as this many standard errors: about 95 % of repeated scans lie
/// within it.
pub const MARGIN_SDS: f64 = 2.0;

/// What disturbs girths.
#[derive(Debug, Clone)]
pub struct Disturbance {
    /// Where, along the axis, mm.
    pub along_mm: RangeInclusive<f64>,
    /// What it adds to the standard error of a girth, mm.
    pub sd_mm: f64,
    /// What it adds besides, more to slim legs: this over the girth, mm².
    pub sd_times_girth_mm2: f64,
    /// The doubt that all girths there have.
    pub doubt: Option<Doubt>,
}

/// What disturbs both legs alike.
#[derive(Debug, Clone, Copy, Default)]
pub struct Common {
    /// Cameras whose views do not meet.
    pub seams: Option<Seams>,
    /// Standard error of girths by the scanner's software, which smoothed the meshes, mm.
    pub smoothing_sd_mm: Option<f64>,
    /// How far apart the points are, mm, if they are coarse.
    pub coarse_mm: Option<f64>,
}

impl Common {
    /// The causes that are known, each as a disturbance of all girths.
    pub fn known_causes(&self) -> Vec<Disturbance> {
        let seams = self.seams.map(|seams| {
            let doubt = (seams.girth_sd_mm > DOUBT_SD_MM).then(|| doubt_of_seams(seams));
            Disturbance::everywhere(seams.girth_sd_mm, doubt)
        });
        let smoothing = self
            .smoothing_sd_mm
            .map(|sd_mm| Disturbance::everywhere(sd_mm, doubt_of_smoothing(sd_mm)));
        let coarse = self.coarse_mm.map(Disturbance::of_coarse);
        seams.into_iter().chain(smoothing).chain(coarse).collect()
    }

    /// The doubts that concern the whole scan.
    pub fn doubts(&self) -> Vec<Doubt> {
        let seams = self.seams.map(doubt_of_seams);
        seams.into_iter().chain(self.smoothing_sd_mm.and_then(doubt_of_smoothing)).collect()
    }
}

fn doubt_of_seams(Seams { step_mm, girth_sd_mm }: Seams) -> Doubt {
    Doubt::ViewsApart { step_mm, girth_off_mm: MARGIN_SDS * girth_sd_mm }
}

/// Smoothing that costs girths more than what they usually are off by.
fn doubt_of_smoothing(girth_sd_mm: f64) -> Option<Doubt> {
    let girth_off_mm = MARGIN_SDS * girth_sd_mm;
    (girth_sd_mm > DOUBT_SD_MM).then_some(Doubt::Smoothed { girth_off_mm })
}

impl Disturbance {
    /// Of cloth whose edge lies at a height: a doubt if it is that for sure. Otherwise a girth with it or without it is
    /// as likely, which is π times its thickness to each side.
    pub fn of_cloth(cover: &Cover, height_mm: f64) -> Disturbance {
        let end =
            |edge: Option<f64>, beyond_mm: f64, open: f64| edge.map_or(open, |mm| mm + beyond_mm);
        let lower = end(cover.lower.map(|edge| edge.along_mm), -CLOTH_REACH_MM, f64::NEG_INFINITY);
        let upper = end(cover.upper.map(|edge| edge.along_mm), CLOTH_REACH_MM, f64::INFINITY);
        let step_mm = cover.thickness_mm();
        let doubt = Doubt::Cloth { step_mm, height_mm };
        Disturbance {
            along_mm: lower..=upper,
            sd_mm: if cover.is_sure { 0.0 } else { PI * step_mm },
            sd_times_girth_mm2: 0.0,
            doubt: cover.is_sure.then_some(doubt),
        }
    }

    /// All along a leg.
    fn everywhere(sd_mm: f64, doubt: Option<Doubt>) -> Disturbance {
        let along_mm = f64::NEG_INFINITY..=f64::INFINITY;
        Disturbance { along_mm, sd_mm, sd_times_girth_mm2: 0.0, doubt }
    }

    /// Of points that are so far apart, mm.
    pub fn of_coarse(spacing_mm: f64) -> Disturbance {
        let sd_times_girth_mm2 = COARSE_SD_SHARE * spacing_mm.powi(2);
        Disturbance { sd_times_girth_mm2, ..Disturbance::everywhere(0.0, None) }
    }

    /// What it adds to the standard error of a girth, mm.
    pub fn sd_of_mm(&self, girth_mm: f64) -> f64 {
        self.sd_mm.hypot(self.sd_times_girth_mm2 / girth_mm)
    }

    /// Disturbs a girth at a distance along the axis, mm, if it reaches so far: its standard errors, mm, and its doubts.
    fn disturb<const N: usize>(
        &self,
        along_mm: f64,
        girth_mm: f64,
        sds_mm: [&mut f64; N],
        doubts: &mut Vec<Doubt>,
    ) {
        if !self.along_mm.contains(&along_mm) {
            return;
        }
        let own_mm = self.sd_of_mm(girth_mm);
        sds_mm.into_iter().for_each(|sd_mm| *sd_mm = sd_mm.hypot(own_mm));
        let is_new = |doubt: &Doubt| doubts.iter().all(|other| other.code() != doubt.code());
        doubts.extend(self.doubt.filter(is_new));
    }

    /// Disturbs a level.
    pub fn on_landmark(&self, of: &mut Landmark) {
        let sds_mm = [&mut of.girth_sd_mm, &mut of.girth_of_level_sd_mm];
        self.disturb(of.along_mm, of.girth_tape_mm, sds_mm, &mut of.doubts);
    }

    /// Disturbs an estimate.
    pub fn on_estimate(&self, of: &mut Estimate) {
        let sds_mm = [&mut of.girth_sd_mm, &mut of.girth_of_level_sd_mm];
        self.disturb(of.along_mm, of.girth_tape_mm, sds_mm, &mut of.doubts);
    }

    /// Disturbs the girth at a height.
    pub fn on_height(&self, of: &mut HeightGirth) {
        self.disturb(of.along_mm, of.girth_tape_mm, [&mut of.girth_sd_mm], &mut of.doubts);
    }
}

/// How far apart the points of coarse legs are, mm: those of the coarser one. `None` if neither is.
pub fn coarse_spacing_mm(legs: &Sides<Option<Leg>>) -> Option<f64> {
    let legs = [&legs.left, &legs.right].into_iter().flatten();
    let coarser = legs.map(|leg| leg.mesh.spacing_mm()).reduce(f64::max);
    coarser.filter(|spacing_mm| *spacing_mm > COARSE_SPACING_MM)
}
