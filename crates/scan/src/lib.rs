//! Bytes → [`Scan`].
//!
#![doc = include_str!("../README.md")]
//!
//! Memory: besides the input, a decoder needs at most 16 MB plus twelve times the bytes of the
//! points (24 each) and triangles (12 each) read so far. Counts in a header are trusted only as far
//! as the bytes for them are present.

#![warn(missing_docs)]

pub mod ending;
pub mod fault;
mod format;
mod obj;
pub mod ord;
mod ply;
mod sniff;
mod stl;
mod text;
mod weld;
mod wrl;
mod xyz;

use nalgebra::Point3;

pub use fault::{CutSign, ScanFault, SourcePosition};
pub use format::{Content, Format};

/// One export of the scanner as it is: without unit or up axis, and in arbitrary order.
///
/// Invariants, guaranteed by the decoders: there is at least one point; every coordinate is finite;
/// every triangle index is within `points`; no triangle uses a point twice. If there are triangles,
/// no two points coincide and every point belongs to a triangle. `triangles` may be empty, for a
/// bare point cloud.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// Points in the export's own unit and axes.
    pub points: Vec<Point3<f64>>,
    /// Triangles as indices into `points`; which way round they are wound may be wrong.
    pub triangles: Vec<[u32; 3]>,
}

/// How many points or triangles make a piece of a fingerprint: so many that the calls cost nothing.
const PIECE: usize = 4096;

impl Scan {
    /// Gives `each` the number of points, the points and the triangles as bytes, in order and in pieces:
    /// what a fingerprint is the hash of. Scans are equal exactly if these bytes are.
    pub fn each_piece(&self, mut each: impl FnMut(&[u8])) {
        let mut piece = Vec::new();
        each(&(self.points.len() as u64).to_le_bytes());
        for points in self.points.chunks(PIECE) {
            piece.clear();
            for value in points.iter().flat_map(|point| point.iter()) {
                // The two zeros are one place.
                piece.extend_from_slice(&(value + 0.0).to_le_bytes());
            }
            each(&piece);
        }
        for triangles in self.triangles.chunks(PIECE) {
            piece.clear();
            for corner in triangles.as_flattened() {
                piece.extend_from_slice(&corner.to_le_bytes());
            }
            each(&piece);
        }
    }
}

/// How a file ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Nothing shows that more is to come.
    Whole,
    /// Without a line end but with a whole surface: an OBJ mesh whose last face joins the others, and whose points
    /// all belong to a face. Some exporters never write a last line end.
    NoLineEnd,
    /// More is to come, or was to.
    CutShort,
}

/// What one export is.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Its scan, or the first fault found, with its place.
    pub scan: Result<Scan, ScanFault>,
    /// How its file ends.
    pub end: End,
}

/// Decodes the bytes of one export.
///
/// # Errors
/// The first fault found, with its place; see [`ScanFault`].
pub fn read(bytes: &[u8], format: Format) -> Result<Scan, ScanFault> {
    reading(bytes, format).scan
}

/// Decodes the bytes of one export, and reports how they end.
pub fn reading(bytes: &[u8], format: Format) -> Reading {
    if let Some(fault) = misnamed(bytes, format) {
        return Reading { scan: Err(fault), end: End::Whole };
    }
    match completeness(bytes, format) {
        Ok(()) => Reading { scan: decoded(bytes, format), end: End::Whole },
        Err(fault) if !fault.may_be_mended_by_waiting() => {
            Reading { scan: Err(fault), end: End::Whole }
        }
        Err(cut) => {
            let unended = if format == Format::Obj { obj::read_unended(bytes) } else { None };
            match unended {
                Some(scan) => Reading { scan: scan.map_err(|_| cut), end: End::NoLineEnd },
                None => Reading { scan: Err(cut), end: End::CutShort },
            }
        }
    }
}

/// The scan in bytes that are not cut short.
fn decoded(bytes: &[u8], format: Format) -> Result<Scan, ScanFault> {
    let scan = match format {
        Format::Obj => obj::read(bytes),
        Format::Ply => ply::read(bytes),
        Format::Stl => stl::read(bytes),
        Format::Wrl => wrl::read(bytes),
        Format::Xyz => xyz::read(bytes),
    }?;
    if scan.points.is_empty() { Err(ScanFault::NoPoints) } else { Ok(scan) }
}

/// Checks whether bytes are cut short, without decoding them completely; cheap enough for every look.
///
/// # Errors
/// [`ScanFault::Empty`] or [`ScanFault::CutShort`], which waiting may resolve, or an obvious
/// earlier fault; all others are left to [`read`].
pub fn completeness(bytes: &[u8], format: Format) -> Result<(), ScanFault> {
    if text::is_blank(bytes) {
        return Err(ScanFault::Empty);
    }
    if misnamed(bytes, format).is_some() {
        return Ok(());
    }
    match format {
        Format::Obj => obj::completeness(bytes),
        Format::Ply => ply::completeness(bytes),
        Format::Stl => stl::completeness(bytes),
        Format::Wrl => wrl::completeness(bytes),
        Format::Xyz => xyz::completeness(bytes),
    }
}

/// The fault if the content clearly has another format than the file-name ending.
fn misnamed(bytes: &[u8], format: Format) -> Option<ScanFault> {
    let content = sniff::detect(bytes)?;
    (content != Content::Scan(format)).then_some(ScanFault::LooksLike { content, format })
}
