//! The calibre jump: where a leg's girth changes by more than its length, a circular knit may not do. A hint,
//! never a decision.
//!
//! It is sought between adjacent points of the form. The local slope would be above 1 on healthy legs: at B1
//! of an average man it is 1.25, while from B to C the girth changes by 0.77 per length.

use gaiter_leg::{Level, Side};
use gaiter_sizes::{Garment, Point};
use serde::Serialize;

use super::readings::{TAPE_GIRTH_MM, along_mm, trusted};
use crate::Record;
use crate::measure::{Length, Measure};

/// The change of girth per length above which flat knit is usually chosen: 1 cm per 1 cm.
const JUMP: f64 = 1.0;

/// The stretch of a leg between two adjacent points of the form.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stretch {
    /// The patient's `left` or `right`.
    pub side: &'static str,
    /// The lower level.
    pub from: &'static str,
    /// The upper level.
    pub to: &'static str,
    /// The girth of the upper level minus that of the lower one, mm.
    pub girth_change_mm: f64,
    /// The length along the leg between them, mm.
    pub length_mm: f64,
    /// The size of the change per length.
    pub per_length: f64,
    /// Its standard uncertainty; null if that of a girth or height is unknown.
    pub per_length_sd: Option<f64>,
    /// Whether the change is larger than the length.
    pub is_jump: bool,
}

/// The stretches of both legs between the levels of a garment, lowest first. A level without a trusted girth
/// and height is left out: the stretch then goes to the next one.
pub fn stretches(record: &Record, garment: &Garment) -> Vec<Stretch> {
    let has_both =
        |level: &Level| garment.has(Point::Girth(*level)) && garment.has(Point::Length(*level));
    let of_leg = |side: Side| {
        let levels = Level::ALL.into_iter().filter(has_both);
        let known: Vec<At> = levels.filter_map(|level| At::find(record, side, level)).collect();
        let pairs = known.windows(2).filter_map(|pair| stretch(record, side, [pair[0], pair[1]]));
        pairs.collect::<Vec<_>>()
    };
    record.sides().flat_map(of_leg).collect()
}

/// A level with girth and height.
#[derive(Debug, Clone, Copy)]
struct At {
    level: Level,
    girth: Length,
    height: Length,
}

impl At {
    fn find(record: &Record, side: Side, level: Level) -> Option<At> {
        let measure = Measure::find(record, side, level).ok()?;
        let girth = trusted(&measure, measure.girth).ok()?;
        let height = trusted(&measure, measure.height?).ok()?;
        Some(At { level, girth, height })
    }

    /// Standard error of the girth, mm.
    fn girth_sd_mm(&self) -> Option<f64> {
        if self.girth.is_by_hand { Some(TAPE_GIRTH_MM) } else { self.girth.sd_mm }
    }
}

fn stretch(record: &Record, side: Side, [low, high]: [At; 2]) -> Option<Stretch> {
    let heights = [low.height, high.height];
    let [from_mm, to_mm] = along_mm(record, side, [low.level, high.level], heights);
    let length_mm = to_mm - from_mm;
    if length_mm <= 0.0 {
        return None;
    }
    let girth_change_mm = high.girth.mm - low.girth.mm;
    let per_length = girth_change_mm.abs() / length_mm;
    // The girths' and the heights' errors as independent.
    let sd = || {
        let girth_mm = low.girth_sd_mm()?.hypot(high.girth_sd_mm()?);
        let height_mm = low.height.sd_mm?.hypot(high.height.sd_mm?);
        Some(girth_mm.hypot(per_length * height_mm) / length_mm)
    };
    Some(Stretch {
        side: side.word(),
        from: low.level.name(),
        to: high.level.name(),
        girth_change_mm,
        length_mm,
        per_length,
        per_length_sd: sd(),
        is_jump: per_length > JUMP,
    })
}
