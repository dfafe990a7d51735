//! A coarse body that is measured quickly, for tests that need many scans and no figures.

#![allow(clippy::unwrap_used)]

use std::io::Read;

/// A scan that can be measured; each comment gives other bytes of the same body.
pub fn coarse(comment: impl std::fmt::Display) -> Vec<u8> {
    let gzip = include_bytes!("../../fixtures/coarse/f_average.obj.gz");
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(&gzip[..]).read_to_end(&mut bytes).unwrap();
    bytes.extend(format!("# {comment}\n").bytes());
    bytes
}
