//! Scans of bodies that a station takes in.

#![allow(clippy::unwrap_used)]

use std::fs::File;
use std::io::Read;

/// A scan that can be measured; each `n` gives another scan of the same body.
pub fn body(n: usize) -> Vec<u8> {
    numbered(n, "fixtures/scans/f_average_clean.obj.gz")
}

/// As [`body`], measured in a third of the time.
pub fn coarse_body(n: usize) -> Vec<u8> {
    numbered(n, "fixtures/coarse/f_average.obj.gz")
}

/// The body of a fixture as scan `n` writes it: its first coordinate has further digits, which all count.
fn numbered(n: usize, fixture: &str) -> Vec<u8> {
    let file = File::open(crate::root().join(fixture)).unwrap();
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(file).read_to_end(&mut bytes).unwrap();
    let first = bytes.windows(3).position(|line| line == b"\nv ").unwrap() + 3;
    let end = first + bytes[first..].iter().position(|byte| *byte == b' ').unwrap();
    bytes.splice(end..end, format!("{n:09}").bytes());
    bytes
}
