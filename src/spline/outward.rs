//! Which side of a tube is its outside.

use nalgebra::{Point3, Vector3};

use super::surface::Surface;

/// Whether ∂P/∂u × ∂P/∂v points out of the tube. It points in where v runs counter-clockwise seen
/// against the direction of u, as around a left leg, and out around its mirror image.
///
/// Told by the sign of the volume that the tube encloses, sampled at its knots and closed at both
/// ends by fans: it depends on no frame, nor on ends that are horizontal or plane.
pub fn along_cross_around_is_outward(surface: &Surface) -> bool {
    let rings = rings(surface);
    let (bottom, top) = (&rings[0], &rings[rings.len() - 1]);
    // With the apex in the bottom's own centre the bottom encloses nothing.
    let apex = centre(bottom);
    let six_volumes = |[a, b, c]: [Point3<f64>; 3]| (a - apex).dot(&(b - apex).cross(&(c - apex)));
    let sides = rings.windows(2).flat_map(|pair| sides(&pair[0], &pair[1]));
    let cap = turns(top).map(|(from, to)| [centre(top), to, from]);
    sides.chain(cap).map(six_volumes).sum::<f64>() > 0.0
}

/// Points of the surface at its knots: a ring each knot along, upwards in u.
fn rings(surface: &Surface) -> Vec<Vec<Point3<f64>>> {
    let (along, around) = (surface.along().breakpoints(), surface.around().breakpoints());
    // The last breakpoint around is the first one again.
    let turn = &around[1..];
    along.iter().map(|&u| turn.iter().map(|&v| surface.point(u, v)).collect()).collect()
}

/// The triangles between two rings; their corners follow each other so that normals are u × v.
fn sides<'a>(
    low: &'a [Point3<f64>],
    high: &'a [Point3<f64>],
) -> impl Iterator<Item = [Point3<f64>; 3]> + 'a {
    let quads = turns(low).zip(turns(high));
    quads.flat_map(|((a, d), (b, c))| [[a, b, c], [a, c, d]])
}

/// Each point of a ring with its successor.
fn turns(ring: &[Point3<f64>]) -> impl Iterator<Item = (Point3<f64>, Point3<f64>)> + '_ {
    ring.iter().copied().zip(ring.iter().copied().cycle().skip(1))
}

fn centre(ring: &[Point3<f64>]) -> Point3<f64> {
    Point3::from(ring.iter().map(|p| p.coords).sum::<Vector3<f64>>() / ring.len() as f64)
}
