//! The records that `gaiter compare` compares: those that are named, or all of a patient's folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::cli::report::{Fault, record_of_file};
use crate::cli::{Exit, complain, shown};
use crate::flow::patient::naming::patient_folder;
use crate::record::schema::NOT_VOUCHED;
use crate::record::{Record, SUMS};
use crate::station::runtime::causes::chain;
use crate::store::StoreFault;
use crate::store::revision::families;

/// The record's file within its folder.
const RECORD: &str = "record.json";

/// A record and where it is.
#[derive(Debug)]
pub(super) struct Found {
    /// The path of its `record.json`.
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
            Some(records) => found.extend(last_of_days(records)),
            None => found.push(one(path)?),
        }
    }
    Ok(found)
}

/// The records of a patient in a store, of each day the last scan. A record that a person moved into the
/// folder of another patient is left out, and that is told.
pub(super) fn of_patient(store: &Path, patient: &str) -> Result<Vec<Found>, Unusable> {
    let folder = store.join(patient_folder(Some(patient)));
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut records = in_folder(&folder)?.unwrap_or_default();
    records.retain(|of| {
        let is_own = of.record.patient.as_ref().is_some_and(|own| own.id == patient);
        if !is_own {
            complain(format_args!(
                "gaiter: {}: is not a record of the patient whose folder it is in; it was left out",
                shown(of.path.display())
            ));
        }
        is_own
    });
    Ok(last_of_days(records))
}

fn one(path: &Path) -> Result<Found, Unusable> {
    let path = if path.is_dir() { path.join(RECORD) } else { path.to_owned() };
    let record = record_of_file(path.clone())?;
    if record.has_finding(NOT_VOUCHED) {
        complain(format_args!(
            "gaiter: {}: nothing vouches for its figures, because no {SUMS} is beside it",
            shown(path.display())
        ));
    }
    Ok(Found { path, record })
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

/// The last scan of each day on the scanner's calendar; a scan of unknown time stays.
fn last_of_days(records: Vec<Found>) -> Vec<Found> {
    let (timed, mut kept): (Vec<Found>, Vec<Found>) =
        records.into_iter().partition(|of| of.record.acquired.is_some());
    let mut days: BTreeMap<_, Found> = BTreeMap::new();
    for of in timed {
        let Some(acquired) = of.record.acquired.clone() else { continue };
        let day = acquired.local().date();
        let known = days.get(&day).and_then(|known| known.record.acquired.as_ref());
        if known.is_none_or(|known| known.at < acquired.at) {
            days.insert(day, of);
        }
    }
    kept.extend(days.into_values());
    kept
}
