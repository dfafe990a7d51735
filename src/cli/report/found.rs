//! The record that `gaiter report` is to report: a `record.json`, a record's folder, or the newest record in
//! a patient's folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_record::RECORD;

use crate::cli::shown;
use crate::station::runtime::causes::chain;
use crate::store::StoreFault;
use crate::store::revision::families;

/// A record's file, and what there is to say about how it was found.
#[derive(Debug, PartialEq, Eq)]
pub struct Found {
    /// The path of its `record.json`.
    pub path: PathBuf,
    /// Which of several records was taken.
    pub remark: Option<String>,
}

/// Why there is no record at a path.
#[derive(Debug, thiserror::Error)]
pub enum NotFound {
    /// Nothing has this name.
    #[error(
        "{}: there is no such file or folder; name a record's folder, its record.json, or a \
         patient's folder", shown(.0.display())
    )]
    Nothing(PathBuf),
    /// It is a folder without a record.
    #[error(
        "{}: neither a record.json nor a record's folder is in this folder; name a record's folder, its \
         record.json, or a patient's folder", shown(.0.display())
    )]
    NoRecord(PathBuf),
    /// It cannot be looked at.
    #[error("{}: {}", shown(path.display()), shown(source))]
    Unreadable {
        /// The path.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It is a folder that cannot be listed.
    #[error("{}: {}", shown(path.display()), shown(chain(source)))]
    Unlisted {
        /// The path.
        path: PathBuf,
        /// Why.
        source: StoreFault,
    },
}

/// Finds the record at a path.
///
/// # Errors
/// See [`NotFound`]. A file whose content cannot be read is found all the same.
pub fn found(path: &Path) -> Result<Found, NotFound> {
    let whole = path.to_owned();
    let is_folder = match fs::metadata(path) {
        Ok(metadata) => metadata.is_dir(),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(NotFound::Nothing(whole));
        }
        Err(source) => return Err(NotFound::Unreadable { path: whole, source }),
    };
    if !is_folder {
        return Ok(Found { path: whole, remark: None });
    }
    let own = path.join(RECORD);
    if own.exists() {
        return Ok(Found { path: own, remark: None });
    }
    // A store's folder holds patients: none of them is taken unasked.
    let unlisted = |source| NotFound::Unlisted { path: path.to_owned(), source };
    let mut records = families(path).map_err(unlisted)?;
    records.retain(|record| record.patient_folder == path);
    let newest = records.last().ok_or_else(|| NotFound::NoRecord(path.to_owned()))?;
    let folder = &newest.latest().1;
    let shown = shown(folder.display());
    let remark = match records.len() {
        1 => format!("its only record is reported: {shown}"),
        count => format!("the newest of its {count} records is reported: {shown}"),
    };
    Ok(Found { path: folder.join(RECORD), remark: Some(remark) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_revision_of_a_patient_is_taken_and_said_and_of_a_store_none() {
        let store = tempfile::tempdir().unwrap();
        let patient = store.path().join("4711");
        let folder = |name: &str| patient.join(name);
        let names = [
            "20261121T091500Z_aaaaaaaa",
            "20261122T091500Z_bbbbbbbb",
            "20261122T091500Z_bbbbbbbb_r2",
        ];
        for name in names {
            fs::create_dir_all(folder(name)).unwrap();
            fs::write(folder(name).join(RECORD), "{}").unwrap();
        }
        let newest = folder(names[2]);
        let of_patient = found(&patient).unwrap();
        assert_eq!(of_patient.path, newest.join(RECORD));
        let remark = of_patient.remark.unwrap();
        assert!(remark.starts_with("the newest of its 2 records"), "{remark}");
        assert!(remark.ends_with(&newest.display().to_string()), "{remark}");
        let of_record = Found { path: folder(names[0]).join(RECORD), remark: None };
        assert_eq!(found(&folder(names[0])).unwrap(), of_record);
        let store = store.path();
        assert!(matches!(found(store), Err(NotFound::NoRecord(path)) if path == store));
        let missing = store.join("4712");
        assert!(matches!(found(&missing), Err(NotFound::Nothing(path)) if path == missing));
        let of_a_file = folder(names[0]).join(RECORD).join("4711");
        assert!(
            matches!(found(&of_a_file), Err(NotFound::Unreadable { path, .. }) if path == of_a_file)
        );
    }
}
