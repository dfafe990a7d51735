//! STEP AP214: a tube as one B-spline face of an open shell, in millimetres.
//!
//! A file has 33 instances besides the control points, the least that is complete under the schema
//! with units and a product (nurbs.md 7.1; OpenCASCADE reads a face without a product as nothing).
//! The edges are the surface's own end rows and its seam, so they lie on it exactly.

mod exchange;
mod outward;

use crate::spline::Surface;
use crate::spline::basis::DEGREE;
use exchange::{Id, Instances, lines, list, logical, real, text};

/// The program that wrote the file, for the header.
const SYSTEM: &str = concat!("gaiter ", env!("CARGO_PKG_VERSION"));

/// AP214, the schema that most CAD systems read.
const SCHEMA: &str = "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }";

/// What a file says about itself. Files leave the house: nothing here may name a patient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StepHeader<'a> {
    /// The file's own name, such as `left.step`.
    pub file_name: &'a str,
    /// What a CAD system shows in its tree, such as `left leg`.
    pub product: &'a str,
    /// When the file was made, ISO 8601 such as `2026-11-21T09:15:00Z`; empty: not said.
    pub time_stamp: &'a str,
}

/// The tube as a STEP file. Exact: the periodic surface is written with clamped knots around, and
/// numbers read back as they were. The face points outward, whichever way the surface is turned.
pub fn tube(surface: &Surface, name: &StepHeader) -> Vec<u8> {
    let mut file = Instances::default();
    let net = net(&mut file, surface);
    let face = face(&mut file, &net, outward::along_cross_around_is_outward(surface));
    let shape = shape(&mut file, face);
    product(&mut file, &text(name.product), shape);
    file.into_file(&header(name))
}

/// The control points in the file, with what every curve and surface on them needs.
struct Net {
    /// Row-major; the last column repeats the first one's places under numbers of its own.
    points: Vec<Id>,
    columns: usize,
    along: Knots,
    around: Knots,
}

/// A knot vector as STEP has it: distinct values and how often each occurs.
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

fn header(name: &StepHeader) -> String {
    let (file_name, time, system) = (text(name.file_name), text(name.time_stamp), text(SYSTEM));
    let (description, schema) = (text(name.product), text(SCHEMA));
    format!(
        "FILE_DESCRIPTION(({description}),'2;1');\n\
         FILE_NAME({file_name},{time},(''),(''),{system},{system},'');\n\
         FILE_SCHEMA(({schema}));\n"
    )
}

fn net(file: &mut Instances, surface: &Surface) -> Net {
    let (around, points) = surface.clamped_around();
    let mut point = |xyz: &[f64]| {
        let xyz = list(xyz.iter().map(|value| real(*value)));
        file.add(&format!("CARTESIAN_POINT('',{xyz})"))
    };
    Net {
        points: points.iter().map(|p| point(p.coords.as_slice())).collect(),
        columns: around.len() - DEGREE - 1,
        along: Knots::new(surface.along().knots()),
        around: Knots::new(&around),
    }
}

/// The face: its outward normal is u × v or the contrary.
fn face(file: &mut Instances, net: &Net, along_cross_around_is_outward: bool) -> Id {
    let Net { points, columns, along, around } = net;
    let rows = lines(points.chunks_exact(*columns).map(list));
    let surface = file.add(&format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',{DEGREE},{DEGREE},{rows},.UNSPECIFIED.,.F.,.T.,.F.,\n\
         {},{},\n{},\n{},.UNSPECIFIED.)",
        along.multiplicities, around.multiplicities, along.values, around.values
    ));

    let (low, high) = (&points[..*columns], &points[points.len() - columns..]);
    let mut vertex = |point: Id| file.add(&format!("VERTEX_POINT('',{point})"));
    let (foot, head) = (vertex(low[0]), vertex(high[0]));
    let mut curve = |points: String, closed: bool, knots: &Knots| {
        let (closed, Knots { multiplicities, values }) = (logical(closed), knots);
        file.add(&format!(
            "B_SPLINE_CURVE_WITH_KNOTS('',{DEGREE},{points},.UNSPECIFIED.,{closed},.F.,\n\
             {multiplicities},{values},.UNSPECIFIED.)"
        ))
    };
    let bottom = curve(list(low), true, around);
    let top = curve(list(high), true, around);
    let seam = curve(list(points.iter().step_by(*columns)), false, along);

    let mut edge =
        |from: Id, to: Id, curve: Id| file.add(&format!("EDGE_CURVE('',{from},{to},{curve},.T.)"));
    let (bottom, top) = (edge(foot, foot, bottom), edge(head, head, top));
    let seam = edge(foot, head, seam);
    // Counter-clockwise in (u, v), the seam once at each end of v.
    let sides = [(seam, true), (top, true), (seam, false), (bottom, false)]
        .map(|(edge, sense)| file.add(&format!("ORIENTED_EDGE('',*,*,{edge},{})", logical(sense))));
    let round = file.add(&format!("EDGE_LOOP('',{})", list(sides)));
    // A loop runs counter-clockwise seen from outside, so it turns together with the face.
    let sense = logical(along_cross_around_is_outward);
    let bound = file.add(&format!("FACE_OUTER_BOUND('',{round},{sense})"));
    file.add(&format!("ADVANCED_FACE('',({bound}),{surface},{sense})"))
}

/// The face as the representation of a shape, with its units.
fn shape(file: &mut Instances, face: Id) -> Id {
    let shell = file.add(&format!("OPEN_SHELL('',({face}))"));
    let model = file.add(&format!("SHELL_BASED_SURFACE_MODEL('',({shell}))"));
    let length = file.add("(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.))");
    let angle = file.add("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))");
    let solid_angle = file.add("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())");
    let uncertainty = file.add(&format!(
        "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-4),{length},\
         'distance_accuracy_value','')"
    ));
    let context = file.add(&format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)\n\
         GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({uncertainty}))\n\
         GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle}))\n\
         REPRESENTATION_CONTEXT('',''))"
    ));
    file.add(&format!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',({model}),{context})"))
}

/// The product that the shape belongs to; `name` is quoted.
fn product(file: &mut Instances, name: &str, shape: Id) {
    let application = file.add("APPLICATION_CONTEXT('automotive design')");
    file.add(&format!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,\
         {application})"
    ));
    let context = file.add(&format!("PRODUCT_CONTEXT('',{application},'mechanical')"));
    let product = file.add(&format!("PRODUCT({name},{name},'',({context}))"));
    let formation = file.add(&format!("PRODUCT_DEFINITION_FORMATION('','',{product})"));
    let context =
        file.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"));
    let definition = file.add(&format!("PRODUCT_DEFINITION('design','',{formation},{context})"));
    let definition = file.add(&format!("PRODUCT_DEFINITION_SHAPE('','',{definition})"));
    file.add(&format!("SHAPE_DEFINITION_REPRESENTATION({definition},{shape})"));
}
