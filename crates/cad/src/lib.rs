//! [`Surface`](gaiter_spline::Surface) → CAD files and meshes.
//!
#![doc = include_str!("../README.md")]
//!
//! | file | what it holds |
//! |---|---|
//! | [`kind`] | [`FileKind`]: the kinds of file there are, their names and their bytes |
//! | [`header`] | [`FileHeader`]: name, product and writer of a file |
//! | [`ends`] | the planes that close a tube at its ends |
//! | [`step`] | STEP AP214 and AP242: the tube as one B-spline face, or a solid |
//! | `step/boundary.rs`, `step/product.rs` | its faces and edges; its units and its product |
//! | `step/exchange.rs` | the notation of STEP files (ISO 10303-21) |
//! | [`iges`] | IGES 5.3: the tube as one B-spline surface, or a solid |
//! | `iges/solid.rs`, `iges/notation.rs` | its faces and edges; the notation of IGES files |
//! | [`mesh`] | STL, OBJ and glTF: triangles within a tolerance |

#![warn(missing_docs)]

pub mod ends;
pub mod header;
pub mod iges;
pub mod kind;
pub mod mesh;
pub mod step;

pub use ends::{End, EndNotPlane, Shape};
pub use header::FileHeader;
pub use kind::{CadFault, FileFormat, FileKind, Output};
pub use step::Schema;
