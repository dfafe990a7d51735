//! Where the points of a leg's mesh lie on its fitted skin: at which direction of the skin's normal, and how far
//! outside.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;

use super::equidistant::Sections;
use super::section::{SPACING_MM, Section, Spokes};
use crate::parting::segment::Leg;

/// Angles at which each section's radius is read; in between it is interpolated. 2.5° are 2 mm on a calf, where a
/// chord lies 0.01 mm inside the skin.
const ANGLES: usize = 144;

/// A point of the mesh on the fitted skin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Height above the floor, mm.
    pub height_mm: f64,
    /// Place in the plane across the leg, to the front and to the patient's left, mm.
    pub place: Vector2<f64>,
    /// Angle about the leg's middle, radians: 0 to the front, positive to the patient's left.
    pub angle: f64,
    /// Direction of the fitted skin's normal, likewise.
    pub direction: f64,
    /// Distance outside the fitted skin, mm.
    pub outside_mm: f64,
}

/// Each point of a leg's mesh between two heights on its skin; `None` elsewhere, and where the skin has no sections.
pub fn placed(leg: &Leg, sections: &Sections, [low_mm, high_mm]: [f64; 2]) -> Vec<Option<Placed>> {
    let measured = sections.rows.iter().filter_map(|row| row.section.as_ref());
    let spokes = measured.map(|section| &section.curve).find_map(|curve| curve.spokes(ANGLES));
    let ring = |section: &Section| Ring::from_section(section, spokes.as_ref());
    let rows: Vec<Option<Ring>> =
        sections.rows.iter().map(|row| row.section.as_ref().map(ring)).collect();
    let from_mm = sections.rows.first().map_or(0.0, |row| row.along_mm);
    let left = leg.side.lateral_sign();
    let one = |point: &nalgebra::Point3<f64>| {
        if !(low_mm..high_mm).contains(&point.z) {
            return None;
        }
        let (along_mm, in_plane) = sections.axis.place(point);
        let at = (along_mm - from_mm) / SPACING_MM;
        if at < 0.0 {
            return None;
        }
        let below = at as usize;
        let (lower, upper) = (rows.get(below)?.as_ref()?, rows.get(below + 1)?.as_ref()?);
        let share = at - below as f64;
        let arm = in_plane.coords - lower.centre.lerp(&upper.centre, share);
        let angle = arm.y.atan2(arm.x);
        let [lower, upper] = [lower, upper].map(|ring| ring.at(angle));
        let [radius_mm, turned] = [0, 1].map(|i| lower[i] + share * (upper[i] - lower[i]));
        Some(Placed {
            height_mm: point.z,
            place: Vector2::new(in_plane.x, left * in_plane.y),
            angle: left * angle,
            direction: left * (angle - turned),
            outside_mm: (arm.norm() - radius_mm) * turned.cos(),
        })
    };
    leg.mesh.points().iter().map(one).collect()
}

/// A section's curve at equal angles.
struct Ring {
    centre: Vector2<f64>,
    /// Radius, mm, and by how much the normal is turned against the radius, radians.
    values: Vec<[f64; 2]>,
}

impl Ring {
    fn from_section(section: &Section, spokes: Option<&Spokes>) -> Ring {
        let radii = section.curve.radii(ANGLES, spokes);
        let value = |index: usize| {
            let [before, after] = [index + ANGLES - 1, index + 1].map(|i| radii[i % ANGLES]);
            let slope = (after - before) * ANGLES as f64 / (2.0 * TAU);
            [radii[index], slope.atan2(radii[index])]
        };
        Ring { centre: section.centre.coords, values: (0..ANGLES).map(value).collect() }
    }

    fn at(&self, angle: f64) -> [f64; 2] {
        let place = (angle + PI).rem_euclid(TAU) / TAU * ANGLES as f64;
        let (first, share) = (place as usize % ANGLES, place.fract());
        let (from, to) = (self.values[first], self.values[(first + 1) % ANGLES]);
        [0, 1].map(|i| from[i] + share * (to[i] - from[i]))
    }
}
