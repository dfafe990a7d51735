//! A plane across the leg with its own coordinates.

use nalgebra::{Point2, Point3, Unit, Vector3};

use crate::side::Side;

/// A plane across the leg, with an origin and the directions in which angles around it are counted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneFrame {
    /// The origin of the plane's coordinates, body frame.
    pub origin: Point3<f64>,
    /// Unit normal, up along the leg.
    pub normal: Unit<Vector3<f64>>,
    /// Unit vector in the plane that points to the front (angle 0°).
    pub front: Unit<Vector3<f64>>,
    /// Unit vector in the plane that points to the leg's lateral side (angle 90°).
    pub lateral: Unit<Vector3<f64>>,
}

impl PlaneFrame {
    /// The plane through a point, square to a direction, which is turned upwards if necessary. A
    /// direction along y, to which no front belongs, is no leg's: see `axis::TILT_MAX_DEG`.
    pub fn new(origin: Point3<f64>, direction: &Vector3<f64>, side: Side) -> PlaneFrame {
        let normal = Unit::new_normalize(direction * direction.z.signum());
        let ahead = -Vector3::y();
        let front = Unit::new_normalize(ahead - normal.into_inner() * normal.dot(&ahead));
        let lateral = Unit::new_normalize(normal.cross(&front) * side.lateral_sign());
        PlaneFrame { origin, normal, front, lateral }
    }

    /// The parallel plane that is this much higher, mm.
    pub fn raised(&self, by_mm: f64) -> PlaneFrame {
        PlaneFrame { origin: self.origin + self.normal.into_inner() * by_mm, ..*self }
    }

    /// Distance of a point above the plane, mm.
    pub fn above(&self, point: &Point3<f64>) -> f64 {
        self.normal.dot(&(point - self.origin))
    }

    /// Coordinates (front, lateral) of a point's projection onto the plane, mm from the origin.
    pub fn coordinates(&self, point: &Point3<f64>) -> Point2<f64> {
        let from_origin = point - self.origin;
        Point2::new(self.front.dot(&from_origin), self.lateral.dot(&from_origin))
    }

    /// The point with these coordinates (front, lateral).
    pub fn point(&self, at: &Point2<f64>) -> Point3<f64> {
        self.origin + self.front.into_inner() * at.x + self.lateral.into_inner() * at.y
    }
}
