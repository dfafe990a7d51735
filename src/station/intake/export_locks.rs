//! One station of a machine per export folder: two would make two records of each scan.
//!
//! On a local disk the folder itself is locked, which changes nothing in it. An open folder would keep a
//! share from being unmounted, so for a share a file of this machine stands for it. Stations on other
//! machines are not seen.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tracing::info;

use super::file_system;
use crate::record::sha256;
use crate::store::durable::FileId;

/// Where locks for shares lie: a folder in which every user of the machine may make files.
const LOCKS: &str = "/run/lock";

/// How long another process may take to give a folder back: a station that ends, or its last child.
const GIVEN_BACK: Duration = Duration::from_secs(3);

/// How often it is asked for meanwhile.
const ASKED: Duration = Duration::from_millis(20);

/// The export folders that this process has. The kernel gives them back when it ends.
#[derive(Debug, Default)]
pub struct ExportLocks(Mutex<BTreeMap<PathBuf, Held>>);

#[derive(Debug)]
struct Held {
    /// Which folder it was: another may have come in its place.
    id: FileId,
    /// None where the file system knows no locks.
    _file: Option<File>,
}

impl ExportLocks {
    /// Whether a folder is this process's now, or no other's as far as can be told. Blocks.
    ///
    /// # Errors
    /// Where the folder cannot be asked.
    pub fn hold(&self, folder: &Path) -> io::Result<bool> {
        let id = FileId::of(folder)?;
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if all.get(folder).is_some_and(|held| held.id == id) {
            return Ok(true);
        }
        all.remove(folder);
        let file = match lock_file(folder) {
            Ok(file) => file,
            Err(error) => {
                info!(event = "export-dir-not-locked", %error);
                all.insert(folder.to_owned(), Held { id, _file: None });
                return Ok(true);
            }
        };
        let _file = match file.try_lock() {
            Ok(()) => Some(file),
            Err(TryLockError::WouldBlock) => return Ok(false),
            Err(TryLockError::Error(error)) => {
                info!(event = "export-dir-not-locked", %error);
                None
            }
        };
        all.insert(folder.to_owned(), Held { id, _file });
        Ok(true)
    }

    /// The first of these folders that another process keeps, if any. One that cannot be asked is left to
    /// the looks. Blocks.
    pub fn kept_by_another(&self, folders: &[PathBuf]) -> Option<PathBuf> {
        let began = Instant::now();
        loop {
            let other = folders.iter().find(|folder| matches!(self.hold(folder), Ok(false)))?;
            if began.elapsed() >= GIVEN_BACK {
                return Some(other.clone());
            }
            sleep(ASKED);
        }
    }

    /// Gives up all folders but these.
    pub fn keep_only(&self, folders: &[PathBuf]) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.retain(|folder, _| folders.contains(folder));
    }
}

/// What is locked for a folder.
fn lock_file(folder: &Path) -> io::Result<File> {
    if !file_system::of(folder)?.is_network() {
        return File::open(folder);
    }
    let place = folder.canonicalize()?;
    let name = format!("gaiter-{}", &sha256(place.as_os_str().as_encoded_bytes())[..16]);
    let path = Path::new(LOCKS).join(name);
    // A file of another user can be locked and not made anew.
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
