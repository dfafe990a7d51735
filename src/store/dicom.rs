//! An archive of images (PACS) as a store: each record is a study of DICOM objects, stored over DICOMweb (STOW-RS).
//!
//! The server itself is the register. What it shows of the study (QIDO-RS) is compared with the objects of the record,
//! whose UIDs are always the same: only what is missing is sent, and a record counts as stored once the server shows
//! all of it, whatever it answered.

mod answers;
mod server;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};
use std::time::Duration;

use gaiter_dicom::{
    DicomObject, DicomRules, EncodeFault, Listed, PatientIdFault, Sent, Study, objects, web,
    withdrawal,
};
use gaiter_flow::ScanId;
use gaiter_https::{EndpointFault, HttpAnswer, HttpFault, HttpRequest, HttpsClient};
use http::header::{ACCEPT, AUTHORIZATION, CACHE_CONTROL, CONTENT_TYPE, HeaderName, HeaderValue};
use http::{Method, Uri};
use jiff::Timestamp;

use super::authorization::{self, secret_words};
use super::server::ServerFault;
use super::{Delivery, Receipt, RecordStore, Rejection, StoreFault};
pub use server::{DicomAccess, DicomServer};

/// The search for studies of a patient whom no archive knows.
const TRIAL_SEARCH: &str = "studies?PatientID=gaiter-check&limit=1";

/// What was stored a moment ago must be found.
const ANEW: HeaderValue = HeaderValue::from_static("no-cache");

/// Requests of a long step: one that looks what is there, one that stores, one that looks again.
const REQUESTS_MOST: u32 = 3;

/// An archive of images as a store.
#[derive(Debug)]
pub struct DicomStore {
    server: DicomServer,
    rules: DicomRules,
    client: HttpsClient,
    /// The station's name: a withdrawal names it.
    station: String,
}

impl DicomStore {
    /// Its name in the journal.
    pub const NAME: &str = "dicom";

    /// The store of a station, of objects by `rules`, at this server.
    pub fn new(server: DicomServer, rules: DicomRules, station: &str) -> DicomStore {
        let client = HttpsClient::new(server.tls.clone(), None, server.limit);
        DicomStore { server, rules, client, station: station.to_owned() }
    }

    /// What the server has of a study.
    fn listed(&self, study: &Study, patient: &str) -> Result<Vec<Listed>, StoreFault> {
        let (answer, secret) = self.ask(Method::GET, &web::search(study), None)?;
        answers::listed(&answer, &without(&secret, patient))
    }

    /// Sends objects. Whether the server has them, only a search tells.
    fn send(&self, objects: &[DicomObject], patient: &str) -> Result<(), StoreFault> {
        let body = web::multipart(objects).map_err(unwritable)?;
        let (answer, secret) = self.ask(Method::POST, "studies", Some(body))?;
        answers::stored(&answer, objects.len(), &without(&secret, patient))
    }

    /// Asks the server for a path below its base, with a body of this media type or without. Returns the answer, and the
    /// words that must get into no log.
    fn ask(
        &self,
        method: Method,
        path: &str,
        body: Option<(String, Vec<u8>)>,
    ) -> Result<(HttpAnswer, Vec<String>), ServerFault> {
        let json = HeaderValue::from_static(web::JSON);
        let mut headers: Vec<(HeaderName, HeaderValue)> =
            vec![(ACCEPT, json), (CACHE_CONTROL, ANEW)];
        let address = format!("{}/{path}", self.server.base);
        let uri: Uri = address.parse().map_err(|_| HttpFault::from(EndpointFault::Address))?;
        let body = match body {
            Some((media_type, body)) => {
                let media_type = HeaderValue::from_str(&media_type);
                let media_type = media_type.map_err(|_| HttpFault::from(EndpointFault::Address))?;
                headers.push((CONTENT_TYPE, media_type));
                body
            }
            None => Vec::new(),
        };
        let shown = self.authorization()?;
        let secret = shown.as_ref().map(secret_words).unwrap_or_default();
        headers.extend(shown.map(|shown| (AUTHORIZATION, shown)));
        Ok((self.client.send(HttpRequest { method, uri, headers, body })?, secret))
    }

    /// What the header `Authorization` holds; `None` if none is needed.
    fn authorization(&self) -> Result<Option<HeaderValue>, ServerFault> {
        match &self.server.access {
            DicomAccess::Open => Ok(None),
            DicomAccess::Basic { user, password } => authorization::basic(user, password).map(Some),
            DicomAccess::Bearer { token } => authorization::bearer(token).map(Some),
        }
    }
}

impl RecordStore for DicomStore {
    fn name(&self) -> &'static str {
        DicomStore::NAME
    }

    fn place(&self) -> String {
        self.server.base.clone()
    }

    fn is_server(&self) -> bool {
        true
    }

    fn own_certificate(&self) -> Option<&Path> {
        self.server.tls.own.as_ref().map(|(certificate, _)| certificate.as_path())
    }

    /// Each request has the limit for itself.
    fn step_most(&self) -> Duration {
        self.server.limit * REQUESTS_MOST
    }

    fn takes_unassigned(&self) -> bool {
        false
    }

    fn gives_back(&self) -> bool {
        true
    }

    /// Whether it lets the station search. Whether it lets it store, the first record tells.
    fn reach(&self) -> Result<(), StoreFault> {
        let (answer, secret) = self.ask(Method::GET, TRIAL_SEARCH, None)?;
        answers::is_archive(&answer, &without(&secret, ""))
    }

    fn put(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
        let (record, patient) = delivery.named_record().map_err(StoreFault::Permanent)?;
        let study = Study::new(delivery.scan.as_str(), patient).map_err(misfit)?;
        let before = self.listed(&study, patient)?;
        let sent = Sent {
            record: &record,
            files: delivery.files,
            first_seen: delivery.first_seen,
            study: &study,
            withdrawals: study.withdrawals(&before),
        };
        let mut missing = objects(&sent, &self.rules);
        let count = missing.len();
        missing.retain(|object| !is_shown(object, &before));
        let receipt = |already_there| Receipt { folder: PathBuf::from(study.uid()), already_there };
        if missing.is_empty() {
            return Ok(receipt(true));
        }
        self.send(&missing, patient)?;
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
    ) -> Result<(), StoreFault> {
        // Of a patient whose id cannot be written nothing was sent.
        let Some((patient, study)) =
            from.and_then(|from| Some((from, Study::new(scan.as_str(), from).ok()?)))
        else {
            return Ok(());
        };
        let listed = self.listed(&study, patient)?;
        let now = Timestamp::now();
        match withdrawal(&study, &listed, &self.station, &self.rules, now) {
            Some(mark) => {
                self.send(&[mark], patient)?;
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
    StoreFault::Permanent(Rejection::Dicom(fault))
}

fn unwritable(fault: EncodeFault) -> StoreFault {
    StoreFault::Permanent(Rejection::DicomObject(fault.to_string()))
}

fn is_shown(object: &DicomObject, listed: &[Listed]) -> bool {
    listed.iter().any(|of| of.uid == object.uid())
}

/// The words that must get into no log: those of the credentials, and the patient's id.
fn without<'w>(secret: &'w [String], patient: &'w str) -> Vec<&'w str> {
    secret.iter().map(String::as_str).chain([patient]).collect()
}
