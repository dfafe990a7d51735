//! PLY, the Polygon File Format of Stanford: a text header that lists elements and their
//! properties, then the elements as text or binary in either byte order.
//!
//! Only the `x`, `y`, `z` of `vertex` are read, and the list `vertex_indices` or `vertex_index` of
//! `face` and `tristrips`. All other elements and properties are skipped, whatever their type, unless they
//! may be faces under another name.

mod ascii;
mod binary;
mod header;
mod values;
mod writer;

use super::fault::ScanFault;
use super::weld::welded;
use super::{Scan, text};
use header::{Encoding, Header};

pub(super) use header::opens;

/// Decodes a complete PLY file. A file that is longer than its header declares is refused, because
/// either the header or the rest is wrong.
///
/// # Errors
/// See [`ScanFault`]; the first fault found, with its line, or its element and byte.
pub(super) fn read(bytes: &[u8]) -> Result<Scan, ScanFault> {
    let bytes = text::without_mark(bytes);
    let header = Header::read(bytes)?;
    let (has, says, what) = match header.encoding {
        Encoding::Ascii => (ascii::line_count(bytes, &header), header.record_count(), "lines"),
        _ => (bytes.len(), binary::extent(bytes, &header)?, "bytes"),
    };
    if has > says {
        return Err(ScanFault::TooLong { what, has, says });
    }
    let mesh = match header.encoding {
        Encoding::Ascii => values::mesh(&header, ascii::Lines::after_header(bytes, &header)),
        _ => values::mesh(&header, binary::Bytes::after_header(bytes, &header)),
    }?;
    Ok(welded(mesh))
}

/// Whether all elements that the header announces are present: by arithmetic in binary files, where
/// only the lengths of lists are read, and by counting lines in text.
///
/// # Errors
/// [`ScanFault::CutShort`] with details; a header that cannot be read is left to [`read`].
pub(super) fn completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    let bytes = text::without_mark(bytes);
    let header = match Header::read(bytes) {
        Ok(header) => header,
        Err(cut @ ScanFault::CutShort { .. }) => return Err(cut),
        Err(_) => return text::refuse_reserved(bytes),
    };
    if header.encoding != Encoding::Ascii {
        return match binary::extent(bytes, &header) {
            Err(cut @ ScanFault::CutShort { .. }) => Err(cut),
            _ => Ok(()),
        };
    }
    text::refuse_binary(bytes)?;
    let mut lines = ascii::line_count(bytes, &header);
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        if lines < element.count {
            return Err(element.missing(lines));
        }
        lines -= element.count;
    }
    text::refuse_open_line(bytes)
}
