//! The records of one patient in a store: the latest revision of each scan.
//!
//! The store has a folder for each patient, so nothing else has to be listed, and nothing that is remembered can
//! be out of date: what a person removes or moves is not there when it is asked for. A station that delivered it
//! still knows it, and reports that.

use std::fs;
use std::path::{Path, PathBuf};

use gaiter_flow::patient::naming::{RecordName, patient_folder};
use gaiter_record::{RECORD, Record};
use gaiter_visits::LeftOut;

use super::stored::StoredFault;
use super::{Family, families};
use crate::store::{StoreFault, sums};

#[derive(Debug, Default)]
pub struct PatientRecords {
    /// Those that can be used, by the times of their folders' names.
    pub records: Vec<PlacedRecord>,
    /// Those that cannot, and why.
    pub unusable: Vec<UnusableRecord>,
}

/// A record and its folder.
#[derive(Debug)]
pub struct PlacedRecord {
    /// Its folder; or its `record.json`, where a person named that.
    pub folder: PathBuf,
    pub record: Record,
}

/// A record that cannot be used.
#[derive(Debug)]
pub struct UnusableRecord {
    pub folder: PathBuf,
    /// The content of the folder's name.
    name: RecordName,
    pub fault: StoredFault,
}

impl PatientRecords {
    /// What is left out of a comparison: the records that cannot be used, and those of these folders' names, which
    /// a station delivered, that are gone.
    pub fn left_out(&self, delivered: &[String]) -> Vec<LeftOut> {
        let unusable = self.unusable.iter().map(|of| LeftOut {
            seen: of.name.first_seen,
            scan: of.name.scan.clone(),
            code: of.fault.code(),
            is_of_another: matches!(of.fault, StoredFault::Other("patient")),
        });
        let delivered = delivered.iter().filter_map(|name| RecordName::read(name));
        let removed = delivered.filter(|name| !self.has(&name.scan)).map(|name| LeftOut {
            seen: name.first_seen,
            scan: name.scan,
            code: REMOVED,
            is_of_another: false,
        });
        unusable.chain(removed).collect()
    }

    /// Whether there is a record of the scan whose id begins like this.
    fn has(&self, scan: &str) -> bool {
        self.records.iter().any(|of| of.record.scan.sha256.starts_with(scan))
            || self.unusable.iter().any(|of| of.name.scan == scan)
    }
}

/// Why a record is left out: a station delivered it, and it is not in the store any more.
pub const REMOVED: &str = "record-removed";

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
        let (name, place) = family.latest();
        let folder = place.clone();
        match read(&family, place, patient) {
            Ok(record) => found.records.push(PlacedRecord { folder, record }),
            Err(fault) => {
                found.unusable.push(UnusableRecord { folder, name: name.clone(), fault });
            }
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
