//! The folder of a disclosure: written under a hidden name, for its owner only, and named once it is whole.

use std::cell::RefCell;
use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_flow::ScanId;
use gaiter_record::SUMS;

use super::reach::PersonFault;
use crate::cli::terminal_safe;
use crate::store::{Access, durable, sums};

/// A disclosure that is being written.
pub(super) struct Bundle {
    staged: PathBuf,
    /// What `SHA256SUMS` will list: the hash and the path of each file.
    listed: RefCell<Vec<(ScanId, String)>>,
}

impl Bundle {
    /// Begins a disclosure that is to be named `out`.
    pub(super) fn begin(out: &Path) -> Result<Bundle, PersonFault> {
        if out.symlink_metadata().is_ok() {
            return Err(PersonFault::There(terminal_safe(out.display())));
        }
        let name = out.file_name().unwrap_or_default().to_string_lossy();
        let staged = out.with_file_name(format!(".{name}.partial"));
        tried("cannot clear", &staged, durable::remove_folder(&staged))?;
        tried("cannot make", &staged, durable::make_folder(&staged))?;
        Ok(Bundle { staged, listed: RefCell::default() })
    }

    /// Copies a file or folder into a folder of the disclosure. Links are left out, and so are files whose
    /// name `takes` rejects.
    pub(super) fn copy(
        &self,
        from: &Path,
        within: &str,
        takes: impl Fn(&str) -> bool + Copy,
    ) -> Result<(), PersonFault> {
        let name = from.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let found = durable::if_there(fs::symlink_metadata(from));
        // It may have been removed, or moved by the station, since the list was made.
        let Some(found) = tried("cannot read", from, found)? else { return Ok(()) };
        if found.is_dir() {
            let within = format!("{within}/{name}");
            let entries = tried("cannot list", from, fs::read_dir(from))?;
            for entry in entries {
                let path = tried("cannot list", from, entry)?.path();
                self.copy(&path, &within, takes)?;
            }
            return Ok(());
        }
        if !found.is_file() || !takes(&name) {
            return Ok(());
        }
        let to = self.folder(within)?.join(from.file_name().unwrap_or(OsStr::new("file")));
        let copied = Access::Private.copy_unsynced(from, &to);
        let (_, digest) = tried("cannot copy", from, copied)?;
        self.listed.borrow_mut().push((ScanId::of_digest(digest), format!("{within}/{name}")));
        Ok(())
    }

    /// Writes a file of the disclosure.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), PersonFault> {
        let path = self.staged.join(name);
        tried("cannot write", &path, durable::write_new(&path, bytes))?;
        self.listed.borrow_mut().push((sums::scan_id(bytes), name.to_owned()));
        Ok(())
    }

    /// Writes the sums and gives the folder its name. Returns how many files it has.
    pub(super) fn finish(self, out: &Path) -> Result<usize, PersonFault> {
        let mut listed = self.listed.into_inner();
        listed.sort_by(|one, other| one.1.cmp(&other.1));
        let text: String = listed.iter().map(|(sum, name)| sums::line(sum, name)).collect();
        let path = self.staged.join(SUMS);
        tried("cannot write", &path, durable::write_new(&path, text.as_bytes()))?;
        match durable::rename_new(&self.staged, out) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                Err(PersonFault::There(terminal_safe(out.display())))
            }
            renamed => tried("cannot name", out, renamed).map(|()| listed.len()),
        }
    }

    fn folder(&self, within: &str) -> Result<PathBuf, PersonFault> {
        let mut folder = self.staged.clone();
        for part in within.split('/') {
            folder.push(part);
            tried("cannot make", &folder, durable::make_folder_once(&folder))?;
        }
        Ok(folder)
    }
}

fn tried<T>(what: &'static str, path: &Path, result: io::Result<T>) -> Result<T, PersonFault> {
    result.map_err(|source| PersonFault::File { what, path: terminal_safe(path.display()), source })
}
