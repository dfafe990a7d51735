//! CAD files and meshes, read back.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

mod iges;
mod mesh;
mod sections_file;
mod step;

use gaiter_cad::FileHeader;

/// What the files of the test bodies say of themselves.
pub const HEADER: FileHeader = FileHeader { file_name: "left.step", product: "left leg" };
