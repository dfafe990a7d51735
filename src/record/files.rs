//! The files of a record folder, as bytes.

use sha2::{Digest, Sha256};

use super::{Provenance, compose, csv, drawing};
use crate::cad::step::{self, StepHeader};
use crate::leg::{Extraction, Method};
use crate::scan::Format;

/// The list of all other files' hashes, as `sha256sum -c` reads it.
pub const SUMS: &str = "SHA256SUMS";

/// One file of a record folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordFile {
    /// File name within the folder, ASCII, no separators.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// All files of a record folder in the order in which they are to be written: `record.json` first,
/// the scan's own bytes, and `SHA256SUMS` over all others last. The same arguments give the same
/// bytes.
///
/// # Errors
/// Where a figure cannot be written as JSON.
pub fn record_files(
    extraction: &Extraction,
    provenance: &Provenance,
    method: &Method,
    scan_bytes: &[u8],
    format: Format,
) -> Result<Vec<RecordFile>, serde_json::Error> {
    let record = compose::record(extraction, provenance, method);
    let mut json = serde_json::to_vec_pretty(&record)?;
    json.push(b'\n');
    let file = |name: &str, bytes: Vec<u8>| RecordFile { name: name.to_owned(), bytes };
    let mut files = vec![
        file("record.json", json),
        file("measurements.csv", csv::measurements(&record).into_bytes()),
        file("legs.svg", drawing::legs(extraction).into_bytes()),
    ];
    for leg in &extraction.legs {
        if let Some(surface) = &leg.surface {
            let side = leg.side.word();
            let (name, product) = (format!("{side}.step"), format!("{side} leg"));
            let header = StepHeader { file_name: &name, product: &product, time_stamp: "" };
            files.push(file(&name, step::tube(&surface.surface, &header)));
        }
    }
    files.push(file(&format!("scan.{}", format.ending()), scan_bytes.to_vec()));
    let sums = sums(&files);
    files.push(file(SUMS, sums.into_bytes()));
    Ok(files)
}

/// SHA-256 of bytes, lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A line a file: hash, two spaces, name.
fn sums(files: &[RecordFile]) -> String {
    files.iter().map(|file| format!("{}  {}\n", sha256(&file.bytes), file.name)).collect()
}
