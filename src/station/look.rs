//! One look at an export folder: which files could be scans, and their stamps. Nothing is opened.

use std::collections::BTreeMap;
use std::fs::{self, Metadata};
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use crate::flow::Stamp;
use crate::scan::Format;

/// Endings under which scanners and copying programs write what is not finished.
const UNFINISHED: [&str; 2] = [".part", ".tmp"];

/// What a look found.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Found {
    /// Regular files whose ending says that they are scans.
    pub files: BTreeMap<PathBuf, Stamp>,
    /// How many other regular files lie there, unfinished ones aside.
    pub strange: usize,
}

/// Lists a folder. Links, folders, pipes and hidden files do not count.
///
/// # Errors
/// Where the folder cannot be listed to its end: half a list would make files vanish.
pub fn look(folder: &Path) -> io::Result<Found> {
    let mut found = Found::default();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let Some(name) = path.file_name().map(|name| name.to_string_lossy()) else { continue };
        let unfinished = UNFINISHED.iter().any(|end| name.to_ascii_lowercase().ends_with(end));
        if name.starts_with('.') || unfinished {
            continue;
        }
        // A file that cannot be examined is one that is not there yet; others do not wait for it.
        let Ok(metadata) = path.symlink_metadata() else { continue };
        if !metadata.is_file() {
            continue;
        }
        if Format::of_file_name(&name).is_err() {
            found.strange += 1;
            continue;
        }
        found.files.insert(path, stamp(&metadata));
    }
    Ok(found)
}

/// The stamp of a file.
pub fn stamp(metadata: &Metadata) -> Stamp {
    let ns = |seconds: i64, nanoseconds: i64| {
        i128::from(seconds) * 1_000_000_000 + i128::from(nanoseconds)
    };
    Stamp {
        dev: metadata.dev(),
        ino: metadata.ino(),
        size: metadata.size(),
        mtime_ns: ns(metadata.mtime(), metadata.mtime_nsec()),
        ctime_ns: ns(metadata.ctime(), metadata.ctime_nsec()),
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn only_regular_files_that_could_be_scans_are_found() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        for name in ["a.obj", "B.OBJ", ".c.obj", "d.obj.part", "e.TMP", "notes.pdf"] {
            fs::write(at(name), name).unwrap();
        }
        fs::create_dir(at("folder.obj")).unwrap();
        symlink(at("a.obj"), at("link.obj")).unwrap();
        symlink("/nowhere", at("broken.obj")).unwrap();
        rustix::fs::mkfifoat(rustix::fs::CWD, at("pipe.obj"), rustix::fs::Mode::RUSR).unwrap();
        let found = look(dir.path()).unwrap();
        let names: Vec<PathBuf> = found.files.into_keys().collect();
        assert_eq!(names, [at("B.OBJ"), at("a.obj")]);
        assert_eq!(found.strange, 1);
    }

    #[test]
    fn a_missing_folder_is_no_empty_folder() {
        assert!(look(Path::new("/nowhere/at/all")).is_err());
    }
}
