//! How a girth depends on the direction of its plane, and so on the stature, by which the axes of shank
//! and thigh are found.

use super::landmark::Landmark;
use crate::leg::sections::axis::LegAxis;
use crate::leg::sections::equidistant::{Sections, Source};

/// Completes landmarks: how much their girth changes with a tilt of the tape, and in their standard error
/// what the plane is uncertain by. `others` are the axes for statures that differ by their standard error,
/// if the axis depends on that; the one that changes the girth more counts.
pub fn complete<'a>(
    landmarks: impl Iterator<Item = &'a mut Landmark>,
    sections: &Sections,
    others: &[LegAxis],
) {
    // The other sources do not know the skin beside a plane.
    let Source::Skin(skin) = &sections.source else { return };
    for landmark in landmarks {
        let along_mm = landmark.along_mm;
        let Some(per_deg) = skin.girth_per_deg(along_mm) else { continue };
        landmark.girth_per_deg_mm = Some(per_deg[0].hypot(per_deg[1]));
        let own = sections.axis.plane(along_mm);
        let centre = own.point(&skin.centre(along_mm));
        let change_mm = |other: &LegAxis| {
            let normal = other.plane(other.along(&centre)).normal;
            let tilt_deg = [&own.front, &own.lateral].map(|side| normal.dot(side).to_degrees());
            (per_deg[0] * tilt_deg[0] + per_deg[1] * tilt_deg[1]).abs()
        };
        let change_mm = others.iter().map(change_mm).fold(0.0, f64::max);
        landmark.girth_sd_mm = landmark.girth_sd_mm.hypot(change_mm);
    }
}
