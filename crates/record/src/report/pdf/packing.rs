//! Compression of the streams of a PDF.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

/// Fast rather than small, because every scan gets a PDF: level 6 saves a seventh of its size but takes
/// five times as long.
const LEVEL: Compression = Compression::fast();

/// Compresses bytes for the `FlateDecode` filter.
pub(super) fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(bytes.len() / 3), LEVEL);
    // Writing to memory never fails. Uncompressed bytes would not be a valid stream.
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.unwrap_or_default()
}
