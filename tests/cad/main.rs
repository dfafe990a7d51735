//! CAD files and meshes, read back.

mod iges;
mod mesh;
mod of_records;
mod step;
