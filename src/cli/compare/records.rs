//! The records that `gaiter compare` compares: those that are named, or all of a patient's folder.

use std::path::{Path, PathBuf};

use gaiter_record::schema::NOT_VOUCHED;
use gaiter_record::{Record, SUMS};
use gaiter_visits::{LeftOut, last_of_days};

use crate::cli::report::{Fault, record_at};
use crate::cli::{Exit, complain, shown};
use crate::station::runtime::causes::chain;
use crate::store::StoreFault;
use crate::store::revision::{families, visits};

/// The record's file within its folder.
const RECORD: &str = "record.json";

/// A record and where it is.
#[derive(Debug)]
pub(super) struct Found {
    /// Its folder, or its `record.json`.
    pub path: PathBuf,
    /// The record.
    pub record: Record,
}

/// Why the records cannot be used.
#[derive(Debug, thiserror::Error)]
pub(super) enum Unusable {
    /// One of them cannot be read.
    #[error(transparent)]
    Record(#[from] Fault),
    /// A folder cannot be listed.
    #[error("{}: {}", shown(path.display()), shown(chain(source)))]
    Unlisted {
        /// The path.
        path: PathBuf,
        /// Why.
        source: StoreFault,
    },
}

impl Unusable {
    /// The exit of the verb.
    pub(super) fn exit(&self) -> Exit {
        match self {
            Unusable::Record(fault) => fault.exit(),
            Unusable::Unlisted { .. } => Exit::Io,
        }
    }
}

/// The records at these paths, in their order. Of a patient's folder, the newest revision of each scan is
/// read, and the last scan of each day counts.
pub(super) fn at(paths: &[PathBuf]) -> Result<Vec<Found>, Unusable> {
    let mut found = Vec::new();
    for path in paths {
        match in_folder(path)? {
            Some(records) => found.extend(last_of_days(records, |of| &of.record)),
            None => found.push(one(path)?),
        }
    }
    Ok(found)
}

/// The records of a patient in a store, of each day the last scan, and what is left out: records that cannot be
/// used, and of the `delivered` ones those that are gone. Both are told.
pub(super) fn of_patient(
    store: &Path,
    patient: &str,
    delivered: &[String],
) -> Result<(Vec<Found>, Vec<LeftOut>), Unusable> {
    let unlisted = |source| Unusable::Unlisted { path: store.to_owned(), source };
    let found = visits::of_patient(store, patient).map_err(unlisted)?;
    for of in &found.unusable {
        let (folder, fault) = (shown(of.folder.display()), shown(chain(&of.fault)));
        complain(format_args!("gaiter: {folder}: is left out: {fault}"));
    }
    let left_out = found.left_out(delivered);
    for of in left_out.iter().filter(|of| of.code == visits::REMOVED) {
        let (seen, scan) = (of.seen, &of.scan);
        complain(format_args!(
            "gaiter: the record of scan {scan}, seen {seen}, is left out: it was delivered and is no longer \
             in the store"
        ));
    }
    let records = found.records.into_iter();
    let records = records.map(|of| Found { path: of.folder, record: of.record }).collect();
    Ok((last_of_days(records, |of: &Found| &of.record), left_out))
}

fn one(path: &Path) -> Result<Found, Unusable> {
    let record = record_at(path)?;
    if record.has_finding(NOT_VOUCHED) {
        complain(format_args!(
            "gaiter: {}: nothing vouches for its figures, because no {SUMS} is beside it",
            shown(path.display())
        ));
    }
    Ok(Found { path: path.to_owned(), record })
}

/// The records of a patient's folder; `None` if it is a record or its folder.
fn in_folder(path: &Path) -> Result<Option<Vec<Found>>, Unusable> {
    if !path.is_dir() || path.join(RECORD).exists() {
        return Ok(None);
    }
    let unlisted = |source| Unusable::Unlisted { path: path.to_owned(), source };
    let mut families = families(path).map_err(unlisted)?;
    families.retain(|family| family.patient_folder == path);
    let records = families.iter().map(|family| one(&family.latest().1));
    let records = records.collect::<Result<Vec<Found>, Unusable>>()?;
    Ok((!records.is_empty()).then_some(records))
}
