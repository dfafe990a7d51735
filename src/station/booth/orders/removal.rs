//! Removes an order that was applied, and no other file: practice software may put the next order under the
//! same name at any time.
//!
//! A file cannot be compared and deleted in one step, but it can be renamed. So the order first gets a
//! hidden name of ours, then it is examined, and only the file that was read is deleted. Any other file
//! has come meanwhile and gets its own name back if that is free. If the name is taken, or if the
//! station ends in between, the file stays under the hidden name, where the next look finds it.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::io;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use rustix::fs::{CWD, RenameFlags, renameat_with};

use super::read::{self, Read};
use crate::station::share::stall::StepCounter;
use crate::station::share::stamped_file::stamp;
use crate::store::durable;

/// The ending of the hidden names. Orders have another ending, so other programs that search the folder
/// ignore these files.
const ENDING: &[u8] = b".gaiter-taken";

/// The hidden name of an order.
pub fn hidden(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().as_bytes();
    path.with_file_name(OsStr::from_bytes(&[b".".as_slice(), name, ENDING].concat()))
}

/// The order's own path, if this one is a hidden name of ours.
pub fn original(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.as_bytes().strip_prefix(b".")?.strip_suffix(ENDING)?;
    (!name.is_empty()).then(|| path.with_file_name(OsString::from(OsStr::from_bytes(name))))
}

/// Removes an order if it is still the one that was read. Another one stays.
///
/// # Errors
/// If it cannot be renamed or deleted.
pub fn remove(path: &Path, read: &Read, counter: &StepCounter) -> io::Result<()> {
    remove_in_steps(path, read, counter, || ())
}

/// Like [`remove`]; `between` is called when the order has its hidden name but is not examined yet.
pub(super) fn remove_in_steps(
    path: &Path,
    read: &Read,
    counter: &StepCounter,
    between: impl FnOnce(),
) -> io::Result<()> {
    let taken = hidden(path);
    if durable::if_there(durable::rename_new(path, &taken))?.is_none() {
        // Another process has removed it.
        return Ok(());
    }
    between();
    if is_same(&taken, read, counter) {
        return delete(&taken);
    }
    // If it cannot be put back, the next look finds it.
    let _ = put_back(&taken, path);
    Ok(())
}

/// Deletes a file under a hidden name durably: one that a power cut restores is applied again.
pub fn delete(taken: &Path) -> io::Result<()> {
    fs::remove_file(taken)?;
    durable::sync_folder(taken.parent().unwrap_or(Path::new(".")))
}

/// Gives a file under a hidden name its own name back. Never replaces another file.
///
/// # Errors
/// If the name is taken, or the file system cannot guarantee that; any other I/O error.
pub fn put_back(taken: &Path, path: &Path) -> io::Result<()> {
    Ok(renameat_with(CWD, taken, CWD, path, RenameFlags::NOREPLACE)?)
}

/// Whether a file is the one that was read: the same content, and the same inode or the same time.
fn is_same(path: &Path, read: &Read, counter: &StepCounter) -> bool {
    let now = path.symlink_metadata().and_then(|metadata| {
        if metadata.is_file() { read::read(path, stamp(&metadata), counter) } else { Ok(None) }
    });
    let Ok(Some(now)) = now else { return false };
    let is_distinct = now.file != read.file && now.state.mtime_ns != read.state.mtime_ns;
    now.state.digest == read.state.digest && !is_distinct
}
