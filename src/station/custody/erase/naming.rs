//! Files of the state folder that name a person in their bytes: refused orders, journals that were set aside.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use gaiter_flow::patient::erasure::names;

use crate::store::durable;

/// Some files of the state folder.
#[derive(Debug, Clone, Copy)]
pub(in crate::station) struct Files {
    /// Their folder; '' for the state folder itself.
    folder: &'static str,
    /// How their names begin.
    beginning: &'static str,
}

pub(in crate::station) const REFUSED_ORDERS: Files =
    Files { folder: "orders-refused", beginning: "" };

/// Journals that were set aside.
pub(in crate::station) const OLD_JOURNALS: Files =
    Files { folder: "", beginning: "journal.ruined-" };

/// Removes those of these files, or folders of files, that name a person.
pub(super) fn remove(state_dir: &Path, files: Files, patient: &str) -> io::Result<()> {
    for path in files_naming(state_dir, files, patient)? {
        match path.is_dir() {
            true => durable::remove_folder(&path)?,
            false => fs::remove_file(&path)?,
        }
    }
    let folder = state_dir.join(files.folder);
    if folder.is_dir() { durable::sync_folder(&folder) } else { Ok(()) }
}

/// Those of these files, or folders of files, that name a person.
pub(in crate::station) fn files_naming(
    state_dir: &Path,
    files: Files,
    patient: &str,
) -> io::Result<Vec<PathBuf>> {
    let entries = durable::if_there(fs::read_dir(state_dir.join(files.folder)))?;
    let mut found = Vec::new();
    for entry in entries.into_iter().flatten() {
        let path = entry?.path();
        let name = path.file_name().map(OsStr::as_bytes).unwrap_or_default();
        if name.starts_with(files.beginning.as_bytes()) && holds(&path, patient)? {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// Whether a file, or a file in a folder, names a person.
fn holds(path: &Path, patient: &str) -> io::Result<bool> {
    if !path.is_dir() {
        return Ok(names(&fs::read(path)?, patient));
    }
    for entry in fs::read_dir(path)? {
        let inner = entry?.path();
        if inner.is_file() && names(&fs::read(inner)?, patient) {
            return Ok(true);
        }
    }
    Ok(false)
}
