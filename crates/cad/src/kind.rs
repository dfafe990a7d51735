//! The kinds of file that can be made from a surface.

use std::collections::BTreeSet;

use gaiter_spline::{Ends, Surface, TessellationFault, facets};
use serde::{Deserialize, Serialize};

use super::ends::{EndNotPlane, Shape};
use super::header::FileHeader;
use super::step::{self, Schema};
use super::{iges, mesh};

/// The notation of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum FileFormat {
    /// STEP, exact.
    Step(Schema),
    /// IGES 5.3, exact.
    Iges,
    /// Binary STL, triangles.
    Stl,
    /// Wavefront OBJ, triangles.
    Obj,
    /// Binary glTF, triangles.
    Glb,
}

/// One kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FileKind {
    /// Its file format.
    pub format: FileFormat,
    /// What it contains of the leg.
    pub shape: Shape,
}

/// Which files are made of each leg.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// The kinds of file; empty for none.
    pub files: BTreeSet<FileKind>,
    /// How far the triangles of a mesh may lie from the surface, mm, above 0.
    pub mesh_tolerance_mm: f64,
}

/// A tenth of the noise of the best scans, and finer than a printer can show.
const MESH_TOLERANCE_MM: f64 = 0.05;

impl Default for Output {
    /// The tube as STEP AP214, which is exact and which most CAD systems read.
    fn default() -> Output {
        let step = FileKind { format: FileFormat::Step(Schema::Ap214), shape: Shape::Tube };
        Output { files: BTreeSet::from([step]), mesh_tolerance_mm: MESH_TOLERANCE_MM }
    }
}

/// Why a file cannot be made of a surface.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CadFault {
    /// The surface cannot become a solid.
    #[error(transparent)]
    EndNotPlane(#[from] EndNotPlane),
    /// The surface cannot become triangles.
    #[error(transparent)]
    Tessellation(#[from] TessellationFault),
}

impl CadFault {
    /// The stable code of this fault, for records.
    pub fn code(&self) -> &'static str {
        match self {
            CadFault::EndNotPlane(_) => "ends-not-plane",
            CadFault::Tessellation(_) => "mesh-not-made",
        }
    }
}

impl FileKind {
    /// The part of the file name after the leg's name: `-ap242-solid.step`.
    pub fn ending(self) -> String {
        let (protocol, ending) = match self.format {
            FileFormat::Step(Schema::Ap214) => ("", "step"),
            FileFormat::Step(Schema::Ap242) => ("-ap242", "step"),
            FileFormat::Iges => ("", "igs"),
            FileFormat::Stl => ("", "stl"),
            FileFormat::Obj => ("", "obj"),
            FileFormat::Glb => ("", "glb"),
        };
        let shape = match self.shape {
            Shape::Tube => "",
            Shape::Solid => "-solid",
        };
        format!("{protocol}{shape}.{ending}")
    }

    /// The bytes of the file. `mesh_tolerance_mm` applies to triangles only; STEP and IGES are exact.
    ///
    /// # Errors
    /// [`CadFault`]: the ends of a solid are not plane, or the surface has no triangles within the
    /// tolerance.
    pub fn bytes(
        self,
        surface: &Surface,
        mesh_tolerance_mm: f64,
        header: &FileHeader,
    ) -> Result<Vec<u8>, CadFault> {
        let triangles = || {
            let ends = match self.shape {
                Shape::Tube => Ends::Open,
                Shape::Solid => Ends::Fans,
            };
            facets(surface, mesh_tolerance_mm, ends)
        };
        Ok(match self.format {
            FileFormat::Step(schema) => step::write(surface, self.shape, schema, header)?,
            FileFormat::Iges => iges::write(surface, self.shape, header)?,
            FileFormat::Stl => mesh::stl(&triangles()?, header),
            FileFormat::Obj => mesh::obj(&triangles()?, header),
            FileFormat::Glb => mesh::glb(&triangles()?, header),
        })
    }
}
