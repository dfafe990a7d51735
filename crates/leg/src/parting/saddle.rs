//! The crotch of a skin: the saddle where the left and the right thigh first become one.
//!
//! Of all ways over the skin from thigh to thigh, the one whose highest point is lowest leads over the
//! crotch. It is found by adding the edges of the mesh from below, until the legs are connected. Thighs
//! that touch share no edges, and so do not matter. The links between neighbours stand for the edges of
//! a cloud.

use nalgebra::Point3;

use super::cloud_skin::CloudSkin;
use super::leg_tracking::LINK_MIN_MM;
use super::skin_border::SkinBorder;
use crate::frame::union_find::DisjointSets;
use crate::sections::slice::{EDGE_MAX_MM, Mesh};
use crate::side::{Side, Sides};

/// The thighs are separated in this band of heights, as shares of stature: below every crotch, above knees
/// that touch.
const BAND_SHARE: [f64; 2] = [0.33, 0.35];

/// Neighbours in a cloud are up to this many spacings apart: about twenty points; and more where the
/// legs are not connected because points are spread unevenly.
const CLOUD_REACHES: [f64; 2] = [2.5, 4.0];

/// The saddle between two legs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Saddle {
    /// Its height, mm.
    pub height_mm: f64,
    /// The lower end of the border on which it lies, mm; `None` if it lies in the skin.
    pub border_bottom_mm: Option<f64>,
}

/// The saddle of a skin whose legs are separated by `owner`, up to a height; `None` if the legs are not
/// connected below, or are one already where they are separated (cloth). Triangles with an edge longer than
/// `EDGE_MAX_MM` are no skin.
pub fn saddle(
    mesh: &Mesh,
    stature_mm: f64,
    highest_mm: f64,
    owner: impl Fn(&Point3<f64>) -> Option<Side>,
) -> Option<Saddle> {
    let [from_mm, to_mm] = BAND_SHARE.map(|share| share * stature_mm);
    let points = mesh.points();
    let mut sets = DisjointSets::new(points.len());
    let mut seeds = Sides::<Option<u32>>::default();
    for (point, index) in points.iter().zip(0..) {
        if (from_mm..to_mm).contains(&point.z)
            && let Some(side) = owner(point)
        {
            sets.join(index, *seeds.get_mut(side).get_or_insert(index));
        }
    }
    let Sides { left: Some(left), right: Some(right) } = seeds else { return None };
    let legs = Legs { sets, ends: [left, right] };
    let lowest_mm = to_mm + LINK_MIN_MM;
    if mesh.triangles().is_empty() {
        let at_reach = |reach| of_cloud(points, [from_mm, to_mm, highest_mm], reach, legs.clone());
        return CLOUD_REACHES.into_iter().find_map(at_reach).filter(|s| s.height_mm > lowest_mm);
    }
    let border = SkinBorder::above(mesh, from_mm, LINK_MIN_MM);
    let seams = border.seams.iter().copied();
    let edges = if has_long_edge(mesh) {
        above(points, to_mm, sides(mesh, to_mm).chain(seams)).collect()
    } else {
        above(points, to_mm, mesh.edges().iter().copied().chain(seams)).collect()
    };
    let top = points[legs.first_joined(points, edges)? as usize];
    // A border that is no longer than the spacing of points is a missing triangle.
    let bottom_mm = border.bottom_mm(mesh, &top, LINK_MIN_MM);
    let border_bottom_mm = bottom_mm.filter(|bottom_mm| top.z - bottom_mm > LINK_MIN_MM);
    (top.z > lowest_mm).then_some(Saddle { height_mm: top.z, border_bottom_mm })
}

/// The saddle of a cloud.
fn of_cloud(
    points: &[Point3<f64>],
    [from_mm, to_mm, highest_mm]: [f64; 3],
    reach: f64,
    legs: Legs,
) -> Option<Saddle> {
    let skin = CloudSkin::between(points, [from_mm, highest_mm], reach);
    // They are counted first: a cloud has ten to a point, and a list that grows takes more than twice their
    // memory.
    let links = skin.links();
    let high = || above(points, to_mm, links.iter().copied());
    let mut edges = Vec::with_capacity(high().count());
    edges.extend(high());
    let top = legs.first_joined(points, edges)?;
    // A cloud does not show how far down a border reaches.
    let border_bottom_mm = skin.is_open(top).then_some(from_mm);
    Some(Saddle { height_mm: points[top as usize].z, border_bottom_mm })
}

/// Connected points, and one of each leg.
#[derive(Clone)]
struct Legs {
    sets: DisjointSets,
    ends: [u32; 2],
}

impl Legs {
    /// The higher end of the edge that connects the legs, if edges are added from below.
    fn first_joined(mut self, points: &[Point3<f64>], mut edges: Vec<Edge>) -> Option<u32> {
        let [left, right] = self.ends;
        edges.sort_unstable();
        edges.into_iter().find_map(|Edge { ends: [a, b], .. }| {
            self.sets.join(a, b);
            let is_joined = self.sets.root(left) == self.sets.root(right);
            is_joined.then(|| if points[a as usize].z > points[b as usize].z { a } else { b })
        })
    }
}

/// An edge, ordered by its higher end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    /// The bits of the higher end's height, which order positive numbers as the numbers.
    top: u64,
    ends: [u32; 2],
}

/// The edges whose higher end is above a height.
fn above(
    points: &[Point3<f64>],
    from_mm: f64,
    edges: impl Iterator<Item = [u32; 2]>,
) -> impl Iterator<Item = Edge> {
    edges.filter_map(move |[a, b]| {
        let top_mm = points[a as usize].z.max(points[b as usize].z);
        (top_mm > from_mm).then(|| Edge { top: top_mm.to_bits(), ends: [a.min(b), a.max(b)] })
    })
}

/// Whether any edge of a mesh is longer than `EDGE_MAX_MM`.
fn has_long_edge(mesh: &Mesh) -> bool {
    let point = |index: u32| mesh.points()[index as usize];
    let is_long = |&[a, b]: &[u32; 2]| (point(a) - point(b)).norm_squared() > EDGE_MAX_MM.powi(2);
    mesh.edges().iter().any(is_long)
}

/// The sides of the triangles that reach above a height and have no side longer than `EDGE_MAX_MM`.
fn sides(mesh: &Mesh, from_mm: f64) -> impl Iterator<Item = [u32; 2]> {
    let points = mesh.points();
    let is_high = move |triangle: &&[u32; 3]| {
        triangle.iter().any(|corner| points[*corner as usize].z > from_mm)
    };
    let high = mesh.triangles().iter().filter(is_high);
    let skin = high.filter(move |triangle| mesh.facet(triangle).longest_edge_mm() <= EDGE_MAX_MM);
    skin.flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATURE_MM: f64 = 1700.0;
    const CROTCH_MM: f64 = 805.0;

    /// Distance of the slices of the skin, mm.
    const ROW_MM: f64 = 4.0;

    /// Half the distance of the thighs' middles, mm.
    const FOCUS_MM: f64 = 90.0;

    /// Points of one thigh in a slice.
    const AROUND: u32 = 60;

    /// The right half (x ≥ 0) of a Cassini oval in polar coordinates, from its inner point or from the
    /// front around to the back. Two ovals become one where `b` reaches the distance of the foci.
    fn half_oval(b: f64) -> Vec<[f64; 2]> {
        let (a2, b4) = (FOCUS_MM.powi(2), b.powi(4));
        let radius = |angle: f64, sign: f64| {
            let rest = (b4 - (a2 * (2.0 * angle).sin()).powi(2)).max(0.0);
            (a2 * (2.0 * angle).cos() + sign * rest.sqrt()).max(0.0).sqrt()
        };
        let at = |angle: f64, r: f64| [r * angle.cos(), r * angle.sin()];
        let share = |i: u32| f64::from(i) / f64::from(AROUND);
        if b >= FOCUS_MM {
            let quarter = std::f64::consts::FRAC_PI_2;
            return (0..=AROUND)
                .map(|i| -quarter + 2.0 * quarter * share(i))
                .map(|angle| at(angle, radius(angle, 1.0)))
                .collect();
        }
        // Once inside from the inner point to the tangent, outside back to the other, and inside again.
        let widest = 0.5 * (b * b / a2).asin();
        let along = |i: u32| {
            let turn = std::f64::consts::TAU * share(i);
            (-widest * turn.sin(), if turn.cos() > 0.0 { -1.0 } else { 1.0 })
        };
        (0..=AROUND).map(along).map(|(angle, sign)| at(angle, radius(angle, sign))).collect()
    }

    /// Two thighs that become one body at the crotch, as triangles: right half, left half, and what
    /// closes the crotch.
    fn body() -> Vec<[Point3<f64>; 3]> {
        let rows: Vec<Vec<Point3<f64>>> = (0..150)
            .map(|row| 0.32 * STATURE_MM + ROW_MM * f64::from(row))
            .map(|z| {
                let oval = half_oval(FOCUS_MM + 0.08 * (z - CROTCH_MM));
                oval.into_iter().map(|[x, y]| Point3::new(x, y, z)).collect()
            })
            .collect();
        let mirror = |p: Point3<f64>| Point3::new(-p.x, p.y, p.z);
        let mut triangles = Vec::new();
        for pair in rows.windows(2) {
            for i in 0..AROUND as usize {
                let [a, b, c, d] = [pair[0][i], pair[0][i + 1], pair[1][i], pair[1][i + 1]];
                triangles.extend([[a, b, d], [a, d, c]]);
                triangles.extend([[a, b, d], [a, d, c]].map(|corners| corners.map(mirror)));
            }
            let (inner, front) = (pair[0][0], pair[1][0]);
            let back = pair[1][AROUND as usize];
            if back.y - front.y > 1.0 && inner.x > 0.0 {
                triangles.extend([[inner, front, back], [mirror(inner), front, back]]);
            }
        }
        triangles
    }

    fn found(triangles: &[[Point3<f64>; 3]]) -> Option<Saddle> {
        let mut points: Vec<Point3<f64>> = Vec::new();
        let mut index = std::collections::BTreeMap::new();
        let mut number = |p: Point3<f64>| {
            let key = [p.x, p.y, p.z].map(|value| (value * 1e6).round() as i64);
            *index.entry(key).or_insert_with(|| {
                points.push(p);
                points.len() as u32 - 1
            })
        };
        let triangles = triangles.iter().map(|corners| corners.map(&mut number)).collect();
        let owner = |p: &Point3<f64>| Some(if p.x > 0.0 { Side::Left } else { Side::Right });
        let highest_mm = 0.56 * STATURE_MM;
        saddle(&Mesh::new(points, triangles), STATURE_MM, highest_mm, owner)
    }

    #[test]
    fn two_ovals_that_become_one_join_at_the_closed_form_s_height() {
        let saddle = found(&body()).unwrap();
        assert!((0.0..=ROW_MM).contains(&(saddle.height_mm - CROTCH_MM)), "{saddle:?}");
        assert_eq!(saddle.border_bottom_mm, None);
    }

    #[test]
    fn thighs_that_touch_are_not_one_skin() {
        // Each half moves inwards until the thighs overlap below the crotch.
        let pressed = |p: Point3<f64>| {
            let inward_mm = if p.z < CROTCH_MM - 30.0 { 25.0 } else { 0.0 };
            Point3::new(p.x - p.x.signum() * inward_mm, p.y, p.z)
        };
        let pressed: Vec<_> = body().into_iter().map(|corners| corners.map(pressed)).collect();
        let saddle = found(&pressed).unwrap();
        assert!((0.0..=ROW_MM).contains(&(saddle.height_mm - CROTCH_MM)), "{saddle:?}");
    }

    #[test]
    fn shells_with_a_gap_between_them_are_one_skin() {
        let apart = |corners: [Point3<f64>; 3]| {
            let mean_x = corners.iter().map(|p| p.x).sum::<f64>();
            let mean_z = corners.iter().map(|p| p.z).sum::<f64>() / 3.0;
            let up_mm = if mean_z > CROTCH_MM - 40.0 { 3.0 } else { 0.0 };
            corners.map(|p| Point3::new(p.x + 1.5 * mean_x.signum(), p.y, p.z + up_mm))
        };
        let split: Vec<_> = body().into_iter().map(apart).collect();
        let saddle = found(&split).unwrap();
        let off_mm = saddle.height_mm - 3.0 - CROTCH_MM;
        assert!((-ROW_MM..=2.0 * ROW_MM).contains(&off_mm), "{saddle:?}");
        assert_eq!(saddle.border_bottom_mm, None);
    }

    #[test]
    fn where_the_skin_between_the_thighs_is_missing_the_saddle_lies_on_its_border() {
        let seen = |corners: &[Point3<f64>; 3]| {
            corners.iter().any(|p| p.x.abs() > 14.0 || p.z > CROTCH_MM + 20.0)
        };
        let seen: Vec<_> = body().into_iter().filter(seen).collect();
        let saddle = found(&seen).unwrap();
        assert!((0.0..30.0).contains(&(saddle.height_mm - CROTCH_MM)), "{saddle:?}");
        assert!(saddle.border_bottom_mm.is_some_and(|mm| mm < CROTCH_MM), "{saddle:?}");
    }

    #[test]
    fn legs_that_are_not_connected_have_no_saddle() {
        let below: Vec<_> =
            body().into_iter().filter(|c| c.iter().all(|p| p.z < CROTCH_MM - 20.0)).collect();
        assert_eq!(found(&below), None);
    }
}
