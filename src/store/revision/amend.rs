//! Measures that a person sets: a further revision of the record with what was set beside the scan's
//! measures.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_flow::cause::Cause;
use gaiter_record::measure::amendment::{AmendFault, Amendment};
use gaiter_record::schema::SCHEMA;
use gaiter_record::{FilesFault, RECORD, Record, RecordFile, ReportChoice, amended_files};
use serde_json::Value;

use super::stored::{Stored, StoredFault};
use super::{Added, add, families};
use crate::store::StoreFault;

/// What precedes the number in the folder name of a later revision.
const REVISION: &str = "_r";

/// A record with another revision.
#[derive(Debug, Clone, PartialEq)]
pub struct Amended {
    pub folder: PathBuf,
    pub record: Record,
}

/// Why a record was not amended. It is unchanged then.
#[derive(Debug, thiserror::Error)]
pub enum AmendRecordFault {
    #[error("{}", Cause::known("no-record", []))]
    NoRecord,
    /// It cannot be read.
    #[error(transparent)]
    Stored(#[from] StoredFault),
    /// The value to set is not possible.
    #[error(transparent)]
    Amend(#[from] AmendFault),
    /// It was made by another version, and would lose figures if this one wrote it.
    #[error("{}", other_version(.0))]
    OtherVersion(String),
    /// Files of the revision cannot be made.
    #[error("the new revision cannot be made")]
    Files(#[from] FilesFault),
    /// The record was taken back from its patient meanwhile.
    #[error("{}", Cause::known("record-withdrawn", []))]
    Withdrawn,
    /// Another revision was added meanwhile.
    #[error("{}", Cause::known("revised-meanwhile", []))]
    Meanwhile,
    /// The store cannot be listed.
    #[error(transparent)]
    Unlisted(#[from] StoreFault),
    /// The revision cannot be written.
    #[error("the new revision cannot be written")]
    Io(#[from] io::Error),
}

impl AmendRecordFault {
    /// Why, as data.
    pub fn cause(&self) -> Cause {
        match self {
            AmendRecordFault::NoRecord => Cause::known("no-record", []),
            AmendRecordFault::OtherVersion(version) => other_version(version),
            AmendRecordFault::Withdrawn => Cause::known("record-withdrawn", []),
            AmendRecordFault::Meanwhile => Cause::known("revised-meanwhile", []),
            AmendRecordFault::Io(error) => Cause::of_system(error).after(self),
            AmendRecordFault::Stored(StoredFault::Io(error)) => {
                Cause::of_system(error).after("reading failed")
            }
            AmendRecordFault::Unlisted(StoreFault::Transient { source, .. }) => {
                Cause::of_system(source).after(self)
            }
            AmendRecordFault::Files(fault) => Cause::verbatim(format_args!("{self}: {fault}")),
            AmendRecordFault::Stored(_)
            | AmendRecordFault::Amend(_)
            | AmendRecordFault::Unlisted(_) => Cause::verbatim(self),
        }
    }
}

fn other_version(version: &str) -> Cause {
    Cause::known("other-version", [("version", version.to_owned())])
}

/// Sets measures of a record, in this order: writes a further revision beside the latest one. Values that are
/// far off the scan's are only set if `is_sure`. `folder` is the folder of any of its revisions.
///
/// # Errors
/// See [`AmendRecordFault`].
pub fn amend_record(
    folder: &Path,
    amendments: &[Amendment],
    is_sure: bool,
    choice: &ReportChoice,
) -> Result<Amended, AmendRecordFault> {
    let whole = folder.canonicalize().map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => AmendRecordFault::NoRecord,
        _ => AmendRecordFault::Io(error),
    })?;
    let family = families(&whole)?
        .into_iter()
        .find(|family| family.revisions.iter().any(|(_, place)| *place == whole));
    let name = whole.file_name().and_then(OsStr::to_str).ok_or(AmendRecordFault::NoRecord)?;
    let name = numbered(name).map_or(name, |(name, _)| name);
    let within = whole.parent().ok_or(AmendRecordFault::NoRecord)?;
    let (number, latest, stored) = match family {
        Some(family) => {
            let (name, latest) = family.latest();
            (name.revision, latest.clone(), Stored::read(&family)?)
        }
        // In a folder of its own that `gaiter extract` wrote.
        None => {
            let latest = latest_alone(within, name)?;
            let (number, latest) = latest.ok_or(AmendRecordFault::NoRecord)?;
            let stored = Stored::in_folder(&latest)?;
            (number, latest, stored)
        }
    };
    if !is_kept_whole(&stored) {
        return Err(AmendRecordFault::OtherVersion(stored.record.made_by.gaiter));
    }
    let mut record = stored.record.amended(amendments, is_sure)?;
    record.revision = number.max(record.revision).saturating_add(1);
    let before = stored.listed.iter().map(|name| {
        let bytes = stored.listed_file(name)?;
        Ok(RecordFile { name: name.clone(), bytes })
    });
    let before = before.collect::<io::Result<Vec<RecordFile>>>()?;
    let files = amended_files(&record, choice, before)?;
    match add(within, &latest, &format!("{name}{REVISION}{}", record.revision), &files) {
        Ok(Added::There(folder)) => Ok(Amended { folder, record }),
        Ok(Added::Withdrawn) => Err(AmendRecordFault::Withdrawn),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
            Err(AmendRecordFault::Meanwhile)
        }
        Err(error) => Err(error.into()),
    }
}

/// The name of a folder without the number of its revision, and the number; `None` if it has none.
fn numbered(name: &str) -> Option<(&str, u32)> {
    let (name, number) = name.rsplit_once(REVISION)?;
    Some((name, number.parse().ok().filter(|number| *number > 1)?))
}

/// The number and the folder of the latest revision of the record of this name in a folder; `None` if there is none.
fn latest_alone(within: &Path, name: &str) -> io::Result<Option<(u32, PathBuf)>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(within)? {
        let path = entry?.path();
        let own = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
        let number = match numbered(own) {
            _ if own == name => Some(1),
            Some((base, number)) if base == name => Some(number),
            _ => None,
        };
        let is_record = path.join(RECORD).is_file();
        found.extend(number.filter(|_| is_record).map(|number| (number, path)));
    }
    Ok(found.into_iter().max())
}

/// Whether this version writes everything that the record holds.
fn is_kept_whole(stored: &Stored) -> bool {
    let written = serde_json::to_value(&stored.record);
    stored.record.schema == SCHEMA && written.is_ok_and(|now| holds(&now, &stored.json))
}

/// Whether a value has every key and every element of another.
fn holds(now: &Value, before: &Value) -> bool {
    match (now, before) {
        (Value::Object(now), Value::Object(before)) => {
            before.iter().all(|(key, value)| now.get(key).is_some_and(|now| holds(now, value)))
        }
        (Value::Array(now), Value::Array(before)) => {
            now.len() == before.len() && now.iter().zip(before).all(|(now, was)| holds(now, was))
        }
        (now, before) => now == before,
    }
}
