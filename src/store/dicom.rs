//! An archive of images (PACS) as a store: each record is a study of DICOM objects, stored over DICOMweb (STOW-RS) or
//! over an association (C-STORE).
//!
//! The server itself is the register. What it shows of the study (QIDO-RS, C-FIND) is compared with the objects of the
//! record, whose UIDs are always the same: only what is missing is sent, and a record counts as stored once the server
//! shows all of it, not because it said yes.

mod answers;
mod dimse;
mod server;
#[cfg(test)]
mod tests;
mod web;

use std::path::{Path, PathBuf};
use std::time::Duration;

use gaiter_dicom::{
    DicomObject, DicomRules, EncodeFault, Listed, PatientIdFault, Person, Sent, Study, objects,
    withdrawal,
};
use gaiter_flow::ScanId;
use gaiter_record::{ImagingRequest, Patient};
use jiff::Timestamp;

use super::server::ServerFault;
use super::{Delivery, Receipt, RecordStore, Rejection, StoreFault};
use dimse::DimseArchive;
use server::END_MOST;
pub use server::{DicomAccess, DicomServer, DicomWay, DimseServer};
use web::WebArchive;

/// Requests or associations of a step that look what is there: two before it stores, and two after.
const LOOKS_MOST: u32 = 4;

/// The server, by how it is asked.
#[derive(Debug)]
enum Archive {
    Web(WebArchive),
    Dimse(DimseArchive),
}

/// An archive of images as a store.
#[derive(Debug)]
pub struct DicomStore {
    server: DicomServer,
    rules: DicomRules,
    archive: Archive,
    /// The station's name: a withdrawal names it.
    station: String,
}

impl DicomStore {
    /// Its name in the journal.
    pub const NAME: &str = "dicom";

    /// The store of a station, of objects by `rules`, at this server.
    pub fn new(server: DicomServer, rules: DicomRules, station: &str) -> DicomStore {
        let archive = match server.way.clone() {
            DicomWay::Web { base, access, tls } => {
                Archive::Web(WebArchive::new(base, access, tls, server.limit))
            }
            DicomWay::Dimse(dimse) => Archive::Dimse(DimseArchive::new(dimse, server.limit)),
        };
        DicomStore { server, rules, archive, station: station.to_owned() }
    }

    /// What the server has of a study.
    fn listed(&self, study: &Study, patient: &str) -> Result<Vec<Listed>, StoreFault> {
        match &self.archive {
            Archive::Web(archive) => archive.listed(study, patient),
            Archive::Dimse(archive) => archive.listed(study),
        }
    }

    /// Sends objects, which may say who the patient is, each with the limit for itself: where the line is slow, the next
    /// try goes on where this one ended. Whether the server has them, only a search tells.
    fn send(
        &self,
        objects: &[DicomObject],
        patient: &str,
        is_named: bool,
    ) -> Result<(), StoreFault> {
        let mut failed = Vec::new();
        for object in objects {
            failed.extend(match &self.archive {
                Archive::Web(archive) => archive.store(object, patient, is_named)?,
                Archive::Dimse(archive) => archive.store(object)?,
            });
        }
        answers::judged(&failed, objects.len())
    }
}

impl RecordStore for DicomStore {
    fn name(&self) -> &'static str {
        DicomStore::NAME
    }

    fn place(&self) -> String {
        self.server.place()
    }

    fn is_server(&self) -> bool {
        true
    }

    fn own_certificate(&self) -> Option<&Path> {
        self.server.tls()?.own.as_ref().map(|(certificate, _)| certificate.as_path())
    }

    /// Each request or association has the limit for itself, and so has each object: the figures and files.
    fn step_most(&self) -> Duration {
        let objects = 1 + self.rules.attach.len() as u32;
        (self.server.limit + END_MOST) * (LOOKS_MOST + objects)
    }

    fn takes_unassigned(&self) -> bool {
        false
    }

    fn gives_back(&self) -> bool {
        true
    }

    /// Whether it lets the station search. Whether it lets it store, the first record tells.
    fn reach(&self) -> Result<(), StoreFault> {
        match &self.archive {
            Archive::Web(archive) => archive.reach(),
            Archive::Dimse(archive) => archive.reach(),
        }
    }

    fn put(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
        let (record, patient) = delivery.named_record().map_err(StoreFault::Permanent)?;
        let study = Study::new(delivery.scan.as_str(), patient).map_err(misfit)?;
        let study = study.answering(record.patient.as_ref().and_then(Patient::request));
        let before = self.listed(&study, patient)?;
        let person = delivery.person.map(|of| Person {
            name: &of.dicom_name,
            birth_date: of.birth_date,
            sex: &of.sex,
        });
        let is_named = self.rules.names && person.is_some();
        let sent = Sent {
            record: &record,
            files: delivery.files,
            first_seen: delivery.first_seen,
            study: &study,
            person,
            withdrawals: study.withdrawals(&before),
        };
        let mut missing = objects(&sent, &self.rules);
        let count = missing.len();
        missing.retain(|object| !is_shown(object, &before));
        let receipt = |already_there| Receipt { folder: PathBuf::from(study.uid()), already_there };
        if missing.is_empty() {
            return Ok(receipt(true));
        }
        self.send(&missing, patient, is_named)?;
        let after = self.listed(&study, patient)?;
        missing.retain(|object| !is_shown(object, &after));
        if !missing.is_empty() {
            let why = format!("it does not show {} of {count} objects", missing.len());
            return Err(ServerFault::Answer(why).into());
        }
        Ok(receipt(false))
    }

    /// Marks what holds there as made for the wrong patient. Nothing is deleted; some archives hide it then, and the
    /// mark with it.
    fn withdraw(
        &self,
        scan: &ScanId,
        from: Option<&str>,
        _keeper: Option<&str>,
        receipt: Option<&str>,
        request: Option<&ImagingRequest>,
    ) -> Result<(), StoreFault> {
        // Of a patient whose id cannot be written nothing was sent.
        let Some((patient, study)) =
            from.and_then(|from| Some((from, Study::new(scan.as_str(), from).ok()?)))
        else {
            return Ok(());
        };
        let study = study.answering(request);
        let study = match receipt {
            Some(uid) => study.confirmed(uid),
            None => study,
        };
        let listed = self.listed(&study, patient)?;
        let now = Timestamp::now();
        match withdrawal(&study, &listed, &self.station, &self.rules, now) {
            Some(mark) => {
                self.send(&[mark], patient, false)?;
                match study.holding(&self.listed(&study, patient)?).len() {
                    0 => Ok(()),
                    holding => {
                        let why = format!("it still shows {holding} objects without the mark");
                        Err(ServerFault::Answer(why).into())
                    }
                }
            }
            None if receipt.is_some() && study.withdrawals(&listed) == 0 => {
                let why = "it does not show the study that it has confirmed".to_owned();
                Err(ServerFault::Answer(why).into())
            }
            None => Ok(()),
        }
    }

    /// Removes nothing: what a server was given is the house's own, and is listed for the person who erases.
    fn erase(
        &self,
        _patient: &str,
        _before: Timestamp,
        _scans: &[ScanId],
    ) -> Result<(), StoreFault> {
        Ok(())
    }
}

fn misfit(fault: PatientIdFault) -> StoreFault {
    StoreFault::Permanent(Rejection::DicomPatientId(fault))
}

fn unwritable(fault: EncodeFault) -> StoreFault {
    StoreFault::Permanent(Rejection::DicomObject(fault))
}

fn is_shown(object: &DicomObject, listed: &[Listed]) -> bool {
    listed.iter().any(|of| of.uid == object.uid())
}
