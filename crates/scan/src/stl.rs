//! Stereolithography, text or binary: triangles without shared points, which are welded.
//!
//! A binary file has an 80-byte header of any content, the number of triangles, and 50 bytes for
//! each. Headers often begin with `solid`, like text files, so the length decides first.

mod ascii;
mod binary;

use super::fault::ScanFault;
use super::{Scan, text};

pub(super) use binary::is_binary_by_length;

/// Decodes a complete STL file.
///
/// # Errors
/// See [`ScanFault`]; the first fault found, with its line or triangle.
pub(super) fn read(bytes: &[u8]) -> Result<Scan, ScanFault> {
    if is_text(bytes) { ascii::read(bytes) } else { binary::read(bytes) }
}

/// Whether the file contains everything it announces: text ends with `endsolid`, and the length of
/// a binary file matches its number of triangles.
///
/// # Errors
/// [`ScanFault::CutShort`] if something is missing.
pub(super) fn completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    if is_text(bytes) { ascii::completeness(bytes) } else { binary::completeness(bytes) }
}

/// Whether the file is text: it has no control characters, and its length is not that of a binary
/// file. The text reader refuses text of another kind.
fn is_text(bytes: &[u8]) -> bool {
    !is_binary_by_length(bytes) && text::refuse_binary(bytes).is_ok()
}
