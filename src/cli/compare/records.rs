//! The records that `gaiter compare` compares: those that are named, or all of a patient's folder.

use std::path::{Path, PathBuf};

use gaiter_record::RECORD;
use gaiter_visits::{LeftOut, last_of_days};

use crate::cli::report::{ReportFault, checked_record_at};
use crate::cli::{complain, terminal_safe};
use crate::station::runtime::chain;
use crate::store::revision::families;
use crate::store::revision::visits::{self, PlacedRecord};

/// The records at these paths, in their order. Of a patient's folder, the newest revision of each scan is
/// read, and the last scan of each day counts.
pub(super) fn at(paths: &[PathBuf]) -> Result<Vec<PlacedRecord>, ReportFault> {
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
/// used, and of the `delivered` ones those that are gone. Both are printed.
pub(super) fn of_patient(
    store: &Path,
    patient: &str,
    delivered: &[String],
) -> Result<(Vec<PlacedRecord>, Vec<LeftOut>), ReportFault> {
    let unlisted = |source| ReportFault::Unlisted { path: store.to_owned(), source };
    let found = visits::of_patient(store, patient).map_err(unlisted)?;
    for of in &found.unusable {
        let (folder, fault) = (terminal_safe(of.folder.display()), terminal_safe(chain(&of.fault)));
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
    Ok((last_of_days(found.records, |of| &of.record), left_out))
}

fn one(path: &Path) -> Result<PlacedRecord, ReportFault> {
    Ok(PlacedRecord { folder: path.to_owned(), record: checked_record_at(path)? })
}

/// The records of a patient's folder; `None` if it is a record or its folder.
fn in_folder(path: &Path) -> Result<Option<Vec<PlacedRecord>>, ReportFault> {
    if !path.is_dir() || path.join(RECORD).exists() {
        return Ok(None);
    }
    let unlisted = |source| ReportFault::Unlisted { path: path.to_owned(), source };
    let mut families = families(path).map_err(unlisted)?;
    families.retain(|family| family.patient_folder == path);
    let records = families.iter().map(|family| one(&family.latest().1));
    let records = records.collect::<Result<Vec<PlacedRecord>, ReportFault>>()?;
    Ok((!records.is_empty()).then_some(records))
}
