//! How a girth depends on the direction of its plane, and so on the stature, by which the axes of shank
//! and thigh are found.

use super::girth::GirthCurve;
use super::landmark::Landmark;
use crate::leg::level::By;
use crate::leg::sections::axis::LegAxis;
use crate::leg::sections::equidistant::{Sections, Source};
use crate::leg::sections::skin::Skin;

/// Over this distance to each side of a landmark, the change of its girth with the plane is compared, mm.
const REACH_MM: f64 = 10.0;

/// Completes landmarks: how much their girth changes with a tilt of the tape, and in their standard errors
/// what the planes are uncertain by. `others` are the axes for statures that differ by their standard error,
/// if the axis depends on that; the one that changes the girth more counts.
pub fn complete<'a>(
    landmarks: impl Iterator<Item = &'a mut Landmark>,
    sections: &Sections,
    curve: &GirthCurve,
    others: &[LegAxis],
) {
    // The other sources do not know the skin beside a plane.
    let Source::Skin(skin) = &sections.source else { return };
    for landmark in landmarks {
        let along_mm = landmark.along_mm;
        let Some(per_deg) = skin.girth_per_deg(along_mm) else { continue };
        landmark.girth_per_deg_mm = Some(per_deg[0].hypot(per_deg[1]));
        let at =
            |along_mm| others.iter().map(move |other| change_mm(sections, skin, along_mm, other));
        let change_mm = at(along_mm).flatten().fold(0.0, |most: f64, mm| most.max(mm.abs()));
        landmark.girth_sd_mm = landmark.girth_sd_mm.hypot(change_mm);
        if landmark.by == By::Turn {
            // Where the girth changes by more above than below, its turning point moves.
            let pairs = at(along_mm - REACH_MM).zip(at(along_mm + REACH_MM));
            let slopes = pairs.filter_map(|(low, high)| Some((high? - low?) / (2.0 * REACH_MM)));
            let slope = slopes.fold(0.0, |most: f64, slope| most.max(slope.abs()));
            let [_, _, bend, _] = curve.tape(along_mm);
            let moved_mm = slope / bend.abs().max(f64::MIN_POSITIVE);
            landmark.height_sd_mm = landmark.height_sd_mm.hypot(moved_mm);
        }
    }
}

/// How much the girth changes in the plane of another axis, mm; `None` outside the skin.
fn change_mm(sections: &Sections, skin: &Skin, along_mm: f64, other: &LegAxis) -> Option<f64> {
    let per_deg = skin.girth_per_deg(along_mm)?;
    let own = sections.axis.plane(along_mm);
    let centre = own.point(&skin.centre(along_mm));
    let normal = other.plane(other.along(&centre)).normal;
    let tilt_deg = [&own.front, &own.lateral].map(|side| normal.dot(side).to_degrees());
    Some(per_deg[0] * tilt_deg[0] + per_deg[1] * tilt_deg[1])
}
