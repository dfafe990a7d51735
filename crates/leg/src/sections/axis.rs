//! A leg's axis, along which it is made upright (paper 1.1), and the planes of the tape across it.
//!
//! A tape lies square to the part of the leg it goes around. So the axis of [`Tape::Shank`] has two
//! straight parts, shank and thigh, and the planes turn from one to the other about the knee. The
//! planes make coordinates of the whole leg: which plane a point lies in, and where in it. In these
//! coordinates the leg is straight, and everything else works in them.
//!
//! [`Tape::Shank`]: crate::method::Tape::Shank

use nalgebra::{Point2, Point3, Vector3};

use super::bend::Bend;
use super::plane_frame::PlaneFrame;
use super::slice::Crossing;
use crate::parting::segment::Leg;
use crate::side::Side;

/// A leg's axis with the planes across it.
#[derive(Debug, Clone)]
pub struct LegAxis {
    /// The plane through the point where the axis of the shank meets the floor, z = 0. Distances along
    /// the axis count from here.
    pub foot: PlaneFrame,
    /// How the planes turn about the knee; `None` if all are parallel.
    pub bend: Option<Bend>,
}

impl LegAxis {
    /// A straight axis through a point.
    pub fn straight(through: Point3<f64>, direction: &Vector3<f64>, side: Side) -> LegAxis {
        let plane = PlaneFrame::new(through, direction, side);
        LegAxis { foot: plane.raised(-through.z / plane.normal.z), bend: None }
    }

    /// Angle between the shank's axis and the vertical, degrees, 0 to 90.
    pub fn tilt_deg(&self) -> f64 {
        self.foot.normal.z.clamp(-1.0, 1.0).acos().to_degrees()
    }

    /// Angle between the axes of shank and thigh, degrees; 0 if all planes are parallel.
    pub fn bend_deg(&self) -> f64 {
        self.bend.as_ref().map_or(0.0, Bend::angle_deg)
    }

    /// The bend, at a distance along the axis of the shank above which the planes turn.
    fn bend_at(&self, along_mm: f64) -> Option<&Bend> {
        self.bend.as_ref().filter(|bend| along_mm > bend.from_mm())
    }

    /// Distance along the axis of the plane in which a point lies, mm from the floor.
    pub fn along(&self, point: &Point3<f64>) -> f64 {
        let along_mm = self.foot.above(point);
        self.bend_at(along_mm).map_or(along_mm, |bend| bend.along(point))
    }

    /// Distance along the axis at which it is this high above the floor, mm.
    pub fn along_at_height(&self, height_mm: f64) -> f64 {
        let along_mm = height_mm / self.foot.normal.z;
        self.bend_at(along_mm).map_or(along_mm, |bend| bend.along_at_height(height_mm))
    }

    /// The plane at a distance along the axis.
    pub fn plane(&self, along_mm: f64) -> PlaneFrame {
        self.bend_at(along_mm)
            .map_or_else(|| self.foot.raised(along_mm), |bend| bend.plane(along_mm))
    }

    /// The place of a point in the straightened leg: the distance along the axis of the plane in which it
    /// lies, and its coordinates (front, lateral) there, mm.
    pub fn place(&self, point: &Point3<f64>) -> (f64, Point2<f64>) {
        let along_mm = self.foot.above(point);
        match self.bend_at(along_mm) {
            Some(bend) => {
                let (along_mm, plane) = bend.plane_of(point);
                (along_mm, plane.coordinates(point))
            }
            None => (along_mm, self.foot.coordinates(point)),
        }
    }

    /// The point with these coordinates (front, lateral) in the plane at `along_mm`.
    pub fn at(&self, along_mm: f64, in_plane: &Point2<f64>) -> Point3<f64> {
        self.plane(along_mm).point(in_plane)
    }

    /// The points where the leg's skin crosses each plane; `along_mm` must ascend.
    pub fn slices(&self, leg: &Leg, along_mm: &[f64]) -> Vec<Vec<Crossing>> {
        let heights: Vec<f64> = leg.mesh.points().iter().map(|point| self.along(point)).collect();
        leg.mesh.slices_at(&heights, along_mm, |along_mm| self.plane(along_mm).normal)
    }

    /// Coordinates (front, lateral) of the points of a slice, mm from the axis.
    pub fn points(&self, along_mm: f64, slice: &[Crossing]) -> Vec<Point2<f64>> {
        let plane = self.plane(along_mm);
        slice.iter().map(|crossing| plane.coordinates(&crossing.position)).collect()
    }
}
