//! Files of the state folder that name a person in their bytes: refused orders, journals that were set aside.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use gaiter_flow::patient::erasure::names;

use crate::store::durable;

/// The folder of refused orders in the state folder.
const ORDERS: &str = "orders-refused";

/// The beginning of the names of journals that were set aside.
const ASIDE: &str = "journal.ruined-";

/// Removes refused orders that name a person.
pub(super) fn remove_orders(state_dir: &Path, patient: &str) -> io::Result<()> {
    remove(&state_dir.join(ORDERS), "", patient)
}

/// Removes set-aside journals that name a person.
pub(super) fn remove_journals(state_dir: &Path, patient: &str) -> io::Result<()> {
    remove(state_dir, ASIDE, patient)
}

/// Removes the entries of a folder whose names begin so and whose bytes name a person.
fn remove(folder: &Path, beginning: &str, patient: &str) -> io::Result<()> {
    for path in naming(folder, beginning, patient)? {
        match path.is_dir() {
            true => durable::remove_folder(&path)?,
            false => fs::remove_file(&path)?,
        }
    }
    if folder.is_dir() { durable::sync_folder(folder) } else { Ok(()) }
}

/// The refused orders in a state folder that name a person.
pub(in crate::station) fn orders_naming(
    state_dir: &Path,
    patient: &str,
) -> io::Result<Vec<PathBuf>> {
    naming(&state_dir.join(ORDERS), "", patient)
}

/// The journals that were set aside in a state folder and name a person.
pub(in crate::station) fn journals_naming(
    state_dir: &Path,
    patient: &str,
) -> io::Result<Vec<PathBuf>> {
    naming(state_dir, ASIDE, patient)
}

/// The entries of a folder whose names begin so and whose bytes name a person.
fn naming(folder: &Path, beginning: &str, patient: &str) -> io::Result<Vec<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let mut found = Vec::new();
    for entry in entries {
        let path = entry?.path();
        let name = path.file_name().map(OsStr::as_bytes).unwrap_or_default();
        if name.starts_with(beginning.as_bytes()) && holds(&path, patient)? {
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
