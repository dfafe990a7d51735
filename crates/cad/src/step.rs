//! STEP: a tube as one B-spline face of an open shell, or the solid inside it with a plane at each
//! end, in millimetres.
//!
//! Under AP214 the tube's file has 33 instances besides the control points, the minimum that is
//! complete under the schema with units and a product (OpenCASCADE reads nothing from a face
//! without a product). The edges are the surface's own end rows and its seam, so they lie on
//! it exactly.

mod boundary;
mod exchange;
mod product;

use gaiter_spline::Surface;
use serde::{Deserialize, Serialize};

use super::ends::{self, EndNotPlane, Shape};
use super::header::{FileHeader, SYSTEM};
use boundary::Boundary;
use exchange::{Instances, text};

/// The application protocol that a file follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Schema {
    /// ISO 10303-214, automotive design: what most CAD systems read.
    Ap214,
    /// ISO 10303-242, managed model-based 3D engineering: its successor, in the first edition,
    /// which every later one contains.
    Ap242,
}

impl Schema {
    /// The schema's name and object identifier.
    fn identifier(self) -> &'static str {
        match self {
            Schema::Ap214 => "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }",
            Schema::Ap242 => {
                "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }"
            }
        }
    }
}

/// Writes the surface as a STEP file. Exact: the periodic surface is written with clamped knots around,
/// and numbers read back unchanged. Faces point outward, whatever the orientation of the surface.
///
/// # Errors
/// [`EndNotPlane`] for a solid whose ends are not plane; a tube can always be written.
pub fn write(
    surface: &Surface,
    shape: Shape,
    schema: Schema,
    header: &FileHeader,
) -> Result<Vec<u8>, EndNotPlane> {
    let mut file = Instances::default();
    let boundary = Boundary::new(&mut file, surface);
    let outward = surface.along_cross_around_is_outward();
    let mut faces = vec![boundary.tube(&mut file, outward)];
    if shape == Shape::Solid {
        faces.extend(boundary.caps(&mut file, &ends::planes(surface)?, outward));
    }
    let shape = product::shape(&mut file, shape, &faces);
    product::product(&mut file, schema, &text(header.product), shape);
    Ok(file.into_file(&head(schema, header)))
}

fn head(schema: Schema, header: &FileHeader) -> String {
    let (file_name, system) = (text(header.file_name), text(SYSTEM));
    let (description, schema) = (text(header.product), text(schema.identifier()));
    format!(
        "FILE_DESCRIPTION(({description}),'2;1');\n\
         FILE_NAME({file_name},'',(''),(''),{system},{system},'');\n\
         FILE_SCHEMA(({schema}));\n"
    )
}
