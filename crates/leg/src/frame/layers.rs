//! Two skins in one export: a second shell, the mirror image of the first, or a layer over it.
//!
//! Neighbouring points of one skin are linked by a few edges. Where two skins run beside each other,
//! points have neighbours that no short way along the edges leads to.

use std::mem::replace;

use nalgebra::Point3;

use crate::sections::slice::Mesh;

/// The legs, as shares of the stature: above the feet, below the crotch.
const LEGS_SHARE: [f64; 2] = [0.05, 0.45];

/// Points that are looked at: enough for a share to 0.02.
const SAMPLES: usize = 2000;

/// Neighbours in one skin are linked by at most this many edges.
const LINKS_MAX: usize = 3;

/// The share of the legs' points that have an unlinked neighbour within the length of an edge, of its own where those
/// are shorter; 0 for a point cloud. One skin has up to 0.1, where shells overlap and thighs touch; two have 0.7 or more.
pub fn unlinked_share(mesh: &Mesh, stature_mm: f64) -> f64 {
    let [low, high] = LEGS_SHARE.map(|share| share * stature_mm);
    let legs = mesh.part(|facet| (low..high).contains(&facet.middle().z));
    let Some(edge_mm) = legs.edge_mm() else { return 0.0 };
    // The points that share an edge with each point.
    let mut links = vec![Vec::new(); legs.points().len()];
    for &[a, b] in legs.edges() {
        links[a as usize].push(b);
        links[b as usize].push(a);
    }
    let slabs = Slabs::new(legs.points(), edge_mm);
    // In the order of slabs, samples are spread over all heights.
    let stride = slabs.points.len().div_ceil(SAMPLES).max(1);
    let samples = slabs.points.iter().step_by(stride).map(|(.., index)| *index);
    let count = samples.clone().count();
    // For each point the last sample to which it is linked.
    let mut linked_to = vec![u32::MAX; legs.points().len()];
    let is_beside = |&sample: &u32| {
        mark(&links, sample, &mut linked_to);
        let place = &legs.points()[sample as usize];
        let far = |point: u32| (legs.points()[point as usize] - place).norm();
        // Where a mesh is denser than elsewhere, points that lie within its usual edge are many edges apart.
        let reach_mm = links[sample as usize].iter().map(|next| far(*next)).fold(0.0, f64::max);
        let mut near = slabs.near(place).filter(|point| far(*point) < reach_mm.min(edge_mm));
        near.any(|point| linked_to[point as usize] != sample)
    };
    samples.filter(is_beside).count() as f64 / count.max(1) as f64
}

/// Points by slabs of height, and by their place across within each.
struct Slabs {
    edge_mm: f64,
    /// Number of the slab, the point, and its index.
    points: Vec<(i64, Point3<f64>, u32)>,
}

impl Slabs {
    /// Slabs as thick as an edge is long.
    fn new(points: &[Point3<f64>], edge_mm: f64) -> Slabs {
        let slab = |point: &Point3<f64>| (point.z / edge_mm).floor() as i64;
        let mut points: Vec<_> =
            points.iter().zip(0..).map(|(point, index)| (slab(point), *point, index)).collect();
        points.sort_unstable_by(|p, q| p.0.cmp(&q.0).then(p.1.x.total_cmp(&q.1.x)));
        Slabs { edge_mm, points }
    }

    /// The indices of the points nearer to a place than an edge is long.
    fn near(&self, place: &Point3<f64>) -> impl Iterator<Item = u32> {
        let own = (place.z / self.edge_mm).floor() as i64;
        let within = move |slab: i64| {
            let from = |x_mm: f64| {
                let is_before = |p: &(i64, Point3<f64>, u32)| (p.0, p.1.x) < (slab, x_mm);
                self.points.partition_point(is_before)
            };
            &self.points[from(place.x - self.edge_mm)..from(place.x + self.edge_mm)]
        };
        let near = move |(_, point, _): &&(i64, Point3<f64>, u32)| {
            (point - place).norm_squared() < self.edge_mm * self.edge_mm
        };
        [own - 1, own, own + 1]
            .into_iter()
            .flat_map(within)
            .filter(near)
            .map(|(_, _, index)| *index)
    }
}

/// Marks a point, and those that up to [`LINKS_MAX`] edges lead to, with its index.
fn mark(links: &[Vec<u32>], point: u32, marks: &mut [u32]) {
    marks[point as usize] = point;
    let mut outermost = vec![point];
    for _ in 0..LINKS_MAX {
        let next = outermost.iter().flat_map(|from| &links[*from as usize]).copied();
        outermost = next.filter(|to| replace(&mut marks[*to as usize], point) != point).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tubes about the upright axis with these radii, 800 mm high, in triangles of about 6 mm.
    fn tubes(radii_mm: &[f64]) -> Mesh {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for &radius_mm in radii_mm {
            let around = (std::f64::consts::TAU * radius_mm / 6.0) as u32;
            let first = points.len() as u32;
            for row in 0..134 {
                for column in 0..around {
                    let turn = std::f64::consts::TAU * f64::from(column) / f64::from(around);
                    let (sin, cos) = turn.sin_cos();
                    let z = 6.0 * f64::from(row);
                    points.push(Point3::new(radius_mm * cos, radius_mm * sin, z));
                    if row > 0 {
                        let above = first + row * around + column;
                        let beside = first + row * around + (column + 1) % around;
                        triangles.push([above - around, beside - around, above]);
                        triangles.push([beside - around, beside, above]);
                    }
                }
            }
        }
        Mesh::new(points, triangles)
    }

    #[test]
    fn one_skin_has_no_unlinked_neighbours_and_a_layer_over_it_has_them_nearly_everywhere() {
        assert_eq!(unlinked_share(&tubes(&[50.0]), 1600.0), 0.0);
        assert_eq!(unlinked_share(&tubes(&[50.0, 90.0]), 1600.0), 0.0);
        for offset_mm in [1.0, 2.0, 3.0] {
            let share = unlinked_share(&tubes(&[50.0, 50.0 + offset_mm]), 1600.0);
            assert!(share > 0.8, "{offset_mm} mm: {share}");
        }
    }

    #[test]
    fn a_point_cloud_has_no_links_to_miss() {
        assert_eq!(unlinked_share(&Mesh::cloud(vec![Point3::origin(); 9], 1.0), 1600.0), 0.0);
    }
}
