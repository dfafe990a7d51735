//! A folder of JSON files in the state folder: decisions, erasures, and what the stores note of what they handed over.
//! The journal can be made anew from spool, quarantine and stores; what these files hold cannot.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use super::durable;

/// The file-name ending.
const ENDING: &str = ".json";

/// The folder. A file is named without its ending.
#[derive(Debug, Clone)]
pub struct JsonFolder(PathBuf);

impl JsonFolder {
    /// The folder at this path, which may not be there yet.
    pub fn new(path: PathBuf) -> JsonFolder {
        JsonFolder(path)
    }

    /// Makes the folder if there is none.
    pub fn make(&self) -> io::Result<()> {
        durable::make_folder_once(&self.0)?;
        durable::sync_folder(self.0.parent().unwrap_or(Path::new("/")))
    }

    /// Opens a folder of this name, creates it if needed, and removes files that a crash left half written.
    pub fn open(state_dir: &Path, name: &str) -> io::Result<JsonFolder> {
        Ok(JsonFolder(durable::open_folder(state_dir, name)?))
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Where a file is, or would be.
    pub fn file(&self, name: &str) -> PathBuf {
        self.0.join(format!("{name}{ENDING}"))
    }

    /// The files' names, sorted.
    pub fn names(&self) -> io::Result<Vec<String>> {
        let mut names = Vec::new();
        for entry in fs::read_dir(&self.0)? {
            let name = entry?.file_name();
            names.extend(name.to_string_lossy().strip_suffix(ENDING).map(str::to_owned));
        }
        names.retain(|name| !name.starts_with('.'));
        names.sort();
        Ok(names)
    }

    /// The bytes of a file; `None` if there is none.
    pub fn bytes(&self, name: &str) -> io::Result<Option<Vec<u8>>> {
        durable::if_there(fs::read(self.file(name)))
    }

    /// What a file holds; `None` if there is none.
    ///
    /// # Errors
    /// Any I/O error; `InvalidData` if it holds something else.
    pub fn read<T: DeserializeOwned>(&self, name: &str) -> io::Result<Option<T>> {
        let Some(bytes) = self.bytes(name)? else { return Ok(None) };
        let read = serde_json::from_slice(&bytes);
        read.map(Some).map_err(|error| io::Error::new(ErrorKind::InvalidData, error))
    }

    /// Writes a file, in the place of an earlier one; durable on return.
    ///
    /// # Errors
    /// Any I/O error; the earlier file then stays.
    pub fn keep(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        durable::replace_file(&self.0, &format!("{name}{ENDING}"), bytes)
    }

    /// Removes a file, if there is one.
    pub fn remove(&self, name: &str) -> io::Result<()> {
        match durable::if_there(fs::remove_file(self.file(name)))? {
            Some(()) => durable::sync_folder(&self.0),
            None => Ok(()),
        }
    }
}
