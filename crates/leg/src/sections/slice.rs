//! Parallel planes through the skin: the points where the mesh's edges cross them or, for a bare
//! point cloud, the points near them.
//!
//! A facet's edge is a chord of the skin: its points lie up to e²/8R inside. On an ankle of radius
//! 28 mm with edges of 6 mm that makes the girth 0.3 mm too small. So a crossing is moved outwards
//! onto the curve described by the normals at the edge's two ends (the quadratic term of Vlachos et
//! al., Curved PN Triangles, 2001).

use std::sync::OnceLock;

use nalgebra::{Isometry3, Point3, Unit, Vector3};

use super::edges::edges;
use crate::frame::components;

/// If the normals at an edge's two ends differ by more than this, they do not describe a smooth piece
/// of skin (a fold, a rim, facets of opposite orientation), and the chord is used. Cosine of 45°.
const SMOOTH_EDGE_MIN_COSINE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The slice of a point cloud consists of the points up to this far from the plane, mm, or up to
/// one spacing if that is more: sweeping scanners put their points in rows up to 10 mm apart.
const SLAB_HALF_MIN_MM: f64 = 5.5;

/// A triangle with a longer edge is not skin but a spike or a bridge, mm. This is ten times the edge of a
/// usual export, and wider than any hole that could be closed reliably.
pub(crate) const EDGE_MAX_MM: f64 = 60.0;

/// This many edges give their median length to 1 %.
const EDGES_MAX: usize = 5000;

/// A skin to be sliced: a triangle mesh with vertex normals, or a bare point cloud.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    points: Vec<Point3<f64>>,
    /// Empty for a point cloud.
    triangles: Vec<[u32; 3]>,
    /// Area-weighted mean normal of the triangles around each point, of arbitrary sign; empty for a
    /// point cloud.
    normals: Vec<Vector3<f64>>,
    /// Half the thickness of a point cloud's slices, mm.
    slab_half_mm: f64,
    /// Each edge of the triangles once, found when the mesh is first sliced.
    edges: OnceLock<Vec<[u32; 2]>>,
}

/// A triangle by its corners.
#[derive(Debug, Clone, Copy)]
pub struct Facet([Vector3<f64>; 3]);

impl Facet {
    /// Its middle.
    pub fn middle(&self) -> Point3<f64> {
        let [a, b, c] = self.0;
        ((a + b + c) / 3.0).into()
    }

    /// Twice its area along its normal.
    pub(crate) fn across(&self) -> Vector3<f64> {
        let [a, b, c] = self.0;
        (b - a).cross(&(c - a))
    }

    /// Whether it reaches into a range of heights, mm.
    pub fn reaches(&self, [low, high]: [f64; 2]) -> bool {
        let [a, b, c] = self.0.map(|corner| corner.z);
        a.min(b).min(c) <= high && a.max(b).max(c) >= low
    }

    /// Length of its longest edge, mm; 0 for the points of a cloud.
    pub(crate) fn longest_edge_mm(&self) -> f64 {
        let [a, b, c] = self.0;
        (a - b).norm_squared().max((b - c).norm_squared()).max((c - a).norm_squared()).sqrt()
    }
}

/// The point where an edge of the mesh crosses a plane, or the projection of a nearby point onto it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// The edge's two points, smaller index first; for a point cloud, the point twice.
    pub edge: [u32; 2],
    /// The position on the plane.
    pub position: Point3<f64>,
}

/// How many facets and edges of a mesh meet at a point.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Around {
    /// Facets.
    pub facets: u32,
    /// Edges.
    pub edges: u32,
}

impl Around {
    /// Whether facets surround the point. At a border there is one more edge than there are facets.
    pub fn is_surrounded(&self) -> bool {
        self.facets > 0 && self.facets == self.edges
    }
}

impl Mesh {
    /// A mesh; every index must be within `points`, as guaranteed by a scan.
    pub fn new(points: Vec<Point3<f64>>, triangles: Vec<[u32; 3]>) -> Mesh {
        let mut normals = vec![Vector3::zeros(); points.len()];
        for triangle in &triangles {
            let [a, b, c] = triangle.map(|corner| points[corner as usize]);
            let normal = (b - a).cross(&(c - a));
            for &corner in triangle {
                // Facets around a point need not have the same orientation; around smooth skin they
                // lie within a right angle of each other, so the sign can be determined.
                let sum: &mut Vector3<f64> = &mut normals[corner as usize];
                *sum += if sum.dot(&normal) < 0.0 { -normal } else { normal };
            }
        }
        for normal in &mut normals {
            *normal = normal.try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
        }
        Mesh { points, triangles, normals, slab_half_mm: 0.0, edges: OnceLock::new() }
    }

    /// A bare point cloud with this distance between neighbouring points.
    pub fn cloud(points: Vec<Point3<f64>>, spacing_mm: f64) -> Mesh {
        let slab_half_mm = spacing_mm.max(SLAB_HALF_MIN_MM);
        let (triangles, normals) = (Vec::new(), Vec::new());
        Mesh { points, triangles, normals, slab_half_mm, edges: OnceLock::new() }
    }

    /// The mesh after a rigid motion.
    pub fn moved(mut self, motion: &Isometry3<f64>) -> Mesh {
        self.points.iter_mut().for_each(|point| *point = motion * *point);
        self.normals.iter_mut().for_each(|normal| *normal = motion * *normal);
        self
    }

    /// The points.
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Median length of the triangles' edges, mm; `None` for a point cloud.
    pub fn edge_mm(&self) -> Option<f64> {
        let mut lengths: Vec<f64> = self.sampled_edges_mm().collect();
        let middle = lengths.len() / 2;
        (middle > 0).then(|| *lengths.select_nth_unstable_by(middle, f64::total_cmp).1)
    }

    /// Mean distance of neighbouring points, mm: of as many on the same area in a square grid, of which each has two
    /// triangles. Of a point cloud its spacing, if that is more than half of its slices' least thickness.
    pub(crate) fn spacing_mm(&self) -> f64 {
        if self.triangles.is_empty() {
            return self.slab_half_mm;
        }
        let doubled = self.triangles.iter().map(|triangle| self.facet(triangle).across().norm());
        (doubled.sum::<f64>() / self.triangles.len() as f64).sqrt()
    }

    /// The share of edges that are longer than this, mm, by as many of them as for [`Mesh::edge_mm`].
    pub(crate) fn share_longer(&self, than_mm: f64) -> f64 {
        let count = self.sampled_edges_mm().len().max(1);
        let longer = self.sampled_edges_mm().filter(|length_mm| *length_mm > than_mm).count();
        longer as f64 / count as f64
    }

    /// Edge lengths of a sample of triangles, mm.
    fn sampled_edges_mm(&self) -> impl ExactSizeIterator<Item = f64> {
        let at = move |point: u32| self.points[point as usize];
        let stride = self.triangles.len().div_ceil(EDGES_MAX).max(1);
        let sample = self.triangles.iter().step_by(stride);
        sample.map(move |&[a, b, _]| (at(a) - at(b)).norm())
    }

    /// Triangles as indices into the points.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Edges of the triangles, each once and in ascending order, smaller index first.
    pub fn edges(&self) -> &[[u32; 2]] {
        self.edges.get_or_init(|| edges(self.points.len(), &self.triangles))
    }

    /// A triangle with its corners.
    pub(crate) fn facet(&self, triangle: &[u32; 3]) -> Facet {
        Facet(triangle.map(|corner| self.points[corner as usize].coords))
    }

    /// What meets at each point.
    pub fn around(&self) -> Vec<Around> {
        let mut around = vec![Around::default(); self.points.len()];
        self.triangles.iter().flatten().for_each(|corner| around[*corner as usize].facets += 1);
        self.edges().iter().flatten().for_each(|end| around[*end as usize].edges += 1);
        around
    }

    /// Unit normal of the skin at a point, of arbitrary sign; zero for a point cloud.
    pub fn normal(&self, point: u32) -> Vector3<f64> {
        self.normals.get(point as usize).copied().unwrap_or_default()
    }

    /// The triangles that `keeps` accepts, with their points; for a point cloud the points, as facets
    /// without area. Normals stay those of the whole mesh.
    pub fn part(&self, keeps: impl Fn(&Facet) -> bool) -> Mesh {
        let [part] = self.parts(|facet| keeps(facet).then_some(0));
        part
    }

    /// As [`Mesh::part`], several parts at once: `which` gives the index of the part to which a triangle
    /// belongs.
    pub fn parts<const N: usize>(&self, which: impl Fn(&Facet) -> Option<usize>) -> [Mesh; N] {
        if self.triangles.is_empty() {
            let mut parts: [Vec<Point3<f64>>; N] = std::array::from_fn(|_| Vec::new());
            for point in &self.points {
                if let Some(part) = which(&Facet([point.coords; 3])) {
                    parts[part].push(*point);
                }
            }
            return parts.map(|points| Mesh::cloud(points, self.slab_half_mm));
        }
        let mut parts: [Vec<[u32; 3]>; N] = std::array::from_fn(|_| Vec::new());
        for triangle in &self.triangles {
            if let Some(part) = which(&self.facet(triangle)) {
                parts[part].push(*triangle);
            }
        }
        parts.map(|triangles| self.of_triangles(triangles))
    }

    /// What lies wholly below a height, with the normals of what remains.
    pub(crate) fn wholly_below(&self, height_mm: f64) -> Mesh {
        let below = self.part(|facet| !facet.reaches([height_mm, f64::INFINITY]));
        if below.triangles.is_empty() { below } else { Mesh::new(below.points, below.triangles) }
    }

    /// The mesh without some of its triangles, with the normals of what remains.
    pub fn without(&self, is_left_out: &[bool]) -> Mesh {
        let kept = self.triangles.iter().zip(is_left_out).filter(|(_, left_out)| !**left_out);
        let kept: Vec<[u32; 3]> = kept.map(|(triangle, _)| *triangle).collect();
        let (triangles, used) = components::renumbered(self.points.len(), kept);
        let points = used.iter().map(|&point| self.points[point as usize]).collect();
        Mesh::new(points, triangles)
    }

    /// The mesh of some of the triangles.
    fn of_triangles(&self, triangles: Vec<[u32; 3]>) -> Mesh {
        let (triangles, used) = components::renumbered(self.points.len(), triangles);
        Mesh {
            points: used.iter().map(|&point| self.points[point as usize]).collect(),
            normals: used.iter().map(|&point| self.normals[point as usize]).collect(),
            triangles,
            slab_half_mm: self.slab_half_mm,
            edges: OnceLock::new(),
        }
    }

    /// Height of the highest point, mm; −∞ if there is none.
    pub fn highest_mm(&self) -> f64 {
        self.points.iter().map(|point| point.z).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Crossings of the mesh's edges with the planes `direction · p = offset`, one list per offset,
    /// each edge once, in the order of the edges' indices; for a point cloud the projections of the
    /// points near each plane, in their order. `offsets` must ascend.
    pub fn slices(&self, direction: &Unit<Vector3<f64>>, offsets: &[f64]) -> Vec<Vec<Crossing>> {
        let heights: Vec<f64> = self.points.iter().map(|p| direction.dot(&p.coords)).collect();
        self.slices_at(&heights, offsets, |_| *direction)
    }

    /// As [`Mesh::slices`], with planes that need not be parallel: `heights` is, for each point, the
    /// offset of the plane in which it lies, and `normal` that of the plane with an offset.
    pub(super) fn slices_at(
        &self,
        heights: &[f64],
        offsets: &[f64],
        normal: impl Fn(f64) -> Unit<Vector3<f64>>,
    ) -> Vec<Vec<Crossing>> {
        if self.triangles.is_empty() {
            return self.slabs(heights, offsets, normal);
        }
        let normals: Vec<_> = offsets.iter().map(|offset| normal(*offset)).collect();
        let mut slices = vec![Vec::new(); offsets.len()];
        let (Some(lowest), Some(highest)) = (offsets.first(), offsets.last()) else {
            return slices;
        };
        let mut first = 0;
        for &edge in self.edges() {
            let [p, q] = edge.map(|end| heights[end as usize]);
            let (low, high) = if p < q { (p, q) } else { (q, p) };
            if high < *lowest || low >= *highest {
                continue;
            }
            // Starts at the last edge's position, which is close in most exports.
            while first > 0 && offsets[first - 1] > low {
                first -= 1;
            }
            while first < offsets.len() && offsets[first] <= low {
                first += 1;
            }
            for index in first..offsets.len() {
                if offsets[index] > high {
                    break;
                }
                let position = self.crossing(edge, heights, &normals[index], offsets[index]);
                slices[index].push(Crossing { edge, position });
            }
        }
        slices
    }

    /// The points of a cloud near each plane, projected onto it.
    fn slabs(
        &self,
        heights: &[f64],
        offsets: &[f64],
        normal: impl Fn(f64) -> Unit<Vector3<f64>>,
    ) -> Vec<Vec<Crossing>> {
        let normals: Vec<_> = offsets.iter().map(|offset| normal(*offset)).collect();
        let mut slices = vec![Vec::new(); offsets.len()];
        for ((point, &height), index) in self.points.iter().zip(heights).zip(0..) {
            let first = offsets.partition_point(|&offset| offset < height - self.slab_half_mm);
            let near = offsets[first..].iter().zip(&normals[first..]);
            let near = near.take_while(|(offset, _)| **offset <= height + self.slab_half_mm);
            for ((offset, normal), slice) in near.zip(&mut slices[first..]) {
                let position = point + normal.into_inner() * (offset - height);
                slice.push(Crossing { edge: [index, index], position });
            }
        }
        slices
    }

    /// Where one edge crosses a plane, on the curved skin above the edge.
    fn crossing(
        &self,
        [from, to]: [u32; 2],
        heights: &[f64],
        normal: &Unit<Vector3<f64>>,
        offset: f64,
    ) -> Point3<f64> {
        let (from, to) = (from as usize, to as usize);
        let t = (offset - heights[from]) / (heights[to] - heights[from]);
        let edge = self.points[to] - self.points[from];
        let chord_point = self.points[from] + edge * t;
        let (n0, n1) = (self.normals[from], self.normals[to]);
        let n1 = if n0.dot(&n1) < 0.0 { -n1 } else { n1 };
        if n0.dot(&n1) < SMOOTH_EDGE_MIN_COSINE {
            return chord_point;
        }
        let rise = t * (1.0 - t) / 2.0 * edge.dot(&(n1 - n0));
        let outward = (n0 + n1).normalize();
        let in_plane = outward - normal.into_inner() * normal.dot(&outward);
        chord_point + in_plane * rise
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A cylinder of `sides` facets around and rings every 5 mm up to 50 mm.
    fn tube(radius_mm: f64, sides: u32) -> Mesh {
        let at = |ring: u32, side: u32| {
            let angle = TAU * f64::from(side) / f64::from(sides);
            let z = 5.0 * f64::from(ring);
            Point3::new(radius_mm * angle.cos(), radius_mm * angle.sin(), z)
        };
        let points = (0..11).flat_map(|r| (0..sides).map(move |s| at(r, s))).collect();
        let mut triangles = Vec::new();
        for (ring, side) in (0..10).flat_map(|r| (0..sides).map(move |s| (r, s))) {
            let next = (side + 1) % sides;
            let [a, b] = [ring * sides + side, ring * sides + next];
            triangles.extend([[a, b, b + sides], [a, b + sides, a + sides]]);
        }
        Mesh::new(points, triangles)
    }

    #[test]
    fn crossings_lie_on_the_round_skin_not_on_its_facets() {
        let radius_mm = 28.0;
        let mesh = tube(radius_mm, 30);
        let sagitta_mm = radius_mm * (1.0 - (TAU / 60.0).cos());
        assert!(sagitta_mm > 0.15, "the facets must differ from the cylinder: {sagitta_mm}");
        for points in mesh.slices(&Vector3::z_axis(), &[7.0, 22.5, 31.0]) {
            assert_eq!(points.len(), 60);
            for p in points.iter().map(|crossing| crossing.position) {
                assert!((p.x.hypot(p.y) - radius_mm).abs() < 0.002, "{p}");
            }
        }
    }

    #[test]
    fn a_plane_through_points_and_edges_crosses_each_edge_once() {
        let mesh = tube(28.0, 30);
        let at_ring = &mesh.slices(&Vector3::z_axis(), &[20.0])[0];
        let rings: Vec<f64> = at_ring.iter().map(|crossing| crossing.position.z).collect();
        assert!(rings.iter().all(|z| *z == 20.0));
        assert_eq!(at_ring.len(), 60);
    }

    #[test]
    fn a_plane_that_misses_the_mesh_crosses_nothing() {
        let mesh = tube(28.0, 30);
        assert!(mesh.slices(&Vector3::z_axis(), &[-1.0, 51.0]).iter().all(Vec::is_empty));
    }
}
