//! The faces of a tube, the planes that close it, and the edges they share.

use gaiter_spline::Surface;
use gaiter_spline::basis::DEGREE;
use nalgebra::Point3;

use super::exchange::{Id, Instances, lines, list, logical, real};
use crate::ends::EndPlane;

/// The surface and the edges of the faces on it.
pub struct Boundary {
    surface: Id,
    /// The edges around at the start and at the end of u; both run in the direction of v.
    rims: [Id; 2],
    /// The edge between the two along the seam.
    seam: Id,
}

impl Boundary {
    /// Adds the surface with its control points and its edges.
    pub fn new(file: &mut Instances, surface: &Surface) -> Boundary {
        let (around, points) = surface.clamped_around();
        let columns = around.len() - DEGREE - 1;
        let [along, around] = [surface.along().knots(), &around].map(Knots::new);
        // The last of a row repeats the first one's position under its own number.
        let point =
            |point: &Point3<f64>| file.add_numbers("CARTESIAN_POINT", point.coords.as_slice());
        let points: Vec<Id> = points.iter().map(point).collect();
        let rows = lines(points.chunks_exact(columns).map(list));
        let surface = file.add(&format!(
            "B_SPLINE_SURFACE_WITH_KNOTS('',{DEGREE},{DEGREE},{rows},.UNSPECIFIED.,.F.,.T.,.F.,\n\
             {},{},\n{},\n{},.UNSPECIFIED.)",
            along.multiplicities, around.multiplicities, along.values, around.values
        ));

        let (low, high) = (&points[..columns], &points[points.len() - columns..]);
        let mut vertex = |point: Id| file.add(&format!("VERTEX_POINT('',{point})"));
        let (foot, head) = (vertex(low[0]), vertex(high[0]));
        let mut curve = |points: String, closed: bool, knots: &Knots| {
            let (closed, Knots { multiplicities, values }) = (logical(closed), knots);
            file.add(&format!(
                "B_SPLINE_CURVE_WITH_KNOTS('',{DEGREE},{points},.UNSPECIFIED.,{closed},.F.,\n\
                 {multiplicities},{values},.UNSPECIFIED.)"
            ))
        };
        let bottom = curve(list(low), true, &around);
        let top = curve(list(high), true, &around);
        let seam = curve(list(points.iter().step_by(columns)), false, &along);

        let mut edge = |from: Id, to: Id, curve: Id| {
            file.add(&format!("EDGE_CURVE('',{from},{to},{curve},.T.)"))
        };
        let rims = [edge(foot, foot, bottom), edge(head, head, top)];
        Boundary { surface, rims, seam: edge(foot, head, seam) }
    }

    /// The face on the tube. Its outward normal is u × v or the opposite.
    pub fn tube(&self, file: &mut Instances, along_cross_around_is_outward: bool) -> Id {
        let Boundary { surface, rims: [bottom, top], seam } = *self;
        // Counter-clockwise in (u, v), the seam once at each end of v.
        let round = [(seam, true), (top, true), (seam, false), (bottom, false)];
        // A loop runs counter-clockwise seen from outside, so its orientation follows that of the face.
        face(file, surface, &round, along_cross_around_is_outward)
    }

    /// The faces at the two ends. Each runs along its rim in the opposite direction to the tube.
    pub fn caps(
        &self,
        file: &mut Instances,
        [first, last]: &[EndPlane; 2],
        along_cross_around_is_outward: bool,
    ) -> [Id; 2] {
        let [bottom, top] = self.rims;
        let first = plane(file, first);
        let first = face(file, first, &[(bottom, along_cross_around_is_outward)], true);
        let last = plane(file, last);
        [first, face(file, last, &[(top, !along_cross_around_is_outward)], true)]
    }
}

/// A face on a surface, inside a loop of edges. Each edge has a flag: whether it is run in its own
/// direction. `sense`: whether the face's normal is the surface's and the loop runs as listed.
fn face(file: &mut Instances, surface: Id, round: &[(Id, bool)], sense: bool) -> Id {
    let sides: Vec<Id> = round
        .iter()
        .map(|(edge, own_way)| {
            file.add(&format!("ORIENTED_EDGE('',*,*,{edge},{})", logical(*own_way)))
        })
        .collect();
    let round = file.add(&format!("EDGE_LOOP('',{})", list(sides)));
    let sense = logical(sense);
    let bound = file.add(&format!("FACE_OUTER_BOUND('',{round},{sense})"));
    file.add(&format!("ADVANCED_FACE('',({bound}),{surface},{sense})"))
}

fn plane(file: &mut Instances, plane: &EndPlane) -> Id {
    let place = file.add_numbers("CARTESIAN_POINT", plane.place.coords.as_slice());
    let outward = file.add_numbers("DIRECTION", plane.outward.as_slice());
    let across = file.add_numbers("DIRECTION", plane.across.as_slice());
    let axes = file.add(&format!("AXIS2_PLACEMENT_3D('',{place},{outward},{across})"));
    file.add(&format!("PLANE('',{axes})"))
}

/// A knot vector in STEP's form: distinct values and their multiplicities.
struct Knots {
    multiplicities: String,
    values: String,
}

impl Knots {
    fn new(knots: &[f64]) -> Knots {
        let distinct = || knots.chunk_by(|a, b| a == b);
        Knots {
            multiplicities: list(distinct().map(<[f64]>::len)),
            values: list(distinct().map(|equal| real(equal[0]))),
        }
    }
}
