//! The recorded bodies of `fixtures/scans` and their truth; bodies changed and written again.

// Each test crate uses its own part.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::io::Read;
use std::path::PathBuf;

use gaiter_scan::{Format, Scan, read};
use serde_json::Value;

pub use crate::wavefront::obj;

fn path(file: &str) -> PathBuf {
    crate::root().join("fixtures/scans").join(file)
}

/// The export of a recorded body, as the scanner wrote it.
pub fn export(name: &str) -> Vec<u8> {
    let packed = fs::read(path(&format!("{name}.obj.gz"))).unwrap();
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(packed.as_slice()).read_to_end(&mut bytes).unwrap();
    bytes
}

/// What is true of the body behind a recorded export.
pub fn truth(name: &str) -> Value {
    serde_json::from_slice(&fs::read(path(&format!("{name}.truth.json"))).unwrap()).unwrap()
}

/// Points and triangles of a recorded body, in the export's unit and axes.
pub fn scan(name: &str) -> Scan {
    read(&export(name), Format::Obj).unwrap()
}
