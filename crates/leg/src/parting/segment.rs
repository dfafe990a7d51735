//! Segmentation: the two legs cut from the body, and the crotch where they meet (paper 1, fig. 2a).
//!
//! Each leg is followed slice by slice from its shank, upwards into the trunk and downwards to the
//! floor. Thighs that touch are split along the neck between them. A leg that is missing or ends
//! early does not prevent cutting the other. The crotch is looked for in all of the body; with it, the legs are
//! followed in what lies below the crop.

use nalgebra::{Point2, Point3};

use super::crotch::{CROTCH_SHARE, Crotch};
use super::crotch_search::{crotch, join};
use super::footprint::Footprint;
use super::leg_tracking::{GROWTH_UP_MM, Parting, STEP_MM, Step, Track, follow, slices};
use super::saddle::saddle;
use crate::frame::body::Body;
use crate::sections::slice::{EDGE_MAX_MM, Mesh};
use crate::side::{Side, Sides};

/// A leg may widen by this from one slice to the next downwards, mm: the instep and the heel widen faster.
const GROWTH_DOWN_MM: f64 = 30.0;

/// Height at which tracking starts, as a share of stature: the middle of the heights at which the
/// stance saw the shanks.
const START_SHARE: f64 = 0.11;

/// Points of a shank are within this distance of its middle, mm, including lymphoedema.
const SHANK_REACH_MM: f64 = 160.0;

/// A leg that ends below this share of stature has no calf and is not measured.
const LEG_MIN_SHARE: f64 = 0.20;

/// A leg keeps this much skin above the crotch, mm, because a section perpendicular to a tilted
/// axis reaches higher at the hip than at the crotch.
const ABOVE_CROTCH_MM: f64 = 60.0;

/// This much is cut off a leg that ends early, mm: two of the slices in which it was followed,
/// because the last may lie on whatever comes next.
const CUT_MARGIN_MM: f64 = 20.0;

/// One leg's skin in the body frame, foot included, cut above the crotch.
#[derive(Debug, Clone)]
pub struct Leg {
    /// Whose leg.
    pub side: Side,
    /// The leg's skin.
    pub mesh: Mesh,
    /// The height at which the leg ends below the crotch, mm; `None` if it reaches the crotch.
    pub cut_mm: Option<f64>,
}

/// The legs and the crotch.
#[derive(Debug, Clone)]
pub struct Legs {
    /// The legs; `None` for a leg that is not in the scan.
    pub legs: Sides<Option<Leg>>,
    /// The crotch.
    pub crotch: Crotch,
}

coded_enum! {
    /// Why the legs cannot be separated.
    #[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
    pub enum SegmentFault {
        /// Every leg ends below where a crotch could be.
        #[error(
            "no leg continues above {height_mm:.0} mm: the upper part of the legs is missing in the \
             scan; scan again"
        )]
        LegsEnd {
            /// Height of the last slice that shows a leg, mm.
            height_mm: f64,
        } => "segment-legs-end",
        /// The legs join at the height of the calves.
        #[error(
            "the legs merge at {height_mm:.0} mm, on the calf: is there cloth around them? scan \
             again with the legs bare and apart"
        )]
        JoinTooLow {
            /// The height, mm.
            height_mm: f64,
        } => "segment-join-too-low",
        /// The legs never join.
        #[error(
            "the legs are still separate at {height_mm:.0} mm, above any possible crotch: is the upper body \
             missing in the scan?"
        )]
        NeverJoin {
            /// Height of the last slice, mm.
            height_mm: f64,
        } => "segment-never-join",
    }
}

/// Cuts the body into its legs.
///
/// # Errors
/// A [`SegmentFault`] if no leg can be followed to where the legs meet.
pub fn segment(body: &Body) -> Result<Legs, SegmentFault> {
    let top_mm = CROTCH_SHARE[1] * body.tracking_scale_mm + ABOVE_CROTCH_MM;
    let mesh = &body.mesh.part(|facet| facet.middle().z < top_mm + EDGE_MAX_MM);
    let (_, up) = upwards(body, mesh, top_mm);
    Ok(segment_below(body, found_crotch(body, mesh, &up)?))
}

/// Cuts the legs from a body with this crotch. Only what lies below the crop is looked at, so that a crop has the same
/// legs as the whole body.
pub(crate) fn segment_below(body: &Body, crotch: Crotch) -> Legs {
    let stature_mm = body.tracking_scale_mm;
    let start_mm = START_SHARE * stature_mm;
    let mesh = &body.mesh.wholly_below(crotch.crop_mm());
    let (seeds, up) = upwards(body, mesh, crotch.crop_mm());
    let mut downwards = heights(0.0, start_mm);
    downwards.reverse();
    let mut down = follow(mesh, &seeds, &downwards, GROWTH_DOWN_MM, Parting::Nearest);
    down.steps.reverse();
    let cut_mm = Sides::of_each(|side| {
        let ends = [*up.ends_mm.get(side), crotch.hidden_from_mm()].into_iter().flatten();
        let end_mm = ends.reduce(f64::min).filter(|end_mm| *end_mm < crotch.height_mm);
        end_mm.map(|end_mm| end_mm - CUT_MARGIN_MM)
    });
    let whole_mm = crotch.height_mm + ABOVE_CROTCH_MM;
    let top_mm = Sides::of_each(|side| cut_mm.get(side).unwrap_or(whole_mm));
    let foot = Zone { track: &down, margin_mm: GROWTH_DOWN_MM };
    let shank = Zone { track: &up, margin_mm: GROWTH_UP_MM };
    let skins = cut(mesh, &foot, start_mm, &shank, &top_mm);
    let leg = |side: Side, mesh: Mesh| {
        seeds.get(side).as_ref()?;
        let cut_mm = *cut_mm.get(side);
        let is_long = cut_mm.is_none_or(|cut_mm| cut_mm >= LEG_MIN_SHARE * stature_mm);
        is_long.then_some(Leg { side, mesh, cut_mm })
    };
    let Sides { left, right } = skins;
    let legs = Sides { left: leg(Side::Left, left), right: leg(Side::Right, right) };
    Legs { legs, crotch }
}

/// The legs' footprints where tracking starts, and the legs followed from there up to a height.
fn upwards(body: &Body, mesh: &Mesh, top_mm: f64) -> (Sides<Option<Footprint>>, Track) {
    let start_mm = START_SHARE * body.tracking_scale_mm;
    let seeds = seeds(mesh, &body.shanks, start_mm);
    let up = follow(mesh, &seeds, &heights(start_mm, top_mm), GROWTH_UP_MM, Parting::Neck);
    (seeds, up)
}

/// Heights from `from` to below `to`, ascending; the first is half a step above `from`.
fn heights(from_mm: f64, to_mm: f64) -> Vec<f64> {
    let count = ((to_mm - from_mm) / STEP_MM).max(0.0) as usize;
    (0..count).map(|index| from_mm + (index as f64 + 0.5) * STEP_MM).collect()
}

/// The legs' footprints where tracking starts.
fn seeds(
    mesh: &Mesh,
    shanks: &Sides<Option<Point2<f64>>>,
    start_mm: f64,
) -> Sides<Option<Footprint>> {
    let slice = &slices(mesh, &[start_mm])[0];
    Sides::of_each(|side| {
        let own = (*shanks.get(side))?;
        let other = *shanks.get(side.other());
        let nearer = |p: &&Point2<f64>| other.is_none_or(|o| (*p - own).norm() < (*p - o).norm());
        let near = |p: &&Point2<f64>| (*p - own).norm() < SHANK_REACH_MM;
        let points: Vec<_> = slice.iter().filter(nearer).filter(near).copied().collect();
        Footprint::from_points(&points)
    })
}

/// The crotch, checked against the usual range.
fn found_crotch(body: &Body, mesh: &Mesh, up: &Track) -> Result<Crotch, SegmentFault> {
    let stature_mm = body.tracking_scale_mm;
    if !body.is_whole {
        return Ok(Crotch::unseen(stature_mm));
    }
    let [lowest_mm, highest_mm] = CROTCH_SHARE.map(|share| share * stature_mm);
    let height_mm = up.steps.last().map_or(0.0, |step| step.height_mm);
    let crotch = match joined(up) {
        Some((steps, join)) => {
            let zone = Zone { track: up, margin_mm: GROWTH_UP_MM };
            let owner = |point: &Point3<f64>| zone.owner(&point.xy(), point.z);
            let saddle = saddle(mesh, stature_mm, highest_mm, owner);
            let found = crotch(mesh, steps, join, saddle, stature_mm);
            let joined_mm = found.touching_from_mm.unwrap_or(found.height_mm).min(found.height_mm);
            if joined_mm < LEG_MIN_SHARE * stature_mm {
                return Err(SegmentFault::JoinTooLow { height_mm: joined_mm });
            }
            // No fold shows the crotch: cloth, or thighs pressed together.
            let touching_from_mm = found.height_mm;
            let is_hidden = found.height_mm < lowest_mm;
            if is_hidden { Crotch::hidden(touching_from_mm, stature_mm) } else { found }
        }
        None => {
            let ends = [up.ends_mm.left, up.ends_mm.right];
            let end_mm = ends.into_iter().flatten().reduce(f64::max);
            let end_mm = end_mm.ok_or(SegmentFault::NeverJoin { height_mm })?;
            if end_mm < lowest_mm {
                return Err(SegmentFault::LegsEnd { height_mm: end_mm });
            }
            Crotch::of_one_leg(end_mm)
        }
    };
    if crotch.height_mm > highest_mm {
        return Err(SegmentFault::NeverJoin { height_mm: crotch.height_mm });
    }
    Ok(crotch)
}

/// The steps in which both legs are followed, and the step from which on they are joined.
fn joined(up: &Track) -> Option<(&[Step], usize)> {
    let ends = [up.ends_mm.left, up.ends_mm.right];
    let end_mm = ends.into_iter().flatten().fold(f64::INFINITY, f64::min);
    let count = up.steps.partition_point(|step| step.height_mm <= end_mm);
    let steps = &up.steps[..count];
    join(steps).map(|join| (steps, join))
}

/// A range of heights of both legs, ascending.
struct Zone<'a> {
    /// The tracked slices, ascending.
    track: &'a Track,
    /// Skin belongs to the leg up to this far beyond a footprint, mm.
    margin_mm: f64,
}

impl Zone<'_> {
    /// The leg that a point at this height belongs to; `None` if neither.
    fn owner(&self, place: &Point2<f64>, height_mm: f64) -> Option<Side> {
        let steps = &self.track.steps;
        let above = steps.partition_point(|step| step.height_mm < height_mm);
        let around = &steps[above.saturating_sub(1)..(above + 1).min(steps.len())];
        let far = |step: &&Step| (step.height_mm - height_mm).abs();
        let nearest = around.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
        let beyond_mm = Sides::of_each(|side| {
            let print = nearest.prints.get(side).as_ref();
            print.map_or(f64::INFINITY, |print| print.beyond_mm(place))
        });
        let is_left = match nearest.neck {
            Some(neck) if self.track.parting == Parting::Neck => neck.is_left(place),
            _ => beyond_mm.left <= beyond_mm.right,
        };
        let side = if is_left { Side::Left } else { Side::Right };
        (*beyond_mm.get(side) <= self.margin_mm).then_some(side)
    }
}

/// The legs' skins: all skin up to the top of each that the zones assign to it, of which that of the foot
/// ends at `foot_top_mm`.
fn cut(
    mesh: &Mesh,
    foot: &Zone,
    foot_top_mm: f64,
    shank: &Zone,
    top_mm: &Sides<f64>,
) -> Sides<Mesh> {
    let highest_mm = top_mm.left.max(top_mm.right);
    let [left, right] = mesh.parts(|facet| {
        let middle = facet.middle();
        if middle.z >= highest_mm || facet.longest_edge_mm() > EDGE_MAX_MM {
            return None;
        }
        let zone = if middle.z < foot_top_mm { foot } else { shank };
        let side = zone.owner(&middle.xy(), middle.z)?;
        let is_below = middle.z < foot_top_mm || middle.z < *top_mm.get(side);
        is_below.then_some(if side == Side::Left { 0 } else { 1 })
    });
    Sides { left, right }
}
