//! Finds the axes of a leg.
//!
//! The paper uses the first principal component of the points (`principal_axis`), which leans by
//! up to 3.6° towards the better visible side. A line through the centroids of sections, all with
//! equal weight, does not depend on how densely the skin was sampled.

use nalgebra::{Matrix3, Point2, Point3, SymmetricEigen, Unit, Vector3};

use super::axis::LegAxis;
use super::bend::{self, Bend, Line, MIDDLE_INTERVAL_MM, Middle};
use super::centroid::outline_centroid;
use super::plane_frame::PlaneFrame;
use crate::method::{AxisFit, Tape};
use crate::parting::segment::Leg;

/// The centroids for the axis of the whole leg start here, as a share of stature: above the foot.
const LEG_FROM_STATURE_SHARE: f64 = 0.066;

/// … and end here, as a share of the crotch's height: below the groin.
const LEG_TO_CROTCH_SHARE: f64 = 0.92;

/// Distance between the sections that give the axis of the whole leg, mm.
const LEG_SPACING_MM: f64 = 20.0;

/// The axis of the shank: between these shares of stature, above the malleoli and below the knee.
const SHANK_STATURE_SHARE: [f64; 2] = [0.06, 0.28];

/// The axis of the thigh: between these shares of stature …
const THIGH_STATURE_SHARE: [f64; 2] = [0.36, 0.43];

/// … but no nearer to the crotch than this, mm, where the skin of the other leg begins …
const THIGH_BELOW_CROTCH_MM: f64 = 25.0;

/// … and over this length at least, mm.
const THIGH_LENGTH_MIN_MM: f64 = 60.0;

/// Distance between the sections that give the axes of shank and thigh, mm.
const SPACING_MM: f64 = 8.0;

/// Sections are first horizontal, then square to the axis found, until that moves by less than this,
/// degrees.
const STILL_DEG: f64 = 0.01;

/// An axis that still moves after this many rounds oscillates by less than the noise of its centroids.
const ROUNDS_MAX: usize = 8;

/// Fewer centroids than this are too few for the axis of a leg or a shank.
const CENTROIDS_MIN: usize = 10;

/// Fewer than this are too few for that of a thigh, of which 60 mm at least are looked at.
const THIGH_CENTROIDS_MIN: usize = 5;

/// Fewer points than this are too few for an axis; a leg of an export has thousands.
const POINTS_MIN: usize = 100;

/// A leg that leans by more than this is not standing, degrees; A-poses lean by 6 to 11.
const TILT_MAX_DEG: f64 = 35.0;

/// Above this bend, degrees, two planes could meet within 80 mm of the axis of a tall person's knee: their
/// spacing there is 0.08 of the stature over 1.5 times the bend.
const BEND_MAX_DEG: f64 = 55.0;

/// The middle of the leg is looked at over these shares of stature: beyond the turn of the planes, also
/// if the stature is 4 % off.
const MIDDLE_STATURE_SHARE: [f64; 2] = [0.265, 0.415];

coded_enum! {
    /// Why a leg has no axis.
    #[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
    pub enum AxisFault {
        /// Too few sections.
        #[error("{found} sections between ankle and groin; an axis needs {needed}")]
        TooFewSections {
            /// Number found.
            found: usize,
            /// Number needed.
            needed: usize,
        } => "axis-too-few-sections",
        /// Too few points.
        #[error("{found} points below the crotch; an axis needs {needed}")]
        TooFewPoints {
            /// Number found.
            found: usize,
            /// Number needed.
            needed: usize,
        } => "axis-too-few-points",
        /// The axis leans too far.
        #[error("the leg's axis leans by {tilt_deg:.0} degrees")]
        Leaning {
            /// Angle between the axis and the vertical, degrees.
            tilt_deg: f64,
        } => "axis-leans",
    }
}

coded_enum! {
    /// Why the planes do not turn towards the thigh, but stay square to the shank.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum NoThigh {
        /// Too little of the thigh or of the knee was seen.
        NotSeen => "thigh-not-seen",
        /// The knee is bent too far.
        TooBent {
            /// Angle between the axes of shank and thigh, degrees.
            bend_deg: f64,
        } => "knee-bent-too-far",
    }
}

/// A leg's axis, and why its planes do not turn, where they should.
#[derive(Debug, Clone)]
pub struct FoundAxis {
    /// The axis.
    pub axis: LegAxis,
    /// Why it has no thigh.
    pub no_thigh: Option<NoThigh>,
}

/// Finds a leg's axis for a way of holding the tape. `top_mm` is the height of the crotch, or of the end
/// of what was seen of the leg, mm.
///
/// # Errors
/// An [`AxisFault`] if there are too few sections or points, or if the leg leans too far.
pub fn find(leg: &Leg, stature_mm: f64, top_mm: f64, tape: Tape) -> Result<FoundAxis, AxisFault> {
    let straight = |line: Line| LegAxis::straight(line.through, &line.direction, leg.side);
    let whole = |axis| Ok(FoundAxis { axis, no_thigh: None });
    match tape {
        Tape::Shank => shank_and_thigh(leg, stature_mm, top_mm),
        Tape::Leg(AxisFit::Centroids) => whole(straight(leg_line(leg, stature_mm, top_mm)?)),
        Tape::Leg(AxisFit::Principal) => whole(straight(principal_axis(leg, top_mm)?)),
        Tape::Horizontal => {
            let line = leg_line(leg, stature_mm, top_mm)?;
            whole(straight(Line { direction: Vector3::z_axis(), ..line }))
        }
    }
}

/// The axis whose planes are square to the shank up to the knee, and to the thigh above it.
fn shank_and_thigh(leg: &Leg, stature_mm: f64, top_mm: f64) -> Result<FoundAxis, AxisFault> {
    let shank = line(leg, &shank_stretch(stature_mm))?;
    let axis = LegAxis::straight(shank.through, &shank.direction, leg.side);
    let (bend, no_thigh) = match thigh(leg, stature_mm, top_mm) {
        Ok((thigh, middle)) => {
            let bend = Bend::new(&axis.foot, thigh, middle, stature_mm, leg.side);
            match bend.angle_deg() {
                bend_deg if bend_deg > BEND_MAX_DEG => (None, Some(NoThigh::TooBent { bend_deg })),
                _ => (Some(bend), None),
            }
        }
        // A leg that ends below the knee needs none.
        Err(why) => (None, (top_mm > bend::FROM_STATURE_SHARE * stature_mm).then_some(why)),
    };
    Ok(FoundAxis { axis: LegAxis { bend, ..axis }, no_thigh })
}

/// The axis of shank and thigh that a leg would have with another stature, which differs by a few percent:
/// one round on from the one found. `None` if too little was seen there.
pub(crate) fn for_stature(
    leg: &Leg,
    axis: &LegAxis,
    stature_mm: f64,
    top_mm: f64,
) -> Option<LegAxis> {
    let shank = Line { through: axis.foot.origin, direction: axis.foot.normal };
    let shank = next_line(leg, &shank, &shank_stretch(stature_mm)).ok()?;
    let straight = LegAxis::straight(shank.through, &shank.direction, leg.side);
    let Some(bend) = &axis.bend else { return Some(straight) };
    let thigh = next_line(leg, &bend.thigh, &thigh_stretch(stature_mm, top_mm)).ok()?;
    let bend = Bend::new(&straight.foot, thigh, bend.middle.clone(), stature_mm, leg.side);
    Some(LegAxis { bend: Some(bend), ..straight })
}

fn shank_stretch(stature_mm: f64) -> Stretch {
    let height_mm = SHANK_STATURE_SHARE.map(|share| share * stature_mm);
    Stretch { height_mm, spacing_mm: SPACING_MM, least: CENTROIDS_MIN }
}

fn thigh_stretch(stature_mm: f64, top_mm: f64) -> Stretch {
    let [low, high] = THIGH_STATURE_SHARE.map(|share| share * stature_mm);
    let to_mm = high.min(top_mm - THIGH_BELOW_CROTCH_MM);
    let from_mm = low.min(to_mm - THIGH_LENGTH_MIN_MM);
    Stretch { height_mm: [from_mm, to_mm], spacing_mm: SPACING_MM, least: THIGH_CENTROIDS_MIN }
}

/// The axis of the thigh, and the middle of the leg about the knee.
fn thigh(leg: &Leg, stature_mm: f64, top_mm: f64) -> Result<(Line, Middle), NoThigh> {
    let thigh = line(leg, &thigh_stretch(stature_mm, top_mm)).map_err(|_| NoThigh::NotSeen)?;
    Ok((thigh, middle(leg, stature_mm).ok_or(NoThigh::NotSeen)?))
}

/// The axis of the whole leg.
fn leg_line(leg: &Leg, stature_mm: f64, crotch_height_mm: f64) -> Result<Line, AxisFault> {
    let height_mm = [LEG_FROM_STATURE_SHARE * stature_mm, LEG_TO_CROTCH_SHARE * crotch_height_mm];
    line(leg, &Stretch { height_mm, spacing_mm: LEG_SPACING_MM, least: CENTROIDS_MIN })
}

/// The axis of a straight body between two heights, mm.
///
/// # Errors
/// An [`AxisFault`] if there are too few sections, or if it leans too far.
pub(crate) fn straight_line(leg: &Leg, height_mm: [f64; 2]) -> Result<Line, AxisFault> {
    line(leg, &Stretch { height_mm, spacing_mm: SPACING_MM, least: CENTROIDS_MIN })
}

/// The line through the centroids of the sections square to it, where it is between two heights.
fn line(leg: &Leg, along: &Stretch) -> Result<Line, AxisFault> {
    let mut line = Line { through: Point3::origin(), direction: Vector3::z_axis() };
    for _ in 0..ROUNDS_MAX {
        let next = next_line(leg, &line, along)?;
        let moved_deg = next.direction.angle(&line.direction).to_degrees();
        line = next;
        if moved_deg < STILL_DEG {
            break;
        }
    }
    Ok(line)
}

/// A stretch of a leg, and how its axis is looked for.
struct Stretch {
    /// From this height to that, mm.
    height_mm: [f64; 2],
    spacing_mm: f64,
    /// Fewer centroids than this are too few.
    least: usize,
}

/// The line through the centroids of the sections square to a line, where that is between two heights.
fn next_line(leg: &Leg, line: &Line, along: &Stretch) -> Result<Line, AxisFault> {
    let Stretch { height_mm: [from_mm, to_mm], spacing_mm, least } = *along;
    let plane = PlaneFrame::new(line.at_height(from_mm), &line.direction, leg.side);
    let length_mm = (to_mm - from_mm) / line.direction.z;
    let count = (length_mm / spacing_mm).max(0.0) as usize + 1;
    let planes: Vec<PlaneFrame> =
        (0..count).map(|index| plane.raised(spacing_mm * index as f64)).collect();
    let centroids = centroids(leg, &planes);
    if centroids.len() < least {
        return Err(AxisFault::TooFewSections { found: centroids.len(), needed: CENTROIDS_MIN });
    }
    standing(line_through(&centroids))
}

/// The centroids of the leg's sections in parallel planes, which ascend.
fn centroids(leg: &Leg, planes: &[PlaneFrame]) -> Vec<Point3<f64>> {
    let Some(first) = planes.first() else { return Vec::new() };
    let offsets: Vec<f64> =
        planes.iter().map(|plane| first.normal.dot(&plane.origin.coords)).collect();
    let slices = leg.mesh.slices(&first.normal, &offsets);
    let centroid = |(plane, slice): (&PlaneFrame, Vec<super::slice::Crossing>)| {
        let points = slice.iter().map(|crossing| plane.coordinates(&crossing.position));
        Some(plane.point(&outline_centroid(&points.collect::<Vec<_>>())?))
    };
    planes.iter().zip(slices).filter_map(centroid).collect()
}

/// The middle of the leg about the knee.
fn middle(leg: &Leg, stature_mm: f64) -> Option<Middle> {
    let [from_mm, to_mm] = MIDDLE_STATURE_SHARE.map(|share| share * stature_mm);
    let count = ((to_mm - from_mm) / SPACING_MM) as usize;
    let base = PlaneFrame::new(Point3::origin(), &Vector3::z(), leg.side);
    let step_mm = (to_mm - from_mm) / count.max(1) as f64;
    let planes: Vec<PlaneFrame> =
        (0..=count).map(|index| base.raised(from_mm + step_mm * index as f64)).collect();
    let centroids = centroids(leg, &planes);
    let heights: Vec<f64> = centroids.iter().map(|centroid| centroid.z).collect();
    let (low, high) = (heights.first()?, heights.last()?);
    // Beyond what was seen the curve would be a guess.
    if low - from_mm > MIDDLE_INTERVAL_MM / 2.0 || to_mm - high > MIDDLE_INTERVAL_MM / 2.0 {
        return None;
    }
    let points: Vec<Point2<f64>> = centroids.iter().map(|centroid| centroid.xy()).collect();
    bend::middle([from_mm, to_mm], &heights, &points)
}

/// The axis of a leg as in the paper: the first principal component of all its points below the
/// crotch, including the foot.
fn principal_axis(leg: &Leg, crotch_height_mm: f64) -> Result<Line, AxisFault> {
    let below = leg.mesh.points().iter().filter(|point| point.z <= crotch_height_mm);
    let points: Vec<Point3<f64>> = below.copied().collect();
    if points.len() < POINTS_MIN {
        return Err(AxisFault::TooFewPoints { found: points.len(), needed: POINTS_MIN });
    }
    standing(line_through(&points))
}

/// Refuses an axis that leans more than a standing leg's.
fn standing(line: Line) -> Result<Line, AxisFault> {
    let tilt_deg = line.direction.z.clamp(-1.0, 1.0).acos().to_degrees();
    if tilt_deg.is_nan() || tilt_deg > TILT_MAX_DEG {
        return Err(AxisFault::Leaning { tilt_deg });
    }
    Ok(line)
}

/// The least-squares line, upwards.
fn line_through(points: &[Point3<f64>]) -> Line {
    let middle =
        points.iter().fold(Vector3::zeros(), |sum, p| sum + p.coords) / points.len() as f64;
    let spread = points.iter().fold(Matrix3::zeros(), |sum, p| {
        let d = p.coords - middle;
        sum + d * d.transpose()
    });
    let eigen = SymmetricEigen::new(spread);
    let direction = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    let direction = Unit::new_normalize(direction * direction.z.signum());
    Line { through: middle.into(), direction }
}
