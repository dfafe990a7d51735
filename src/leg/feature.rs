//! Feature points: peaks and valleys of the curvature around a section (paper 1.3, fig. 4b, 4c).

use std::f64::consts::{PI, TAU};

use nalgebra::Point3;

use super::axis::LegAxis;
use super::curvature;
use super::section::Section;

/// Angles at which the curvature is taken.
const ANGLES: usize = 360;

/// A peak or valley stands out by at least this share of the mean curvature 2π / girth; less is a
/// round side of the leg.
const PROMINENCE_MIN_SHARE: f64 = 0.25;

/// What a feature point is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Locally most curved: a corner, such as the tibial crest or the Achilles tendon.
    Peak,
    /// Locally flattest or most hollow.
    Valley,
}

impl Kind {
    /// The word used in records.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Peak => "peak",
            Kind::Valley => "valley",
        }
    }
}

/// A feature point of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// Peak or valley.
    pub kind: Kind,
    /// Angle around the section's centre, degrees in (−180, 180]: 0 front, 90 lateral.
    pub angle_deg: f64,
    /// The place on the fitted curve, body frame, mm.
    pub position: Point3<f64>,
    /// Curvature there, 1/mm, positive where convex.
    pub curvature_per_mm: f64,
    /// By how much it stands out from its neighbours, 1/mm.
    pub prominence_per_mm: f64,
}

/// The feature points of a section in order around from the front: P1, P2, …
pub fn features(axis: &LegAxis, section: &Section) -> Vec<Feature> {
    let points = section.curve.points(ANGLES);
    let curvatures = curvature::around(&points, section.girth.contour_mm);
    let gate = PROMINENCE_MIN_SHARE * TAU / section.girth.contour_mm;
    let mut found: Vec<Feature> = standing_out(&curvatures, gate)
        .into_iter()
        .map(|turn| {
            let index = turn.index as f64 + vertex(&curvatures, turn.index);
            let angle = wrapped(-PI + TAU * index / ANGLES as f64);
            Feature {
                kind: if turn.is_peak { Kind::Peak } else { Kind::Valley },
                angle_deg: angle.to_degrees(),
                position: section.point(axis, angle),
                curvature_per_mm: curvatures[turn.index],
                prominence_per_mm: turn.prominence,
            }
        })
        .collect();
    found.sort_by(|a, b| a.angle_deg.rem_euclid(360.0).total_cmp(&b.angle_deg.rem_euclid(360.0)));
    found
}

/// A turning point of a closed row of values.
#[derive(Debug, Clone, Copy)]
struct Turn {
    index: usize,
    is_peak: bool,
    prominence: f64,
}

/// Turning points of a closed row of values that differ from both neighbouring ones by the gate or
/// more: pairs that differ by less are left out, the closest first.
fn standing_out(values: &[f64], gate: f64) -> Vec<Turn> {
    let count = values.len();
    let turn = |index: usize| {
        let (before, own) = (values[(index + count - 1) % count], values[index]);
        let after = values[(index + 1) % count];
        let is_peak = own > before && own >= after;
        let is_valley = own < before && own <= after;
        (is_peak || is_valley).then_some(Turn { index, is_peak, prominence: 0.0 })
    };
    let mut turns: Vec<Turn> = (0..count).filter_map(turn).collect();
    let difference = |a: &Turn, b: &Turn| (values[a.index] - values[b.index]).abs();
    while turns.len() >= 2 {
        let next = |place: usize| (place + 1) % turns.len();
        let gap = |place: &usize| difference(&turns[*place], &turns[next(*place)]);
        let Some(closest) = (0..turns.len()).min_by(|a, b| gap(a).total_cmp(&gap(b))) else {
            break;
        };
        if gap(&closest) >= gate {
            break;
        }
        let (first, second) = (closest.min(next(closest)), closest.max(next(closest)));
        turns.remove(second);
        turns.remove(first);
    }
    let around = turns.clone();
    for (place, turn) in turns.iter_mut().enumerate() {
        let neighbours =
            [around[(place + around.len() - 1) % around.len()], around[(place + 1) % around.len()]];
        let gaps = neighbours.map(|neighbour| difference(turn, &neighbour));
        turn.prominence = gaps[0].min(gaps[1]);
    }
    turns
}

/// Where the parabola through a value and its two neighbours turns, in steps from the value,
/// −0.5 to 0.5.
fn vertex(values: &[f64], index: usize) -> f64 {
    let count = values.len();
    let (before, own) = (values[(index + count - 1) % count], values[index]);
    let after = values[(index + 1) % count];
    let bend = before - 2.0 * own + after;
    if bend == 0.0 { 0.0 } else { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) }
}

/// The same angle in (−π, π].
fn wrapped(angle: f64) -> f64 {
    PI - (PI - angle).rem_euclid(TAU)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ripples_below_the_gate_are_no_turning_points() {
        let values: Vec<f64> = (0..360)
            .map(|i| f64::from(i).to_radians())
            .map(|t| (3.0 * t).cos() + 0.05 * (40.0 * t).cos())
            .collect();
        let turns = standing_out(&values, 0.5);
        assert_eq!(turns.len(), 6);
        assert_eq!(turns.iter().filter(|turn| turn.is_peak).count(), 3);
        assert!(turns.iter().all(|turn| turn.prominence > 1.9));
        assert_eq!(standing_out(&values, 3.0).len(), 0);
    }

    #[test]
    fn the_angle_of_the_seam_is_180_degrees() {
        assert_eq!(wrapped(-PI), PI);
        assert_eq!(wrapped(PI), PI);
        assert!((wrapped(3.0 * PI / 2.0) + PI / 2.0).abs() < 1e-15);
    }
}
