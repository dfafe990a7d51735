//! Two visits of a group: what changed on each leg.

use std::collections::BTreeSet;

use gaiter_leg::Side;
use gaiter_leg::side::Sides;

use super::caution::{Caution, cautions, stance_change};
use super::course::{Course, Group};
use super::excess::{ExcessChange, excess_change};
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
    /// The excess volume of the affected leg; `None` if no leg is, or one of the legs is missing.
    pub excess: Option<ExcessChange>,
    /// What speaks against comparing them.
    pub cautions: Vec<Caution>,
}

/// The change of one leg.
#[derive(Debug, Clone, PartialEq)]
pub struct LegChange {
    /// Of the volume over the pieces that all visits have, mL; `None` if there are none.
    pub volume: Option<Change>,
    /// Of the girths at fixed places, mm, lowest first. Places at which the skin has moved too far because the
    /// leg was held differently are missing.
    pub girths: Vec<PlaceChange>,
    /// Of the volume of each piece, mL, lowest first. Pieces are missing like `girths`.
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
        let leg = |side: Side| {
            let legs = visits.map(|visit| visit.legs.get(side).as_ref());
            let [Some(before), Some(after)] = legs else { return None };
            let stance = stance_change(visits, side).unwrap_or_default();
            let volumes = [earlier, later].map(|visit| self.volume(group, visit, side));
            let volume = match volumes {
                [Some(before), Some(after)] => {
                    let of_stance = stance.of_volume(before.value);
                    Some(Change::between(&before, &after).with_stance(of_stance))
                }
                _ => None,
            };
            if cautions.contains(&Caution::Posture) {
                return Some(LegChange { volume, girths: Vec::new(), pieces: Vec::new() });
            }
            let legs = [before, after];
            let girths = girths(visits, legs, &stance);
            Some(LegChange { volume, girths, pieces: pieces(visits, legs, &stance, group) })
        };
        Comparison {
            earlier,
            later,
            legs: Sides::of_each(leg),
            excess: excess_change(self, group, earlier, later),
            cautions,
        }
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
    let steps = legs[0].places.keys().filter(|step| stance.allows(**step, **step + 1));
    steps.filter_map(change).collect()
}

fn is_doubtful(legs: [&LegAtVisit; 2], steps: &[Step]) -> bool {
    let mut places =
        legs.into_iter().flat_map(|leg| steps.iter().filter_map(|step| leg.places.get(step)));
    places.any(|place| place.is_doubtful)
}
