//! How the planes of the tape turn from square to the shank to square to the thigh.
//!
//! Between two heights, 0.30 and 0.38 of the stature, a plane stands on the middle of the leg's
//! horizontal section at its height z and is square to (1 − w)·s + w·t, w = smoothstep. Its distance
//! along the axis is a cubic of z that continues the distances along shank and thigh with their
//! slopes, so that the coordinates are smooth across both ends.

use gaiter_spline::{Basis, Smoothing, Spline, fit};
use nalgebra::{Point2, Point3, Unit, Vector3};

use super::plane_frame::PlaneFrame;
use crate::side::Side;

/// The planes turn from this share of the stature …
pub(super) const FROM_STATURE_SHARE: f64 = 0.30;

/// … to this one.
const TO_STATURE_SHARE: f64 = 0.38;

/// Steps of the search for the plane of a point; each halves the error at least, most square it.
const STEPS_MAX: usize = 60;

/// The search ends when the plane passes the point by less than this, mm.
const CLOSE_MM: f64 = 1e-6;

/// Number of steps of the planes that narrow the search for the plane of a point.
const SOME: usize = 32;

/// A straight line with its direction upwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// A point on it.
    pub through: Point3<f64>,
    /// Unit vector along it, z > 0.
    pub direction: Unit<Vector3<f64>>,
}

impl Line {
    /// The point of the line at a height, mm.
    pub fn at_height(&self, height_mm: f64) -> Point3<f64> {
        let rise_mm = height_mm - self.through.z;
        self.through + self.direction.into_inner() * (rise_mm / self.direction.z)
    }
}

/// The middle of a leg's horizontal sections, x and y over the height, as smooth curves, mm.
pub type Middle = [Spline; 2];

/// Length of the pieces of the middle's curves, mm.
pub(super) const MIDDLE_INTERVAL_MM: f64 = 60.0;

/// The middle from one place along a leg to another, as smooth curves through points at places.
pub(super) fn middle(
    [from_mm, to_mm]: [f64; 2],
    places_mm: &[f64],
    points: &[Point2<f64>],
) -> Option<Middle> {
    let intervals = ((to_mm - from_mm) / MIDDLE_INTERVAL_MM).ceil() as usize;
    let basis = Basis::uniform_clamped(from_mm, to_mm, intervals).ok()?;
    let weights = vec![1.0; places_mm.len()];
    let curve = |axis: usize| {
        let values: Vec<f64> = points.iter().map(|point| point[axis]).collect();
        fit(&basis, places_mm, &values, &weights, Smoothing::None).ok()
    };
    Some([curve(0)?, curve(1)?])
}

/// The turn of the planes about the knee.
#[derive(Debug, Clone)]
pub struct Bend {
    side: Side,
    shank: Line,
    /// The axis of the thigh.
    pub thigh: Line,
    pub(super) middle: Middle,
    /// The heights between which the planes turn, mm.
    height_mm: [f64; 2],
    /// The distances along the axis of the first and the last plane that turns, mm.
    along_mm: [f64; 2],
    /// Distance along the axis per height at these two.
    slope: [f64; 2],
    /// The last plane that turns. Those above are parallel to it.
    top: PlaneFrame,
    /// Some of the planes that turn, at equal shares, as normal and offset: they narrow the search for
    /// the plane of a point.
    some: Vec<(Vector3<f64>, f64)>,
}

impl Bend {
    /// The turn from a shank whose axis starts at `foot` to a thigh, on a leg with this middle.
    pub fn new(
        foot: &PlaneFrame,
        thigh: Line,
        middle: Middle,
        stature_mm: f64,
        side: Side,
    ) -> Bend {
        let height_mm = [FROM_STATURE_SHARE, TO_STATURE_SHARE].map(|share| share * stature_mm);
        let shank = Line { through: foot.origin, direction: foot.normal };
        let mut bend = Bend {
            side,
            shank,
            thigh,
            middle,
            height_mm,
            along_mm: [0.0; 2],
            slope: [1.0; 2],
            top: *foot,
            some: Vec::new(),
        };
        let [low_mm, high_mm] = height_mm;
        bend.slope = [(low_mm, &shank), (high_mm, &thigh)]
            .map(|(height_mm, line)| line.direction.dot(&bend.middle_slope(height_mm)));
        bend.along_mm[0] = foot.above(&bend.middle_at(low_mm));
        bend.along_mm[1] = bend.along_of(1.0);
        bend.top = bend.turned(1.0);
        let some = (0..=SOME).map(|index| {
            let share = index as f64 / SOME as f64;
            let normal = bend.normal(share);
            (normal, normal.dot(&bend.middle_at(bend.height_of(share)).coords))
        });
        bend.some = some.collect();
        bend
    }

    /// Angle between the axes of shank and thigh, degrees.
    pub fn angle_deg(&self) -> f64 {
        self.shank.direction.angle(&self.thigh.direction).to_degrees()
    }

    /// Distance along the axis up to which all planes are square to the shank, mm.
    pub fn from_mm(&self) -> f64 {
        self.along_mm[0]
    }

    /// The plane at a distance along the axis above [`Bend::from_mm`].
    pub fn plane(&self, along_mm: f64) -> PlaneFrame {
        let beyond_mm = along_mm - self.along_mm[1];
        if beyond_mm >= 0.0 {
            return self.top.raised(beyond_mm);
        }
        let share = root(|share| self.along_of(share) - along_mm, 0.0, 1.0);
        self.turned(share)
    }

    /// The plane in which a point above [`Bend::from_mm`] lies, and its distance along the axis, mm.
    pub(super) fn plane_of(&self, point: &Point3<f64>) -> (f64, PlaneFrame) {
        let beyond_mm = self.top.above(point);
        if beyond_mm >= 0.0 {
            return (self.along_mm[1] + beyond_mm, self.top.raised(beyond_mm));
        }
        let share = self.share_of(point);
        (self.along_of(share), self.turned(share))
    }

    /// Distance along the axis of the plane in which a point above [`Bend::from_mm`] lies, mm.
    pub fn along(&self, point: &Point3<f64>) -> f64 {
        let beyond_mm = self.top.above(point);
        match beyond_mm >= 0.0 {
            true => self.along_mm[1] + beyond_mm,
            false => self.along_of(self.share_of(point)),
        }
    }

    /// The share of the turn at which a point lies.
    fn share_of(&self, point: &Point3<f64>) -> f64 {
        let below = |share: f64| {
            let middle = self.middle_at(self.height_of(share));
            -self.normal(share).dot(&(point - middle))
        };
        // The first plane above the point. At least the lowest one is below it.
        let is_below =
            |(normal, offset): &(Vector3<f64>, f64)| normal.dot(&point.coords) >= *offset;
        let above = self.some.partition_point(is_below).clamp(1, SOME);
        let [low, high] = [above - 1, above].map(|index| index as f64 / SOME as f64);
        root(below, low, high)
    }

    /// Distance along the axis of the plane that stands at a height above the first one that turns, mm.
    pub fn along_at_height(&self, height_mm: f64) -> f64 {
        let [low_mm, high_mm] = self.height_mm;
        let share = ((height_mm - low_mm) / (high_mm - low_mm)).clamp(0.0, 1.0);
        let beyond_mm = (height_mm - self.top.origin.z) / self.top.normal.z;
        if share < 1.0 { self.along_of(share) } else { self.along_mm[1] + beyond_mm.max(0.0) }
    }

    /// The plane at a share of the turn's height.
    fn turned(&self, share: f64) -> PlaneFrame {
        let (height_mm, weight) = (self.height_of(share), smoothstep(share));
        let [shank, thigh] = [&self.shank, &self.thigh].map(|line| line.at_height(height_mm));
        let between = shank + (thigh - shank) * weight;
        let plane = PlaneFrame::new(between, &self.normal(share), self.side);
        plane.raised(plane.above(&self.middle_at(height_mm)))
    }

    fn normal(&self, share: f64) -> Vector3<f64> {
        let weight = smoothstep(share);
        let [shank, thigh] = [&self.shank, &self.thigh].map(|line| line.direction.into_inner());
        (shank * (1.0 - weight) + thigh * weight).normalize()
    }

    fn height_of(&self, share: f64) -> f64 {
        let [low_mm, high_mm] = self.height_mm;
        low_mm + (high_mm - low_mm) * share
    }

    /// Distance along the axis at a share of the turn's height, mm: its slope goes from the first to
    /// the last as the planes turn.
    fn along_of(&self, share: f64) -> f64 {
        let ([low_mm, high_mm], [first, last]) = (self.height_mm, self.slope);
        let turned = share.powi(3) - share.powi(4) / 2.0;
        self.along_mm[0] + (high_mm - low_mm) * (first * share + (last - first) * turned)
    }

    fn middle_at(&self, height_mm: f64) -> Point3<f64> {
        // Both curves have the same basis.
        let [x, y] = &self.middle;
        let row = x.basis.row(height_mm);
        Point3::new(row.dot(&x.coefficients), row.dot(&y.coefficients), height_mm)
    }

    fn middle_slope(&self, height_mm: f64) -> Vector3<f64> {
        let [x, y] = self.middle.each_ref().map(|curve| curve.derivatives(height_mm)[1]);
        Vector3::new(x, y, 1.0)
    }
}

/// From 0 to 1 with a slope of 0 at both ends.
fn smoothstep(share: f64) -> f64 {
    let share = share.clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// Where an ascending function is 0 between two places; the nearer one if it is nowhere 0 between them. By
/// secants, and by halves where they are slow (the Illinois method).
fn root(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let ([mut at_low, mut at_high], mut last) = ([function(low), function(high)], 0);
    if at_low >= 0.0 {
        return low;
    }
    if at_high <= 0.0 {
        return high;
    }
    let mut place = low;
    for _ in 0..STEPS_MAX {
        place = (low * at_high - high * at_low) / (at_high - at_low);
        let at = function(place);
        if at.abs() < CLOSE_MM {
            break;
        }
        if at < 0.0 {
            (low, at_low) = (place, at);
            at_high /= if last == -1 { 2.0 } else { 1.0 };
            last = -1;
        } else {
            (high, at_high) = (place, at);
            at_low /= if last == 1 { 2.0 } else { 1.0 };
            last = 1;
        }
    }
    place
}
