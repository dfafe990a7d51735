//! Records in a store, as a station writes them, without the wait for one.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

use gaiter_cad::Output;
use gaiter_leg::{Method, extract};
use gaiter_record::{
    Acquired, AcquiredFrom, Patient, Provenance, ReportChoice, ScanFile, Source, SourceKind,
    record_files, sha256,
};
use gaiter_scan::Format;

/// Stores the record of a scan, measured by this method, and tells its folder. `at` is when the scan
/// was first seen, as its folder tells it: 20261121T091500Z.
pub fn store(root: &Path, patient: &str, at: &str, bytes: &[u8], method: &Method) -> PathBuf {
    let extraction = extract(bytes, Format::Obj, method).unwrap();
    let sources = vec![Source::from_kind(SourceKind::FileName)];
    let acquired = "2026-11-21T09:14:59Z".parse().unwrap();
    let provenance = Provenance {
        station: Some("booth-1".to_owned()),
        patient: Some(Patient { id: patient.to_owned(), sources }),
        acquired: Some(Acquired::new(acquired, AcquiredFrom::FileTime)),
        ..Provenance::of_scan(sha256(bytes))
    };
    let scan = ScanFile { bytes, format: Format::Obj, ord: None };
    let (output, choice) = (Output::default(), ReportChoice::default());
    let made = record_files(&extraction, &provenance, method, &output, &choice, scan);
    let folder = root.join(patient).join(format!("{at}_{}", &provenance.sha256[..8]));
    fs::create_dir_all(&folder).unwrap();
    for file in made.unwrap().1 {
        fs::write(folder.join(file.name), file.bytes).unwrap();
    }
    folder
}

/// Every file below a folder with its bytes, sorted.
pub fn content(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut content = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            content.extend(self::content(&path));
        } else {
            let bytes = fs::read(&path).unwrap();
            content.push((path, bytes));
        }
    }
    content.sort();
    content
}
