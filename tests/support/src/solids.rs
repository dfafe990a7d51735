//! Tubes of known radius in place of legs: their girths, curvatures and heights are closed forms.
//! Millimetres, in the body frame; the angle is gaiter's: 0 front, growing towards lateral.

// Each test crate uses its own part.
#![allow(clippy::unwrap_used)]

use std::f64::consts::TAU;

use gaiter_leg::levels::girth::{GirthCurve, girth_curve};
use gaiter_leg::method::{AxisFit, SectionFit, Tape};
use gaiter_leg::parting::segment::Leg;
use gaiter_leg::sections::axis::LegAxis;
use gaiter_leg::sections::axis_fit::{self, AxisFault};
use gaiter_leg::sections::equidistant::{Sections, sections};
use gaiter_leg::sections::section::Section;
use gaiter_leg::sections::slice::Mesh;
use gaiter_leg::side::Side;
use nalgebra::{Point3, Vector3};

pub use crate::chance::Chance;

/// The stature that goes with a tube.
pub const STATURE_MM: f64 = 1500.0;

/// The crotch's height that goes with a tube; a tube reaches beyond it, and below the floor.
pub const CROTCH_MM: f64 = 720.0;

/// From where to where along its axis a tube reaches.
const ALONG_MM: [f64; 2] = [-60.0, 800.0];

/// A tube of the radius r(angle in radians, distance along the axis in mm).
pub struct Tube<'a> {
    pub radius: &'a dyn Fn(f64, f64) -> f64,
    pub side: Side,
    /// Where the axis meets the floor.
    pub foot: Point3<f64>,
    /// Up along the axis, of any length.
    pub direction: Vector3<f64>,
    /// Points around.
    pub columns: usize,
    /// Distance of the rings of points.
    pub ring_mm: f64,
    /// Standard deviation of the radial noise.
    pub noise_mm: f64,
    /// Points moved at random on the skin by up to 0.3 cells, diagonals at random.
    pub is_scattered: bool,
    /// Where there is no skin, by angle and distance along the axis.
    pub hole: &'a dyn Fn(f64, f64) -> bool,
    /// Seed of noise and scatter.
    pub seed: u64,
}

impl<'a> Tube<'a> {
    /// An upright left tube with edges of about 5 mm, whole and exact.
    pub fn upright(radius: &'a dyn Fn(f64, f64) -> f64) -> Tube<'a> {
        Tube {
            radius,
            side: Side::Left,
            foot: Point3::origin(),
            direction: Vector3::z(),
            columns: 72,
            ring_mm: 5.0,
            noise_mm: 0.0,
            is_scattered: false,
            hole: &|_, _| false,
            seed: 1,
        }
    }

    /// The tube as a leg.
    pub fn leg(&self) -> Leg {
        let up = self.direction.normalize();
        let ahead = -Vector3::y();
        let front = (ahead - up * up.dot(&ahead)).normalize();
        let lateral = up.cross(&front) * self.side.lateral_sign();
        let mut chance = Chance(self.seed);
        let rings = ((ALONG_MM[1] - ALONG_MM[0]) / self.ring_mm).ceil() as usize + 1;
        let mut places = Vec::with_capacity(rings * self.columns);
        let mut points = Vec::with_capacity(rings * self.columns);
        for (ring, column) in (0..rings).flat_map(|r| (0..self.columns).map(move |c| (r, c))) {
            let off =
                if self.is_scattered { [chance.even(0.3), chance.even(0.3)] } else { [0.0; 2] };
            let angle = TAU * (column as f64 + off[0]) / self.columns as f64;
            let along = ALONG_MM[0] + self.ring_mm * (ring as f64 + off[1]);
            let radius = (self.radius)(angle, along) + self.noise_mm * chance.normal();
            places.push((angle, along));
            let (sin, cos) = angle.sin_cos();
            points.push(self.foot + up * along + front * (radius * cos) + lateral * (radius * sin));
        }
        let mut triangles = Vec::new();
        for (ring, column) in (1..rings).flat_map(|r| (0..self.columns).map(move |c| (r, c))) {
            let at = |ring: usize, column: usize| (ring * self.columns + column) as u32;
            let next = (column + 1) % self.columns;
            let [a, b] = [at(ring - 1, column), at(ring - 1, next)];
            let [c, d] = [at(ring, next), at(ring, column)];
            let (angle, along) = places[a as usize];
            let middle = (angle + TAU / 2.0 / self.columns as f64, along + self.ring_mm / 2.0);
            if (self.hole)(middle.0, middle.1) {
                continue;
            }
            if self.is_scattered && chance.even(1.0) < 0.0 {
                triangles.extend([[a, b, d], [b, c, d]]);
            } else {
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        // Points of the holes belong to no triangle and go, as they do from a scan.
        Leg { side: self.side, mesh: Mesh::new(points, triangles).part(|_| true), cut_mm: None }
    }

    /// The tube's sections, square to the axis that gaiter finds.
    pub fn sections(&self, fit: SectionFit) -> Sections {
        let leg = self.leg();
        let axis = axis(&leg, STATURE_MM, CROTCH_MM).unwrap();
        let span_mm = [40.0, axis.along_at_height(CROTCH_MM)];
        sections(&leg, axis, span_mm, fit).unwrap()
    }
}

/// Length of a closed curve r(angle), as a polygon of 20 000 sides (short by 4·10⁻⁹).
pub fn contour_mm(radius: impl Fn(f64) -> f64) -> f64 {
    let corners = outline(radius, 20_000);
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(p, q)| (q[0] - p[0]).hypot(q[1] - p[1])).sum()
}

/// Length of the convex hull of a closed curve r(angle) by Cauchy's formula: the integral over all
/// directions of how far the curve reaches.
pub fn tape_mm(radius: impl Fn(f64) -> f64) -> f64 {
    const DIRECTIONS: usize = 2000;
    let corners = outline(radius, 4000);
    let reach = |direction: usize| {
        let (sin, cos) = (TAU * direction as f64 / DIRECTIONS as f64).sin_cos();
        corners.iter().map(|[x, y]| x * cos + y * sin).fold(f64::NEG_INFINITY, f64::max)
    };
    (0..DIRECTIONS).map(reach).sum::<f64>() * TAU / DIRECTIONS as f64
}

fn outline(radius: impl Fn(f64) -> f64, count: usize) -> Vec<[f64; 2]> {
    let at = |index: usize| {
        let angle = TAU * index as f64 / count as f64;
        [radius(angle) * angle.cos(), radius(angle) * angle.sin()]
    };
    (0..count).map(at).collect()
}

/// All sections, none of which may be open.
pub fn all(sections: &Sections) -> Vec<&Section> {
    let found: Vec<&Section> =
        sections.rows.iter().filter_map(|row| row.section.as_ref()).collect();
    assert_eq!(found.len(), sections.rows.len(), "some sections are open");
    assert!(found.len() > 100, "only {} sections", found.len());
    found
}

/// Fails where a figure is further from the expected one than the tolerance.
#[track_caller]
pub fn near(found: f64, expected: f64, tolerance: f64, what: &str) {
    let off = found - expected;
    assert!(off.abs() <= tolerance, "{what}: {found} for {expected}, {off:.6} off");
}

/// The girth curve over sections of a tube.
pub fn curve_of(sections: &Sections) -> GirthCurve {
    girth_curve(sections, STATURE_MM).unwrap()
}

/// The one axis of a whole leg, through the centroids of its sections.
pub fn axis(leg: &Leg, stature_mm: f64, crotch_mm: f64) -> Result<LegAxis, AxisFault> {
    found(leg, stature_mm, crotch_mm, Tape::Leg(AxisFit::Centroids))
}

/// The paper's axis of a whole leg.
pub fn principal_axis(leg: &Leg, crotch_mm: f64) -> Result<LegAxis, AxisFault> {
    found(leg, STATURE_MM, crotch_mm, Tape::Leg(AxisFit::Principal))
}

fn found(leg: &Leg, stature_mm: f64, crotch_mm: f64, tape: Tape) -> Result<LegAxis, AxisFault> {
    axis_fit::find(leg, stature_mm, crotch_mm, tape).map(|found| found.axis)
}

/// The radius of an ellipse whose long axis points to the front and the back.
pub fn ellipse(long: f64, short: f64) -> impl Fn(f64, f64) -> f64 {
    move |angle: f64, _| long * short / (short * angle.cos()).hypot(long * angle.sin())
}

/// Angle between two directions, degrees.
pub fn off_deg(a: f64, b: f64) -> f64 {
    ((a - b + 180.0).rem_euclid(360.0) - 180.0).abs()
}

/// An edge of 5 mm on a mesh of regular cells leaves this of a girth, mm.
pub const REGULAR_MM: f64 = 0.01;

/// … on a mesh of scattered points, mm: edges are up to 8 mm long.
pub const SCATTERED_MM: f64 = 0.1;

/// … of the paper's fit, mm: its lines between points of both sides are chords of the skin.
pub const CHORDS_MM: f64 = 0.2;
