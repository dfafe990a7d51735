//! Reasons for caution in comparing two visits whose figures mean the same.

use gaiter_leg::Side;
use gaiter_record::Acquired;

use super::course::{Course, Group};
use super::stance::StanceChange;
use super::visit::Visit;

/// Legs swell during the day; times of day that differ by more than this are reported, hours.
const TIME_OF_DAY_H: f64 = 3.0;

/// A phantom's mean error that differs by more than this between two checks is reported, mm: beyond the
/// scatter of the checks themselves.
const DRIFT_MM: f64 = 0.5;

/// A reason for caution in a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Caution {
    /// The times of day differ.
    TimeOfDay {
        /// By how much, hours; at most 12.
        hours: f64,
    },
    /// A time of day is not known.
    TimeUnknown,
    /// The posture that was declared is another: neither girths nor volumes are compared.
    Posture,
    /// The leg was held differently, as the scans show.
    Stance {
        /// Which leg.
        side: Side,
        /// By how much.
        change: StanceChange,
    },
    /// The scans are of different stations.
    Station,
    /// The phantom was not measured before one of the visits.
    NoPhantom,
    /// The phantom's mean error has changed.
    Drift {
        /// Later minus earlier, mm.
        by_mm: f64,
    },
    /// A measure was set by hand at one of the visits.
    ByHand {
        /// On which leg.
        side: Side,
    },
}

impl Caution {
    /// The stable code used in the JSON form and in docs/codes.md.
    pub fn code(&self) -> &'static str {
        match self {
            Caution::TimeOfDay { .. } => "time-of-day-differs",
            Caution::TimeUnknown => "time-of-day-unknown",
            Caution::Posture => "posture-differs",
            Caution::Stance { .. } => "stance-differs",
            Caution::Station => "station-differs",
            Caution::NoPhantom => "phantom-not-checked",
            Caution::Drift { .. } => "phantom-drift",
            Caution::ByHand { .. } => "measures-by-hand",
        }
    }
}

/// Reasons for caution in comparing an earlier visit with a later one.
pub(super) fn cautions([earlier, later]: [&Visit; 2]) -> Vec<Caution> {
    let mut found: Vec<Caution> = time_of_day([earlier, later]).into_iter().collect();
    found.extend(earlier.is_of_other_posture(later).then_some(Caution::Posture));
    found.extend(Side::FROM_FRONT.into_iter().filter_map(|side| stance([earlier, later], side)));
    if earlier.station != later.station {
        found.push(Caution::Station);
    }
    match (earlier.phantom_mm, later.phantom_mm) {
        (Some(one), Some(other)) => {
            let by_mm = other - one;
            found.extend((by_mm.abs() > DRIFT_MM).then_some(Caution::Drift { by_mm }));
        }
        _ => found.push(Caution::NoPhantom),
    }
    let by_hand = |side: &Side| earlier.has_by_hand(*side) || later.has_by_hand(*side);
    let sides = Side::FROM_FRONT.into_iter().filter(by_hand);
    found.extend(sides.map(|side| Caution::ByHand { side }));
    found
}

/// The caution that two visits differ in their times of day.
fn time_of_day(visits: [&Visit; 2]) -> Option<Caution> {
    let [one, other] = visits.map(|visit| visit.acquired.as_ref().and_then(time_of_day_h));
    let (Some(one), Some(other)) = (one, other) else { return Some(Caution::TimeUnknown) };
    let apart = (one - other).abs();
    let hours = apart.min(24.0 - apart);
    (hours > TIME_OF_DAY_H).then_some(Caution::TimeOfDay { hours })
}

impl Course {
    /// That a visit of a group was at another time of day than its last one, with which visits are compared; `None` also
    /// if one of the times is not known.
    pub fn other_time_of_day(&self, group: &Group, visit: usize) -> Option<Caution> {
        let last = &self.visits[*group.visits.last()?];
        let found = time_of_day([&self.visits[visit], last])?;
        matches!(found, Caution::TimeOfDay { .. }).then_some(found)
    }
}

fn stance(visits: [&Visit; 2], side: Side) -> Option<Caution> {
    let change = stance_change(visits, side).filter(StanceChange::matters)?;
    Some(Caution::Stance { side, change })
}

/// How differently a leg stood; `None` if one of the records does not state it.
pub(super) fn stance_change(visits: [&Visit; 2], side: Side) -> Option<StanceChange> {
    let [before, after] = visits.map(|visit| visit.legs.get(side).as_ref()?.stance);
    Some(before?.to(&after?))
}

/// The local time of day, hours; `None` if the scanner's time zone is not known: UTC would be off by hours.
fn time_of_day_h(acquired: &Acquired) -> Option<f64> {
    acquired.utc_offset_min?;
    let time = acquired.local().time();
    Some(f64::from(time.hour()) + f64::from(time.minute()) / 60.0)
}
