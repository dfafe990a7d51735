//! The state folder of a station, which belongs to one process.

use std::fs::{self, Permissions};
use std::io;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;

use tracing::warn;

use super::error::StationError;
use super::journal::StateLock;
use crate::store::{OTHERS, durable};

/// A state folder that belongs to this process.
#[derive(Debug)]
pub struct OwnStateDir {
    /// No station has run on it before.
    pub first_start: bool,
    _lock: StateLock,
}

/// Takes a state folder for this process, and creates it if needed.
///
/// # Errors
/// If it cannot be created or closed to others, or if another user or process has it.
pub fn take_state_dir(path: &Path) -> Result<OwnStateDir, StationError> {
    let state = |source| StationError::State { path: path.to_owned(), source };
    let make = || -> io::Result<()> {
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        durable::make_folder_once(path)
    };
    make().map_err(state)?;
    close(path)?;
    let lock = StateLock::take(path)?;
    // The spool is made after the first journal is complete. So a first start that was cut off, with the
    // partial journal it left, is not taken for a station that lost its journal.
    let first_start = !fs::exists(path.join("spool")).map_err(state)?;
    Ok(OwnStateDir { first_start, _lock: lock })
}

/// Takes the rights in a state folder from everybody but its owner, who must be this process's user: who may
/// write in it could plant decisions and the page's token.
fn close(path: &Path) -> Result<(), StationError> {
    let state = |source| StationError::State { path: path.to_owned(), source };
    let found = fs::metadata(path).map_err(state)?;
    if found.uid() != rustix::process::geteuid().as_raw() {
        return Err(StationError::StateOfAnother { path: path.to_owned() });
    }
    if found.mode() & OTHERS == 0 {
        return Ok(());
    }
    warn!(event = "state-folder-closed", mode = format!("{:04o}", found.mode() & 0o7777));
    fs::set_permissions(path, Permissions::from_mode(0o700)).map_err(state)?;
    // Some file systems accept a mode and keep their own.
    match fs::metadata(path).map_err(state)?.mode() & OTHERS {
        0 => Ok(()),
        _ => Err(state(io::Error::other("its file system does not let it be closed to others"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().mode() & 0o7777
    }

    #[test]
    fn a_folder_is_made_for_its_user_and_one_that_is_open_is_closed() {
        let dir = tempfile::tempdir().unwrap();
        let state = dir.path().join("state");
        drop(take_state_dir(&state).unwrap());
        assert_eq!(mode(&state), 0o700);
        for open in [0o777, 0o770, 0o755, 0o2750, 0o701] {
            fs::set_permissions(&state, Permissions::from_mode(open)).unwrap();
            drop(take_state_dir(&state).unwrap());
            assert_eq!(mode(&state), 0o700, "{open:o}");
        }
    }

    #[test]
    fn a_folder_of_another_user_is_refused_as_it_is() {
        let dir = tempfile::tempdir().unwrap();
        let state = dir.path().join("state");
        fs::create_dir(&state).unwrap();
        fs::set_permissions(&state, Permissions::from_mode(0o777)).unwrap();
        // Only root can give a folder away.
        if std::os::unix::fs::chown(&state, Some(65_534), None).is_err() {
            return;
        }
        let fault = take_state_dir(&state).unwrap_err();
        assert!(matches!(fault, StationError::StateOfAnother { .. }), "{fault}");
        assert_eq!((mode(&state), fs::read_dir(&state).unwrap().count()), (0o777, 0));
    }
}
