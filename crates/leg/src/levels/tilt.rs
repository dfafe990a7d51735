//! How a girth depends on the direction of its plane, and so on the stature, by which the axes of shank
//! and thigh are found.

use nalgebra::Point3;

use super::girth::GirthCurve;
use super::landmark::Landmark;
use crate::level::By;
use crate::sections::axis::LegAxis;
use crate::sections::equidistant::{Sections, Source};
use crate::sections::plane_frame::PlaneFrame;
use crate::sections::skin::Skin;

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
        let Some(here) = TiltPlane::at(sections, skin, along_mm) else { continue };
        landmark.girth_per_deg_mm = Some(here.per_deg[0].hypot(here.per_deg[1]));
        let changes = others.iter().map(|other| here.change_mm(other));
        let change_mm = changes.fold(0.0, |most: f64, mm| most.max(mm.abs()));
        for sd_mm in [&mut landmark.girth_sd_mm, &mut landmark.girth_of_level_sd_mm] {
            *sd_mm = sd_mm.hypot(change_mm);
        }
        if landmark.by != By::Turn || others.is_empty() {
            continue;
        }
        let beside = [along_mm - REACH_MM, along_mm + REACH_MM];
        let [Some(below), Some(above)] =
            beside.map(|along_mm| TiltPlane::at(sections, skin, along_mm))
        else {
            continue;
        };
        // Where the girth changes by more above than below, its turning point moves.
        let slope = |other| (above.change_mm(other) - below.change_mm(other)) / (2.0 * REACH_MM);
        let slope = others.iter().map(slope).fold(0.0, |most: f64, slope| most.max(slope.abs()));
        let [_, _, bend, _] = curve.tape(along_mm);
        let moved_mm = slope / bend.abs().max(f64::MIN_POSITIVE);
        landmark.height_sd_mm = landmark.height_sd_mm.hypot(moved_mm);
    }
}

/// A place on a leg: its plane, and how its girth changes with a tilt of it.
struct TiltPlane {
    plane: PlaneFrame,
    centre: Point3<f64>,
    /// Towards the front, and towards the lateral side, mm per degree.
    per_deg: [f64; 2],
}

impl TiltPlane {
    /// `None` outside the skin.
    fn at(sections: &Sections, skin: &Skin, along_mm: f64) -> Option<TiltPlane> {
        let per_deg = skin.girth_per_deg(along_mm)?;
        let plane = sections.axis.plane(along_mm);
        let centre = plane.point(&skin.centre(along_mm));
        Some(TiltPlane { plane, centre, per_deg })
    }

    /// How much its girth changes in the plane of another axis, mm.
    fn change_mm(&self, other: &LegAxis) -> f64 {
        let normal = other.plane(other.along(&self.centre)).normal;
        let tilt_deg =
            [&self.plane.front, &self.plane.lateral].map(|side| normal.dot(side).to_degrees());
        self.per_deg[0] * tilt_deg[0] + self.per_deg[1] * tilt_deg[1]
    }
}
