//! What makes girths wrong over a part of a leg, or all of it, by more than the skin's points show.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use crate::comparison::seams::Seams;
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
    pub fn of_seams(Seams { step_mm, girth_sd_mm }: Seams) -> Disturbance {
        let doubt = Doubt::ViewsApart { step_mm, girth_sd_mm };
        Disturbance {
            along_mm: f64::NEG_INFINITY..=f64::INFINITY,
            sd_mm: girth_sd_mm,
            doubt: Some(doubt).filter(|_| girth_sd_mm > DOUBT_SD_MM),
        }
    }

    /// Disturbs a girth, if it lies there.
    pub fn on(&self, girth: &mut impl Disturbed) {
        if !self.along_mm.contains(&girth.along_mm()) {
            return;
        }
        girth.widen(self.sd_mm);
        let doubts = girth.doubts();
        let is_new = |doubt: &Doubt| doubts.iter().all(|other| other.code() != doubt.code());
        if let Some(doubt) = self.doubt.filter(is_new) {
            girth.doubts().push(doubt);
        }
    }
}

/// A girth that something may disturb.
pub trait Disturbed {
    /// Where it lies along the axis, mm.
    fn along_mm(&self) -> f64;
    /// Adds to its standard error, mm.
    fn widen(&mut self, sd_mm: f64);
    /// Its doubts.
    fn doubts(&mut self) -> &mut Vec<Doubt>;
}

impl Disturbed for Landmark {
    fn along_mm(&self) -> f64 {
        self.along_mm
    }

    fn widen(&mut self, sd_mm: f64) {
        self.girth_sd_mm = self.girth_sd_mm.hypot(sd_mm);
        self.girth_of_level_sd_mm = self.girth_of_level_sd_mm.hypot(sd_mm);
    }

    fn doubts(&mut self) -> &mut Vec<Doubt> {
        &mut self.doubts
    }
}

impl Disturbed for Estimate {
    fn along_mm(&self) -> f64 {
        self.along_mm
    }

    fn widen(&mut self, sd_mm: f64) {
        self.girth_sd_mm = self.girth_sd_mm.hypot(sd_mm);
        self.girth_of_level_sd_mm = self.girth_of_level_sd_mm.hypot(sd_mm);
    }

    fn doubts(&mut self) -> &mut Vec<Doubt> {
        &mut self.doubts
    }
}

impl Disturbed for HeightGirth {
    fn along_mm(&self) -> f64 {
        self.along_mm
    }

    fn widen(&mut self, sd_mm: f64) {
        self.girth_sd_mm = self.girth_sd_mm.hypot(sd_mm);
    }

    fn doubts(&mut self) -> &mut Vec<Doubt> {
        &mut self.doubts
    }
}
