//! The figures of a record that go to systems of others, as on the measuring sheet: the right leg first, from G
//! down to A, girths by tape and vertical heights above the floor.
//!
//! A figure that is estimated by the body's proportions is not among them: a number whose mark is lost would be
//! taken for a measured one. It is in the report that goes along.

use super::Record;
use super::measure::{Length, Measure};
use super::report::Mark;
use super::rounding;
use crate::leg::{Level, Side};

/// A girth or a height.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportFigure {
    /// The leg.
    pub side: Side,
    /// The level.
    pub level: Level,
    /// Girth or height.
    pub what: What,
    /// The figure, cm, rounded as on the sheet.
    pub cm: f64,
    /// Its standard error, cm; `None` for one that a person set, or if it is unknown.
    pub sd_cm: Option<f64>,
    /// Whether a person set it.
    pub is_by_hand: bool,
    /// Codes of the doubts about it; empty for one that a person set.
    pub doubts: Vec<String>,
}

/// What a figure measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum What {
    /// The girth by tape.
    Girth,
    /// The height above the floor.
    Height,
}

impl ExportFigure {
    /// The code of its box on order forms: `cB`, `lB1`.
    pub fn code(&self) -> String {
        let letter = match self.what {
            What::Girth => 'c',
            What::Height => 'l',
        };
        format!("{letter}{}", self.level.name())
    }
}

/// All figures of a record that are not estimated.
pub fn export_figures(record: &Record) -> Vec<ExportFigure> {
    let mut figures = Vec::new();
    for side in Side::FROM_FRONT.into_iter().filter(|side| record.sides().any(|of| of == *side)) {
        for level in Level::ALL.into_iter().rev() {
            let Ok(measure) = Measure::of(record, side, level) else { continue };
            let lengths = [(What::Girth, Some(measure.girth)), (What::Height, measure.height)];
            let of = |(what, length): (What, Option<Length>)| {
                let length = length.filter(|of| measure.mark_of(*of) != Mark::Estimated)?;
                let doubts = match length.is_by_hand {
                    true => Vec::new(),
                    false => measure.doubts.iter().map(|doubt| (*doubt).to_owned()).collect(),
                };
                Some(ExportFigure {
                    side,
                    level,
                    what,
                    cm: rounding::cm(length.mm),
                    sd_cm: length.sd_mm.map(|sd_mm| rounding::mm(sd_mm / 10.0)),
                    is_by_hand: length.is_by_hand,
                    doubts,
                })
            };
            figures.extend(lengths.into_iter().filter_map(of));
        }
    }
    figures
}
