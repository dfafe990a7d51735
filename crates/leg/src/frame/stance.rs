//! The stance of a body: its shanks, its feet, the direction of the toes, and the floor.

use nalgebra::{Point2, Point3, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::floor::{Floor, floor};
use super::soles::{LongAxis, long_axis};
use crate::parting::cluster::clusters;
use crate::sections::hull::Hull;
use crate::sections::slice::{Crossing, Mesh};

/// Heights at which the shanks are searched for, as shares of stature: above the malleoli (0.045)
/// and below the calf's belly (0.20), where no hand hangs and legs hardly ever touch.
const SHANK_SHARES: [f64; 8] = [0.08, 0.09, 0.10, 0.11, 0.12, 0.13, 0.14, 0.15];

/// At least this many of these heights must show exactly two shanks …
const SHANK_SLICES_MIN: usize = 3;

/// … or this many exactly one, of one leg: a hole that hides a shank is shorter than that.
const LONE_SLICES_MIN: usize = 6;

/// The middle of a leg moves by at most this between two of these heights, mm: on a tall person who leans by 35°, with
/// three heights in between.
const LONE_STEP_MAX_MM: f64 = 60.0;

/// Points of one shank closer than this are connected, mm: three times the spacing of a coarse
/// export, less than the gap between two shanks.
pub(super) const SHANK_LINK_MM: f64 = 20.0;

/// Minimum and maximum diameter of a shank, mm, including lymphoedema.
const SHANK_DIAMETER_MM: [f64; 2] = [35.0, 300.0];

/// Minimum diameter of the pylon of a prosthesis, mm: usual tubes have 22 to 34.
const PYLON_DIAMETER_MM: f64 = 15.0;

/// A prosthesis shows its pylon beside a single shank at this many of these heights; its socket and its shoe may be
/// as thick as a shank.
const PYLON_SLICES_MIN: usize = 2;

/// A ring surrounds its middle if its points fall into this many of eight equal sectors; a sheet,
/// an arm seen from one side or a speck does not.
const SHANK_SECTORS_MIN: usize = 5;

/// Points below this share of stature belong to the feet: under the malleoli.
pub(crate) const FOOT_SHARE: f64 = 0.035;

/// A foot has at least this many points.
pub(crate) const FOOT_POINTS_MIN: usize = 50;

/// Minimum and maximum length of a foot as a share of stature. ANSUR II: 0.139 to 0.169 from first to
/// last percentile; a foot whose skin ends above the sole is a little shorter, a swollen foot longer.
pub(crate) const FOOT_LENGTH_SHARE: [f64; 2] = [0.115, 0.19];

/// Maximum width of a foot as a share of stature. ANSUR II: 0.066 at the last percentile; swollen
/// feet are wider, and a plate or platform under the feet is far wider.
const FOOT_WIDTH_MAX_SHARE: f64 = 0.10;

/// Minimum ratio of a foot's reach ahead of its ankle to that behind it; a foot that is seen whole
/// reaches 2 to 4 times as far.
const TOE_TO_HEEL_MIN: f64 = 1.3;

/// Feet that point further apart than this do not show the facing, degrees.
const FEET_SPREAD_MAX_DEG: f64 = 100.0;

/// The feet contradict the ankles if the facing found from the feet deviates by more than this from
/// the perpendicular to the line through the ankles, degrees.
const SQUARE_MAX_DEG: f64 = 35.0;

/// The stance of an upright body whose lowest point is at about z = 0, mm.
#[derive(Debug, Clone)]
pub struct Stance {
    /// Middle of each shank, one or two in any order, at their lowest common height.
    pub shanks: Vec<Point2<f64>>,
    /// Middle of each foot, in the order of `shanks`.
    pub feet: Vec<Point2<f64>>,
    /// Direction of the toes, if the feet show it.
    pub toes: Result<Vector2<f64>, FeetUnclear>,
    /// How far one shank stands ahead of the other where the toes point, mm, if there are two and their feet show it.
    pub forward_mm: Option<f64>,
    /// The floor under the soles.
    pub floor: Floor,
}

coded_enum! {
    /// Why the feet do not show the facing.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, thiserror::Error)]
    #[serde(rename_all = "snake_case")]
    pub enum FeetUnclear {
        /// Hardly any points near the floor.
        #[error("a foot has only {points} points")]
        NotSeen {
            /// Points of the foot with fewer points.
            points: usize,
        } => "foot-not-seen",
        /// The part on the floor is not a foot but a platform, a plate, or a leg without its foot.
        #[error(
            "what stands on the floor is {length_percent:.0} % of the stature long and \
             {width_percent:.0} % wide, which is not a foot"
        )]
        NoFoot {
            /// Length, percent of the stature.
            length_percent: f64,
            /// Width, percent of the stature.
            width_percent: f64,
        } => "no-foot",
        /// A foot reaches as far ahead of the ankle as behind it.
        #[error("a foot reaches {ratio:.2} times as far ahead of its ankle as behind it")]
        NoToes {
            /// Reach ahead over reach behind.
            ratio: f64,
        } => "no-toes",
        /// The feet point apart.
        #[error("the feet point {spread_deg:.0} degrees apart")]
        Apart {
            /// Angle between the feet, degrees.
            spread_deg: f64,
        } => "feet-apart",
        /// The toes point along the line through the ankles.
        #[error(
            "the toes point {off_deg:.0} degrees away from the perpendicular to the line through the ankles"
        )]
        NotSquare {
            /// Deviation from the perpendicular, degrees.
            off_deg: f64,
        } => "toes-not-square",
    }
}

impl FeetUnclear {
    /// Whether what stands on the floor is more than a foot: a plate, or a platform.
    pub(super) fn is_larger_than_a_foot(&self) -> bool {
        matches!(self, FeetUnclear::NoFoot { length_percent, width_percent }
            if *length_percent > 100.0 * FOOT_LENGTH_SHARE[1]
                || *width_percent > 100.0 * FOOT_WIDTH_MAX_SHARE)
    }
}

/// What was seen where two shanks, or a single one, were expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "two shanks are seen at only {pairs} of {heights} heights between 8 % and 15 % of the \
     stature, one alone at {singles} ({most} at most at one height): is nobody there, is a leg \
     hidden, do the legs touch, or is another person or an object beside the patient?"
)]
pub struct NoLegs {
    /// Heights at which exactly two were seen.
    pub pairs: usize,
    /// Heights at which exactly one was seen.
    pub singles: usize,
    /// Heights that were examined.
    pub heights: usize,
    /// The largest number seen at one height.
    pub most: usize,
}

/// Finds the stance of a body with this stature, mm; `floor_mm` is the height of its floor if that was scanned.
///
/// # Errors
/// [`NoLegs`] if too few heights show exactly two shanks, or one and nothing else.
pub(crate) fn stance(
    mesh: &Mesh,
    stature_mm: f64,
    floor_mm: Option<f64>,
) -> Result<Stance, NoLegs> {
    let shanks = found_shanks(mesh, stature_mm)?;
    let feet_points = feet(mesh, &shanks, FOOT_SHARE * stature_mm);
    let stands = shanks.iter().zip(&feet_points);
    let directions: Result<Vec<Vector2<f64>>, FeetUnclear> =
        stands.map(|(shank, foot)| toe_direction(*shank, foot, stature_mm)).collect();
    let middle = |(points, shank): (&Vec<[f64; 3]>, &Point2<f64>)| match points.len() {
        0 => *shank,
        n => {
            points.iter().fold(Point2::origin(), |sum, p| sum + Vector2::new(p[0], p[1]) / n as f64)
        }
    };
    Ok(Stance {
        feet: feet_points.iter().zip(&shanks).map(middle).collect(),
        forward_mm: directions.as_ref().ok().and_then(|toes| forward_mm(&shanks, toes)),
        toes: directions.and_then(|directions| toes(&shanks, &directions)),
        floor: floor_mm
            .map(|height_mm| Floor::seen(height_mm, &feet_points, stature_mm))
            .or_else(|| floor(&feet_points, stature_mm))
            .unwrap_or(Floor { height_mm: 0.0, sd_mm: f64::INFINITY, doubt: None }),
        shanks,
    })
}

/// Length of the longer foot of a body of about this stature, mm; `None` if there is no foot.
pub(crate) fn longest_foot_mm(mesh: &Mesh, stature_mm: f64) -> Option<f64> {
    let shanks = found_shanks(mesh, stature_mm).ok()?;
    let feet = feet(mesh, &shanks, FOOT_SHARE * stature_mm);
    let lengths = feet.iter().filter(|foot| foot.len() >= FOOT_POINTS_MIN);
    lengths.map(|foot| long_axis(foot).length).reduce(f64::max)
}

/// The shanks of a body of about this stature.
fn found_shanks(mesh: &Mesh, stature_mm: f64) -> Result<Vec<Point2<f64>>, NoLegs> {
    let heights: Vec<f64> = SHANK_SHARES.iter().map(|share| share * stature_mm).collect();
    // Only a tenth of the body is sliced.
    let [low, high] = [heights[0], heights[heights.len() - 1]];
    let part = mesh.part(|facet| facet.reaches([low, high]));
    let slices = part.slices(&Vector3::z_axis(), &heights);
    shanks(slices.iter().map(|slice| rings(slice)).collect())
}

/// The shanks at the lowest height that shows the full number.
fn shanks(rings: Vec<Vec<Ring>>) -> Result<Vec<Point2<f64>>, NoLegs> {
    let pylons: Vec<bool> = rings.iter().map(|rings| rings.iter().any(Ring::is_pylon)).collect();
    let rings: Vec<Vec<Point2<f64>>> = rings.into_iter().map(only_shanks).collect();
    let of_count = |count: usize| rings.iter().filter(|found| found.len() == count).count();
    let (pairs, singles) = (of_count(2), of_count(1));
    let most = rings.iter().map(Vec::len).max().unwrap_or(0);
    let on_pylon = rings.iter().zip(pylons).filter(|(found, pylon)| found.len() == 1 && *pylon);
    let has_prosthesis = on_pylon.count() >= PYLON_SLICES_MIN && is_one_leg(&rings);
    let legs = if pairs >= SHANK_SLICES_MIN && !has_prosthesis {
        2
    } else if has_prosthesis || singles >= LONE_SLICES_MIN && is_one_leg(&rings) {
        1
    } else {
        return Err(NoLegs { pairs, singles, heights: rings.len(), most });
    };
    Ok(rings.into_iter().find(|found| found.len() == legs).unwrap_or_default())
}

/// Whether the single rings are those of one leg. Some heights may show two: the other leg is a prosthesis, thin but
/// for its shoe and its socket.
fn is_one_leg(rings: &[Vec<Point2<f64>>]) -> bool {
    let singles: Vec<Point2<f64>> =
        rings.iter().filter(|found| found.len() == 1).flatten().copied().collect();
    let is_near = |pair: &[Point2<f64>]| (pair[1] - pair[0]).norm() <= LONE_STEP_MAX_MM;
    singles.windows(2).all(is_near) && rings.iter().all(|found| found.len() <= 2)
}

/// Middles of the rings in a slice that may be shanks.
pub(super) fn shank_middles(slice: &[Crossing]) -> Vec<Point2<f64>> {
    only_shanks(rings(slice))
}

/// Points in a slice that surround their middle.
pub(crate) struct Ring {
    pub(crate) middle: Point2<f64>,
    /// Its larger extent, mm.
    pub(crate) size_mm: f64,
    /// In how many of eight equal sectors around the middle there are points.
    pub(crate) sectors: usize,
    pub(super) hull: Hull,
}

impl Ring {
    fn is_shank(&self) -> bool {
        (SHANK_DIAMETER_MM[0]..=SHANK_DIAMETER_MM[1]).contains(&self.size_mm)
    }

    fn is_pylon(&self) -> bool {
        (PYLON_DIAMETER_MM..SHANK_DIAMETER_MM[0]).contains(&self.size_mm)
    }
}

/// The middles of those that may be shanks.
fn only_shanks(rings: Vec<Ring>) -> Vec<Point2<f64>> {
    rings.into_iter().filter(Ring::is_shank).map(|ring| ring.middle).collect()
}

/// The rings in a slice.
fn rings(slice: &[Crossing]) -> Vec<Ring> {
    let points: Vec<Point2<f64>> = slice.iter().map(|crossing| crossing.position.xy()).collect();
    clusters(&points, SHANK_LINK_MM).iter().filter_map(|points| ring(points)).collect()
}

/// Points as a ring; `None` if they do not surround their middle.
pub(crate) fn ring(ring: &[Point2<f64>]) -> Option<Ring> {
    let first = *ring.first()?;
    let (low, high) = ring.iter().fold((first, first), |(l, h), p| (l.inf(p), h.sup(p)));
    let size_mm = (high - low).max();
    let hull = Hull::from_points(ring)?;
    let middle = hull.centroid();
    let mut sectors = [false; 8];
    for point in ring {
        let turn = (point.y - middle.y).atan2(point.x - middle.x) / std::f64::consts::TAU + 0.5;
        sectors[((turn * 8.0) as usize).min(7)] = true;
    }
    let sectors = sectors.iter().filter(|seen| **seen).count();
    (sectors >= SHANK_SECTORS_MIN).then_some(Ring { middle, size_mm, sectors, hull })
}

/// Points of each foot: those below `top_mm`, each assigned to the nearer shank; beside a single shank only those that
/// are linked to it.
fn feet(mesh: &Mesh, shanks: &[Point2<f64>], top_mm: f64) -> Vec<Vec<[f64; 3]>> {
    if let &[shank] = shanks {
        return vec![foot_under(mesh, shank, top_mm)];
    }
    let mut feet = vec![Vec::new(); shanks.len()];
    for point in mesh.points().iter().filter(|point| point.z < top_mm) {
        let far = |shank: &Point2<f64>| (point.xy() - shank).norm_squared();
        let nearest =
            (0..shanks.len()).min_by(|a, b| far(&shanks[*a]).total_cmp(&far(&shanks[*b])));
        if let Some(nearest) = nearest {
            feet[nearest].push([point.x, point.y, point.z]);
        }
    }
    feet
}

/// Points of the foot under a single shank: there may be another foot, of a prosthesis.
fn foot_under(mesh: &Mesh, shank: Point2<f64>, top_mm: f64) -> Vec<[f64; 3]> {
    let low: Vec<&Point3<f64>> = mesh.points().iter().filter(|point| point.z < top_mm).collect();
    let places: Vec<Point2<f64>> = low.iter().map(|point| point.xy()).collect();
    let far = |place: &Point2<f64>| (place - shank).norm_squared();
    let nearest = |foot: &[Point2<f64>]| foot.iter().map(far).fold(f64::INFINITY, f64::min);
    let feet = clusters(&places, SHANK_LINK_MM);
    let Some(own) = feet.into_iter().min_by(|a, b| nearest(a).total_cmp(&nearest(b))) else {
        return Vec::new();
    };
    // Clusters keep their members in the given order.
    let mut own = own.into_iter().peekable();
    let is_own = |point: &&&Point3<f64>| own.next_if(|place| *place == point.xy()).is_some();
    low.iter().filter(is_own).map(|point| [point.x, point.y, point.z]).collect()
}

/// How far one shank stands ahead of the other where the toes of both feet point, mm.
fn forward_mm(shanks: &[Point2<f64>], directions: &[Vector2<f64>]) -> Option<f64> {
    let (&[one, other], &[first, second]) = (shanks, directions) else { return None };
    Some((other - one).dot(&(first + second).normalize()).abs())
}

/// The direction of the toes. For one foot, its own direction. For two, halfway between the feet's
/// mean direction and the perpendicular to the line through the ankles, because a foot turned out
/// distorts the former and a foot set forward the latter.
fn toes(shanks: &[Point2<f64>], directions: &[Vector2<f64>]) -> Result<Vector2<f64>, FeetUnclear> {
    let &[first, second] = directions else {
        return directions.first().copied().ok_or(FeetUnclear::NotSeen { points: 0 });
    };
    let spread_deg = first.angle(&second).to_degrees();
    if spread_deg > FEET_SPREAD_MAX_DEG {
        return Err(FeetUnclear::Apart { spread_deg });
    }
    let toes = (first + second).normalize();
    let across = (shanks[1] - shanks[0]).normalize();
    let square = Vector2::new(-across.y, across.x);
    let square = if square.dot(&toes) < 0.0 { -square } else { square };
    let off_deg = square.angle(&toes).to_degrees();
    if off_deg > SQUARE_MAX_DEG {
        return Err(FeetUnclear::NotSquare { off_deg });
    }
    Ok((toes + square).normalize())
}

/// The long axis of one foot, pointing to the end further from the ankle.
fn toe_direction(
    ankle: Point2<f64>,
    foot: &[[f64; 3]],
    stature_mm: f64,
) -> Result<Vector2<f64>, FeetUnclear> {
    if foot.len() < FOOT_POINTS_MIN {
        return Err(FeetUnclear::NotSeen { points: foot.len() });
    }
    let LongAxis { direction: long, length, width } = long_axis(foot);
    let [length, width] = [length, width].map(|extent| extent / stature_mm);
    let [shortest, longest] = FOOT_LENGTH_SHARE;
    if !(shortest..=longest).contains(&length) || width > FOOT_WIDTH_MAX_SHARE {
        let (length_percent, width_percent) = (100.0 * length, 100.0 * width);
        return Err(FeetUnclear::NoFoot { length_percent, width_percent });
    }
    let reach = foot.iter().map(|p| (Point2::new(p[0], p[1]) - ankle).dot(&long));
    let (back, ahead) = reach.fold((0.0_f64, 0.0_f64), |(b, a), r| (b.max(-r), a.max(r)));
    let ratio = ahead.max(back) / ahead.min(back).max(1.0);
    if ratio < TOE_TO_HEEL_MIN {
        return Err(FeetUnclear::NoToes { ratio });
    }
    Ok(if ahead > back { long } else { -long })
}
