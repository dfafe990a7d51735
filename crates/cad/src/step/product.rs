//! The context of the faces in a STEP file: shape, units, and the product that has the shape.

use super::Schema;
use super::exchange::{Id, Instances, list};
use crate::ends::Shape;

/// The faces as a shape representation with units.
pub fn shape(file: &mut Instances, shape: Shape, faces: &[Id]) -> Id {
    let faces = list(faces);
    let (shell, model, representation) = match shape {
        Shape::Tube => {
            ("OPEN_SHELL", "SHELL_BASED_SURFACE_MODEL", "MANIFOLD_SURFACE_SHAPE_REPRESENTATION")
        }
        Shape::Solid => {
            ("CLOSED_SHELL", "MANIFOLD_SOLID_BREP", "ADVANCED_BREP_SHAPE_REPRESENTATION")
        }
    };
    let shell = file.add(&format!("{shell}('',{faces})"));
    let model = match shape {
        Shape::Tube => file.add(&format!("{model}('',({shell}))")),
        Shape::Solid => file.add(&format!("{model}('',{shell})")),
    };
    let context = context(file);
    file.add(&format!("{representation}('',({model}),{context})"))
}

/// Millimetres, radians, and the accuracy with which edges lie on faces.
fn context(file: &mut Instances) -> Id {
    let length = file.add("(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.))");
    let angle = file.add("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))");
    let solid_angle = file.add("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())");
    let uncertainty = file.add(&format!(
        "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-4),{length},\
         'distance_accuracy_value','')"
    ));
    file.add(&format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)\n\
         GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({uncertainty}))\n\
         GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle}))\n\
         REPRESENTATION_CONTEXT('',''))"
    ))
}

/// The product that the shape belongs to; `name` is quoted.
pub fn product(file: &mut Instances, schema: Schema, name: &str, shape: Id) {
    let (application, protocol, year) = match schema {
        Schema::Ap214 => ("automotive design", "automotive_design", 2000),
        Schema::Ap242 => {
            ("managed model based 3d engineering", "ap242_managed_model_based_3d_engineering", 2014)
        }
    };
    let application = file.add(&format!("APPLICATION_CONTEXT('{application}')"));
    file.add(&format!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','{protocol}',{year},\
         {application})"
    ));
    let context = file.add(&format!("PRODUCT_CONTEXT('',{application},'mechanical')"));
    let product = file.add(&format!("PRODUCT({name},{name},'',({context}))"));
    if schema == Schema::Ap242 {
        // AP242 requires every product to be in a category.
        file.add(&format!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({product}))"));
    }
    let formation = file.add(&format!("PRODUCT_DEFINITION_FORMATION('','',{product})"));
    let context =
        file.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"));
    let definition = file.add(&format!("PRODUCT_DEFINITION('design','',{formation},{context})"));
    let definition = file.add(&format!("PRODUCT_DEFINITION_SHAPE('','',{definition})"));
    file.add(&format!("SHAPE_DEFINITION_REPRESENTATION({definition},{shape})"));
}
