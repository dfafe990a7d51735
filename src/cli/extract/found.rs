//! The scans that the command line names, as files or as folders.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_scan::Format;

use crate::cli::{Exit, terminal_safe};

/// Why a folder gave no scans.
#[derive(Debug, thiserror::Error)]
pub enum FolderFault {
    /// The folder, or a folder within it, cannot be listed.
    #[error("{}: {source}", terminal_safe(folder.display()))]
    Unreadable { folder: PathBuf, source: io::Error },
    /// No file in it has a scan's file ending.
    #[error(
        "{}: the folder holds no scan (.obj, .ply, .stl, .wrl, .xyz, .asc, .txt){}",
        terminal_safe(folder.display()),
        if *recursive { "" } else { "; --recursive looks into its folders, too" }
    )]
    NoScan {
        folder: PathBuf,
        /// Whether the folders within it were searched.
        recursive: bool,
    },
}

impl From<&FolderFault> for Exit {
    fn from(fault: &FolderFault) -> Exit {
        match fault {
            FolderFault::Unreadable { .. } => Exit::Io,
            FolderFault::NoScan { .. } => Exit::NoFile,
        }
    }
}

/// The requested scans, in this order. A folder is replaced by the scans in it, sorted by their
/// paths.
pub fn found(asked: &[PathBuf], recursive: bool) -> Vec<Result<PathBuf, FolderFault>> {
    let of_one = |path: &PathBuf| {
        if !path.is_dir() {
            return vec![Ok(path.clone())];
        }
        let (mut scans, mut faults) = (Vec::new(), Vec::new());
        walk(path, recursive, &mut scans, &mut faults);
        if scans.is_empty() && faults.is_empty() {
            faults.push(FolderFault::NoScan { folder: path.clone(), recursive });
        }
        scans.sort();
        scans.into_iter().map(Ok).chain(faults.into_iter().map(Err)).collect()
    };
    asked.iter().flat_map(of_one).collect()
}

/// Collects the scans of a folder. Links to folders are not followed, because they may form a cycle.
fn walk(folder: &Path, recursive: bool, scans: &mut Vec<PathBuf>, faults: &mut Vec<FolderFault>) {
    let fault = |source| FolderFault::Unreadable { folder: folder.to_owned(), source };
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(source) => return faults.push(fault(source)),
    };
    for entry in entries {
        let (path, kind) = match entry.and_then(|entry| Ok((entry.path(), entry.file_type()?))) {
            Ok(found) => found,
            Err(source) => return faults.push(fault(source)),
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with('.') {
            continue;
        }
        if kind.is_dir() {
            if recursive {
                walk(&path, recursive, scans, faults);
            }
        } else if Format::of_file_name(&name).is_ok() {
            scans.push(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_stands_for_the_scans_in_it_in_the_order_of_their_names() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        fs::create_dir_all(at("deeper/.hidden")).unwrap();
        let files = ["b.obj", "a.PLY", ".hidden.obj", "notes.pdf", "deeper/c.stl"];
        files.iter().for_each(|name| fs::write(at(name), "").unwrap());
        fs::write(at("deeper/.hidden/d.obj"), "").unwrap();
        std::os::unix::fs::symlink(dir.path(), at("deeper/back")).unwrap();
        let paths = |asked: &[PathBuf], recursive| -> Vec<PathBuf> {
            found(asked, recursive).into_iter().map(Result::unwrap).collect()
        };
        let asked = [at("z.obj"), dir.path().to_owned(), at("a.PLY")];
        let expected = ["z.obj", "a.PLY", "b.obj", "a.PLY"].map(at);
        assert_eq!(paths(&asked, false), expected);
        let deep = ["a.PLY", "b.obj", "deeper/c.stl"].map(at);
        assert_eq!(paths(&asked[1..2], true), deep);
    }

    #[test]
    fn a_folder_without_a_scan_is_no_such_file() {
        let dir = tempfile::tempdir().unwrap();
        let faults = found(&[dir.path().to_owned()], true);
        assert!(
            matches!(&faults[..], [Err(fault)] if Exit::from(fault) == Exit::NoFile),
            "{faults:?}"
        );
    }
}
