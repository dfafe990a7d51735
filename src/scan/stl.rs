//! Stereolithography, text or binary: triangles without shared points, which are welded.
//!
//! A binary file has an 80-byte header of any content, the number of triangles, and 50 bytes for
//! each. Headers often begin with `solid` as text files do, so the length decides first.

mod ascii;
mod binary;

use super::fault::ScanFault;
use super::{Scan, text};

pub(super) use binary::is_binary_by_length;

/// Decodes an STL file that is complete.
///
/// # Errors
/// See [`ScanFault`]; the first fault found, with its line or triangle.
pub(super) fn read(bytes: &[u8]) -> Result<Scan, ScanFault> {
    if is_text(bytes) { ascii::read(bytes) } else { binary::read(bytes) }
}

/// Whether the file holds what it announces: text ends with `endsolid`, binary files have the
/// length of their number of triangles.
///
/// # Errors
/// [`ScanFault::CutShort`] where something is missing.
pub(super) fn completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    if is_text(bytes) { ascii::completeness(bytes) } else { binary::completeness(bytes) }
}

/// Whether the file is text: it begins with `solid`, has no control characters, and its length is
/// not that of a binary file. Text of another kind is for the reader of text to refuse.
fn is_text(bytes: &[u8]) -> bool {
    !is_binary_by_length(bytes) && text::refuse_binary(bytes).is_ok()
}
