//! The leg's own axis, along which it is made upright (paper 1.1).
//!
//! The paper uses the first principal component of the points ([`principal_axis`]), which leans by
//! up to 3.6° towards the better visible side. A line through the centroids of sections, all with
//! equal weight, does not depend on how densely the skin was sampled ([`axis`]).

use nalgebra::{Matrix3, Point2, Point3, SymmetricEigen, Unit, Vector3};

use super::hull::Hull;
use super::slice::Crossing;
use crate::leg::parting::segment::Leg;
use crate::leg::side::Side;

/// The centroids for the axis start here, as a share of stature: above the foot.
const FROM_STATURE_SHARE: f64 = 0.066;

/// … and end here, as a share of the crotch's height: below the groin.
const TO_CROTCH_SHARE: f64 = 0.92;

/// Distance between the sections that provide centroids, mm.
const SPACING_MM: f64 = 20.0;

/// Sections are first horizontal, then perpendicular to the axis found; after three rounds the axis
/// moves by less than 0.01°.
const ROUNDS: usize = 3;

/// Fewer centroids than this are too few for an axis.
pub const CENTROIDS_MIN: usize = 10;

/// Fewer points than this are too few for an axis; a leg of an export has thousands.
pub const POINTS_MIN: usize = 100;

/// A leg that leans by more than this is not standing, degrees; A-poses lean by 6 to 11.
const TILT_MAX_DEG: f64 = 35.0;

/// A leg's axis with the frame of the sections perpendicular to it.
#[derive(Debug, Clone, PartialEq)]
pub struct LegAxis {
    /// The point where the axis meets the floor, z = 0; along-axis distances count from here, mm.
    pub foot: Point3<f64>,
    /// Unit vector up along the axis.
    pub direction: Unit<Vector3<f64>>,
    /// Unit vector of the section's plane that points to the front (angle 0°).
    pub front: Unit<Vector3<f64>>,
    /// Unit vector of the section's plane that points to the leg's lateral side (angle 90°).
    pub lateral: Unit<Vector3<f64>>,
}

/// Why a leg has no axis.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum AxisFault {
    /// Too few sections.
    #[error("{found} sections between ankle and groin; an axis needs {CENTROIDS_MIN}")]
    TooFewSections {
        /// Number found.
        found: usize,
    },
    /// Too few points.
    #[error("{found} points below the crotch; an axis needs {POINTS_MIN}")]
    TooFewPoints {
        /// Number found.
        found: usize,
    },
    /// The axis leans too far.
    #[error("the leg's axis leans by {tilt_deg:.0} degrees")]
    Leaning {
        /// Angle between the axis and the vertical, degrees.
        tilt_deg: f64,
    },
}

impl LegAxis {
    /// The axis through `through` with this direction, turned upwards if necessary.
    fn new(through: Point3<f64>, direction: Vector3<f64>, side: Side) -> LegAxis {
        let direction = Unit::new_normalize(direction * direction.z.signum());
        let foot = through - direction.into_inner() * (through.z / direction.z);
        let ahead = -Vector3::y();
        let front = Unit::new_normalize(ahead - direction.into_inner() * direction.dot(&ahead));
        let lateral = Unit::new_normalize(direction.cross(&front) * side.lateral_sign());
        LegAxis { foot, direction, front, lateral }
    }

    /// Angle between the axis and the vertical, degrees, 0 to 90.
    pub fn tilt_deg(&self) -> f64 {
        self.direction.z.clamp(-1.0, 1.0).acos().to_degrees()
    }

    /// Coordinates (front, lateral) of a point in the section plane through it, mm from the axis.
    pub fn in_plane(&self, point: &Point3<f64>) -> Point2<f64> {
        let from_foot = point - self.foot;
        Point2::new(self.front.dot(&from_foot), self.lateral.dot(&from_foot))
    }

    /// Distance of a point from the floor along the axis, mm.
    pub fn along(&self, point: &Point3<f64>) -> f64 {
        self.direction.dot(&(point - self.foot))
    }

    /// The point with these coordinates (front, lateral) in the section at `along_mm`.
    pub fn at(&self, along_mm: f64, in_plane: &Point2<f64>) -> Point3<f64> {
        self.foot
            + self.direction.into_inner() * along_mm
            + self.front.into_inner() * in_plane.x
            + self.lateral.into_inner() * in_plane.y
    }

    /// The points where the leg's skin crosses each section plane; `along_mm` must ascend.
    pub fn slices(&self, leg: &Leg, along_mm: &[f64]) -> Vec<Vec<Crossing>> {
        let zero = self.direction.dot(&self.foot.coords);
        let offsets: Vec<f64> = along_mm.iter().map(|along| along + zero).collect();
        leg.mesh.slices(&self.direction, &offsets)
    }

    /// Coordinates (front, lateral) of a slice's points, mm from the axis.
    pub fn points(&self, slice: &[Crossing]) -> Vec<Point2<f64>> {
        slice.iter().map(|crossing| self.in_plane(&crossing.position)).collect()
    }
}

/// Finds a leg's axis.
///
/// # Errors
/// An [`AxisFault`] if there are too few sections or the leg leans too far.
pub fn axis(leg: &Leg, stature_mm: f64, crotch_height_mm: f64) -> Result<LegAxis, AxisFault> {
    let (from_mm, to_mm) = (FROM_STATURE_SHARE * stature_mm, TO_CROTCH_SHARE * crotch_height_mm);
    let mut axis = LegAxis::new(Point3::origin(), Vector3::z(), leg.side);
    for _ in 0..ROUNDS {
        let count = ((to_mm - from_mm) / SPACING_MM / axis.direction.z).max(0.0) as usize;
        let along: Vec<f64> = (0..count)
            .map(|index| from_mm / axis.direction.z + SPACING_MM * index as f64)
            .collect();
        let slices = axis.slices(leg, &along);
        let centroid = |(along, slice): (&f64, &Vec<Crossing>)| {
            outline_centroid(&axis.points(slice)).map(|middle| axis.at(*along, &middle))
        };
        let centroids: Vec<Point3<f64>> = along.iter().zip(&slices).filter_map(centroid).collect();
        if centroids.len() < CENTROIDS_MIN {
            return Err(AxisFault::TooFewSections { found: centroids.len() });
        }
        let (through, direction) = line_through(&centroids);
        // Checked in every round, because the number of planes in the next one grows with the tilt.
        axis = standing(LegAxis::new(through, direction, leg.side))?;
    }
    Ok(axis)
}

/// Finds a leg's axis as in the paper: the first principal component of all its points below the
/// crotch, including the foot.
///
/// # Errors
/// An [`AxisFault`] if there are too few points or the leg leans too far.
pub fn principal_axis(leg: &Leg, crotch_height_mm: f64) -> Result<LegAxis, AxisFault> {
    let below = leg.mesh.points().iter().filter(|point| point.z <= crotch_height_mm);
    let points: Vec<Point3<f64>> = below.copied().collect();
    if points.len() < POINTS_MIN {
        return Err(AxisFault::TooFewPoints { found: points.len() });
    }
    let (through, direction) = line_through(&points);
    standing(LegAxis::new(through, direction, leg.side))
}

/// Refuses an axis that leans more than a standing leg's.
fn standing(axis: LegAxis) -> Result<LegAxis, AxisFault> {
    let tilt_deg = axis.tilt_deg();
    if tilt_deg.is_nan() || tilt_deg > TILT_MAX_DEG {
        return Err(AxisFault::Leaning { tilt_deg });
    }
    Ok(axis)
}

/// Centroid of the area inside an outline given as unordered points, ordered by their angle about
/// the middle of their hull; a gap is closed by its chord.
pub fn outline_centroid(points: &[Point2<f64>]) -> Option<Point2<f64>> {
    let middle = Hull::of(points)?.centroid();
    let arms = points.iter().map(|p| p - middle);
    let mut outline: Vec<_> = arms.map(|arm| (arm.y.atan2(arm.x), arm)).collect();
    outline.sort_by(|p, q| p.0.total_cmp(&q.0));
    let next = outline.iter().cycle().skip(1);
    let (mut moment, mut twice_area) = (nalgebra::Vector2::zeros(), 0.0);
    for ((_, p), (_, q)) in outline.iter().zip(next) {
        let cross = p.perp(q);
        moment += (p + q) * cross;
        twice_area += cross;
    }
    (twice_area > 0.0).then(|| middle + moment / (3.0 * twice_area))
}

/// The least-squares line: a point on it and its direction.
fn line_through(points: &[Point3<f64>]) -> (Point3<f64>, Vector3<f64>) {
    let middle =
        points.iter().fold(Vector3::zeros(), |sum, p| sum + p.coords) / points.len() as f64;
    let spread = points.iter().fold(Matrix3::zeros(), |sum, p| {
        let d = p.coords - middle;
        sum + d * d.transpose()
    });
    let eigen = SymmetricEigen::new(spread);
    (middle.into(), eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned())
}
