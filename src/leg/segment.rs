//! Segmentation: the two legs cut from the body, and the crotch where they meet (paper 1, fig. 2a).
//!
//! Each leg is followed slice by slice from its shank, upwards until both are one, downwards to
//! the floor. What lies where the leg was one slice ago is the leg; hands, specks and floor pieces
//! never do. Nothing is assumed about shells, holes or closed outlines.

use nalgebra::{Point2, Vector3};

use super::body::{Body, Sides};
use super::cluster::clusters;
use super::footprint::Footprint;
use super::slice::Mesh;

/// Distance of the slices in which a leg is followed, mm.
const STEP_MM: f64 = 10.0;

/// Distance of the slices in which the crotch is then found, mm.
const CROTCH_STEP_MM: f64 = 1.0;

/// Points nearer than this belong together, mm: twice the spacing of a usual export (6 mm).
const LINK_MM: f64 = 12.0;

/// Standard error of the crotch's height, mm: thighs nearer to each other than the linking distance
/// are taken for one, so it may lie that much too low, and half of it is likely.
pub const CROTCH_SD_MM: f64 = LINK_MM / 2.0;

/// From one slice to the next a leg may widen by this, mm: a slope of 45° and some noise.
const GROWTH_UP_MM: f64 = 12.0;

/// Downwards the instep and the heel widen faster, mm.
const GROWTH_DOWN_MM: f64 = 30.0;

/// Height at which following begins, as a share of stature: the middle of the heights in which
/// the stance saw two shanks.
const START_SHARE: f64 = 0.11;

/// Where crotches are, as shares of stature. ANSUR II: mean 0.48, first to last percentile 0.45 to
/// 0.52; children and patients need some room.
const CROTCH_SHARE: [f64; 2] = [0.38, 0.56];

/// A triangle with a longer edge is no piece of skin but a spike or a bridge, mm; ten times the edges
/// of a usual export, and no hole that could be closed honestly is as wide.
const EDGE_MAX_MM: f64 = 60.0;

/// A cluster is both legs' when each holds more than this share of its points.
const SHARED_MIN_SHARE: f64 = 0.1;

/// A leg keeps this much skin above the crotch, mm: a section square to a tilted axis reaches
/// higher at the hip than at the crotch.
const ABOVE_CROTCH_MM: f64 = 60.0;

/// The patient's own side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

impl Side {
    /// Both sides, left first.
    pub const BOTH: [Side; 2] = [Side::Left, Side::Right];

    /// `left` or `right`.
    pub fn word(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
        }
    }

    /// +1 for the left, whose lateral side is +X; −1 for the right.
    pub fn lateral_sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

/// One leg's skin in the body frame, foot included, cut above the crotch.
#[derive(Debug, Clone)]
pub struct Leg {
    /// Whose leg.
    pub side: Side,
    /// The leg's skin.
    pub mesh: Mesh,
}

/// Both legs and where they part.
#[derive(Debug, Clone)]
pub struct Legs {
    /// The legs.
    pub legs: Sides<Leg>,
    /// Height of the crotch above the floor, mm.
    pub crotch_height_mm: f64,
}

/// Why the legs cannot be parted.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SegmentFault {
    /// A leg ends where a leg goes on.
    #[error(
        "the {} leg ends at {height_mm:.0} mm, below any crotch: a part of it is missing in the \
         scan; scan again",
        side.word()
    )]
    LegEnds {
        /// Which leg.
        side: Side,
        /// Height of its last slice, mm.
        height_mm: f64,
    },
    /// The legs become one below any crotch.
    #[error(
        "the legs become one at {height_mm:.0} mm, below any crotch: do the thighs touch? scan \
         again with the legs further apart"
    )]
    JoinTooLow {
        /// Where, mm.
        height_mm: f64,
    },
    /// The legs never become one.
    #[error(
        "the legs are still apart at {height_mm:.0} mm, above any crotch: is the upper body \
         missing in the scan?"
    )]
    NeverJoin {
        /// Height of the last slice, mm.
        height_mm: f64,
    },
}

impl SegmentFault {
    /// The stable code of this fault, for `reason.json` and programs.
    pub fn code(&self) -> &'static str {
        match self {
            SegmentFault::LegEnds { .. } => "segment-leg-ends",
            SegmentFault::JoinTooLow { .. } => "segment-join-too-low",
            SegmentFault::NeverJoin { .. } => "segment-never-join",
        }
    }
}

/// Cuts the body into its legs.
///
/// # Errors
/// A [`SegmentFault`] where the legs cannot be followed to where they meet.
pub fn segment(body: &Body) -> Result<Legs, SegmentFault> {
    let start_mm = START_SHARE * body.stature_mm;
    let [lowest_crotch_mm, highest_crotch_mm] = CROTCH_SHARE.map(|share| share * body.stature_mm);
    let mesh = &body.mesh.below(highest_crotch_mm + ABOVE_CROTCH_MM);
    let seeds = seeds(mesh, &body.shanks, start_mm)?;
    let upwards = heights(start_mm, highest_crotch_mm, STEP_MM);
    let up = follow(mesh, seeds.clone(), &upwards, GROWTH_UP_MM, true);
    let height_mm = up.left.last().map_or(start_mm, |print| print.height_mm);
    match up.end {
        End::Lost(side) => return Err(SegmentFault::LegEnds { side, height_mm }),
        End::Heights => return Err(SegmentFault::NeverJoin { height_mm }),
        End::Joined if height_mm < lowest_crotch_mm => {
            return Err(SegmentFault::JoinTooLow { height_mm });
        }
        End::Joined => {}
    }
    let last = Sides {
        left: up.left.last().cloned().unwrap_or_else(|| seeds.left.clone()),
        right: up.right.last().cloned().unwrap_or_else(|| seeds.right.clone()),
    };
    let fine = heights(height_mm, height_mm + STEP_MM, CROTCH_STEP_MM);
    let apart = follow(mesh, last.clone(), &fine, GROWTH_UP_MM, true);
    let crotch_height_mm =
        CROTCH_STEP_MM + apart.left.last().map_or(height_mm, |print| print.height_mm);
    let mut downwards = heights(0.0, start_mm, STEP_MM);
    downwards.reverse();
    let mut down = follow(mesh, seeds, &downwards, GROWTH_DOWN_MM, false);
    down.left.reverse();
    down.right.reverse();
    let mid_x_mm = (last.left.middle.x + last.right.middle.x) / 2.0;
    let leg = |side: Side, below: &[Footprint], above: &[Footprint]| {
        let foot = Zone { prints: below, margin_mm: GROWTH_DOWN_MM, top_mm: start_mm };
        let top_mm = crotch_height_mm + ABOVE_CROTCH_MM;
        let shank = Zone { prints: above, margin_mm: GROWTH_UP_MM, top_mm };
        Leg { side, mesh: cut(mesh, side, mid_x_mm, &foot, &shank) }
    };
    let (left, right) = rayon::join(
        || leg(Side::Left, &down.left, &up.left),
        || leg(Side::Right, &down.right, &up.right),
    );
    Ok(Legs { legs: Sides { left, right }, crotch_height_mm })
}

/// Heights from `from` to below `to`, ascending, `step` apart, the first half a step above `from`.
fn heights(from_mm: f64, to_mm: f64, step_mm: f64) -> Vec<f64> {
    let count = ((to_mm - from_mm) / step_mm).max(0.0) as usize;
    (0..count).map(|index| from_mm + (index as f64 + 0.5) * step_mm).collect()
}

/// Both legs' footprints where following begins.
fn seeds(
    mesh: &Mesh,
    shanks: &Sides<Point2<f64>>,
    start_mm: f64,
) -> Result<Sides<Footprint>, SegmentFault> {
    let slice = &slices(mesh, &[start_mm])[0];
    let seed = |side: Side, own: Point2<f64>, other: Point2<f64>| {
        let nearer = |p: &&Point2<f64>| (*p - own).norm() < (*p - other).norm();
        let points: Vec<_> = slice.iter().filter(nearer).copied().collect();
        let lost = SegmentFault::LegEnds { side, height_mm: start_mm };
        Footprint::of(&points, start_mm).ok_or(lost)
    };
    Ok(Sides {
        left: seed(Side::Left, shanks.left, shanks.right)?,
        right: seed(Side::Right, shanks.right, shanks.left)?,
    })
}

fn slices(mesh: &Mesh, heights_mm: &[f64]) -> Vec<Vec<Point2<f64>>> {
    let slices = mesh.slices(&Vector3::z_axis(), heights_mm);
    slices.iter().map(|slice| slice.iter().map(|c| c.position.xy()).collect()).collect()
}

/// The footprints passed and why following ended.
struct Track {
    left: Vec<Footprint>,
    right: Vec<Footprint>,
    end: End,
}

/// Why following ended.
enum End {
    /// All heights were passed.
    Heights,
    /// The legs are one.
    Joined,
    /// Nothing lies where this leg was.
    Lost(Side),
}

/// Follows both legs through slices at ascending or descending heights. With `until_joined` it
/// ends where one cluster is both legs'; without, such a cluster is shared out point by point.
fn follow(
    mesh: &Mesh,
    from: Sides<Footprint>,
    heights_mm: &[f64],
    growth_mm: f64,
    until_joined: bool,
) -> Track {
    let mut ascending = heights_mm.to_vec();
    ascending.sort_by(f64::total_cmp);
    let mut slices = slices(mesh, &ascending);
    if heights_mm != ascending {
        slices.reverse();
    }
    let mut last = from;
    let mut track = Track { left: Vec::new(), right: Vec::new(), end: End::Heights };
    for (&height_mm, slice) in heights_mm.iter().zip(&slices) {
        let Some([left, right]) = share_out(slice, &last, growth_mm, until_joined) else {
            track.end = End::Joined;
            break;
        };
        let prints = [Footprint::of(&left, height_mm), Footprint::of(&right, height_mm)];
        let [Some(left), Some(right)] = prints else {
            track.end = End::Lost(if prints[0].is_none() { Side::Left } else { Side::Right });
            break;
        };
        last = Sides { left, right };
        track.left.push(last.left.clone());
        track.right.push(last.right.clone());
    }
    track
}

/// The points of a slice that are the left and the right leg's; none where a cluster is both legs'
/// and `until_joined` says to end there.
fn share_out(
    slice: &[Point2<f64>],
    last: &Sides<Footprint>,
    growth_mm: f64,
    until_joined: bool,
) -> Option<[Vec<Point2<f64>>; 2]> {
    let holds = [last.left.holds(growth_mm), last.right.holds(growth_mm)];
    let mut own = [Vec::new(), Vec::new()];
    for cluster in clusters(slice, LINK_MM) {
        let within = [0, 1].map(|side| {
            let count = cluster.iter().filter(|p| holds[side](p)).count();
            count as f64 / cluster.len() as f64
        });
        if within.iter().all(|&share| share > SHARED_MIN_SHARE) {
            if until_joined {
                return None;
            }
            let [left, right] = [last.left.middle, last.right.middle];
            for point in cluster {
                own[usize::from((point - right).norm() < (point - left).norm())].push(point);
            }
            continue;
        }
        let side = usize::from(within[1] > within[0]);
        if within[side] > 0.5 {
            own[side].extend(cluster);
        }
    }
    Some(own)
}

/// A range of heights of one leg with its footprints, ascending.
struct Zone<'a> {
    prints: &'a [Footprint],
    /// How far beyond a footprint skin still belongs to the leg, mm.
    margin_mm: f64,
    /// The zone ends here, mm.
    top_mm: f64,
}

impl Zone<'_> {
    /// Whether a point at this height lies where the leg lies.
    fn holds(&self, x_y: &Point2<f64>, height_mm: f64) -> bool {
        let above = self.prints.partition_point(|print| print.height_mm < height_mm);
        let around = &self.prints[above.saturating_sub(1)..(above + 1).min(self.prints.len())];
        let far = |print: &&Footprint| (print.height_mm - height_mm).abs();
        let nearest = around.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        nearest.is_some_and(|print| print.holds(self.margin_mm)(x_y))
    }
}

/// The triangles of one leg: in its zone, and on its side of the middle where both legs are one.
fn cut(mesh: &Mesh, side: Side, mid_x_mm: f64, foot: &Zone, shank: &Zone) -> Mesh {
    let own = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| mesh.points()[corner as usize].coords);
        let middle = (a + b + c) / 3.0;
        let longest = (a - b).norm().max((b - c).norm()).max((c - a).norm());
        let zone = if middle.z < foot.top_mm { foot } else { shank };
        longest <= EDGE_MAX_MM
            && middle.z < zone.top_mm
            && (middle.x - mid_x_mm) * side.lateral_sign() > 0.0
            && zone.holds(&middle.xy().into(), middle.z)
    };
    mesh.part(own)
}
