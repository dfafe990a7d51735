//! A point of a form, from a record: the scan's measure, and the one that counts.

use gaiter_leg::{Level, Side};
use gaiter_sizes::Point;
use gaiter_sizes::verdict::{NotGiven, Reading};

use super::{State, Way};
use crate::Record;
use crate::measure::amendment::{Amendment, ByHand, Subject};
use crate::measure::{Absent, Length, Measure};
use crate::report::Reliability;
use crate::sizing::{TAPE_GIRTH_MM, reading};

/// The finding that puts the length of the inside of the leg in doubt.
const CROTCH_UNCERTAIN: &str = "crotch-uncertain";

/// A point of a form.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Read {
    /// The scan's measure.
    pub scanned: Value,
    pub counting: Value,
}

/// A figure as the record gives it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Value {
    pub is: State,
    pub mm: Option<f64>,
    pub sd_mm: Option<f64>,
    pub method: Option<Way>,
    pub doubts: Vec<String>,
}

impl Read {
    /// Whether a person set another value than the scan's.
    pub fn is_edited(&self) -> bool {
        self.counting != self.scanned
    }

    fn both(value: Value) -> Read {
        Read { scanned: value.clone(), counting: value }
    }
}

impl Value {
    fn none(is: State) -> Value {
        Value { is, mm: None, sd_mm: None, method: None, doubts: Vec::new() }
    }
}

/// A point of a leg; `leg` is `None` for a point of neither.
pub(super) fn read(
    record: &Record,
    leg: Option<Side>,
    point: Point,
    scanner_girth_mm: f64,
) -> Read {
    let Some(side) = leg else { return Read::both(Value::none(State::NotByScan)) };
    match point {
        Point::Girth(level) => of_level(record, side, level, |of| {
            let scanner_mm = if of.girth.is_by_hand { 0.0 } else { scanner_girth_mm };
            Some(girth(of, scanner_mm))
        }),
        Point::Length(level) => of_level(record, side, level, |of| {
            of.height.map(|height| value(of, height, Way::ByHand, height.sd_mm))
        }),
        Point::Between(..) => between(record, side, point),
        Point::Foot => of_length(record, side, Subject::FootLength),
        Point::InsideLeg => of_length(record, side, Subject::InsideLeg),
        Point::Beyond(_) => Read::both(Value::none(State::NotByScan)),
    }
}

/// What a person set at a point last; `None` if nothing.
pub(super) fn edited(record: &Record, side: Side, point: Point) -> Option<&Amendment> {
    let last = |subject| record.by_hand(side, subject).map(|hand: ByHand<'_>| hand.last);
    match point {
        Point::Foot => last(Subject::FootLength),
        Point::InsideLeg => last(Subject::InsideLeg),
        Point::Beyond(_) => None,
        point => {
            point.levels().filter_map(|level| last(Subject::Level(level))).max_by_key(|of| of.at)
        }
    }
}

fn of_level(
    record: &Record,
    side: Side,
    level: Level,
    part: impl Fn(&Measure<'_>) -> Option<Value>,
) -> Read {
    let scanned = record.leg(side).and_then(|leg| Measure::scanned(leg, level));
    let none = || Value::none(State::NotMeasured);
    let counting = match Measure::find(record, side, level) {
        Ok(measure) => part(&measure).unwrap_or_else(none),
        Err(absent) => absent_value(absent),
    };
    Read { scanned: scanned.as_ref().and_then(part).unwrap_or_else(none), counting }
}

fn girth(of: &Measure<'_>, scanner_mm: f64) -> Value {
    let sd_mm = match of.girth.is_by_hand {
        true => Some(TAPE_GIRTH_MM),
        false => of.girth.sd_mm.map(|sd_mm| sd_mm.hypot(scanner_mm)),
    };
    value(of, of.girth, Way::Tape, sd_mm)
}

fn value(of: &Measure<'_>, length: Length, by_hand: Way, sd_mm: Option<f64>) -> Value {
    let is = match of.mark_of(length) {
        Reliability::ByHand => State::ByHand,
        Reliability::Estimated => State::Estimated,
        Reliability::Doubtful if of.has_a_doubt_that_matters() => State::Doubtful,
        _ => State::Measured,
    };
    let doubts = match length.is_by_hand {
        true => Vec::new(),
        false => of.doubts.iter().map(|doubt| (*doubt).to_owned()).collect(),
    };
    let method = if length.is_by_hand { by_hand } else { Way::Scan };
    Value { is, mm: Some(length.mm), sd_mm, method: Some(method), doubts }
}

/// A length of the foot or of the inside of the leg.
fn of_length(record: &Record, side: Side, subject: Subject) -> Read {
    let is_in_doubt = subject == Subject::InsideLeg && record.has_finding(CROTCH_UNCERTAIN);
    let value = |length: Length| {
        let (is, method) = match (length.is_by_hand, is_in_doubt) {
            (true, _) => (State::ByHand, Way::ByHand),
            (false, true) => (State::Doubtful, Way::Scan),
            (false, false) => (State::Measured, Way::Scan),
        };
        let doubts = (is == State::Doubtful).then(|| CROTCH_UNCERTAIN.to_owned());
        Value {
            is,
            mm: Some(length.mm),
            sd_mm: length.sd_mm,
            method: Some(method),
            doubts: doubts.into_iter().collect(),
        }
    };
    let scanned = Length::scanned_of(record, side, subject).map(value);
    let counting = Length::find(record, side, subject).map_or_else(absent_value, value);
    Read { scanned: scanned.unwrap_or_else(|| Value::none(State::NotMeasured)), counting }
}

/// A length between two levels. One that is not sure has no figure.
fn between(record: &Record, side: Side, point: Point) -> Read {
    let value = |record: &Record| match reading(record, side, point, 0.0) {
        Reading::NotGiven { why } => Value::none(match why {
            NotGiven::NotFound => State::NotMeasured,
            NotGiven::NotMeasurable => State::NotMeasurable,
            NotGiven::Estimated => State::Estimated,
            NotGiven::Doubtful => State::Doubtful,
            NotGiven::Beyond => State::NotByScan,
        }),
        Reading::Given(given) => Value {
            is: if given.is_by_hand { State::ByHand } else { State::Measured },
            mm: Some(given.mm),
            sd_mm: given.uncertainty_mm,
            method: Some(if given.is_by_hand { Way::ByHand } else { Way::Scan }),
            doubts: Vec::new(),
        },
    };
    let is_set = edited(record, side, point).is_some();
    let scanned = is_set.then(|| value(&Record { amendments: Vec::new(), ..record.clone() }));
    let counting = value(record);
    Read { scanned: scanned.unwrap_or_else(|| counting.clone()), counting }
}

fn absent_value(absent: Absent) -> Value {
    Value::none(match absent {
        Absent::NotFound => State::NotMeasured,
        Absent::NotMeasurable => State::NotMeasurable,
    })
}
