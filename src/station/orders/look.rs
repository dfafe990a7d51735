//! One look at the folder of orders.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::super::look::stamp;
use super::super::patience::Pulse;
use crate::flow::{Group, Mask, Stamp};

/// The files that may be orders.
pub type Orders = BTreeMap<PathBuf, Group>;

/// Lists a folder's regular files whose names the mask means. Links are not followed.
///
/// # Errors
/// Where the folder cannot be listed to its end.
pub fn look(folder: &Path, mask: &Mask, pulse: &Pulse) -> io::Result<Orders> {
    let mut orders = Orders::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        pulse.beat();
        if !mask.means(&entry.file_name().to_string_lossy()) {
            continue;
        }
        // A file that cannot be examined is one that is not there yet.
        let Ok(metadata) = entry.path().symlink_metadata() else { continue };
        if metadata.is_file() {
            orders.insert(entry.path(), Group::from(stamp(&metadata)));
        }
    }
    Ok(orders)
}

/// Removes a file that is still in this state; one that is not is another by now.
///
/// # Errors
/// Where it cannot be removed.
pub fn remove(path: &Path, read: Stamp) -> io::Result<()> {
    let removed = path.symlink_metadata().and_then(|metadata| match stamp(&metadata) == read {
        true => fs::remove_file(path),
        false => Ok(()),
    });
    match removed {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        other => other,
    }
}
