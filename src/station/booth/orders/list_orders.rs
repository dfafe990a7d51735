//! One look at the folder of orders.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_flow::orders::FolderId;
use gaiter_flow::{Group, Mask};

use super::removal;
use crate::station::share::file_system::folder_id;
use crate::station::share::stall::StepCounter;
use crate::station::share::stamped_file::stamp;

/// What a look found.
#[derive(Debug)]
pub struct Found {
    /// The files that may be orders, including those under our hidden names: see [`removal`].
    pub orders: BTreeMap<PathBuf, Group>,
    /// Names that exist but whose files could not be examined.
    pub unexamined: BTreeSet<PathBuf>,
    pub folder: FolderId,
}

/// Lists a folder's regular files whose names match the mask. Links are not followed.
///
/// # Errors
/// If the folder cannot be listed completely, or another folder has taken its place meanwhile.
pub fn look(folder: &Path, mask: &Mask, counter: &StepCounter) -> io::Result<Found> {
    let before = folder_id(folder)?;
    let (mut orders, mut unexamined) = (BTreeMap::new(), BTreeSet::new());
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        counter.step();
        if !is_meant(&path, mask) {
            continue;
        }
        match path.symlink_metadata() {
            Ok(metadata) if metadata.is_file() => {
                orders.insert(path, Group::from(stamp(&metadata)));
            }
            Ok(_) => {}
            // It was removed meanwhile.
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(_) => drop(unexamined.insert(path)),
        }
    }
    if folder_id(folder)? != before {
        return Err(io::Error::other("it was replaced while it was searched"));
    }
    Ok(Found { orders, unexamined, folder: before })
}

/// Whether a path is that of an order, under its own name or under our hidden name for it.
pub fn is_meant(path: &Path, mask: &Mask) -> bool {
    let original = removal::original(path);
    let name = original.as_deref().unwrap_or(path).file_name();
    name.is_some_and(|name| mask.means(&name.to_string_lossy()))
}
