//! The folders of a record store.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_flow::patient::naming::RecordName;

use super::{StoreFault, tried};

/// The folders in a patient's folder that are named like records, sorted by the meaning of their names:
/// a scan's revisions follow one another.
pub(super) fn records_in(patient: &Path) -> Result<Vec<(RecordName, PathBuf)>, StoreFault> {
    let named = |place: PathBuf| {
        let name = place.file_name().and_then(OsStr::to_str).and_then(RecordName::read)?;
        Some((name, place))
    };
    let mut records: Vec<_> = folders(patient)?.into_iter().filter_map(named).collect();
    records.sort();
    Ok(records)
}

/// The folders in a folder; links are not followed.
pub(super) fn folders(within: &Path) -> Result<Vec<PathBuf>, StoreFault> {
    let list = || -> io::Result<Vec<PathBuf>> {
        let mut folders = Vec::new();
        for entry in fs::read_dir(within)? {
            let entry = entry?;
            if entry.file_type()?.is_dir() {
                folders.push(entry.path());
            }
        }
        Ok(folders)
    };
    tried("listing", within, list())
}
