//! The recorded bodies of `fixtures/scans` and their truth; the same as scans that a station takes in.

// Each test crate uses its own part.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use gaiter_leg::{Extraction, Method, Refusal, extract};
use gaiter_scan::{Format, Scan, read};
use serde_json::Value;

use crate::writers::ply;

fn path(file: &str) -> PathBuf {
    crate::root().join("fixtures/scans").join(file)
}

/// The export of a recorded body, as the scanner wrote it.
pub fn export(name: &str) -> Vec<u8> {
    unpacked(&path(&format!("{name}.obj.gz")))
}

fn unpacked(path: &Path) -> Vec<u8> {
    let packed = fs::read(path).unwrap();
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

/// What is measured on a scan, which is handed over as [`ply`].
pub fn extract_scan(scan: &Scan, method: &Method) -> Result<Extraction, Refusal> {
    extract(&ply(scan), Format::Ply, method)
}

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
    let mut bytes = unpacked(&crate::root().join(fixture));
    let first = bytes.windows(3).position(|line| line == b"\nv ").unwrap() + 3;
    let end = first + bytes[first..].iter().position(|byte| *byte == b' ').unwrap();
    bytes.splice(end..end, format!("{n:09}").bytes());
    bytes
}
