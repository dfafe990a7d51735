//! IGES 5.3: a tube as one B-spline surface (entity 128), or the solid inside it with a plane at
//! each end (entity 186), in millimetres. For CAD systems that do not read STEP.

mod notation;
mod solid;

use gaiter_spline::Surface;
use gaiter_spline::basis::DEGREE;

use super::ends::{self, EndNotPlane, Shape};
use super::header::{FileHeader, SYSTEM};
use notation::{Entities, Entity, Pointer, hollerith, real};

/// Points closer than this are the same point, mm; as in STEP files.
const RESOLUTION_MM: f64 = 1e-4;

/// The creation date, which IGES demands in the form `15HYYYYMMDD.HHNNSS`. It is fixed, so that the
/// same leg gives the same bytes.
const NO_DATE: &str = "15H19700101.000000";

/// IGES version 5.3 as the global section numbers it.
const VERSION: u32 = 11;

/// Writes the surface as an IGES file. Exact: the periodic surface is written with clamped knots
/// around, and numbers read back unchanged. The faces of a solid point outward; the tube alone has
/// no outer side, because entity 128 does not define one.
///
/// # Errors
/// [`EndNotPlane`] for a solid whose ends are not plane; a tube can always be written.
pub fn write(surface: &Surface, shape: Shape, header: &FileHeader) -> Result<Vec<u8>, EndNotPlane> {
    let mut file = Entities::default();
    let net = Net::new(surface);
    match shape {
        Shape::Tube => drop(net.surface(&mut file, true)),
        Shape::Solid => solid::solid(&mut file, surface, &net, &ends::planes(surface)?),
    }
    Ok(file.into_file(header.product, &global(surface, header)))
}

/// The global section's parameters, in the standard's order (IGES 5.3, 2.2.4.3).
fn global(surface: &Surface, header: &FileHeader) -> Vec<String> {
    let coordinates = surface.control_points().iter().flat_map(|point| point.iter().copied());
    let largest_mm = coordinates.map(f64::abs).fold(0.0, f64::max);
    let [product, file_name, system] = [header.product, header.file_name, SYSTEM].map(hollerith);
    let words = ["1H,", "1H;", &product, &file_name, &system, &system];
    // Bits of an integer; largest power of ten and digits of a single and of a double.
    let machine = ["32", "38", "6", "308", "15"];
    // The name for the receiver, the scale, the unit (millimetres), one line weight and its width.
    let receiver = [&product, "1.0", "2", "2HMM", "1", "0.01"];
    let (resolution, largest) = (real(RESOLUTION_MM), real(largest_mm));
    let version = VERSION.to_string();
    // After the size come: no author, no organisation, the version, no drafting standard.
    let rest = [NO_DATE, &resolution, &largest, "", "", &version, "0", NO_DATE];
    let all = words.iter().chain(&machine).chain(&receiver).chain(&rest);
    all.map(|parameter| (*parameter).to_owned()).collect()
}

/// The surface with clamped knots around.
struct Net {
    along: Vec<f64>,
    around: Vec<f64>,
    /// Row-major, rows along; the last column repeats the first.
    points: Vec<[f64; 3]>,
}

impl Net {
    fn new(surface: &Surface) -> Net {
        let (around, points) = surface.clamped_around();
        let points = points.into_iter().map(|point| point.coords.into()).collect();
        Net { along: surface.along().knots().to_vec(), around, points }
    }

    fn columns(&self) -> usize {
        self.around.len() - DEGREE - 1
    }

    /// First and last parameter, along and around.
    fn domain(&self) -> [[f64; 2]; 2] {
        [&self.along, &self.around].map(|knots| [knots[0], knots[knots.len() - 1]])
    }

    /// Entity 128; `alone` is false if it belongs to a face.
    fn surface(&self, file: &mut Entities, alone: bool) -> Pointer {
        let rows = self.points.len() / self.columns();
        // Open along, closed around, polynomial, not periodic: the knots are clamped.
        let counts = [rows - 1, self.columns() - 1, DEGREE, DEGREE, 0, 1, 1, 0, 0];
        let knots = self.along.iter().chain(&self.around).copied();
        let weights = vec![1.0; self.points.len()];
        // The first index runs fastest.
        let by_column = (0..self.columns())
            .flat_map(|column| self.points[column..].iter().step_by(self.columns()));
        let domain = self.domain();
        let reals = knots.chain(weights).chain(by_column.flatten().copied());
        let reals = reals.chain(domain.into_iter().flatten());
        let parameters = counts.iter().map(usize::to_string).chain(reals.map(real)).collect();
        let entity = if alone { Entity::SURFACE } else { Entity::SURFACE_OF_FACE };
        file.add(&entity, parameters)
    }

    /// Entity 126 through the control points of a row or a column; `normal` is that of its plane,
    /// if any.
    fn curve<'a>(
        file: &mut Entities,
        knots: &[f64],
        points: impl Iterator<Item = &'a [f64; 3]>,
        normal: Option<[f64; 3]>,
    ) -> Pointer {
        let points: Vec<f64> = points.flatten().copied().collect();
        let last = points.len() / 3 - 1;
        let flat = usize::from(normal.is_some());
        // A plane curve is always a ring here, and so closed. Polynomial, not periodic.
        let counts = [last, DEGREE, flat, flat, 1, 0];
        let weights = vec![1.0; last + 1];
        let domain = [knots[0], knots[knots.len() - 1]];
        let reals = knots.iter().copied().chain(weights).chain(points);
        let reals = reals.chain(domain).chain(normal.unwrap_or_default());
        let parameters = counts.iter().map(usize::to_string).chain(reals.map(real)).collect();
        file.add(&Entity::CURVE, parameters)
    }
}
