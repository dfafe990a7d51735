//! How much more volume one leg has than the other: the excess of the affected leg and its percent reduction
//! where a person named one, else the difference left minus right.
//!
//! Percent change of a leg and percent reduction of its excess are not interchangeable: the same nine
//! patients had 8 % of the one and 35 % of the other. So each has its full name.

use std::collections::BTreeSet;

use gaiter_leg::Side;
use gaiter_record::rounding::MARGIN_SDS;

use super::caution::stance_change;
use super::course::{Affected, Course, Group};
use super::place::Step;
use super::quantity::{Change, Quantity, Shown};

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
    /// By how much of the earlier excess it is smaller, or why that is not reported.
    pub reduction: Result<Reduction, NoReduction>,
}

/// Percent reduction of the excess volume: 100 (E₀ − E₁) / E₀.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reduction {
    /// It, %; negative if the excess grew.
    pub percent: f64,
    /// Its expanded uncertainty, percentage points.
    pub expanded: f64,
}

gaiter_leg::word_enum! {
    /// Why no percent reduction is reported.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum NoReduction {
        /// No change of the excess is shown, so no share of it is either.
        NoChange => "no-change-shown",
        /// The earlier excess is within its uncertainty.
        WithinUncertainty => "within-uncertainty",
        /// The affected leg was the smaller one at the earlier visit.
        SmallerLeg => "smaller-leg",
    }
}

impl Course {
    /// The volume of the left leg minus that of the right one at a visit, mL, over the pieces that both have
    /// at all visits of the group.
    pub fn left_minus_right(&self, group: &Group, visit: usize) -> Option<Quantity> {
        let of = |side: Side| self.volume_of_both(group, visit, side);
        Some(of(Side::Left)?.minus_within_scan(&of(Side::Right)?))
    }

    /// The excess of the affected leg at a visit; `None` unless a person named one leg.
    pub fn excess(&self, group: &Group, visit: usize) -> Option<Excess> {
        let Some(Affected::One(affected)) = self.choice.affected else { return None };
        let of = |side: Side| self.volume_of_both(group, visit, side);
        let (own, other) = (of(affected)?, of(affected.other())?);
        let ml = own.minus_within_scan(&other);
        let percent = 100.0 * ml.value / other.value;
        Some(Excess { affected, ml, percent, other_ml: other.value })
    }

    /// The volume of a leg over the pieces that both legs have.
    fn volume_of_both(&self, group: &Group, visit: usize, side: Side) -> Option<Quantity> {
        let pieces: BTreeSet<Step> = &group.pieces.left & &group.pieces.right;
        let visit = &self.visits[visit];
        visit.legs.get(side).as_ref()?.volume(group.volume, &pieces, &visit.common)
    }
}

/// How the difference left minus right changed between two visits.
pub(super) fn difference_change(
    course: &Course,
    group: &Group,
    visits: [usize; 2],
) -> Option<Change> {
    let [before, after] = visits.map(|visit| course.left_minus_right(group, visit));
    Some(changed(course, group, visits, [before?, after?]))
}

/// How the excess changed between two visits.
pub(super) fn excess_change(
    course: &Course,
    group: &Group,
    visits: [usize; 2],
) -> Option<ExcessChange> {
    let [before, after] = visits.map(|visit| course.excess(group, visit));
    let (before, after) = (before?, after?);
    let change = changed(course, group, visits, [before.ml, after.ml]);
    let reduction = reduction(&before.ml, &after.ml, &change);
    Some(ExcessChange { earlier: before, later: after, change, reduction })
}

/// The change of a figure of both legs, with what another stance does to either.
fn changed(
    course: &Course,
    group: &Group,
    [earlier, later]: [usize; 2],
    [before, after]: [Quantity; 2],
) -> Change {
    let visits = [&course.visits[earlier], &course.visits[later]];
    let stance = Side::BOTH.into_iter().map(|side| {
        let ml = course.volume(group, earlier, side).map_or(0.0, |volume| volume.value);
        stance_change(visits, side).unwrap_or_default().of_volume(ml)
    });
    Change::between(&before, &after).with_stance(stance.fold(0.0, f64::hypot))
}

fn reduction(
    before: &Quantity,
    after: &Quantity,
    change: &Change,
) -> Result<Reduction, NoReduction> {
    if change.shown() == Shown::NoChange {
        return Err(NoReduction::NoChange);
    }
    if before.value.abs() <= before.expanded() {
        return Err(NoReduction::WithinUncertainty);
    }
    if before.value < 0.0 {
        return Err(NoReduction::SmallerLeg);
    }
    let ratio = after.value / before.value;
    // The partial derivatives of E₁ / E₀ with respect to both. The visit at which the leg was held differently
    // is not known from its excess, so the stance counts where it has more effect.
    let of_after = after.parts.total() / before.value;
    let of_before = ratio * before.parts.total() / before.value;
    let of_stance = ratio.abs().max(1.0) * change.stance / before.value;
    let sd = of_after.hypot(of_before).hypot(of_stance);
    let percent = 100.0 * (1.0 - ratio);
    Ok(Reduction { percent, expanded: 100.0 * MARGIN_SDS * sd })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Parts;

    fn quantity(value: f64, random: f64) -> Quantity {
        Quantity::new(value, Parts { random, ..Parts::default() })
    }

    fn between(before: Quantity, after: Quantity, stance: f64) -> Result<Reduction, NoReduction> {
        reduction(&before, &after, &Change::between(&before, &after).with_stance(stance))
    }

    #[test]
    fn the_reduction_is_a_share_of_the_earlier_excess_with_the_uncertainty_of_both() {
        let found = between(quantity(800.0, 30.0), quantity(520.0, 40.0), 0.0).unwrap();
        assert!((found.percent - 35.0).abs() < 1e-9, "{found:?}");
        let expected = 200.0 * (0.05_f64.powi(2) + (0.65_f64 * 0.0375).powi(2)).sqrt();
        assert!((found.expanded - expected).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn another_stance_makes_the_reduction_less_certain_and_never_less_so_than_its_change() {
        let [before, after] = [quantity(800.0, 0.0), quantity(520.0, 0.0)];
        let found = between(before, after, 40.0).unwrap();
        assert!((found.expanded - 10.0).abs() < 1e-9, "{found:?}");
        // An excess that doubles: an error of the earlier one counts twice.
        let found = between(quantity(400.0, 0.0), quantity(800.0, 0.0), 40.0).unwrap();
        assert!((found.expanded - 40.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn why_no_share_is_told_is_the_true_reason() {
        for (before, after, why) in [
            (800.0, 780.0, NoReduction::NoChange),
            (-800.0, -780.0, NoReduction::NoChange),
            (60.0, 400.0, NoReduction::WithinUncertainty),
            (-60.0, 400.0, NoReduction::WithinUncertainty),
            (-800.0, -400.0, NoReduction::SmallerLeg),
        ] {
            assert_eq!(between(quantity(before, 30.0), quantity(after, 30.0), 0.0), Err(why));
        }
        assert_eq!(
            between(quantity(800.0, 30.0), quantity(520.0, 30.0), 200.0),
            Err(NoReduction::NoChange)
        );
    }
}
