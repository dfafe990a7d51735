//! Where cloth over the skin begins or ends: the edge of a bandage, a stocking, a sock, trousers.
//!
//! Cloth of even thickness changes the radius by the same amount all around, at the height of one plane, within a few
//! millimetres. Skin does not: a calf or a swollen ankle rises over centimetres, a fold or a cuff of fat hangs out more
//! on one side than on another, a furrow or the mark of a sock returns to the level it came from.
//!
//! The mean radius near a height is described by a cubic and a step. The step counts if noise explains it no more than
//! a rounder step or a furrow would, and if most directions show it alike.

mod covers;
mod reading;
mod rows;
mod search;
mod step;

use covers::covers;
use reading::Reading;
use rows::Rows;
pub(super) use rows::{DIRECTIONS, direction};
use search::{SHARP, SOFT};

/// The least scatter of points, mm: what a fit leaves of bodies without noise.
const NOISE_MIN_MM: f64 = 0.1;

/// On the other leg, an edge within this distance, mm, and with at least this share of the step is the same.
const OTHER_LEG_MM: f64 = 40.0;
const OTHER_LEG_SHARE: f64 = 0.4;

/// An edge of cloth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// Distance along the axis, mm.
    pub along_mm: f64,
    /// How far the radius grows upwards, mm; negative where cloth ends.
    pub step_mm: f64,
    /// Whether it is sharper than flesh.
    pub is_sharp: bool,
}

/// A part of a leg that cloth covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cover {
    /// Its lower edge; `None` if it lies below what was looked at.
    pub lower: Option<Edge>,
    /// Its upper edge; `None` if it lies above.
    pub upper: Option<Edge>,
    /// Whether it is cloth for sure. A single soft edge might as well be flesh.
    pub is_sure: bool,
}

impl Cover {
    pub(super) fn is_sharp(&self) -> bool {
        [self.lower, self.upper].iter().flatten().any(|edge| edge.is_sharp)
    }

    /// The edge with the most evidence: the lower one.
    pub fn edge(&self) -> Option<Edge> {
        self.lower.or(self.upper)
    }

    /// How thick the cloth is, mm.
    pub fn thickness_mm(&self) -> f64 {
        self.edge().map_or(0.0, |edge| edge.step_mm.abs())
    }
}

/// What covers a leg.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cloth {
    /// The parts covered, lowest first.
    pub covers: Vec<Cover>,
    /// Everything that steps outwards or inwards, whatever it is.
    steps: Vec<Edge>,
}

/// What covers a leg between two distances along the axis. `points` are given by their distance along, their angle and
/// their distance outside a fitted skin; `fitted` is that skin's radius at a distance, in each direction. Any smooth skin will
/// do that follows the leg around: what it cuts off along the leg is in the distances. `noise_mm` is the scatter of the
/// points.
pub fn cloth(
    points: impl Iterator<Item = [f64; 3]>,
    fitted: impl Fn(f64) -> Option<[f64; DIRECTIONS]>,
    noise_mm: f64,
    span_mm: [f64; 2],
) -> Cloth {
    let Some(rows) = Rows::new(points, fitted, noise_mm.max(NOISE_MIN_MM), span_mm) else {
        return Cloth::default();
    };
    let means = rows.means();
    let readings: Vec<Reading> = [SHARP, SOFT]
        .iter()
        .flat_map(|search| rows.places(search, &means))
        .filter_map(|(border, lean)| rows.reading(border, lean))
        .collect();
    let steps = readings.iter().map(|reading| reading.edge(false)).collect();
    Cloth { covers: covers(&readings), steps }
}

impl Cloth {
    /// Makes sure of what is suspected if the other leg has nothing of the kind at the same height, which fat and
    /// swelling of both legs have. Distances along the two axes must be comparable.
    pub fn compare(&mut self, other_leg: &Cloth) {
        for cover in self.covers.iter_mut().filter(|cover| !cover.is_sure) {
            let is_same = |edge: Edge, other: &Edge| {
                (edge.along_mm - other.along_mm).abs() < OTHER_LEG_MM
                    && other.step_mm * edge.step_mm.signum() > OTHER_LEG_SHARE * edge.step_mm.abs()
            };
            cover.is_sure = cover
                .edge()
                .is_some_and(|edge| !other_leg.steps.iter().any(|other| is_same(edge, other)));
        }
    }
}

#[cfg(test)]
mod tests;
