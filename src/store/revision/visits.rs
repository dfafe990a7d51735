//! The records of one patient in a store: the latest revision of each scan.
//!
//! The store has a folder for each patient, so nothing else has to be listed, and nothing that is remembered
//! can be out of date: what a person removes or moves is not there when it is asked for.

use std::fs;
use std::path::{Path, PathBuf};

use gaiter_flow::patient::naming::patient_folder;
use gaiter_record::{RECORD, Record};

use super::stored::StoredFault;
use super::{Family, families};
use crate::store::{StoreFault, sums};

/// The records of a patient.
#[derive(Debug, Default)]
pub struct PatientRecords {
    /// Those that can be used, by the times of their folders' names.
    pub records: Vec<PlacedRecord>,
    /// Those that cannot, and why.
    pub left_out: Vec<(PathBuf, StoredFault)>,
}

/// A record and its folder.
#[derive(Debug)]
pub struct PlacedRecord {
    /// Its folder.
    pub folder: PathBuf,
    /// The record.
    pub record: Record,
}

/// The records of a patient in the store at `root`. Each `record.json` is checked against its `SHA256SUMS`;
/// the other files are not read.
///
/// # Errors
/// If the patient's folder cannot be listed; a patient without a folder has no records.
pub fn of_patient(root: &Path, patient: &str) -> Result<PatientRecords, StoreFault> {
    let folder = root.join(patient_folder(Some(patient)));
    let mut found = PatientRecords::default();
    if !folder.is_dir() {
        return Ok(found);
    }
    let mut families = families(&folder)?;
    families.retain(|family| family.patient_folder == folder);
    for family in families {
        let place = &family.latest().1;
        match read(&family, place, patient) {
            Ok(record) => found.records.push(PlacedRecord { folder: place.clone(), record }),
            Err(fault) => found.left_out.push((place.clone(), fault)),
        }
    }
    Ok(found)
}

fn read(family: &Family, folder: &Path, patient: &str) -> Result<Record, StoredFault> {
    let bytes = fs::read(folder.join(RECORD))?;
    if !sums::check_file(folder, RECORD, &bytes)?? {
        return Err(sums::SumsFault::NoSums.into());
    }
    let record: Record = serde_json::from_slice(&bytes).map_err(StoredFault::Unreadable)?;
    let record = record.checked().map_err(StoredFault::Impossible)?;
    if !record.scan.sha256.starts_with(&family.latest().0.scan) {
        return Err(StoredFault::Other("scan"));
    }
    match record.patient.as_ref().is_some_and(|own| own.id == patient) {
        true => Ok(record),
        false => Err(StoredFault::Other("patient")),
    }
}
