//! An archive of images (PACS) as a store: each record is a study of DICOM objects, stored over DICOMweb (STOW-RS) or
//! over an association (C-STORE).
//!
//! The server itself is the register. What it shows of the study (QIDO-RS, C-FIND) is compared with the objects of the
//! record, whose UIDs are always the same: only what is missing is sent, and a record counts as stored once the server
//! shows all of it, not because it said yes, and not as refused because it said no.
//!
//! Servers that know IHE Imaging Object Change Management hide what was withdrawn and what withdrew it, and do not take
//! the UIDs of either again. So no UID depends on what a server shows of earlier turns.

mod answers;
mod dimse;
mod server;
#[cfg(test)]
mod tests;
mod web;

use std::path::{Path, PathBuf};
use std::time::Duration;

use gaiter_dicom::{
    DicomObject, DicomRules, EncodeFault, Listed, Person, Sent, Study, objects, withdrawal,
};
use gaiter_record::Patient;
use gaiter_record::export::taken;
use jiff::Timestamp;

use super::server::ServerFault;
use super::{Delivery, Receipt, RecordStore, Rejection, StoreFault, TakeBack};
use server::END_MOST;
pub use server::{DicomServer, DimseServer};
use web::WebArchive;

/// Requests or associations of a step besides those that store the record: two that look what is there, one that marks
/// what is left of an earlier turn, two that look again, and two after the record was stored.
const REQUESTS_MOST: u32 = 7;

/// The server, by how it is asked.
#[derive(Debug)]
enum Archive {
    Web(WebArchive),
    Dimse(DimseServer),
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
        let archive = match server.clone() {
            DicomServer::Web { base, access, tls, limit } => {
                Archive::Web(WebArchive::new(base, access, tls, limit))
            }
            DicomServer::Dimse(dimse) => Archive::Dimse(dimse),
        };
        DicomStore { server, rules, archive, station: station.to_owned() }
    }

    /// What the server has of a record up to its turn; it may tell of others, too.
    fn listed(&self, study: &Study, turn: u32) -> Result<Vec<Listed>, StoreFault> {
        match &self.archive {
            Archive::Web(archive) => archive.listed(study, self.repeats(study)),
            Archive::Dimse(archive) => archive.listed(study, turn + 1),
        }
    }

    /// Whether faults may repeat what the server says of a study: not where it may know the patient's name, from this
    /// station or, in the study of a request, from others. It may write the name in another way than it was sent.
    fn repeats(&self, study: &Study) -> bool {
        !self.rules.names && !study.is_of_request()
    }

    /// Sends objects of a record, each with the limit for itself: where the line is slow, the next try goes on where this
    /// one ended.
    fn send(&self, objects: &[DicomObject], study: &Study) -> Result<(), StoreFault> {
        let mut failed = Vec::new();
        for object in objects {
            failed.extend(match &self.archive {
                Archive::Web(archive) => archive.store(object, study, self.repeats(study))?,
                Archive::Dimse(archive) => archive.store(object)?,
            });
        }
        answers::judged(&failed, objects.len())
    }

    /// The mark for what the server shows of the first `turns` turns; `None` if it needs none.
    fn mark(&self, study: &Study, turns: u32, listed: &[Listed]) -> Option<DicomObject> {
        withdrawal(study, turns, listed, &self.station, &self.rules, Timestamp::now())
    }

    /// Marks what the server shows of the first `turns` turns. Returns what it shows then of a record up to its turn.
    fn marked(
        &self,
        study: &Study,
        turn: u32,
        turns: u32,
        listed: Vec<Listed>,
    ) -> Result<Vec<Listed>, StoreFault> {
        let Some(mark) = self.mark(study, turns, &listed) else { return Ok(listed) };
        let answer = self.send(&[mark], study);
        let after = self.listed(study, turn)?;
        if self.mark(study, turns, &after).is_some() {
            answer?;
            let why = "it still shows objects without the mark".to_owned();
            return Err(ServerFault::Answer(why).into());
        }
        Ok(after)
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
        self.server.tls()?.certificate()
    }

    /// Each request or association has the limit for itself, and so has each object: the figures and files.
    fn step_most(&self) -> Duration {
        let objects = 1 + self.rules.attach.len() as u32;
        (self.server.limit() + END_MOST) * (REQUESTS_MOST + objects)
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
        let misfit = |fault| StoreFault::Permanent(Rejection::DicomPatientId(fault));
        let study = Study::new(delivery.scan.as_str(), patient).map_err(misfit)?;
        let study = study
            .answering(record.patient.as_ref().and_then(Patient::request))
            .taken_at(taken(&record, delivery.first_seen));
        let turn = delivery.turn;
        // It may have been given back before it was taken back here.
        let before = self.marked(&study, turn, turn, self.listed(&study, turn)?)?;
        let person = delivery.person.map(|of| Person {
            name: &of.dicom_name,
            birth_date: of.birth_date,
            sex: &of.sex,
        });
        let sent = Sent {
            record: &record,
            files: delivery.files,
            first_seen: delivery.first_seen,
            study: &study,
            person,
            turn,
        };
        let mut missing = objects(&sent, &self.rules);
        let count = missing.len();
        missing.retain(|object| !is_shown(object, &before));
        let receipt = |already_there| Receipt { folder: PathBuf::from(study.uid()), already_there };
        if missing.is_empty() {
            // A station that has lost its decisions does not know that it was taken back.
            return match self.mark(&study, turn + 1, &before) {
                None => Err(StoreFault::Permanent(Rejection::TakenBackThere)),
                Some(_) => Ok(receipt(true)),
            };
        }
        // Whether the server has them, only a search tells, whatever it answered.
        let answer = self.send(&missing, &study);
        let after = self.listed(&study, turn)?;
        missing.retain(|object| !is_shown(object, &after));
        if !missing.is_empty() {
            answer?;
            let why = format!("it does not show {} of {count} objects", missing.len());
            return Err(ServerFault::Answer(why).into());
        }
        Ok(receipt(false))
    }

    /// Marks what is there as made for the wrong patient. Nothing is deleted; some archives hide it then, and the mark
    /// with it.
    fn withdraw(&self, record: &TakeBack<'_>) -> Result<(), StoreFault> {
        // Of a patient whose id cannot be written nothing was sent.
        let study = record.from.and_then(|from| Study::new(record.scan.as_str(), from).ok());
        let Some(study) = study else { return Ok(()) };
        let mut study = study.answering(record.request);
        if let Some(taken) = record.taken {
            study = study.taken_at(taken.clone());
        }
        let study = match record.receipt {
            Some(uid) if !uid.is_empty() => study.confirmed(uid),
            _ => study,
        };
        let (turns, listed) = (record.turn + 1, self.listed(&study, record.turn)?);
        let is_there = study.shows_withdrawal(&listed) || !study.shown(turns, &listed).is_empty();
        self.marked(&study, record.turn, turns, listed)?;
        match record.receipt {
            // If nothing is there it is hidden by the mark of a run that ended, or not shown yet.
            Some(receipt) if receipt.is_empty() || !is_there => Err(ServerFault::NotShown.into()),
            _ => Ok(()),
        }
    }
}

fn unwritable(fault: EncodeFault) -> StoreFault {
    StoreFault::Permanent(Rejection::DicomObject(fault))
}

fn is_shown(object: &DicomObject, listed: &[Listed]) -> bool {
    listed.iter().any(|of| of.uid == object.uid())
}
