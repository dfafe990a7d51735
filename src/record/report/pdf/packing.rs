//! Streams of a paper, packed.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

/// Quick rather than small: every scan has a paper, and level 6 saves a seventh of it in five times the
/// time.
const LEVEL: Compression = Compression::fast();

/// The bytes as `FlateDecode` reads them.
pub(super) fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(bytes.len() / 3), LEVEL);
    // Writing to memory does not fail; bytes that were not packed would not be a stream at all.
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.unwrap_or_default()
}
