//! The two ends of a tube and the planes that close it.

use nalgebra::{Point3, Unit, Vector3};
use serde::{Deserialize, Serialize};

use gaiter_spline::Surface;

/// What a CAD file contains of a leg.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Shape {
    /// Only the surface, open at both ends.
    Tube,
    /// The body inside it, closed by a face at each end.
    Solid,
}

/// An end that lies closer to its plane than this counts as plane, mm: far above the rounding error
/// of coordinates of some metres, far below the accuracy of any CAD system.
pub const PLANE_MM: f64 = 1e-6;

/// One end of a tube.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The end where u begins.
    First,
    /// The end where u ends.
    Last,
}

impl End {
    fn word(self) -> &'static str {
        match self {
            End::First => "lower",
            End::Last => "upper",
        }
    }
}

/// Why a tube cannot be closed by planes.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the {} end of the surface is not plane: it leaves its plane by {off_mm:.6} mm", end.word())]
pub struct EndNotPlane {
    /// Which end.
    pub end: End,
    /// How far its points lie from the plane closest to them, mm; infinite if the end has no area.
    pub off_mm: f64,
}

/// The plane of an end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndPlane {
    /// A point in the plane: the middle of the end.
    pub place: Point3<f64>,
    /// The normal of the plane, pointing out of the tube.
    pub outward: Unit<Vector3<f64>>,
    /// A direction in the plane, towards where the end curve begins.
    pub across: Unit<Vector3<f64>>,
}

/// The planes of both ends, first end first.
///
/// # Errors
/// [`EndNotPlane`]: a point of an end's curve may lie further than [`PLANE_MM`] from its plane.
pub(crate) fn planes(surface: &Surface) -> Result<[EndPlane; 2], EndNotPlane> {
    // The first and the last row of control points, because the surface is clamped along.
    let (points, columns) = (surface.control_points(), surface.around().count());
    let (first, last) = (&points[..columns], &points[points.len() - columns..]);
    let (low, high) = (middle(first), middle(last));
    Ok([plane(first, high - low, End::First)?, plane(last, low - high, End::Last)?])
}

/// The plane of a ring of control points; `inward` points into the tube. The curve lies within the
/// hull of the points, so it is as plane as they are.
fn plane(ring: &[Point3<f64>], inward: Vector3<f64>, end: End) -> Result<EndPlane, EndNotPlane> {
    let place = middle(ring);
    let arms = || ring.iter().map(|point| point - place);
    let nexts = arms().cycle().skip(1);
    let area: Vector3<f64> = arms().zip(nexts).map(|(arm, next)| arm.cross(&next)).sum();
    let shapeless = EndNotPlane { end, off_mm: f64::INFINITY };
    let normal = Unit::try_new(area, f64::MIN_POSITIVE).ok_or(shapeless)?;
    let outward = if normal.dot(&inward) > 0.0 { -normal } else { normal };
    let off_mm = arms().map(|arm| arm.dot(&outward).abs()).fold(0.0, f64::max);
    let first = ring[0] - place;
    let across = first - outward.into_inner() * first.dot(&outward);
    let across = Unit::try_new(across, f64::MIN_POSITIVE).ok_or(shapeless)?;
    if off_mm <= PLANE_MM {
        Ok(EndPlane { place, outward, across })
    } else {
        Err(EndNotPlane { end, off_mm })
    }
}

fn middle(ring: &[Point3<f64>]) -> Point3<f64> {
    Point3::from(ring.iter().map(|point| point.coords).sum::<Vector3<f64>>() / ring.len() as f64)
}
