//! Writes that survive a power cut: content is synced before its name, names by syncing their folder.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, Read, Write};
use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};

use rustix::fs::{CWD, Mode, RenameFlags, renameat_with};
use rustix::io::Errno;
use sha2::{Digest, Sha256};

use crate::store::Access;

impl Access {
    /// Leaves the group the rights that [`Access::Group`] gives. Without a later change of mode, which
    /// would take the set-group-id bit from a folder and which systemd's RestrictSUIDSGID forbids, the
    /// umask decides.
    pub fn open_umask() {
        rustix::process::umask(Mode::WGRP | Mode::RWXO);
    }

    /// Writes a new file and syncs its content; its name is durable once its folder is synced.
    ///
    /// # Errors
    /// Any I/O error, also if the file already exists.
    pub fn write_new(self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        self.write_unsynced(path, bytes)?.sync_all()
    }

    /// Writes a new file. Its content is durable once the file that is returned is synced, its name once
    /// its folder is.
    ///
    /// # Errors
    /// Any I/O error, also if the file already exists.
    pub fn write_unsynced(self, path: &Path, bytes: &[u8]) -> io::Result<File> {
        let mut file = self.create(path)?;
        file.write_all(bytes)?;
        Ok(file)
    }

    /// Copies a file into a new one, which is returned, still to be synced, with the digest of what was
    /// written.
    ///
    /// # Errors
    /// Any I/O error, also if the new file already exists.
    pub fn copy_unsynced(self, from: &Path, to: &Path) -> io::Result<(File, [u8; 32])> {
        let mut source = File::open(from)?;
        let mut file = self.create(to)?;
        let (mut digest, mut piece) = (Sha256::new(), vec![0; PIECE_BYTES]);
        loop {
            match source.read(&mut piece) {
                Ok(0) => break,
                Ok(length) => {
                    digest.update(&piece[..length]);
                    file.write_all(&piece[..length])?;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok((file, digest.finalize().into()))
    }

    /// Makes a new folder.
    ///
    /// # Errors
    /// Any I/O error, also if the name already exists.
    pub fn make_folder(self, path: &Path) -> io::Result<()> {
        fs::DirBuilder::new().mode(self.folder_mode()).create(path)?;
        match self {
            Access::Private => {
                fs::set_permissions(path, Permissions::from_mode(self.folder_mode()))
            }
            Access::Group => Ok(()),
        }
    }

    /// Makes a folder, if there is none.
    ///
    /// # Errors
    /// Any I/O error, also if the name belongs to something other than a folder.
    pub fn make_folder_once(self, path: &Path) -> io::Result<()> {
        match self.make_folder(path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && path.is_dir() => Ok(()),
            other => other,
        }
    }

    fn create(self, path: &Path) -> io::Result<File> {
        let mut options = OpenOptions::new();
        let file = options.write(true).create_new(true).mode(self.file_mode()).open(path)?;
        if self == Access::Private {
            file.set_permissions(Permissions::from_mode(self.file_mode()))?;
        }
        Ok(file)
    }
}

/// How much of a file is in memory while it is copied.
const PIECE_BYTES: usize = 256 * 1024;

/// Writes a new file for the owner only; see [`Access::write_new`].
pub fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    Access::Private.write_new(path, bytes)
}

/// Writes a file that never changes, for the owner only, if there is none.
pub fn write_once(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match write_new(path, bytes) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
        written => written,
    }
}

/// Makes a new folder for the owner only; see [`Access::make_folder`].
pub fn make_folder(path: &Path) -> io::Result<()> {
    Access::Private.make_folder(path)
}

/// Makes a folder for the owner only, if there is none; see [`Access::make_folder_once`].
pub fn make_folder_once(path: &Path) -> io::Result<()> {
    Access::Private.make_folder_once(path)
}

/// Opens a folder of ours within another, creates it if needed, and removes what a crash left half made
/// in it: everything under a dot name. Returns its path.
pub fn open_folder(within: &Path, name: &str) -> io::Result<PathBuf> {
    let folder = within.join(name);
    make_folder_once(&folder)?;
    sync_folder(within)?;
    clear_hidden(&folder)?;
    // The last run may have renamed something and ended before it synced the folder.
    sync_folder(&folder)?;
    Ok(folder)
}

/// Writes a file of such a folder for the owner only, in place of an earlier one of this name; durable on
/// return.
///
/// # Errors
/// Any I/O error; the earlier file then stays.
pub fn replace_file(folder: &Path, name: &str, bytes: &[u8]) -> io::Result<()> {
    let staged = folder.join(format!(".{name}"));
    remove_file(&staged)?;
    write_new(&staged, bytes)?;
    fs::rename(&staged, folder.join(name))?;
    sync_folder(folder)
}

/// Removes every file and folder under a dot name.
pub fn clear_hidden(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if !entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        match entry.file_type()?.is_dir() {
            true => remove_folder(&entry.path())?,
            false => remove_file(&entry.path())?,
        }
    }
    Ok(())
}

/// Makes the names within a folder durable.
pub fn sync_folder(path: &Path) -> io::Result<()> {
    File::open(path)?.sync_all()
}

/// Renames a folder to its final name, never over another.
///
/// # Errors
/// `AlreadyExists` if the name is taken; any other I/O error.
pub fn rename_new(from: &Path, to: &Path) -> io::Result<()> {
    match renameat_with(CWD, from, CWD, to, RenameFlags::NOREPLACE) {
        // Some network file systems do not support NOREPLACE. A plain rename never replaces a folder
        // with content, and ours always have content.
        Err(Errno::INVAL | Errno::NOSYS | Errno::OPNOTSUPP) => rename_unless_there(from, to),
        other => other.map_err(io::Error::from),
    }
}

fn rename_unless_there(from: &Path, to: &Path) -> io::Result<()> {
    if to.symlink_metadata().is_ok() {
        return Err(io::Error::from(io::ErrorKind::AlreadyExists));
    }
    fs::rename(from, to)
}

/// Removes a folder and everything in it, if it exists.
///
/// # Errors
/// Any other I/O error.
pub fn remove_folder(path: &Path) -> io::Result<()> {
    if_there(fs::remove_dir_all(path)).map(drop)
}

/// Removes a file, if it exists.
///
/// # Errors
/// Any other I/O error.
pub fn remove_file(path: &Path) -> io::Result<()> {
    if_there(fs::remove_file(path)).map(drop)
}

/// What was done with a path; `None` if there is nothing at that path.
///
/// # Errors
/// Any other I/O error.
pub fn if_there<T>(done: io::Result<T>) -> io::Result<Option<T>> {
    match done {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        done => done.map(Some),
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::MetadataExt;

    use super::*;

    #[test]
    fn what_is_written_is_for_the_owner_only() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("f");
        make_folder_once(&folder).unwrap();
        make_folder_once(&folder).unwrap();
        write_new(&folder.join("x"), b"x").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        assert_eq!((mode(&folder), mode(&folder.join("x"))), (0o700, 0o600));
    }

    #[test]
    fn a_group_may_read_what_is_made_for_it_and_folders_keep_the_bit_that_hands_it_on() {
        let dir = tempfile::tempdir().unwrap();
        let (root, mode) = (dir.path(), |path: &Path| fs::metadata(path).unwrap().mode() & 0o7777);
        fs::set_permissions(root, Permissions::from_mode(0o2750)).unwrap();
        Access::open_umask();
        let folder = root.join("patient");
        Access::Group.make_folder_once(&folder).unwrap();
        Access::Group.make_folder(&folder.join("record")).unwrap();
        Access::Group.write_new(&folder.join("record/x"), b"x").unwrap();
        Access::Group.copy_unsynced(&folder.join("record/x"), &folder.join("record/y")).unwrap();
        assert_eq!((mode(&folder), mode(&folder.join("record"))), (0o2750, 0o2750));
        let files = ["x", "y"].map(|name| mode(&folder.join("record").join(name)));
        assert_eq!(files, [0o640; 2]);
        assert_eq!(Access::of_folder(mode(&folder)), Access::Group);
        make_folder(&root.join("private")).unwrap();
        assert_eq!(Access::of_folder(mode(&root.join("private"))), Access::Private);
    }

    #[test]
    fn a_rename_never_replaces() {
        let dir = tempfile::tempdir().unwrap();
        let (from, to) = (dir.path().join("from"), dir.path().join("to"));
        make_folder(&from).unwrap();
        make_folder(&to).unwrap();
        for rename in [rename_new, rename_unless_there] {
            let refused = rename(&from, &to).unwrap_err();
            assert_eq!(refused.kind(), io::ErrorKind::AlreadyExists);
        }
        assert!(from.is_dir());
    }
}
