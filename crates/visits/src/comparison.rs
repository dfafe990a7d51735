//! Two visits of a group: what changed on each leg.

use std::collections::BTreeSet;

use gaiter_leg::Side;
use gaiter_leg::side::Sides;

use super::caution::{Caution, cautions, stance_change};
use super::course::{Course, Group};
use super::excess::{Excess, ExcessChange, difference_change, excess_change};
use super::left_out::StandIns;
use super::leg::LegAtVisit;
use super::place::Step;
use super::quantity::Change;
use super::stance::StanceChange;
use super::visit::Visit;

/// What changed from one visit to a later one.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Index of the earlier visit.
    pub earlier: usize,
    /// Index of the later visit.
    pub later: usize,
    /// The change of each leg; `None` if one of the visits lacks it.
    pub legs: Sides<Option<LegChange>>,
    /// Of the volume of the left leg minus that of the right one, mL; `None` if a leg is missing or the posture is
    /// another.
    pub left_minus_right: Option<Change>,
    /// The excess volume of the affected leg; `None` unless one leg is named, and where `left_minus_right` is.
    pub excess: Option<ExcessChange>,
    /// The excess volume at the later visit, also in another posture: it comes from one scan.
    pub later_excess: Option<Excess>,
    /// Reasons for caution in comparing them.
    pub cautions: Vec<Caution>,
    /// Which of the two stand in the place of a record that is left out.
    pub stand_ins: StandIns,
}

/// The change of one leg.
#[derive(Debug, Clone, PartialEq)]
pub struct LegChange {
    /// Of the volume over the pieces that all visits have, mL; `None` if there are none, and in another posture: it
    /// is made of the girths.
    pub volume: Option<Change>,
    /// Of the girths at fixed places, mm, lowest first. Places at which the skin has moved too far because the
    /// leg was held differently are missing, all of them in another posture.
    pub girths: Vec<PlaceChange>,
    /// Of the volume of each piece that counts for the volume, mL, lowest first. Pieces are missing like `girths`.
    pub pieces: Vec<PlaceChange>,
}

/// A change at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceChange {
    /// The place, or the lower place of a piece.
    pub step: Step,
    /// The change.
    pub change: Change,
    /// Whether one of the records has a doubt about the girth there.
    pub is_doubtful: bool,
}

impl Course {
    /// What changed between two visits of a group.
    pub fn compared(&self, group: &Group, earlier: usize, later: usize) -> Comparison {
        let visits = [&self.visits[earlier], &self.visits[later]];
        let cautions = cautions(visits);
        let is_other_posture = cautions.contains(&Caution::Posture);
        let leg = |side: Side| {
            let legs = visits.map(|visit| visit.legs.get(side).as_ref());
            let [Some(before), Some(after)] = legs else { return None };
            if is_other_posture {
                return Some(LegChange { volume: None, girths: Vec::new(), pieces: Vec::new() });
            }
            let stance = stance_change(visits, side).unwrap_or_default();
            let volumes = [earlier, later].map(|visit| self.volume(group, visit, side));
            let volume = match volumes {
                [Some(before), Some(after)] => {
                    let of_stance = stance.of_volume(before.value);
                    Some(Change::between(&before, &after).with_stance(of_stance))
                }
                _ => None,
            };
            let legs = [before, after];
            let girths = girths(visits, legs, &stance);
            let pieces = pieces(visits, legs, &stance, group, side);
            Some(LegChange { volume, girths, pieces })
        };
        Comparison {
            earlier,
            later,
            legs: Sides::of_each(leg),
            left_minus_right: difference_change(self, group, [earlier, later])
                .filter(|_| !is_other_posture),
            excess: excess_change(self, group, [earlier, later]).filter(|_| !is_other_posture),
            later_excess: self.excess(group, later),
            cautions,
            stand_ins: self.stand_ins(group, [earlier, later]),
        }
    }

    /// Which of two visits of a group stand in the place of a record that is left out.
    fn stand_ins(&self, group: &Group, visits: [usize; 2]) -> StandIns {
        let times = visits.map(|visit| self.visits[visit].acquired.as_ref());
        let is_first = group.visits.first() == visits.first();
        let is_next = group.visits.windows(2).any(|pair| *pair == visits);
        StandIns::find(&self.left_out, times, [is_first, is_next])
    }

    /// The comparisons that clinics read: the last visit of a group with its first one, and with the one
    /// before it.
    pub fn last_compared(&self, group: &Group) -> Vec<Comparison> {
        let Some((last, before)) = group.visits.split_last() else { return Vec::new() };
        let mut earlier: Vec<usize> =
            before.first().into_iter().chain(before.last()).copied().collect();
        earlier.dedup();
        earlier.into_iter().map(|earlier| self.compared(group, earlier, *last)).collect()
    }
}

impl Comparison {
    /// The change of the volume of a leg.
    pub(crate) fn volume(&self, side: Side) -> Option<Change> {
        self.legs.get(side).as_ref()?.volume
    }

    /// The changes of the girths of a leg; none where they are not compared.
    pub(crate) fn girths(&self, side: Side) -> &[PlaceChange] {
        self.legs.get(side).as_ref().map(|leg| leg.girths.as_slice()).unwrap_or_default()
    }

    /// The changes of the pieces of a leg; none where they are not compared.
    pub(crate) fn pieces(&self, side: Side) -> &[PlaceChange] {
        self.legs.get(side).as_ref().map(|leg| leg.pieces.as_slice()).unwrap_or_default()
    }

    /// Whether the posture that was declared is another, so that nothing of the legs is compared.
    pub fn is_of_other_posture(&self) -> bool {
        self.cautions.contains(&Caution::Posture)
    }
}

fn girths(visits: [&Visit; 2], legs: [&LegAtVisit; 2], stance: &StanceChange) -> Vec<PlaceChange> {
    let change = |step: &Step| {
        let girth = |of: usize| legs[of].girth(*step, &visits[of].common);
        let change = Change::at_place(&girth(0)?, &girth(1)?).with_stance(stance.of_girth_mm());
        Some(PlaceChange { step: *step, change, is_doubtful: is_doubtful(legs, &[*step]) })
    };
    let steps = legs[0].places.keys().filter(|step| stance.allows(**step, **step));
    steps.filter_map(change).collect()
}

fn pieces(
    visits: [&Visit; 2],
    legs: [&LegAtVisit; 2],
    stance: &StanceChange,
    group: &Group,
    side: Side,
) -> Vec<PlaceChange> {
    let change = |step: &Step| {
        let only = BTreeSet::from([*step]);
        let volume = |of: usize| legs[of].volume(group.volume, &only, &visits[of].common);
        let (before, after) = (volume(0)?, volume(1)?);
        let of_stance = stance.of_piece(before.value);
        Some(PlaceChange {
            step: *step,
            change: Change::at_place(&before, &after).with_stance(of_stance),
            is_doubtful: is_doubtful(legs, &[*step, step + 1]),
        })
    };
    let steps = group.pieces.get(side).iter().filter(|step| stance.allows(**step, **step + 1));
    steps.filter_map(change).collect()
}

fn is_doubtful(legs: [&LegAtVisit; 2], steps: &[Step]) -> bool {
    let mut places =
        legs.into_iter().flat_map(|leg| steps.iter().filter_map(|step| leg.places.get(step)));
    places.any(|place| place.is_doubtful)
}
