//! The scanner's own measures beside a scan file: found, read and compared.

use std::fs::{self, File};
use std::io::{self, Read};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use crate::leg::opinion::SecondOpinion;
use crate::leg::second_opinion::compare;
use crate::leg::{Extraction, Finding};
use crate::scan::ord;

/// What the measurement file beside a scan says to its extraction; nothing where there is none.
pub fn opinions(scan: &Path, extraction: &Extraction) -> Vec<Finding> {
    let unreadable = |error: io::Error| SecondOpinion::Unreadable { why: error.to_string() };
    let read = |file: &Path| {
        let bytes = bytes(file).map_err(unreadable)?;
        ord::read(&bytes).map_err(|fault| SecondOpinion::Unreadable { why: fault.to_string() })
    };
    let found = match beside(scan).map_err(unreadable) {
        Ok(files) => match files.as_slice() {
            [] => return Vec::new(),
            [file] => read(file),
            several => Err(SecondOpinion::Ambiguous { files: several.len() }),
        },
        Err(opinion) => Err(opinion),
    };
    match found {
        Ok(ord) => compare(extraction, &ord),
        Err(opinion) => vec![opinion.into()],
    }
}

/// The measurement files that could be this scan's.
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

/// The bytes of a file, no more than a measurement file has and one that shows it to be none.
fn bytes(file: &Path) -> io::Result<Vec<u8>> {
    // Before it is opened: opening a pipe waits for a writer.
    if !fs::metadata(file)?.is_file() {
        return Err(io::Error::other("it is no regular file"));
    }
    let mut bytes = Vec::new();
    File::open(file)?.take(ord::BYTES_MAX as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}
