//! Finds and reads the scanner's own measures next to a scan file and compares them.

use std::fs::{self, File};
use std::io::{self, Read};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use gaiter_leg::comparison::opinion::SecondOpinion;
use gaiter_leg::comparison::second_opinion::compare;
use gaiter_leg::{Extraction, Finding};
use gaiter_scan::ord;

/// The measurement file next to a scan and the findings from comparing it with the scan's extraction.
/// Both are empty if there is no such file.
pub fn opinions(scan: &Path, extraction: &Extraction) -> (Option<Vec<u8>>, Vec<Finding>) {
    let unreadable = |error: io::Error| {
        (None, vec![SecondOpinion::Unreadable { why: error.to_string() }.into()])
    };
    let files = match beside(scan) {
        Ok(files) => files,
        Err(error) => return unreadable(error),
    };
    match files.as_slice() {
        [] => (None, Vec::new()),
        [file] => bytes(file).map_or_else(unreadable, |bytes| {
            let findings = opinion(&bytes, extraction);
            // Only the beginning of a file that is too large was read.
            ((bytes.len() <= ord::BYTES_MAX).then_some(bytes), findings)
        }),
        several => (None, vec![SecondOpinion::Ambiguous { files: several.len() }.into()]),
    }
}

/// The findings from comparing the bytes of a measurement file with an extraction.
pub fn opinion(bytes: &[u8], extraction: &Extraction) -> Vec<Finding> {
    match ord::read(bytes) {
        Ok(ord) => compare(extraction, &ord),
        Err(fault) => vec![SecondOpinion::Unreadable { why: fault.to_string() }.into()],
    }
}

/// The measurement files that may belong to this scan.
fn beside(scan: &Path) -> io::Result<Vec<PathBuf>> {
    let name = scan.file_name().unwrap_or_default().as_bytes();
    let folder = match scan.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if ord::belongs(entry.file_name().as_bytes(), name) {
            files.push(entry.path());
        }
    }
    Ok(files)
}

/// Reads a file up to one byte more than a measurement file can have. That byte shows it is too large.
fn bytes(file: &Path) -> io::Result<Vec<u8>> {
    // Check before opening, because opening a pipe waits for a writer.
    if !fs::metadata(file)?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    let mut bytes = Vec::new();
    File::open(file)?.take(ord::BYTES_MAX as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}
