//! Records of a patient that are no visits though they were delivered, and whose places other visits take.

use std::cmp::Ordering;

use gaiter_record::{Acquired, AcquiredFrom};
use jiff::Timestamp;
use serde::Serialize;

/// A record that is left out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// When its scan was first seen, from its folder's name.
    pub seen: Timestamp,
    /// The beginning of its scan's id.
    pub scan: String,
    /// Why, by code; see docs/visits.md.
    pub code: &'static str,
    /// It is the record of another patient, so none of this one is missing.
    #[serde(skip)]
    pub is_of_another: bool,
}

/// Which visits of a comparison stand in the place of a record that is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StandIns {
    /// The earlier visit does.
    pub earlier: bool,
    /// The later one does: a newer record is left out.
    pub later: bool,
}

impl LeftOut {
    /// Whether its visit would come before or after one that was taken then; equal if that one would count
    /// instead, because it is from the same day and later.
    fn against(&self, visit: &Acquired) -> Ordering {
        match self.seen > visit.at {
            true => Ordering::Greater,
            false if self.is_of_day(visit) => Ordering::Equal,
            false => Ordering::Less,
        }
    }

    /// Its time on the clock of a visit's scanner.
    pub(super) fn at(&self, visit: &Acquired) -> Acquired {
        Acquired {
            at: self.seen,
            from: AcquiredFrom::Unknown,
            utc_offset_min: visit.utc_offset_min,
        }
    }

    /// Whether its visit would be of the same day as one that was taken then.
    fn is_of_day(&self, visit: &Acquired) -> bool {
        self.at(visit).local().date() == visit.local().date()
    }
}

impl StandIns {
    /// Which of two visits of a group, taken at these times, stand in the place of a record that is left out: with
    /// it, the first of the group, the one before the last, or the last would be another. `is_first`: whether the
    /// earlier visit is the first of its group, `is_next`: whether the later one follows it. A visit without a
    /// time may stand in.
    pub(super) fn find(
        left_out: &[LeftOut],
        [before, after]: [Option<&Acquired>; 2],
        [is_first, is_next]: [bool; 2],
    ) -> StandIns {
        let theirs: Vec<&LeftOut> = left_out.iter().filter(|of| !of.is_of_another).collect();
        let (Some(before), Some(after)) = (before, after) else {
            let is_any = !theirs.is_empty();
            return StandIns { earlier: is_any, later: is_any };
        };
        let takes_first = |of: &&LeftOut| match of.against(before) {
            Ordering::Less => true,
            Ordering::Equal => false,
            Ordering::Greater => of.is_of_day(before),
        };
        let lies_between = |of: &&LeftOut| {
            of.against(before) == Ordering::Greater && of.against(after) == Ordering::Less
        };
        StandIns {
            earlier: is_first && theirs.iter().any(takes_first)
                || is_next && theirs.iter().any(lies_between),
            later: theirs.iter().any(|of| of.against(after) == Ordering::Greater),
        }
    }
}
