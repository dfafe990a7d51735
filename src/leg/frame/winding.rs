//! Which way round the triangles of an export are wound.
//!
//! A mirrored export has left and right exchanged, and its triangles turn inwards. So do those of an
//! export that is only wound the other way round; nothing in the scan tells the two apart.

use super::body_fault::BodyFault;
use crate::leg::method::Winding;
use crate::leg::sections::slice::Mesh;

/// Below this share of the volume that the triangles enclose together, they are wound either way and
/// say nothing. Bodies without soles, in shells and with noise have 0.3 or more.
const CLEAR_SHARE: f64 = 0.15;

/// Checks that the triangles are wound as declared.
///
/// # Errors
/// [`BodyFault::WoundInward`] or [`BodyFault::WoundOutward`].
pub fn check(mesh: &Mesh, declared: Winding) -> Result<(), BodyFault> {
    let share = outward_share(mesh);
    match declared {
        Winding::Outward if share < -CLEAR_SHARE => Err(BodyFault::WoundInward),
        Winding::Inward if share > CLEAR_SHARE => Err(BodyFault::WoundOutward),
        Winding::Outward | Winding::Inward => Ok(()),
    }
}

/// The volume that the triangles enclose with the middle of the body, as a share of the sum of their
/// parts without signs: −1 to 1, positive if they turn outwards; 0 for a point cloud.
fn outward_share(mesh: &Mesh) -> f64 {
    let points = mesh.points();
    let sum = points.iter().fold(nalgebra::Vector3::zeros(), |sum, point| sum + point.coords);
    let middle = sum / points.len().max(1) as f64;
    let (mut volume, mut size) = (0.0, 0.0);
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|corner| points[corner as usize].coords - middle);
        let part = a.dot(&b.cross(&c));
        volume += part;
        size += part.abs();
    }
    if size > 0.0 { volume / size } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

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
            assert_eq!(check(&body, Winding::Inward), Ok(()));
        }
    }

    #[test]
    fn a_body_wound_outwards_is_measured_unless_it_was_declared_otherwise() {
        assert_eq!(check(&body(false, false), Winding::Outward), Ok(()));
        assert_eq!(check(&body(false, false), Winding::Inward), Err(BodyFault::WoundOutward));
    }

    #[test]
    fn points_say_nothing() {
        let cloud = Mesh::cloud(vec![Point3::origin(); 4], 1.0);
        assert_eq!(check(&cloud, Winding::Outward), Ok(()));
        assert_eq!(check(&cloud, Winding::Inward), Ok(()));
    }
}
