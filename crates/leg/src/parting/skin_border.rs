//! The borders of a skin: where its triangles end, because nothing was seen there or another shell continues.

use nalgebra::Point3;

use crate::frame::components::connected;
use crate::frame::union_find::DisjointSets;
use crate::sections::slice::Mesh;

/// Shells continue in each other where their normals differ by at most this: cosine of 60°. The skins of two
/// thighs that touch face each other.
pub const SAME_SKIN_MIN_COSINE: f64 = 0.5;

/// … and where a step from border to border stays on the skin: it leaves the plane of the skin by at
/// most this share of its length …
pub const OFF_SKIN_MAX_SHARE: f64 = 0.5;

/// … or by this, mm, which noise may cause.
const OFF_SKIN_MIN_MM: f64 = 1.5;

/// The borders of the part of a skin above a height.
pub struct SkinBorder {
    /// Points around which the triangles do not close, lowest first.
    points: Vec<u32>,
    /// Whether another border is so near, by point, that the skin continues there.
    is_seam: Vec<bool>,
    /// Pairs of border points between which the skin continues.
    pub seams: Vec<[u32; 2]>,
}

impl SkinBorder {
    /// The borders above a height. Those of two shells up to `link_mm` apart are linked where they look
    /// like one skin.
    pub fn above(mesh: &Mesh, from_mm: f64, link_mm: f64) -> SkinBorder {
        let points = open_points(mesh, from_mm);
        if points.is_empty() {
            return SkinBorder { points, is_seam: Vec::new(), seams: Vec::new() };
        }
        let shells = connected(mesh.points().len(), mesh.triangles());
        let mut seams = Vec::new();
        let mut is_seam = vec![false; points.len()];
        for (own, &a) in points.iter().enumerate() {
            let height_mm = mesh.points()[a as usize].z;
            let next = points.iter().enumerate().skip(own + 1);
            let near =
                next.take_while(|(_, b)| mesh.points()[**b as usize].z <= height_mm + link_mm);
            for (other, &b) in near {
                if shells[a as usize] != shells[b as usize] && goes_on(mesh, a, b, link_mm) {
                    seams.push([a, b]);
                    (is_seam[own], is_seam[other]) = (true, true);
                }
            }
        }
        SkinBorder { points, is_seam, seams }
    }

    /// The lower end, mm, of the border that passes within `reach_mm` of a place; `None` if none does.
    /// Seams are no borders.
    pub fn bottom_mm(&self, mesh: &Mesh, place: &Point3<f64>, reach_mm: f64) -> Option<f64> {
        let at = |point: u32| &mesh.points()[point as usize];
        let own = self.points.iter().zip(&self.is_seam).filter(|(_, is_seam)| !**is_seam);
        let own: Vec<u32> = own.map(|(point, _)| *point).collect();
        let mut sets = DisjointSets::new(mesh.points().len());
        open_edges(mesh, &own).into_iter().for_each(|[a, b]| sets.join(a, b));
        let beside = own.iter().filter(|point| (at(**point) - place).norm() <= reach_mm);
        let borders: Vec<u32> = beside.map(|point| sets.root(*point)).collect();
        // Points ascend, so the first of a border is its lower end.
        let lowest = own.iter().find(|point| borders.contains(&sets.root(**point)))?;
        Some(at(*lowest).z)
    }
}

/// Edges between border points that belong to an odd number of triangles.
fn open_edges(mesh: &Mesh, border: &[u32]) -> Vec<[u32; 2]> {
    let mut is_open = vec![false; mesh.points().len()];
    border.iter().for_each(|point| is_open[*point as usize] = true);
    let sides = mesh.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let between = sides.filter(|side| side.iter().all(|end| is_open[*end as usize]));
    let mut edges: Vec<[u32; 2]> = between.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    let odd = edges.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1);
    odd.map(|same| same[0]).collect()
}

/// Points above a height around which the triangles do not close, lowest first.
///
/// Around a closed point each neighbour belongs to two triangles, so that the indices of the triangles'
/// other corners cancel each other.
fn open_points(mesh: &Mesh, from_mm: f64) -> Vec<u32> {
    let points = mesh.points();
    let mut rest = vec![0u32; points.len()];
    for &[a, b, c] in mesh.triangles() {
        rest[a as usize] ^= b ^ c;
        rest[b as usize] ^= c ^ a;
        rest[c as usize] ^= a ^ b;
    }
    let open = |&point: &u32| rest[point as usize] != 0 && points[point as usize].z >= from_mm;
    let mut open: Vec<u32> = (0..points.len() as u32).filter(open).collect();
    open.sort_by(|a, b| points[*a as usize].z.total_cmp(&points[*b as usize].z));
    open
}

/// Whether the skin continues from one border point to another.
fn goes_on(mesh: &Mesh, a: u32, b: u32, link_mm: f64) -> bool {
    let step = mesh.points()[b as usize] - mesh.points()[a as usize];
    let (na, nb) = (mesh.normal(a), mesh.normal(b));
    let off_max_mm = OFF_SKIN_MIN_MM.max(OFF_SKIN_MAX_SHARE * step.norm());
    step.norm() <= link_mm
        && na.dot(&nb).abs() >= SAME_SKIN_MIN_COSINE
        && step.dot(&na).abs() <= off_max_mm
        && step.dot(&nb).abs() <= off_max_mm
}
