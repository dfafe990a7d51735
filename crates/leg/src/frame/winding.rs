//! Which way round the triangles of an export are wound.
//!
//! A mirrored export has left and right exchanged, and its triangles turn inwards. So do those of an export
//! that is only wound the other way round; nothing in the scan distinguishes the two. A point cloud, and
//! pieces of a mesh that contradict each other, show nothing.

use nalgebra::{Point3, Vector3};

use super::body_fault::BodyFault;
use super::union_find::DisjointSets;
use crate::method::Winding;
use crate::sections::slice::{EDGE_MAX_MM, Mesh};

/// If the pieces that are wound one way have less than this share of the volume, the winding is mixed and
/// shows nothing.
const CLEAR_SHARE: f64 = 0.98;

/// Checks that the triangles are wound as declared. Returns whether the winding is clear.
///
/// # Errors
/// [`BodyFault::WoundInward`] or [`BodyFault::WoundOutward`].
pub fn check(mesh: &Mesh, declared: Winding) -> Result<bool, BodyFault> {
    if mesh.triangles().is_empty() {
        return Ok(false);
    }
    // The sum over all triangles is quick, and right where all are wound alike.
    let seem_outward = volume(mesh.points(), mesh.triangles().iter()) > 0.0;
    if (declared == Winding::Outward) == seem_outward {
        return Ok(true);
    }
    let outward = outward_share(mesh);
    match declared {
        Winding::Outward if outward < 1.0 - CLEAR_SHARE => Err(BodyFault::WoundInward),
        Winding::Inward if outward > CLEAR_SHARE => Err(BodyFault::WoundOutward),
        Winding::Outward => Ok(outward > CLEAR_SHARE),
        Winding::Inward => Ok(outward < 1.0 - CLEAR_SHARE),
    }
}

/// The volume of the pieces that are wound outwards, as a share of that of all pieces. Each piece, closed or
/// not, encloses a volume with its own middle.
fn outward_share(mesh: &Mesh) -> f64 {
    let at = |corner: u32| mesh.points()[corner as usize].coords;
    let is_skin = |triangle: &[u32; 3]| mesh.facet(triangle).longest_edge_mm() <= EDGE_MAX_MM;
    let skin: Vec<[u32; 3]> = mesh.triangles().iter().copied().filter(is_skin).collect();
    let pieces = pieces(&skin);
    let mut corners = vec![(0.0, Vector3::zeros()); skin.len()];
    for (piece, triangle) in pieces.iter().zip(&skin) {
        let (count, sum) = &mut corners[*piece as usize];
        *count += 3.0;
        *sum += triangle.map(at).into_iter().sum::<Vector3<f64>>();
    }
    let mut volumes = vec![0.0; skin.len()];
    for (piece, triangle) in pieces.iter().zip(&skin) {
        let (count, sum) = corners[*piece as usize];
        let [a, b, c] = triangle.map(|corner| at(corner) - sum / count);
        volumes[*piece as usize] += a.dot(&b.cross(&c));
    }
    let outward: f64 = volumes.iter().filter(|volume| **volume > 0.0).sum();
    let all: f64 = volumes.iter().map(|volume| volume.abs()).sum();
    if all > 0.0 { outward / all } else { 0.5 }
}

/// For each triangle the one that represents its piece: triangles that are wound alike across an edge
/// belong together.
fn pieces(triangles: &[[u32; 3]]) -> Vec<u32> {
    // Two triangles wound alike run along their common edge in opposite directions.
    let mut edges: Vec<(u64, bool, u32)> = Vec::with_capacity(3 * triangles.len());
    for (&[a, b, c], number) in triangles.iter().zip(0..) {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let key = u64::from(from.min(to)) << 32 | u64::from(from.max(to));
            edges.push((key, from < to, number));
        }
    }
    edges.sort_unstable();
    let mut sets = DisjointSets::new(triangles.len());
    for pair in edges.windows(2) {
        let [(edge, ahead, one), (other_edge, other_ahead, other)] = [pair[0], pair[1]];
        if edge == other_edge && ahead != other_ahead {
            sets.join(one, other);
        }
    }
    (0..triangles.len() as u32).map(|triangle| sets.root(triangle)).collect()
}

/// Six times the volume that triangles enclose with their own middle; negative if they turn inwards.
pub(super) fn volume<'a>(
    points: &[Point3<f64>],
    triangles: impl Iterator<Item = &'a [u32; 3]> + Clone,
) -> f64 {
    let at = |corner: u32| points[corner as usize].coords;
    let (count, sum) = triangles.clone().fold((0.0, Vector3::zeros()), |(count, sum), corners| {
        (count + 3.0, sum + corners.map(at).into_iter().sum::<Vector3<f64>>())
    });
    let middle = sum / f64::max(count, 1.0);
    let volumes = triangles.map(|corners| {
        let [a, b, c] = corners.map(|corner| at(corner) - middle);
        a.dot(&b.cross(&c))
    });
    volumes.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron wound outwards, seen in a mirror or not, its triangles turned round or not.
    fn body(is_mirrored: bool, is_turned: bool) -> Mesh {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let place = |[x, y, z]: [f64; 3]| Point3::new(if is_mirrored { -x } else { x }, y, z);
        let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let turn = |[a, b, c]: [u32; 3]| if is_turned { [a, c, b] } else { [a, b, c] };
        Mesh::new(points.map(place).to_vec(), triangles.map(turn).to_vec())
    }

    #[test]
    fn a_mirrored_body_and_one_wound_inwards_are_refused_until_that_is_declared() {
        for (is_mirrored, is_turned) in [(true, false), (false, true)] {
            let body = body(is_mirrored, is_turned);
            assert_eq!(check(&body, Winding::Outward), Err(BodyFault::WoundInward));
            assert_eq!(check(&body, Winding::Inward), Ok(true));
        }
    }

    #[test]
    fn a_body_wound_outwards_is_measured_unless_it_was_declared_otherwise() {
        assert_eq!(check(&body(false, false), Winding::Outward), Ok(true));
        assert_eq!(check(&body(false, false), Winding::Inward), Err(BodyFault::WoundOutward));
    }

    #[test]
    fn shells_wound_either_way_say_nothing() {
        let [first, second] = [body(false, false), body(false, true)];
        let both = [first.points(), second.points()].concat();
        let moved = second.triangles().iter().map(|triangle| triangle.map(|corner| corner + 4));
        let mesh = Mesh::new(both, first.triangles().iter().copied().chain(moved).collect());
        assert_eq!(check(&mesh, Winding::Outward), Ok(false));
        assert!(check(&mesh, Winding::Inward).is_ok());
    }

    #[test]
    fn points_say_nothing() {
        let cloud = Mesh::cloud(vec![Point3::origin(); 4], 1.0);
        assert_eq!(check(&cloud, Winding::Outward), Ok(false));
        assert_eq!(check(&cloud, Winding::Inward), Ok(false));
    }
}
