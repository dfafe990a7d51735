//! The figures of a record that go to systems of others, as on the measuring sheet: the right leg first, from G
//! down to A, girths by tape and vertical heights above the floor.
//!
//! A figure that is estimated by the body's proportions is not among them: a number whose mark is lost would be
//! taken for a measured one. It is in the report that is sent with them.

use gaiter_leg::{Level, Side};
use jiff::tz::TimeZone;
use jiff::{Timestamp, Zoned};

use super::measure::{Length, Measure};
use super::report::Reliability;
use super::rounding;
use super::schema::Record;

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

    fn of_level(record: &Record, side: Side, level: Level) -> Vec<ExportFigure> {
        let Ok(measure) = Measure::find(record, side, level) else { return Vec::new() };
        let is_exported = |length: &Length| measure.mark_of(*length) != Reliability::Estimated;
        let lengths = [(What::Girth, Some(measure.girth)), (What::Height, measure.height)];
        let exported = lengths.into_iter().filter_map(|(what, length)| {
            let Length { mm, sd_mm, is_by_hand } = length.filter(is_exported)?;
            let doubts: &[&str] = if is_by_hand { &[] } else { &measure.doubts };
            Some(ExportFigure {
                side,
                level,
                what,
                cm: rounding::cm(mm),
                sd_cm: sd_mm.map(rounding::sd_cm),
                is_by_hand,
                doubts: doubts.iter().map(|doubt| (*doubt).to_owned()).collect(),
            })
        });
        exported.collect()
    }
}

/// All figures of a record that are not estimated.
pub fn export_figures(record: &Record) -> Vec<ExportFigure> {
    let mut figures = Vec::new();
    for side in record.sides() {
        let levels = Level::ALL.into_iter().rev();
        figures.extend(levels.flat_map(|level| ExportFigure::of_level(record, side, level)));
    }
    figures
}

/// When a record's scan was taken, by the clock at the scanner; UTC if its zone is not known. `first_seen` stands
/// in where the record has no time.
pub fn taken(record: &Record, first_seen: Timestamp) -> Zoned {
    match &record.acquired {
        Some(acquired) => acquired.local(),
        None => first_seen.to_zoned(TimeZone::UTC),
    }
}
