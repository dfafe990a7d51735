//! The place of a record that `gaiter extract --out` writes.

use std::fs;
use std::io;
use std::path::Path;

use gaiter_record::RecordFile;
use rustix::fs::{CWD, RenameFlags, renameat_with};
use rustix::io::Errno;

use super::Undelivered;
use crate::cli::terminal_safe;
use crate::store::durable;
use crate::store::sums::{self, SUMS};

/// Something in a record's place that is not an earlier record of the same scan.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum Foreign {
    #[error("it is not a folder")]
    NoFolder,
    #[error("it has no readable SHA256SUMS")]
    NoSums,
    #[error("it holds the record of another scan")]
    OtherScan,
    #[error("its {} does not belong to the record", terminal_safe(.0))]
    Stranger(String),
    #[error("its {} was changed", terminal_safe(.0))]
    Changed(String),
}

/// Puts the files into `folder`, which lies in `out`. Nothing changes under that name until all files
/// are written and synced. Then they appear at once.
pub fn put_folder(
    out: &Path,
    folder: &Path,
    files: &[RecordFile],
    scan_sha256: &str,
) -> Result<(), Undelivered> {
    let tried = |path: &Path, result: io::Result<()>| {
        result.map_err(|source| Undelivered::Write { path: path.to_owned(), source })
    };
    tried(out, fs::create_dir_all(out))?;
    match foreign(folder, scan_sha256) {
        Err(source) => return tried(folder, Err(source)),
        Ok(Some(what)) => return Err(Undelivered::Occupied { folder: folder.to_owned(), what }),
        Ok(None) => {}
    }
    let staged = out.join(format!(".gaiter-extract-{}", std::process::id()));
    // What a killed process with the same id left behind.
    tried(&staged, durable::remove_folder(&staged))?;
    let put = tried(&staged, stage(&staged, files))
        .and_then(|()| tried(folder, replace(&staged, folder)))
        .and_then(|()| tried(out, durable::sync_folder(out)));
    // This is the earlier record, or the beginning of one that could not be written.
    put.and(tried(&staged, durable::remove_folder(&staged)))
}

/// Writes a whole folder and syncs it.
fn stage(staged: &Path, files: &[RecordFile]) -> io::Result<()> {
    durable::make_folder(staged)?;
    files.iter().try_for_each(|file| durable::write_new(&staged.join(&file.name), &file.bytes))?;
    durable::sync_folder(staged)
}

/// Moves the staged folder to its place. Anything that was there moves to the staged name.
fn replace(staged: &Path, folder: &Path) -> io::Result<()> {
    match durable::rename_new(staged, folder) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
        other => return other,
    }
    match renameat_with(CWD, staged, CWD, folder, RenameFlags::EXCHANGE) {
        // Some network file systems cannot exchange two names.
        Err(Errno::INVAL | Errno::NOSYS | Errno::OPNOTSUPP) => replace_in_steps(staged, folder),
        other => other.map_err(io::Error::from),
    }
}

/// The same as [`replace`] in several steps: for a moment nothing has the final name, but never half a
/// record.
fn replace_in_steps(staged: &Path, folder: &Path) -> io::Result<()> {
    let aside = staged.with_extension("earlier");
    fs::rename(folder, &aside)?;
    if let Err(error) = fs::rename(staged, folder) {
        fs::rename(&aside, folder)?;
        return Err(error);
    }
    fs::rename(&aside, staged)
}

/// What is at `folder` and is not a record of this scan, which may be incomplete. `None` also if nothing
/// or an empty folder is there.
fn foreign(folder: &Path, scan_sha256: &str) -> io::Result<Option<Foreign>> {
    match folder.symlink_metadata() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Ok(found) if !found.is_dir() => return Ok(Some(Foreign::NoFolder)),
        found => found.map(drop)?,
    }
    let mut entries = fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>()?;
    if entries.is_empty() {
        return Ok(None);
    }
    entries.sort_by_key(fs::DirEntry::file_name);
    match sums::scan_of(folder)? {
        Some((scan, _)) if scan.as_str() == scan_sha256 => {}
        None if !folder.join(SUMS).is_file() => return Ok(Some(Foreign::NoSums)),
        _ => return Ok(Some(Foreign::OtherScan)),
    }
    for entry in entries {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name == SUMS {
            continue;
        }
        match sums::sum_of(folder, &name)? {
            Some(sum) if entry.file_type()?.is_file() => {
                if sums::scan_id(&fs::read(entry.path())?) != sum {
                    return Ok(Some(Foreign::Changed(name)));
                }
            }
            _ => return Ok(Some(Foreign::Stranger(name))),
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_replaced_also_where_names_cannot_be_exchanged() {
        for replace in [replace, replace_in_steps] {
            let out = tempfile::tempdir().unwrap();
            let [staged, folder] = ["staged", "folder"].map(|name| out.path().join(name));
            for (place, name) in [(&staged, "new"), (&folder, "old")] {
                fs::create_dir(place).unwrap();
                fs::write(place.join(name), name).unwrap();
            }
            replace(&staged, &folder).unwrap();
            assert!(folder.join("new").is_file() && staged.join("old").is_file());
            assert_eq!(fs::read_dir(out.path()).unwrap().count(), 2);
            assert!(replace(&out.path().join("missing"), &folder).is_err());
            assert!(folder.join("new").is_file(), "a failure leaves the earlier record in place");
        }
    }
}
