//! Whether a body ends in a crown, or was cut off below: for privacy, or by a frame that is too low.

use std::f64::consts::{PI, TAU};

use nalgebra::Point3;

use super::unit_inference::extent;
use crate::sections::slice::Mesh;
use crate::statistics::quantile;

/// Directions in which the top of a body is looked at.
const DIRECTIONS: usize = 16;

/// Depths below the highest point, mm: the top …
const TOP_MM: [f64; 2] = [0.0, 3.0];

/// … what lies right below it …
const BELOW_MM: [f64; 2] = [8.0, 14.0];

/// … and where a head is as wide as it gets, and a body without one has its shoulders.
const WIDE_MM: [f64; 2] = [60.0, 100.0];

/// A crown widens by more than this from the top to what lies below it, mm per mm: by 2.2 and more if it is whole, by
/// 0.7 to 0.9 if a hole of 60 mm of radius makes it 1 % of the stature lower. Where a head is cut through, and at a
/// neck, some of the walls stand upright.
const WIDENING_MIN: f64 = 0.5;

/// This share of the directions may stand upright: hair, an ear, a tilted head.
const UPRIGHT_SHARE: f64 = 0.125;

/// A head is at most so wide from its middle, as a share of the height …
const HEAD_RADIUS_SHARE: f64 = 0.075;

/// … or mm: of adults 0.053 to 0.059, of children 80 to 90 mm; shoulders have 0.08 to 0.15.
const HEAD_RADIUS_MM: f64 = 95.0;

/// Depths at which the heads of children and adults are compared, as shares of the height: above the ears of both.
const HIGH_SHARE: [f64; 2] = [0.03, 0.05];

/// A head that is wider there from its middle, as a share of the height, is a child's of two years, who has 0.08;
/// adults have 0.05 to 0.06.
const CHILD_RADIUS_SHARE: f64 = 0.068;

/// Whether a standing body, z up from its floor at about 0 in any unit, has the head of a small child, or none.
pub(crate) fn is_child(mesh: &Mesh) -> bool {
    let top = mesh.highest_mm();
    let [wide] = reaches(mesh, top, [HIGH_SHARE.map(|share| share * top)]);
    at_share(wide.into_iter(), 0.5).is_some_and(|radius| radius > CHILD_RADIUS_SHARE * top)
}

/// Whether the highest part of a standing body, z up in mm and its floor at about 0, is a crown.
pub(crate) fn is_seen(mesh: &Mesh) -> bool {
    let top_mm = mesh.highest_mm();
    let [top, below, wide] = reaches(mesh, top_mm, [TOP_MM, BELOW_MM, WIDE_MM]);
    let depth_mm = (BELOW_MM[0] + BELOW_MM[1] - TOP_MM[0] - TOP_MM[1]) / 2.0;
    let widening = below.iter().zip(&top).map(|(below, top)| (below - top) / depth_mm);
    // Points too sparse to be seen at both depths are those of a crown: a neck has them in every direction.
    let is_round = at_share(widening, UPRIGHT_SHARE).is_none_or(|share| share > WIDENING_MIN);
    let head_mm = (HEAD_RADIUS_SHARE * top_mm).max(HEAD_RADIUS_MM);
    is_round && at_share(wide.into_iter(), 0.5).is_none_or(|radius_mm| radius_mm < head_mm)
}

/// The distance from the middle of the furthest point in each direction, within ranges of depth below the top;
/// infinite where none was seen.
fn reaches<const N: usize>(mesh: &Mesh, top: f64, depths: [[f64; 2]; N]) -> [[f64; DIRECTIONS]; N] {
    let deepest = depths.iter().fold(0.0, |deepest: f64, [_, to]| deepest.max(*to));
    let high: Vec<&Point3<f64>> =
        mesh.points().iter().filter(|point| top - point.z <= deepest).collect();
    let (low, far) = extent(high.iter().map(|point| **point));
    let middle = (low.coords + far.coords).xy() / 2.0;
    let mut reaches = [[f64::NEG_INFINITY; DIRECTIONS]; N];
    for point in high {
        let arm = point.coords.xy() - middle;
        let turn = (arm.y.atan2(arm.x) + PI) / TAU * DIRECTIONS as f64;
        let direction = (turn as usize).min(DIRECTIONS - 1);
        for (reach, [from, to]) in reaches.iter_mut().zip(depths) {
            if (from..=to).contains(&(top - point.z)) {
                reach[direction] = reach[direction].max(arm.norm());
            }
        }
    }
    reaches
}

/// The value below which this share of the finite ones lies.
fn at_share(values: impl Iterator<Item = f64>, share: f64) -> Option<f64> {
    quantile(values.filter(|value| value.is_finite()).collect(), share)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points 4 mm apart on a surface that turns about the z axis, by its radius over the depth below its top.
    fn turned(radius_mm: impl Fn(f64) -> f64, depths_mm: [f64; 2]) -> bool {
        let mut points = Vec::new();
        let rows = ((depths_mm[1] - depths_mm[0]) / 0.5) as u32;
        for row in 0..rows {
            let depth_mm = depths_mm[0] + 0.5 * f64::from(row);
            let radius_mm = radius_mm(depth_mm);
            for column in 0..60 {
                let angle = TAU * (f64::from(column) + 0.37 * f64::from(row)) / 60.0;
                let [x, y] = [0.8 * radius_mm * angle.cos(), radius_mm * angle.sin()];
                points.push(Point3::new(x, y, 1700.0 - depth_mm));
            }
        }
        is_seen(&Mesh::cloud(points, 4.0))
    }

    /// The radius of a head of 95 mm of radius.
    fn head(depth_mm: f64) -> f64 {
        (depth_mm * (190.0 - depth_mm)).sqrt()
    }

    #[test]
    fn a_head_is_a_crown_also_where_its_top_was_not_seen() {
        for hole_mm in [0.0, 3.0, 8.0, 12.0] {
            assert!(turned(head, [hole_mm, 120.0]), "{hole_mm}");
        }
    }

    #[test]
    fn a_head_that_is_cut_through_and_a_neck_are_none() {
        for cut_mm in [60.0, 80.0, 95.0, 120.0] {
            assert!(!turned(head, [cut_mm, 160.0]), "{cut_mm}");
        }
        for widening in [-0.3, 0.0, 0.5, 0.9] {
            let neck = |depth_mm: f64| 60.0 + widening * depth_mm.min(20.0);
            let is_wide = widening > 0.4;
            let shoulders =
                |depth_mm: f64| if is_wide && depth_mm > 40.0 { 150.0 } else { neck(depth_mm) };
            assert!(!turned(shoulders, [0.0, 120.0]), "{widening}");
        }
    }

    #[test]
    fn a_neck_under_a_flat_lid_is_none() {
        let lid = |depth_mm: f64| if depth_mm < 0.2 { 20.0 } else { 60.0 };
        assert!(!turned(lid, [0.0, 40.0]));
    }
}
