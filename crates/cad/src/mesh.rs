//! Triangles → mesh files: STL, OBJ and binary glTF.
//!
//! The triangles come from [`gaiter_spline::facets`]; this module only writes them. Numbers are
//! rounded to each format's precision, the same way for every triangle that shares a point, so a
//! closed mesh stays closed.

pub mod glb;
pub mod obj;
pub mod stl;
