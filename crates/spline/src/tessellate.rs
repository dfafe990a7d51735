//! Triangles that approximate a tube within a given distance, for printers, viewers and meshes.

mod steps;

use std::ops::Range;

use nalgebra::{Point3, Unit, Vector3};

use super::basis::Basis;
use super::surface::Surface;
use steps::steps;

/// Maximum number of triangles in a useful mesh of a leg: 100 MB of STL. A tolerance that needs
/// more is a mistake.
pub const TRIANGLES_MAX: usize = 2_000_000;

/// The two ends of a tube in a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// Open: the mesh has two rims.
    Open,
    /// Closed by a fan of triangles around the middle of the end, flat if the end is flat.
    Fans,
}

/// A corner of a triangle: its point and the surface normal there. A point on a rim has both the
/// normal of the tube and that of the fan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Corner {
    /// 0-based index of the point.
    pub point: u32,
    /// 0-based index of the normal.
    pub normal: u32,
}

/// The triangles of a tube.
#[derive(Debug, Clone, PartialEq)]
pub struct Facets {
    /// Every point once, also along the seam: rows upwards in u, then the middles of the fans.
    pub points: Vec<Point3<f64>>,
    /// Outward normals: that of the surface at each of its points, then those of the two fans.
    pub normals: Vec<Unit<Vector3<f64>>>,
    /// Triangles, counter-clockwise seen from outside: the tube's, then the fans'.
    pub triangles: Vec<[Corner; 3]>,
}

/// Why a tube has no triangles.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TessellationFault {
    /// The tolerance is not a positive distance.
    #[error("a mesh cannot keep to its surface within {tolerance_mm} mm")]
    NoTolerance {
        /// The requested tolerance, mm.
        tolerance_mm: f64,
    },
    /// The tolerance requires more triangles than [`TRIANGLES_MAX`].
    #[error(
        "a mesh within {tolerance_mm} mm needs {triangles:.0} triangles, more than {}",
        TRIANGLES_MAX
    )]
    TooFine {
        /// The requested tolerance, mm.
        tolerance_mm: f64,
        /// The number of triangles it requires.
        triangles: f64,
    },
    /// The surface has no tangent plane at one of the points, or an end has no area.
    #[error("the surface is not a tube at u = {u}, v = {v}")]
    Degenerate {
        /// Parameter along.
        u: f64,
        /// Parameter around.
        v: f64,
    },
}

/// The triangles of a tube, with a distance of at most `tolerance_mm` between the triangles and the
/// tube in both directions. The seam is closed. Fans lie in the plane of an end if it is plane.
///
/// # Errors
/// [`TessellationFault`]: the tolerance is not positive or requires too many triangles, or the
/// surface is degenerate.
pub fn facets(
    surface: &Surface,
    tolerance_mm: f64,
    ends: Ends,
) -> Result<Facets, TessellationFault> {
    if !(tolerance_mm > 0.0 && tolerance_mm.is_finite()) {
        return Err(TessellationFault::NoTolerance { tolerance_mm });
    }
    let [along, around] = steps(surface, tolerance_mm);
    let triangles = 2.0 * along.iter().sum::<f64>() * around.iter().sum::<f64>();
    // Written this way to refuse NaN too.
    let bounded = triangles <= TRIANGLES_MAX as f64;
    if !bounded {
        return Err(TessellationFault::TooFine { tolerance_mm, triangles });
    }
    let u = parameters(surface.along(), &along);
    let mut v = parameters(surface.around(), &around);
    // The end of a turn equals its start.
    v.pop();
    let sense = if surface.along_cross_around_is_outward() { 1.0 } else { -1.0 };
    let mut facets = tube(surface, &u, &v, sense)?;
    if ends == Ends::Fans {
        let columns = v.len();
        let top = facets.points.len() - columns;
        // Along the tube's own edges a fan runs in the opposite direction.
        let degenerate = |u| TessellationFault::Degenerate { u, v: v[0] };
        facets.fan(0..columns, sense > 0.0).ok_or(degenerate(u[0]))?;
        facets.fan(top..top + columns, sense < 0.0).ok_or(degenerate(u[u.len() - 1]))?;
    }
    Ok(facets)
}

/// Divides each span into its steps; the end of the last span is included.
fn parameters(basis: &Basis, steps: &[f64]) -> Vec<f64> {
    let spans = basis.breakpoints().windows(2).zip(steps);
    let starts = spans.flat_map(|(span, steps)| {
        let (from, length) = (span[0], span[1] - span[0]);
        (0..*steps as u32).map(move |step| from + length * f64::from(step) / steps)
    });
    starts.chain([basis.domain().1]).collect()
}

/// The tube's own points, normals and triangles; `sense` is +1 if u × v points outward, otherwise −1.
fn tube(surface: &Surface, u: &[f64], v: &[f64], sense: f64) -> Result<Facets, TessellationFault> {
    let mut normals = Vec::with_capacity(u.len() * v.len());
    for &u in u {
        for &v in v {
            // `normal` is v × u.
            let normal = surface.derivatives(u, v).normal();
            let normal = normal.ok_or(TessellationFault::Degenerate { u, v })?;
            normals.push(Unit::new_unchecked(normal.into_inner() * -sense));
        }
    }
    let (rows, columns) = (u.len() as u32, v.len() as u32);
    let mut triangles = Vec::with_capacity(2 * u.len() * v.len());
    for row in 1..rows {
        for column in 0..columns {
            let next = (column + 1) % columns;
            let corner = |row, column| {
                let point = row * columns + column;
                Corner { point, normal: point }
            };
            let [a, b] = [row - 1, row].map(|row| corner(row, column));
            let [d, c] = [row - 1, row].map(|row| corner(row, next));
            let pair = [[a, b, c], [a, c, d]];
            triangles.extend(if sense > 0.0 { pair } else { pair.map(turned) });
        }
    }
    Ok(Facets { points: surface.grid(u, v), normals, triangles })
}

fn turned([a, b, c]: [Corner; 3]) -> [Corner; 3] {
    [a, c, b]
}

impl Facets {
    /// The three points of a triangle.
    pub fn places(&self, triangle: &[Corner; 3]) -> [Point3<f64>; 3] {
        triangle.map(|corner| self.points[corner.point as usize])
    }

    /// Closes a ring of points with triangles around its middle, `forward` along the ring or in the
    /// opposite direction. `None` if the ring has no area.
    fn fan(&mut self, ring: Range<usize>, forward: bool) -> Option<()> {
        let on_ring = &self.points[ring.clone()];
        let middle = on_ring.iter().map(|point| point.coords).sum::<Vector3<f64>>();
        let middle = Point3::from(middle / ring.len() as f64);
        let [centre, normal] = [self.points.len(), self.normals.len()].map(|place| place as u32);
        let corner = |point: u32| Corner { point, normal };
        let (first, count) = (ring.start as u32, ring.len() as u32);
        let fan = (0..count).map(|step| {
            let (from, to) = (corner(first + step), corner(first + (step + 1) % count));
            if forward { [from, to, corner(centre)] } else { [to, from, corner(centre)] }
        });
        self.triangles.extend(fan);
        self.points.push(middle);
        let fan = &self.triangles[self.triangles.len() - ring.len()..];
        let area: Vector3<f64> = fan
            .iter()
            .map(|triangle| self.places(triangle))
            .map(|[a, b, c]| (b - a).cross(&(c - a)))
            .sum();
        self.normals.push(Unit::try_new(area, f64::MIN_POSITIVE)?);
        Some(())
    }
}
