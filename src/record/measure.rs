//! What a leg has of a level, as every table shows it: sheet, terminal, CSV and practice software.

pub(super) mod csv;

use super::report::Mark;
use super::schema::{EstimateFigures, LandmarkFigures, LegFigures};
use crate::leg::Level;

/// The doubt of a knee that lies below D by its proportion: it is no knee, so it has no figures.
const BELOW_D: &str = "below-d";

/// The girth and the height of a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure<'a> {
    /// The girth by tape.
    pub girth: Length,
    /// The vertical height above the floor; `None` on the foot, where the tape is not level.
    pub height: Option<Length>,
    /// Whether it is estimated by a proportion of the body.
    pub is_estimate: bool,
    /// Codes of the reasons not to trust it without a check.
    pub doubts: &'a [String],
    /// How it was found, in English.
    pub by: &'a str,
}

/// A length with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Length {
    /// The length, mm.
    pub mm: f64,
    /// Its standard error, mm; `None` if it is unknown.
    pub sd_mm: Option<f64>,
}

impl Measure<'_> {
    /// The measure of a level; `None` if it was not found.
    pub fn of(leg: &LegFigures, level: Level) -> Option<Measure<'_>> {
        let estimate = leg.estimates.get(level.name());
        match (leg.landmarks.get(level.name()), estimate) {
            (Some(found), _) => Some(Measure::found(level, found)),
            (None, Some(of)) if !of.doubts.iter().any(|doubt| doubt == BELOW_D) => {
                Some(Measure::estimated(level, of))
            }
            (None, _) => None,
        }
    }

    /// How to read its figures.
    pub fn mark(&self) -> Mark {
        match (self.is_estimate, self.doubts.is_empty()) {
            (true, _) => Mark::Estimated,
            (false, false) => Mark::Doubtful,
            (false, true) => Mark::Sure,
        }
    }

    fn found(level: Level, of: &LandmarkFigures) -> Measure<'_> {
        Measure {
            girth: Length { mm: of.girth_tape_mm, sd_mm: of.girth_sd_mm },
            height: height(level, of.height_mm, of.height_sd_mm),
            is_estimate: false,
            doubts: &of.doubts,
            by: &of.by,
        }
    }

    fn estimated(level: Level, of: &EstimateFigures) -> Measure<'_> {
        Measure {
            girth: Length { mm: of.girth_tape_mm, sd_mm: of.girth_sd_mm },
            height: height(level, of.height_mm, of.height_sd_mm),
            is_estimate: true,
            doubts: &of.doubts,
            by: &of.by,
        }
    }
}

fn height(level: Level, mm: f64, sd_mm: Option<f64>) -> Option<Length> {
    (level >= Level::B).then_some(Length { mm, sd_mm })
}
