//! The foot: its length and breadth, Y over heel and instep, and A around the metatarsal heads.
//!
//! Scanners do not see the soles of standing feet. Y is still a closed section, because its plane
//! leaves the foot at the rounding of the heel, some millimetres above the floor. A is not; its
//! tape is closed along the floor.

use std::f64::consts::TAU;

use nalgebra::{Point2, Point3, Unit, Vector2, Vector3};

use super::landmark::{Estimate, Landmark};
use super::level_reading::{GAP_DOUBT_DEG, section_doubts};
use crate::doubt::Doubt;
use crate::frame::stance::{FOOT_LENGTH_SHARE, FOOT_POINTS_MIN, FOOT_SHARE};
use crate::level::{By, Level};
use crate::method::SectionFit;
use crate::parting::segment::Leg;
use crate::sections::axis::LegAxis;
use crate::sections::equidistant::sections;
use crate::sections::hull::Hull;
use crate::sections::plane_frame::PlaneFrame;
use crate::sections::section::Section;
use crate::statistics::{GAP_MAX_DEG, largest_gap_deg, range};

/// Both ends of a foot are round: a slice of this length at the end …
const END_MM: f64 = 5.0;

/// … is no broader than this share of the foot. A broader one means that the scan ends, not the foot.
const END_BREADTH_SHARE: f64 = 0.75;

/// The foot ends where only this many points lie beyond, because one or two noisy points are not a toe.
const BEYOND: usize = 2;

/// Y's plane passes through the line where the vertical behind the heel meets the floor. Both are
/// uncertain by this, mm; the floor depends on how much of the soles was seen.
const HEEL_SD_MM: f64 = 2.0;

/// Y's section uses the skin this far on both sides of its plane, mm.
const Y_REACH_MM: f64 = 24.0;

/// The change of girth and height with the plane's position is measured this far on both sides of
/// it, mm.
const Y_BESIDE_MM: f64 = 4.0;

/// Head of the first metatarsal as a share of the foot's length from the heel: 0.735 ± 0.008, from
/// ball-of-foot length over foot length in ANSUR II (first 28 men of the table).
const MEDIAL_SHARE: f64 = 0.735;

/// … and of the fifth: the usual ball line of shoe lasts, 0.1 of the length behind the first.
const LATERAL_SHARE: f64 = 0.635;

/// Standard deviation of these shares among people; ANSUR II has no lateral one.
const SHARE_SD: f64 = 0.02;

/// Standard error of A's girth from closing it along the floor, mm: a sole's edge is rounded by
/// some millimetres.
const SOLE_SD_MM: f64 = 2.0;

/// The skin at a point of the foot's edge is searched for this far ahead and behind, mm.
const EDGE_REACH_MM: f64 = 6.0;

/// The forefoot is lower than this share of stature; points of a plane above it belong to the leg.
const FOREFOOT_STATURE_SHARE: f64 = 0.08;

/// Dimensions of a foot as a whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// From the heel to the longest toe, along the foot, mm.
    pub length_mm: f64,
    /// Largest breadth, perpendicular to the length, mm.
    pub breadth_mm: f64,
}

/// The measurements of a foot.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FootReport {
    /// The foot as a whole.
    pub foot: Foot,
    /// A, by proportion.
    pub a: Option<Estimate>,
    /// Y, if its section was seen.
    pub y: Option<Landmark>,
}

/// Measures a leg's foot; `None` if it was not seen from heel to toes.
pub(crate) fn foot(
    leg: &Leg,
    axis: &LegAxis,
    stature_mm: f64,
    fit: SectionFit,
) -> Option<FootReport> {
    let frame = Frame::new(leg, stature_mm)?;
    let foot = Foot { length_mm: frame.length_mm, breadth_mm: frame.breadth_mm };
    Some(FootReport { foot, a: a(leg, axis, &frame, stature_mm), y: y(leg, axis, &frame, fit) })
}

/// A foot's own frame on the floor.
struct Frame {
    /// The back edge of the heel, on the foot's middle line.
    heel: Point2<f64>,
    /// Unit vector towards the toes.
    ahead: Vector2<f64>,
    /// Unit vector towards the leg's lateral side.
    lateral: Vector2<f64>,
    length_mm: f64,
    breadth_mm: f64,
    /// The points of the foot, (ahead, lateral) from the heel, mm.
    points: Vec<Point2<f64>>,
}

impl Frame {
    fn new(leg: &Leg, stature_mm: f64) -> Option<Frame> {
        let low = leg.mesh.points().iter().filter(|p| p.z < FOOT_SHARE * stature_mm);
        let points: Vec<Point2<f64>> = low.map(|p| p.xy()).collect();
        if points.len() < FOOT_POINTS_MIN {
            return None;
        }
        let hull = Hull::from_points(&points)?;
        let (long, centre) = (hull.long_axis(), hull.centroid());
        // The toes point to −Y, however far the foot is turned out.
        let ahead = if long.y < 0.0 { long } else { -long };
        let lateral = Vector2::new(-ahead.y, ahead.x) * leg.side.lateral_sign();
        let [back_mm, toes_mm] = extent_mm(points.iter().map(|p| (p - centre).dot(&ahead)))?;
        let [left_mm, right_mm] = extent_mm(points.iter().map(|p| (p - centre).dot(&lateral)))?;
        let heel = centre + ahead * back_mm;
        let (length_mm, breadth_mm) = (toes_mm - back_mm, right_mm - left_mm);
        let own = points.iter().map(|p| p - heel);
        let points = own.map(|p| Point2::new(p.dot(&ahead), p.dot(&lateral))).collect();
        let frame = Frame { heel, ahead, lateral, length_mm, breadth_mm, points };
        let [shortest, longest] = FOOT_LENGTH_SHARE;
        let is_foot = (shortest..=longest).contains(&(length_mm / stature_mm));
        (is_foot && frame.has_round_ends()).then_some(frame)
    }

    /// Whether the foot narrows towards both ends, as whole feet do and cut ones do not.
    fn has_round_ends(&self) -> bool {
        let ends = [[0.0, END_MM], [self.length_mm - END_MM, self.length_mm]];
        ends.iter().all(|&[from_mm, to_mm]| {
            let end = self.points.iter().filter(|p| (from_mm..=to_mm).contains(&p.x));
            let [low, high] = range(end.map(|p| p.y));
            high - low <= END_BREADTH_SHARE * self.breadth_mm
        })
    }

    /// The edge of the foot on one side, `sign` +1 lateral, at a share of its length.
    fn edge(&self, share: f64, sign: f64) -> Option<Point2<f64>> {
        let ahead_mm = share * self.length_mm;
        let near = self.points.iter().filter(|p| (p.x - ahead_mm).abs() < EDGE_REACH_MM);
        let aside_mm = near.map(|p| sign * p.y).max_by(f64::total_cmp)?;
        Some(Point2::new(ahead_mm, sign * aside_mm))
    }

    /// A point on the floor, (ahead, lateral) from the heel, in the body frame.
    fn on_floor(&self, point: &Point2<f64>) -> Point3<f64> {
        let place = self.heel + self.ahead * point.x + self.lateral * point.y;
        Point3::new(place.x, place.y, 0.0)
    }
}

/// Minimum and maximum of the values without the outermost few; `None` if there are no others.
fn extent_mm(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let inner = sorted.get(BEYOND..sorted.len().checked_sub(BEYOND)?)?;
    Some([*inner.first()?, *inner.last()?])
}

/// A horizontal vector of the body frame.
fn level(direction: &Vector2<f64>) -> Vector3<f64> {
    Vector3::new(direction.x, direction.y, 0.0)
}

/// Y: the section that rises at 45° from the back edge of the heel over the instep.
fn y(leg: &Leg, axis: &LegAxis, frame: &Frame, fit: SectionFit) -> Option<Landmark> {
    let (ahead, up) = (level(&frame.ahead), Vector3::z());
    let foot = PlaneFrame {
        origin: frame.on_floor(&Point2::origin()),
        normal: Unit::new_normalize(up - ahead),
        front: Unit::new_normalize(up + ahead),
        lateral: Unit::new_normalize(level(&frame.lateral)),
    };
    let tape = LegAxis { foot, bend: None };
    // The paper does not measure feet; its polynomial is for sections that are nearly round.
    let fit = if fit == SectionFit::Paper { SectionFit::Periodic } else { fit };
    let skin = sections(leg, tape, [-Y_REACH_MM, Y_REACH_MM], fit)?;
    let places = skin.at(leg, &[-Y_BESIDE_MM, 0.0, Y_BESIDE_MM]);
    let [Some(low), Some(own), Some(high)] = <[_; 3]>::try_from(places).ok()? else {
        return None;
    };
    let slope = |value: fn(&Section) -> f64| (value(&high) - value(&low)) / (2.0 * Y_BESIDE_MM);
    let girth_slope = slope(|section| section.girth.tape_mm);
    let independent_mm = TAU * own.rms_mm / (own.points as f64).sqrt();
    let noise_mm = own.girth_sd.map_or(independent_mm, |[girth_sd_mm, ..]| girth_sd_mm);
    // The tape is not level: there is no height to which the girth could belong.
    let girth_sd_mm = (girth_slope * HEEL_SD_MM).hypot(noise_mm);
    Some(Landmark {
        level: Level::Y,
        by: By::HeelTape,
        along_mm: axis.along(&skin.axis.at(own.along_mm, &own.centre)),
        height_mm: own.height_mm,
        surface_length_mm: None,
        girth_tape_mm: own.girth.tape_mm,
        girth_contour_mm: own.girth.contour_mm,
        height_sd_mm: (slope(|section| section.height_mm) * HEEL_SD_MM).abs(),
        girth_sd_mm,
        girth_of_level_sd_mm: girth_sd_mm,
        girth_per_deg_mm: None,
        doubts: section_doubts(&own),
    })
}

/// A: the vertical section through the metatarsal heads, located by their share of the foot's length.
fn a(leg: &Leg, axis: &LegAxis, frame: &Frame, stature_mm: f64) -> Option<Estimate> {
    let top_mm = FOREFOOT_STATURE_SHARE * stature_mm;
    let shifted = |share: f64| Ball::find(leg, frame, top_mm, share);
    let [behind, own, ahead] = [shifted(-SHARE_SD)?, shifted(0.0)?, shifted(SHARE_SD)?];
    let spread = |value: fn(&Ball) -> f64| (value(&ahead) - value(&behind)).abs() / 2.0;
    let mut doubts = vec![Doubt::SoleNotSeen];
    if own.gap_deg > GAP_DOUBT_DEG {
        doubts.push(Doubt::Gap { gap_deg: own.gap_deg });
    }
    let girth_sd_mm = spread(|ball| ball.tape_mm).hypot(SOLE_SD_MM);
    Some(Estimate {
        level: Level::A,
        by: By::FootShares { medial: MEDIAL_SHARE, lateral: LATERAL_SHARE },
        along_mm: axis.along(&own.centre),
        height_mm: own.centre.z,
        girth_tape_mm: own.tape_mm,
        height_sd_mm: spread(|ball| ball.centre.z),
        girth_sd_mm,
        girth_of_level_sd_mm: girth_sd_mm,
        doubts,
    })
}

/// A vertical section of the forefoot, closed along the floor.
struct Ball {
    tape_mm: f64,
    centre: Point3<f64>,
    /// Widest gap in the skin above the floor, seen from the middle of the sole, degrees.
    gap_deg: f64,
}

impl Ball {
    /// The section through both edges of the foot, shifted ahead by a share of its length; `None`
    /// if too much of its skin was not seen.
    fn find(leg: &Leg, frame: &Frame, top_mm: f64, shift: f64) -> Option<Ball> {
        let medial = frame.on_floor(&frame.edge(MEDIAL_SHARE + shift, -1.0)?);
        let lateral = frame.on_floor(&frame.edge(LATERAL_SHARE + shift, 1.0)?);
        let across = (lateral - medial).try_normalize(f64::MIN_POSITIVE)?;
        let square = Unit::new_normalize(across.cross(&Vector3::z()));
        let crossings = leg.mesh.slices(&square, &[square.dot(&medial.coords)]).pop()?;
        let middle = nalgebra::center(&medial, &lateral);
        let skin: Vec<Point2<f64>> = crossings
            .iter()
            .map(|crossing| crossing.position)
            .filter(|position| position.z < top_mm)
            .map(|position| Point2::new((position - middle).dot(&across), position.z))
            .collect();
        // The sole counts as seen: the angles are mirrored below the floor line, so no gap is found
        // there.
        let seen = skin.iter().map(|p| p.y.max(0.0).atan2(p.x));
        let seen: Vec<f64> = seen.flat_map(|angle| [angle, -angle]).collect();
        let gap_deg = largest_gap_deg(&seen);
        if gap_deg > GAP_MAX_DEG {
            return None;
        }
        let hull = Hull::from_points(&skin)?;
        let centroid = hull.centroid();
        let centre = middle + across * centroid.x + Vector3::z() * centroid.y;
        Some(Ball { tape_mm: hull.perimeter(), centre, gap_deg })
    }
}

#[cfg(test)]
mod tests;
