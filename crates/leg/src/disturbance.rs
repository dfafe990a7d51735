//! What makes girths wrong over a part of a leg, or all of it, by more than the skin's points show.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use crate::comparison::seams::Seams;
use crate::comparison::smoothed::Smoothed;
use crate::doubt::Doubt;
use crate::levels::at_height::HeightGirth;
use crate::levels::landmark::{Estimate, Landmark};
use crate::sections::cloth::Cover;

/// Cloth changes sections up to this far beyond its edge, mm: two of the curve's pieces.
const CLOTH_REACH_MM: f64 = 25.0;

/// A girth that is disturbed by a larger standard error than this is in doubt, mm: it then may be off by half a
/// centimetre.
const DOUBT_SD_MM: f64 = 2.0;

/// What disturbs girths.
#[derive(Debug, Clone)]
pub struct Disturbance {
    /// Where, along the axis, mm.
    pub along_mm: RangeInclusive<f64>,
    /// What it adds to the standard error of a girth, mm.
    pub sd_mm: f64,
    /// The doubt that all girths there have.
    pub doubt: Option<Doubt>,
}

/// What disturbs both legs alike.
#[derive(Debug, Clone, Copy, Default)]
pub struct Common {
    /// Cameras whose views do not meet.
    pub seams: Option<Seams>,
    /// Smoothing by the scanner's software.
    pub smoothed: Option<Smoothed>,
}

impl Common {
    /// What has a cause that can be told, each as a disturbance of all girths.
    pub fn told(&self) -> Vec<Disturbance> {
        let seams = self.seams.map(Disturbance::of_seams);
        seams.into_iter().chain(self.smoothed.map(Disturbance::of_smoothing)).collect()
    }

    /// The doubts that concern the whole scan.
    pub fn doubts(&self) -> Vec<Doubt> {
        let seams = self
            .seams
            .map(|Seams { step_mm, girth_sd_mm }| Doubt::ViewsApart { step_mm, girth_sd_mm });
        seams.into_iter().chain(self.smoothed.and_then(doubt_of_smoothing)).collect()
    }
}

/// Smoothing that costs girths more than what they usually are off by.
fn doubt_of_smoothing(Smoothed { girth_sd_mm }: Smoothed) -> Option<Doubt> {
    (girth_sd_mm > DOUBT_SD_MM).then_some(Doubt::Smoothed { girth_sd_mm })
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
            doubt: cover.is_sure.then_some(doubt),
        }
    }

    /// Of cameras whose views do not meet.
    fn of_seams(Seams { step_mm, girth_sd_mm }: Seams) -> Disturbance {
        let doubt = Doubt::ViewsApart { step_mm, girth_sd_mm };
        Disturbance::everywhere(girth_sd_mm, Some(doubt).filter(|_| girth_sd_mm > DOUBT_SD_MM))
    }

    /// Of a mesh that was smoothed.
    fn of_smoothing(smoothed: Smoothed) -> Disturbance {
        Disturbance::everywhere(smoothed.girth_sd_mm, doubt_of_smoothing(smoothed))
    }

    /// All along a leg.
    fn everywhere(sd_mm: f64, doubt: Option<Doubt>) -> Disturbance {
        Disturbance { along_mm: f64::NEG_INFINITY..=f64::INFINITY, sd_mm, doubt }
    }

    /// Disturbs a girth at a distance along the axis, mm, if it reaches so far: its standard errors, mm, and its doubts.
    fn disturb<const N: usize>(
        &self,
        along_mm: f64,
        sds_mm: [&mut f64; N],
        doubts: &mut Vec<Doubt>,
    ) {
        if !self.along_mm.contains(&along_mm) {
            return;
        }
        sds_mm.into_iter().for_each(|sd_mm| *sd_mm = sd_mm.hypot(self.sd_mm));
        let is_new = |doubt: &Doubt| doubts.iter().all(|other| other.code() != doubt.code());
        doubts.extend(self.doubt.filter(is_new));
    }

    /// Disturbs a level.
    pub fn on_landmark(&self, of: &mut Landmark) {
        let sds_mm = [&mut of.girth_sd_mm, &mut of.girth_of_level_sd_mm];
        self.disturb(of.along_mm, sds_mm, &mut of.doubts);
    }

    /// Disturbs an estimate.
    pub fn on_estimate(&self, of: &mut Estimate) {
        let sds_mm = [&mut of.girth_sd_mm, &mut of.girth_of_level_sd_mm];
        self.disturb(of.along_mm, sds_mm, &mut of.doubts);
    }

    /// Disturbs the girth at a height.
    pub fn on_height(&self, of: &mut HeightGirth) {
        self.disturb(of.along_mm, [&mut of.girth_sd_mm], &mut of.doubts);
    }
}
