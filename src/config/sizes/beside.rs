//! The files that a configuration names and that belong to it: garments and size tables.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_sizes::BYTES_MAX;

/// The ending of these files in a folder.
const ENDING: &str = "toml";

/// The most files of a folder that are read: more are no collection of size tables.
const FILES_MAX: usize = 200;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextFile {
    pub path: PathBuf,
    pub text: String,
}

/// Why a path gave no files.
#[derive(Debug, thiserror::Error)]
pub enum NoFiles {
    /// It cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        source: io::Error,
    },
    /// The text is not UTF-8.
    #[error("{}:{line}: this is not UTF-8 text; save the file as UTF-8", path.display())]
    NotUtf8 {
        path: PathBuf,
        /// The line of the first such byte, from 1.
        line: usize,
    },
    /// The file is too long for its kind.
    #[error("{} has {found} bytes; such a file has at most {BYTES_MAX}", path.display())]
    TooLong {
        path: PathBuf,
        /// Its length, bytes.
        found: u64,
    },
    /// The folder holds no such file.
    #[error("{} holds no file that ends in .{ENDING}", .0.display())]
    Empty(PathBuf),
    /// The folder holds too many of them.
    #[error("{} holds more than {FILES_MAX} files that end in .{ENDING}", .0.display())]
    TooMany(PathBuf),
}

/// The file at a path, or the files of a folder in the order of their names, from the disk.
///
/// # Errors
/// See [`NoFiles`].
pub fn on_disk(named: &Path) -> Result<Vec<TextFile>, NoFiles> {
    let io = |source| NoFiles::Io { path: named.to_owned(), source };
    let paths = match fs::metadata(named).map_err(io)?.is_dir() {
        false => vec![named.to_owned()],
        true => in_folder(named)?,
    };
    let read = |path: PathBuf| text(&path).map(|text| TextFile { path, text });
    paths.into_iter().map(read).collect()
}

/// The files of a folder by their names, except hidden ones.
fn in_folder(folder: &Path) -> Result<Vec<PathBuf>, NoFiles> {
    let io = |source| NoFiles::Io { path: folder.to_owned(), source };
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        let is_hidden =
            path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        if path.extension().is_some_and(|ending| ending == ENDING) && !is_hidden {
            paths.push(path);
        }
    }
    paths.sort();
    match paths.len() {
        0 => Err(NoFiles::Empty(folder.to_owned())),
        1..=FILES_MAX => Ok(paths),
        _ => Err(NoFiles::TooMany(folder.to_owned())),
    }
}

/// The text of a file. Its length is looked at first: a scan in the wrong place is not read whole.
fn text(path: &Path) -> Result<String, NoFiles> {
    let io = |source| NoFiles::Io { path: path.to_owned(), source };
    let metadata = fs::metadata(path).map_err(io)?;
    if !metadata.is_file() {
        return Err(io(io::Error::other("is not a regular file")));
    }
    if metadata.len() > BYTES_MAX as u64 {
        return Err(NoFiles::TooLong { path: path.to_owned(), found: metadata.len() });
    }
    let bytes = fs::read(path).map_err(io)?;
    String::from_utf8(bytes).map_err(|error| {
        let sound = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = sound.iter().filter(|byte| **byte == b'\n').count() + 1;
        NoFiles::NotUtf8 { path: path.to_owned(), line }
    })
}
