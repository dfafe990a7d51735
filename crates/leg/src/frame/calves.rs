//! The front of a body by its calves, where the feet do not show it: the belly of a calf stands behind the line from
//! the ankle to the knee.

use nalgebra::{Point2, Vector2, Vector3};

use super::stance::shank_middles;
use crate::sections::slice::Mesh;

/// Heights of ankle, calf and knee at which the middles of the shanks are compared, as shares of the stature.
const SHARES: [f64; 3] = [0.08, 0.19, 0.27];

/// The belly of a calf stands at least so far behind, mm: of 66 legs by 9 to 26 mm, also of swollen and of heavy ones,
/// with bent knees, and where a hole in it was closed by a flat membrane.
const BEHIND_MIN_MM: f64 = 6.0;

/// A shank is followed from height to height by the nearest ring, which is no further than this, as a share of the
/// stature: a leg that leans by 35° moves by 0.08.
const REACH_SHARE: f64 = 0.08;

/// The fronts of both calves differ by at most this, degrees: feet may be turned out by 30° each.
const APART_MAX_DEG: f64 = 75.0;

/// Their mean differs by at most this from the perpendicular to the line through the ankles, degrees: one foot may
/// stand before the other, by 350 mm where the ankles are 350 mm apart.
const SQUARE_MAX_DEG: f64 = 50.0;

/// The direction to the front of a body on these two shanks: the perpendicular to the line through the ankles, as a
/// unit vector. `None` if the calves do not agree on it.
pub(crate) fn front(mesh: &Mesh, shanks: &[Point2<f64>], stature_mm: f64) -> Option<Vector2<f64>> {
    let &[first, second] = shanks else { return None };
    let heights = SHARES.map(|share| share * stature_mm);
    let part = mesh.part(|facet| facet.reaches([heights[0], heights[2]]));
    let slices = part.slices(&Vector3::z_axis(), &heights);
    let middles: Vec<Vec<Point2<f64>>> = slices.iter().map(|slice| shank_middles(slice)).collect();
    let [a, b] =
        [first, second].map(|shank| before_calf(&middles, shank, REACH_SHARE * stature_mm));
    let (a, b) = (a?, b?);
    let front = a.normalize() + b.normalize();
    let across = (second - first).normalize();
    let square = Vector2::new(-across.y, across.x);
    let square = if square.dot(&front) < 0.0 { -square } else { square };
    let agree = a.angle(&b).to_degrees() <= APART_MAX_DEG
        && square.angle(&front).to_degrees() <= SQUARE_MAX_DEG;
    agree.then_some(square)
}

/// From the belly of a calf to the line from ankle to knee, mm; `None` where that was not seen, or is too short.
fn before_calf(
    middles: &[Vec<Point2<f64>>],
    shank: Point2<f64>,
    reach_mm: f64,
) -> Option<Vector2<f64>> {
    let mut places = Vec::new();
    let mut own = shank;
    for found in middles {
        let far = |middle: &&Point2<f64>| (*middle - own).norm();
        let nearest = found.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
        own = Some(*nearest).filter(|middle| far(&middle) <= reach_mm)?;
        places.push(own);
    }
    let &[ankle, calf, knee] = places.as_slice() else { return None };
    let along = (SHARES[1] - SHARES[0]) / (SHARES[2] - SHARES[0]);
    let before = ankle + (knee - ankle) * along - calf;
    (before.norm() >= BEHIND_MIN_MM).then_some(before)
}
