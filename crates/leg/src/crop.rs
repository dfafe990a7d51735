//! The crop of a body above its crotch, which shows no face, and what the whole body has shown. Both together give
//! the same measures as the whole, to the last bit: once the crotch is known, only what lies below the crop counts.

use gaiter_scan::{self as scan, Format, Scan};
use serde::{Deserialize, Serialize};

use crate::frame::body::Body;
use crate::method::Method;
use crate::parting::crotch::Crotch;
use crate::parting::segment::segment_below;
use crate::sections::slice::Mesh;
use crate::{Extraction, Refusal, measure};

/// The file of a scan, as the scanner wrote it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Export {
    /// Its format.
    #[serde(with = "FormatWord")]
    pub format: Format,
    /// Its points.
    pub points: usize,
    /// Its triangles.
    pub triangles: usize,
    /// Whether its last line has an end, if it has lines.
    pub has_line_end: bool,
}

/// The words for formats; the crate that reads them writes no documents.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Format", rename_all = "lowercase")]
enum FormatWord {
    Obj,
    Ply,
    Stl,
    Wrl,
    Xyz,
}

/// What a whole body shows and its crop does not.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct WholeBody {
    /// The file of the whole body's scan.
    pub export: Export,
    /// The body without its skin.
    pub body: Body,
    /// The distance of neighbouring points of a bare point cloud, mm; `None` for a mesh.
    pub cloud_spacing_mm: Option<f64>,
    /// The crotch.
    pub crotch: Crotch,
}

impl WholeBody {
    /// What the body of an extraction has shown.
    pub fn from_extraction(extraction: &Extraction) -> WholeBody {
        let Extraction { body, export, crotch, .. } = extraction;
        let is_cloud = body.mesh.triangles().is_empty();
        WholeBody {
            export: *export,
            body: Body { mesh: Mesh::default(), ..body.clone() },
            cloud_spacing_mm: is_cloud.then(|| body.mesh.spacing_mm()),
            crotch: *crotch,
        }
    }
}

impl Extraction {
    /// What of the body lies wholly below [`Crotch::crop_mm`], in the body frame: mm, z up, the floor at 0. Fragments, a
    /// scanned floor and bystanders are not in it. [`Scan::to_ply`] makes the bytes of it that [`extract_crop`] reads.
    pub fn crop(&self) -> Scan {
        let below = self.body.mesh.wholly_below(self.crotch.crop_mm());
        Scan { points: below.points().to_vec(), triangles: below.triangles().to_vec() }
    }
}

/// Measures both legs in the bytes of a crop, as on the whole body, which gave `whole`. Unit, up, facing, winding
/// and scope of the method do not count: what they are about is in `whole`.
///
/// # Errors
/// A [`Refusal`] if the bytes are no PLY file, or no leg can be measured.
pub fn extract_crop(
    bytes: &[u8],
    whole: &WholeBody,
    method: &Method,
) -> Result<Extraction, Refusal> {
    let Scan { points, triangles } = scan::read(bytes, Format::Ply)?;
    let mesh = match whole.cloud_spacing_mm {
        Some(spacing_mm) => Mesh::cloud(points, spacing_mm),
        None => Mesh::new(points, triangles),
    };
    let body = Body { mesh, ..whole.body.clone() };
    let cut = segment_below(&body, whole.crotch);
    measure(body, cut, whole.export, method)
}
