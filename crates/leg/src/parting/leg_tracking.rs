//! Tracks legs slice by slice: whatever lies where a leg was one slice ago is the leg. Hands, specks and
//! floor pieces are never there. Shells, holes and closed outlines are irrelevant.

use nalgebra::{Point2, Point3, Vector3};
use rayon::prelude::*;

use super::cluster::clusters;
use super::footprint::Footprint;
use super::thigh_divider::Neck;
use crate::frame::stance::ring;
use crate::sections::slice::{EDGE_MAX_MM, Mesh};
use crate::side::{Side, Sides};

/// Points of a slice closer than this are connected, mm: twice the spacing of a usual export (6 mm) …
pub const LINK_MIN_MM: f64 = 12.0;

/// Distance between the slices in which a leg is followed, mm.
pub(super) const STEP_MM: f64 = 10.0;

/// A leg may widen by this from one slice to the next, mm: a slope of 45° and some noise.
pub(super) const GROWTH_UP_MM: f64 = 12.0;

/// … or this many edges of the mesh: a slice has a point on each edge that it crosses, and the longest edge
/// of a triangle is rarely longer.
const LINK_EDGES: f64 = 1.6;

/// A mesh is decimated if at least this share of its edges is longer than a link; single ones are no matter.
const WIDE_MIN_SHARE: f64 = 0.01;

/// A cluster belongs to both legs if each holds more than this share of its points.
const SHARED_MIN_SHARE: f64 = 0.1;

/// A cluster belongs to one leg if the leg holds at least this share of it. Judging by girths, with
/// a hand at the thigh the leg holds some 0.7; of a trunk reached by one leg alone, some 0.6.
const OWN_MIN_SHARE: f64 = 0.65;

/// A leg narrows by no more than this from one slice to the next, mm: a slope of 45°. Where less of it is
/// seen, its other side is looked for there still.
const NARROWING_MM: f64 = 10.0;

/// A fold of skin, as of lymphoedema at the knee, hangs out by up to this, mm …
const FOLD_GROWTH_MM: f64 = 40.0;

/// … moves the middle of the leg by no more than this, mm; the middle of a trunk lies 80 mm aside …
const FOLD_SHIFT_MM: f64 = 20.0;

/// … and nearly all of it lies within that reach.
const FOLD_MIN_SHARE: f64 = 0.95;

/// After a hole that hid one side of a leg for long, a closed outline is that leg again if it is no larger than the
/// leg was within this many slices, 200 mm, by more than this factor: a calf grows by 1.3 over 120 mm …
const AGAIN_STEPS: usize = 20;
const AGAIN_GROWTH: f64 = 1.5;

/// … its middle lies within this distance of what is held to be the leg, mm …
const AGAIN_SHIFT_MM: f64 = 50.0;

/// … and so much of it is where the leg was: what could be seen all along.
const AGAIN_MIN_SHARE: f64 = 0.35;

/// Sectors of a closed outline.
const ALL_SECTORS: usize = 8;

/// A leg may be unseen in this many consecutive slices (a bandage, a strap, a row of holes) before
/// it counts as ended.
const UNSEEN_MAX: usize = 3;

/// The nearest points of two thighs lie within this depth of their inner skin, mm.
const INNER_MM: f64 = 40.0;

/// How a cluster that belongs to both legs is split.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parting {
    /// Along the neck between the thighs.
    Neck,
    /// Point by point to the nearer leg, for feet that touch.
    Nearest,
}

/// One slice of the track.
#[derive(Debug, Clone)]
pub struct Step {
    /// Its height, mm.
    pub height_mm: f64,
    /// The positions of the legs, if seen.
    pub prints: Sides<Option<Footprint>>,
    /// The line between the legs, if they are joined here.
    pub neck: Option<Neck>,
    /// Distance between the two legs' points, mm; `None` if the legs are joined or only one is
    /// followed.
    pub gap_mm: Option<f64>,
}

/// The slices of the track, and the ends of the legs.
#[derive(Debug, Clone)]
pub struct Track {
    /// How clusters that belong to both legs were split.
    pub parting: Parting,
    /// The slices, in the order followed.
    pub steps: Vec<Step>,
    /// The last height at which a leg was seen, if it was lost before the last slice, mm.
    pub ends_mm: Sides<Option<f64>>,
}

/// Points of a slice of this skin closer than this are connected, mm.
pub fn link_mm(mesh: &Mesh) -> f64 {
    mesh.edge_mm().map_or(LINK_MIN_MM, |edge_mm| LINK_MIN_MM.max(LINK_EDGES * edge_mm))
}

/// Follows legs from their footprints through slices at ascending or descending heights.
pub fn follow(
    mesh: &Mesh,
    from: &Sides<Option<Footprint>>,
    heights_mm: &[f64],
    growth_mm: f64,
    parting: Parting,
) -> Track {
    let mut last = from.clone();
    let mut unseen = Sides::<usize>::default();
    let mut track = Track { parting, steps: Vec::new(), ends_mm: Sides::default() };
    let mut seen_mm = Sides::of_each(|_| heights_mm.first().copied().unwrap_or(0.0));
    let link_mm = link_mm(mesh);
    let clustered: Vec<Vec<Vec<Point2<f64>>>> =
        slices(mesh, heights_mm).par_iter().map(|slice| clusters(slice, link_mm)).collect();
    for (&height_mm, slice) in heights_mm.iter().zip(clustered) {
        let (own, neck) = share_out(slice, &last, &track.steps, growth_mm, parting);
        let prints = Sides::of_each(|side| Footprint::from_points(own.get(side)));
        for side in Side::BOTH {
            if let Some(print) = prints.get(side) {
                let kept = last.get(side).as_ref().map(|last| print.after(last, NARROWING_MM));
                *last.get_mut(side) = Some(kept.unwrap_or_else(|| print.clone()));
                *unseen.get_mut(side) = 0;
                *seen_mm.get_mut(side) = height_mm;
            } else if last.get(side).is_some() {
                *unseen.get_mut(side) += 1;
                if *unseen.get(side) > UNSEEN_MAX {
                    *last.get_mut(side) = None;
                    *track.ends_mm.get_mut(side) = Some(*seen_mm.get(side));
                }
            }
        }
        let gap_mm = if neck.is_none() { gap_mm(&own) } else { None };
        track.steps.push(Step { height_mm, prints, neck, gap_mm });
    }
    track
}

/// Slices at ascending or descending heights, in that order.
pub fn slices(mesh: &Mesh, heights_mm: &[f64]) -> Vec<Vec<Point2<f64>>> {
    let mut ascending = heights_mm.to_vec();
    ascending.sort_by(f64::total_cmp);
    let slices = mesh.slices(&Vector3::z_axis(), &ascending);
    let mut flat: Vec<Vec<Point2<f64>>> =
        slices.iter().map(|slice| slice.iter().map(|c| c.position.xy()).collect()).collect();
    add_across_facets(mesh, &ascending, &mut flat);
    if heights_mm != ascending {
        flat.reverse();
    }
    flat
}

/// Adds points to slices at ascending heights where one facet is wider than a link, as decimation leaves it on flat
/// skin: the skin is one across it.
fn add_across_facets(mesh: &Mesh, heights_mm: &[f64], slices: &mut [Vec<Point2<f64>>]) {
    if mesh.share_longer(LINK_MIN_MM) < WIDE_MIN_SHARE {
        return;
    }
    let points = mesh.points();
    for triangle in mesh.triangles() {
        let corners = triangle.map(|corner| points[corner as usize]);
        let longest_mm = mesh.facet(triangle).longest_edge_mm();
        if !(LINK_MIN_MM..=EDGE_MAX_MM).contains(&longest_mm) {
            continue;
        }
        let lowest_mm = corners.iter().map(|corner| corner.z).fold(f64::INFINITY, f64::min);
        let first = heights_mm.partition_point(|height_mm| *height_mm <= lowest_mm);
        for (height_mm, slice) in heights_mm[first..].iter().zip(&mut slices[first..]) {
            let Some([from, to]) = cut_of(&corners, *height_mm) else { break };
            let parts = ((to - from).norm() / LINK_MIN_MM).ceil();
            slice
                .extend((1..parts as usize).map(|part| from + (to - from) * (part as f64 / parts)));
        }
    }
}

/// Where a horizontal plane cuts a facet; `None` if it does not.
fn cut_of(corners: &[Point3<f64>; 3], height_mm: f64) -> Option<[Point2<f64>; 2]> {
    let [a, b, c] = corners;
    let mut ends = [(a, b), (b, c), (c, a)].into_iter().filter_map(|(from, to)| {
        let is_cut = (from.z < height_mm) != (to.z < height_mm);
        let at = |share: f64| from.xy() + (to.xy() - from.xy()) * share;
        is_cut.then(|| at((height_mm - from.z) / (to.z - from.z)))
    });
    Some([ends.next()?, ends.next()?])
}

/// The points of a slice's clusters that belong to the left and to the right leg, and the neck if
/// the legs are joined.
fn share_out(
    slice: Vec<Vec<Point2<f64>>>,
    last: &Sides<Option<Footprint>>,
    before: &[Step],
    growth_mm: f64,
    parting: Parting,
) -> (Sides<Vec<Point2<f64>>>, Option<Neck>) {
    let mut own = Sides::<Vec<Point2<f64>>>::default();
    let mut neck = None;
    for cluster in slice {
        let share = |side: Side| {
            last.get(side).as_ref().map_or(0.0, |print| print.share_of(&cluster, growth_mm))
        };
        let shares = Sides::of_each(share);
        if let Sides { left: Some(left), right: Some(right) } = last
            && shares.left.min(shares.right) > SHARED_MIN_SHARE
        {
            let line = Neck::find(&cluster, [right.middle.x, left.middle.x]);
            for point in cluster {
                let is_left = match parting {
                    Parting::Neck => line.is_left(&point),
                    Parting::Nearest => left.beyond_mm(&point) <= right.beyond_mm(&point),
                };
                own.get_mut(if is_left { Side::Left } else { Side::Right }).push(point);
            }
            neck = Some(line);
            continue;
        }
        let side = if shares.left >= shares.right { Side::Left } else { Side::Right };
        let is_fold = || last.get(side).as_ref().is_some_and(|print| is_fold(print, &cluster));
        let is_again = || {
            let share = *shares.get(side);
            share > AGAIN_MIN_SHARE && is_seen_again(before, side, &cluster)
        };
        if *shares.get(side) > OWN_MIN_SHARE || is_fold() || is_again() {
            own.get_mut(side).extend(cluster);
        }
    }
    (own, neck)
}

/// Whether a cluster is a leg that has become wider on one or on all sides at once.
fn is_fold(last: &Footprint, cluster: &[Point2<f64>]) -> bool {
    let middle = Footprint::from_points(cluster).map(|print| print.middle);
    middle.is_some_and(|middle| (middle - last.middle).norm() <= FOLD_SHIFT_MM)
        && last.share_of(cluster, FOLD_GROWTH_MM) >= FOLD_MIN_SHARE
}

/// Whether a cluster is a leg that is seen all around again after a hole.
fn is_seen_again(before: &[Step], side: Side, cluster: &[Point2<f64>]) -> bool {
    let recent = &before[before.len().saturating_sub(AGAIN_STEPS)..];
    let mut prints = recent.iter().filter_map(|step| step.prints.get(side).as_ref());
    let largest_mm = prints.clone().map(Footprint::size_mm).fold(0.0, f64::max);
    let (Some(last), Some(ring)) = (prints.next_back(), ring(cluster)) else { return false };
    ring.sectors == ALL_SECTORS
        && ring.size_mm <= AGAIN_GROWTH * largest_mm
        && (ring.middle - last.middle).norm() <= AGAIN_SHIFT_MM
}

/// Smallest distance between the points of the two legs, mm; if the legs are too far apart to be
/// closing in on each other, their distance across the body.
fn gap_mm(own: &Sides<Vec<Point2<f64>>>) -> Option<f64> {
    let reach = |points: &[Point2<f64>], of: fn(f64, f64) -> f64| {
        points.iter().map(|point| point.x).reduce(of)
    };
    let inner_left = reach(&own.left, f64::min)?;
    let inner_right = reach(&own.right, f64::max)?;
    if inner_left - inner_right > INNER_MM {
        return Some(inner_left - inner_right);
    }
    // The nearest pair lies between the legs, so points beyond their middles need not be compared.
    let near = |points: &[Point2<f64>], x_mm: f64| -> Vec<Point2<f64>> {
        points.iter().filter(|point| (point.x - x_mm).abs() < INNER_MM).copied().collect()
    };
    let (left, right) = (near(&own.left, inner_left), near(&own.right, inner_right));
    let pairs = left.iter().flat_map(|p| right.iter().map(move |q| (p - q).norm()));
    pairs.min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// A trunk with facets all around, of which those at the back are `wide_mm` wide and the others 8 mm.
    fn trunk(wide_mm: f64) -> Mesh {
        let radius_mm = 150.0;
        let mut angles = Vec::new();
        let mut angle: f64 = 0.0;
        while angle < TAU {
            angles.push(angle);
            let width_mm = if (2.5..4.0).contains(&angle) { wide_mm } else { 8.0 };
            angle += width_mm / radius_mm;
        }
        let count = angles.len() as u32;
        let at =
            |angle: &f64, z: f64| Point3::new(radius_mm * angle.cos(), radius_mm * angle.sin(), z);
        let points = [0.0, 20.0].iter().flat_map(|z| angles.iter().map(move |a| at(a, *z)));
        let facets = (0..count).flat_map(|a| {
            let b = (a + 1) % count;
            [[a, b, b + count], [a, b + count, a + count]]
        });
        Mesh::new(points.collect(), facets.collect())
    }

    #[test]
    fn skin_is_one_across_facets_that_are_wider_than_the_others() {
        for wide_mm in [10.0, 20.0, 30.0, 40.0, 50.0] {
            let mesh = trunk(wide_mm);
            let slice = &slices(&mesh, &[10.0])[0];
            assert_eq!(clusters(slice, link_mm(&mesh)).len(), 1, "{wide_mm}");
        }
        // Wider ones are no skin.
        let mesh = trunk(80.0);
        assert!(clusters(&slices(&mesh, &[10.0])[0], link_mm(&mesh)).len() > 1);
    }
}
