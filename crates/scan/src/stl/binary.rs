//! Binary STL: `80 bytes, u32 count, count × (12 × f32, u16)`, little endian.

use nalgebra::Point3;

use super::super::fault::{CutSign, ScanFault, SourcePosition, cut_short};
use super::super::weld::welded;
use super::super::{Scan, text};

/// Bytes before the first triangle: the header and the triangle count.
const HEAD_BYTES: usize = 84;

/// Bytes per triangle: its normal, its corners, and an attribute.
const TRIANGLE_BYTES: usize = 50;

/// Bytes of the normal before the first corner.
const NORMAL_BYTES: usize = 12;

/// Whether the length is exactly that of a binary file with its triangle count, which must be at least
/// one. This never holds for text, because four characters as a triangle count mean gigabytes.
pub(in super::super) fn is_binary_by_length(bytes: &[u8]) -> bool {
    announced(bytes).is_some_and(|count| count > 0 && length_for(count) == bytes.len())
}

/// The triangle count in the header.
fn announced(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEAD_BYTES - 4..HEAD_BYTES)?;
    Some(u32::from_le_bytes(count.try_into().ok()?) as usize)
}

fn length_for(count: usize) -> usize {
    HEAD_BYTES + TRIANGLE_BYTES * count
}

/// Whether all announced triangles are present and written.
///
/// # Errors
/// [`ScanFault::CutShort`] with details.
pub(super) fn completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    let Some(count) = announced(bytes) else {
        let what = "bytes of the header";
        return Err(cut_short(CutSign::Missing { what, has: bytes.len(), of: HEAD_BYTES }));
    };
    if bytes.len() < length_for(count) {
        let has = (bytes.len() - HEAD_BYTES) / TRIANGLE_BYTES;
        return Err(cut_short(CutSign::Missing { what: "triangles", has, of: count }));
    }
    // Windows and network shares reserve space for a file before they fill it.
    let unwritten = bytes.iter().rev().take_while(|&&byte| byte == 0).count();
    if unwritten >= TRIANGLE_BYTES && bytes.len() > HEAD_BYTES {
        return Err(cut_short(CutSign::Unwritten { bytes: unwritten }));
    }
    Ok(())
}

/// Decodes a binary STL. A file that is longer than its triangle count says is refused: either the
/// count or the rest is wrong, and a body without a leg must not pass.
///
/// # Errors
/// [`ScanFault::CutShort`], [`ScanFault::TooLong`], [`ScanFault::NotFinite`].
pub(super) fn read(bytes: &[u8]) -> Result<Scan, ScanFault> {
    completeness(bytes)?;
    let says = length_for(announced(bytes).unwrap_or_default());
    if bytes.len() != says {
        return Err(ScanFault::TooLong { what: "bytes", has: bytes.len(), says });
    }
    let records = bytes[HEAD_BYTES..].chunks_exact(TRIANGLE_BYTES);
    let mut points = Vec::with_capacity(3 * records.len());
    let mut triangles = Vec::with_capacity(records.len());
    for (index, record) in records.enumerate() {
        let first = points.len() as u32;
        for corner in 0..3 {
            let at = NORMAL_BYTES + NORMAL_BYTES * corner;
            points.push(point(&record[at..at + NORMAL_BYTES]).map_err(|(axis, value)| {
                let byte = HEAD_BYTES + TRIANGLE_BYTES * index + at + 4 * axis;
                let place = SourcePosition::Record { name: "triangle", number: index + 1, byte };
                ScanFault::NotFinite { place, found: text::spelled(f64::from(value)) }
            })?);
        }
        triangles.push([first, first + 1, first + 2]);
    }
    Ok(welded((points, triangles)))
}

/// Three little-endian numbers; otherwise the axis and value of the first number that is not finite.
fn point(bytes: &[u8]) -> Result<Point3<f64>, (usize, f32)> {
    let value = |axis: usize| {
        let part = [0, 1, 2, 3].map(|i| bytes[4 * axis + i]);
        let value = f32::from_le_bytes(part);
        if value.is_finite() { Ok(f64::from(value)) } else { Err((axis, value)) }
    };
    Ok(Point3::new(value(0)?, value(1)?, value(2)?))
}
