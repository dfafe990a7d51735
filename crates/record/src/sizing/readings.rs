//! The points of an order form, from a record: what a person set counts, then what the scan shows without a
//! doubt.

use gaiter_leg::{Level, Side};
use gaiter_sizes::Point;
use gaiter_sizes::verdict::{Given, NotGiven, Reading};

use crate::Record;
use crate::measure::amendment::Subject;
use crate::measure::{Absent, Length, Measure, along_mm_at};
use crate::report::Reliability;

/// The standard error of a girth that a person took with a tape, mm. Leg volumes by tape, the square of the
/// girth, have a standard error of 1.2 to 1.4 %, so a girth has 0.65 %: 2.5 mm on a calf of 380 mm.
pub const TAPE_GIRTH_MM: f64 = 2.5;

/// A point of a leg. `scanner_girth_mm` is a standard error common to all girths of the scanner; it is added
/// in squares to that of each girth that the scan gives.
pub fn reading(record: &Record, side: Side, point: Point, scanner_girth_mm: f64) -> Reading {
    let found = match point {
        Point::Girth(level) => girth(record, side, level, scanner_girth_mm),
        Point::Length(level) => height(record, side, level).map(given),
        Point::Between(low, high) => between(record, side, [low, high]),
        Point::Foot => length(record, side, Subject::FootLength),
        Point::InsideLeg => length(record, side, Subject::InsideLeg),
        Point::Beyond(_) => Err(NotGiven::Beyond),
    };
    found.map_or_else(|why| Reading::NotGiven { why }, Reading::Given)
}

/// The girth at a level.
fn girth(record: &Record, side: Side, level: Level, scanner_mm: f64) -> Result<Given, NotGiven> {
    let measure = Measure::find(record, side, level).map_err(NotGiven::from)?;
    let girth = trusted(&measure, measure.girth)?;
    Ok(match girth.is_by_hand {
        true => Given { uncertainty_mm: Some(TAPE_GIRTH_MM), ..given(girth) },
        false => {
            // A size chart means the girth of the level, wherever that lies.
            let sd_mm = measure.girth_of_level_sd_mm;
            let uncertainty_mm = sd_mm.map(|sd_mm| sd_mm.hypot(scanner_mm));
            Given { uncertainty_mm, ..given(girth) }
        }
    })
}

/// The height of a level above the floor. No source states how well a person marks one, so the uncertainty of
/// a height by hand is unknown.
fn height(record: &Record, side: Side, level: Level) -> Result<Length, NotGiven> {
    let measure = Measure::find(record, side, level).map_err(NotGiven::from)?;
    trusted(&measure, measure.height.ok_or(NotGiven::NotFound)?)
}

/// The length along the leg between two levels. The errors of the two heights are taken as independent, which
/// is too much rather than too little: what is common to both cancels.
fn between(record: &Record, side: Side, levels: [Level; 2]) -> Result<Given, NotGiven> {
    let [low, high] = levels.map(|level| height(record, side, level));
    let heights = [low?, high?];
    let [low_mm, high_mm] = along_mm(record, side, levels, heights);
    let uncertainty_mm = match heights.map(|of| of.sd_mm) {
        [Some(low_mm), Some(high_mm)] => Some(low_mm.hypot(high_mm)),
        _ => None,
    };
    let is_by_hand = heights.iter().any(|of| of.is_by_hand);
    Ok(Given { mm: high_mm - low_mm, uncertainty_mm, is_by_hand })
}

/// Where levels at these heights lie along the leg, mm; where the record does not show that of both, the
/// heights themselves.
pub(super) fn along_mm(
    record: &Record,
    side: Side,
    levels: [Level; 2],
    heights: [Length; 2],
) -> [f64; 2] {
    let along = |level: Level, height: Length| {
        let leg = record.leg(side)?;
        let found = leg.landmarks.get(level.name()).filter(|_| !height.is_by_hand);
        found.map(|of| of.along_axis_mm).or_else(|| along_mm_at(leg, height.mm))
    };
    let [low, high] = [0, 1].map(|index| along(levels[index], heights[index]));
    match (low, high) {
        (Some(low_mm), Some(high_mm)) => [low_mm, high_mm],
        _ => heights.map(|of| of.mm),
    }
}

/// The length of the foot or of the inside of the leg.
fn length(record: &Record, side: Side, subject: Subject) -> Result<Given, NotGiven> {
    let length = Length::find(record, side, subject).map_err(NotGiven::from)?;
    let is_inside_leg = subject == Subject::InsideLeg;
    match is_inside_leg && !length.is_by_hand && record.has_finding("crotch-uncertain") {
        true => Err(NotGiven::Doubtful),
        false => Ok(given(length)),
    }
}

/// A girth or height of a measure that can be judged by; see [`Reliability`].
pub(super) fn trusted(measure: &Measure<'_>, length: Length) -> Result<Length, NotGiven> {
    match measure.mark_of(length) {
        Reliability::Estimated => Err(NotGiven::Estimated),
        Reliability::Doubtful if measure.has_a_doubt_that_matters() => Err(NotGiven::Doubtful),
        _ => Ok(length),
    }
}

fn given(length: Length) -> Given {
    Given { mm: length.mm, uncertainty_mm: length.sd_mm, is_by_hand: length.is_by_hand }
}

impl From<Absent> for NotGiven {
    fn from(absent: Absent) -> NotGiven {
        match absent {
            Absent::NotFound => NotGiven::NotFound,
            Absent::NotMeasurable => NotGiven::NotMeasurable,
        }
    }
}
