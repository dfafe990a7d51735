//! Allows one station of a machine per export folder: two would make two records of each scan.
//!
//! On a local disk the folder itself is locked, which changes nothing in it. An open folder on a share
//! would prevent unmounting it, so a file on this machine is locked instead. Stations on other machines
//! are not detected.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use gaiter_flow::orders::FolderId;
use gaiter_record::sha256;
use tracing::info;

use crate::station::runtime::locked;
use crate::station::share::file_system;
use crate::store::polling::poll;

/// Where locks for shares are: a folder in which every user of the machine may create files.
const LOCKS: &str = "/run/lock";

/// How long another process may take to release a folder: a station that is ending, or its last child.
const GIVEN_BACK: Duration = Duration::from_secs(3);

/// The export folders that this process has locked. The kernel releases them when it ends.
#[derive(Debug, Default)]
pub struct ExportLocks(Mutex<BTreeMap<PathBuf, LockedFolder>>);

#[derive(Debug)]
struct LockedFolder {
    /// Which folder it was: another may have taken its place.
    id: FolderId,
    /// `None` if the file system has no locks.
    _file: Option<File>,
}

impl ExportLocks {
    /// Whether this process has the folder now, or no other process has it as far as is known. Blocks.
    ///
    /// # Errors
    /// If the folder cannot be examined.
    pub fn hold(&self, folder: &Path) -> io::Result<bool> {
        let id = file_system::folder_id(folder)?;
        let mut all = locked(&self.0);
        if all.get(folder).is_some_and(|held| held.id == id) {
            return Ok(true);
        }
        all.remove(folder);
        let locked = lock_file(folder).map_err(TryLockError::Error);
        let _file = match locked.and_then(|file| file.try_lock().map(|()| file)) {
            Ok(file) => Some(file),
            Err(TryLockError::WouldBlock) => return Ok(false),
            Err(TryLockError::Error(error)) => {
                info!(event = "export-dir-not-locked", %error);
                None
            }
        };
        all.insert(folder.to_owned(), LockedFolder { id, _file });
        Ok(true)
    }

    /// The first of these folders that another process keeps locked, if any. A folder that cannot be
    /// examined is left to the looks. Blocks.
    pub fn kept_by_another(&self, folders: &[PathBuf]) -> Option<PathBuf> {
        let kept = || folders.iter().find(|folder| matches!(self.hold(folder), Ok(false)));
        match poll(GIVEN_BACK, || kept().is_none().then_some(())) {
            Some(()) => None,
            None => kept().cloned(),
        }
    }

    /// Releases all folders except these.
    pub fn keep_only(&self, folders: &[PathBuf]) {
        let mut all = locked(&self.0);
        all.retain(|folder, _| folders.contains(folder));
    }
}

/// The file to lock for a folder.
fn lock_file(folder: &Path) -> io::Result<File> {
    if !file_system::detect(folder)?.is_network() {
        return File::open(folder);
    }
    let place = folder.canonicalize()?;
    let name = format!("gaiter-{}", &sha256(place.as_os_str().as_encoded_bytes())[..16]);
    let path = Path::new(LOCKS).join(name);
    // A file of another user can be locked but not created again.
    File::open(&path).or_else(|_| {
        OpenOptions::new().write(true).create(true).truncate(false).mode(0o644).open(&path)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_one_stations_until_it_ends_and_one_in_its_place_is_another() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("export");
        std::fs::create_dir(&folder).unwrap();
        let (first, second) = (ExportLocks::default(), ExportLocks::default());
        assert!(first.hold(&folder).unwrap() && first.hold(&folder).unwrap());
        assert!(!second.hold(&folder).unwrap());
        std::fs::rename(&folder, dir.path().join("moved")).unwrap();
        assert!(second.hold(&folder).is_err(), "it is not there");
        std::fs::create_dir(&folder).unwrap();
        assert!(second.hold(&folder).unwrap());
        assert!(!first.hold(&folder).unwrap());
        second.keep_only(&[]);
        assert!(first.hold(&folder).unwrap());
        drop(first);
        assert_eq!(second.kept_by_another(&[folder]), None);
    }
}
