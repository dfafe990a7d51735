//! Triangles → mesh files: STL, OBJ and binary glTF.
//!
//! The triangles come from [`crate::spline::facets`]; here they are only written down. Numbers are
//! rounded to what each format holds, the same for every triangle that meets in a point, so a mesh
//! that is closed stays closed.

pub mod glb;
pub mod obj;
pub mod stl;
