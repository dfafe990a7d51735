//! The excess volume of the affected leg over the other one, and its percent reduction.
//!
//! Percent change of a leg and percent reduction of its excess are not interchangeable: the same nine
//! patients had 8 % of the one and 35 % of the other. So each is told by its full name.

use std::collections::BTreeSet;

use gaiter_leg::Side;
use gaiter_record::rounding::MARGIN_SDS;

use super::caution::stance_change;
use super::course::{Affected, Course, Group};
use super::place::Step;
use super::quantity::{Change, Quantity};

/// The excess of one leg at a visit, over the pieces that both legs have at all visits of the group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excess {
    /// The affected leg.
    pub affected: Side,
    /// Its volume minus that of the other leg, mL.
    pub ml: Quantity,
    /// The same, % of the other leg.
    pub percent: f64,
    /// The volume of the other leg, mL.
    pub other_ml: f64,
}

/// How the excess changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExcessChange {
    /// At the earlier visit.
    pub earlier: Excess,
    /// At the later one.
    pub later: Excess,
    /// The change, mL.
    pub change: Change,
    /// By how much of the earlier excess it is smaller; `None` if the earlier excess was within its own
    /// uncertainty.
    pub reduction: Option<Reduction>,
}

/// Percent reduction of the excess volume: 100 (E₀ − E₁) / E₀.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reduction {
    /// It, %; negative if the excess grew.
    pub percent: f64,
    /// Its expanded uncertainty, percentage points.
    pub expanded: f64,
}

impl Course {
    /// The affected leg: the one that was chosen, or the one that was larger at the group's first visit by more
    /// than the uncertainty; `None` if both are affected or neither is larger.
    pub fn affected(&self, group: &Group) -> Option<Side> {
        match self.choice.affected {
            Some(Affected::One(side)) => Some(side),
            Some(Affected::Both) => None,
            None => {
                let first = self.excess_of(group, *group.visits.first()?, Side::Left)?;
                let is_shown = first.ml.value.abs() > first.ml.expanded();
                let larger = if first.ml.value > 0.0 { Side::Left } else { Side::Right };
                is_shown.then_some(larger)
            }
        }
    }

    /// The excess of the affected leg at a visit.
    pub fn excess(&self, group: &Group, visit: usize) -> Option<Excess> {
        self.excess_of(group, visit, self.affected(group)?)
    }

    fn excess_of(&self, group: &Group, visit: usize, affected: Side) -> Option<Excess> {
        let pieces: BTreeSet<Step> = &group.pieces.left & &group.pieces.right;
        let visit = &self.visits[visit];
        let volume = |side: Side| {
            visit.legs.get(side).as_ref()?.volume(group.volume, &pieces, &visit.common)
        };
        let (own, other) = (volume(affected)?, volume(affected.other())?);
        let ml = own.minus_within_scan(&other);
        Some(Excess {
            affected,
            ml,
            percent: 100.0 * ml.value / other.value,
            other_ml: other.value,
        })
    }
}

/// How the excess changed between two visits.
pub(super) fn excess_change(
    course: &Course,
    group: &Group,
    earlier: usize,
    later: usize,
) -> Option<ExcessChange> {
    let (before, after) = (course.excess(group, earlier)?, course.excess(group, later)?);
    let visits = [&course.visits[earlier], &course.visits[later]];
    let stance = Side::BOTH.into_iter().map(|side| {
        let ml = course.volume(group, earlier, side).map_or(0.0, |volume| volume.value);
        stance_change(visits, side).unwrap_or_default().of_volume(ml)
    });
    Some(ExcessChange {
        earlier: before,
        later: after,
        change: Change::between(&before.ml, &after.ml).with_stance(stance.fold(0.0, f64::hypot)),
        reduction: reduction(&before.ml, &after.ml),
    })
}

fn reduction(before: &Quantity, after: &Quantity) -> Option<Reduction> {
    if before.value <= before.expanded() {
        return None;
    }
    let ratio = after.value / before.value;
    // The partial derivatives of E₁ / E₀ with respect to both.
    let sd =
        (after.parts.total() / before.value).hypot(ratio * before.parts.total() / before.value);
    let percent = 100.0 * (1.0 - ratio);
    Some(Reduction { percent, expanded: 100.0 * MARGIN_SDS * sd })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Parts;

    fn quantity(value: f64, random: f64) -> Quantity {
        Quantity { value, parts: Parts { random, ..Parts::default() } }
    }

    #[test]
    fn the_reduction_is_a_share_of_the_earlier_excess_with_the_uncertainty_of_both() {
        let found = reduction(&quantity(800.0, 30.0), &quantity(520.0, 40.0)).unwrap();
        assert!((found.percent - 35.0).abs() < 1e-9, "{found:?}");
        let expected = 200.0 * (0.05_f64.powi(2) + (0.65_f64 * 0.0375).powi(2)).sqrt();
        assert!((found.expanded - expected).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn no_share_is_taken_of_an_excess_within_its_uncertainty_or_of_a_smaller_leg() {
        for before in [quantity(60.0, 30.0), quantity(-800.0, 30.0)] {
            assert_eq!(reduction(&before, &quantity(20.0, 30.0)), None);
        }
    }
}
