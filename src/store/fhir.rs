//! A FHIR R4 server as a store: each record is a transaction of resources that are created if none has their
//! identifier yet, so that the same record can be sent again at any time.
//!
//! The server itself is the register. A resource that is there already is compared with what was sent: one of an
//! earlier revision, or one that was withdrawn, is replaced; one of a later revision stays.

mod access;
mod answers;
mod existing;
mod patient;
mod smart;

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use hyper::Method;
use hyper::header::{ACCEPT, CONTENT_TYPE, HeaderName, HeaderValue};
use serde_json::Value;

use self::access::Token;
use self::answers::{Asked, outcome_of};
use super::http::{HttpAnswer, HttpClient, HttpFault, HttpRequest};
use super::server::ServerFault;
use super::{Delivery, Misfit, Receipt, StoreFault};
use crate::flow::ScanId;
use crate::flow::server::EndpointFault;
use crate::flow::server::fhir::FhirServer;
use crate::record::Record;
use crate::record::fhir::{self, FhirKey, FhirRules, Sent};

/// The media type of FHIR as JSON.
const JSON: HeaderValue = HeaderValue::from_static("application/fhir+json");

/// The id of a patient whom no server knows.
const TRIAL_PATIENT: &str = "gaiter-check";

/// A FHIR server as a store.
#[derive(Debug, Clone)]
pub struct FhirStore {
    server: FhirServer,
    rules: FhirRules,
    /// The token in use.
    token: Arc<Mutex<Option<Token>>>,
}

impl FhirStore {
    /// Its name in the journal.
    pub const NAME: &str = crate::flow::server::fhir::NAME;

    /// Resources as `rules` says, for this server.
    pub fn new(server: FhirServer, rules: FhirRules) -> FhirStore {
        FhirStore { server, rules, token: Arc::default() }
    }

    /// The base address, as configured.
    pub fn place(&self) -> String {
        self.server.base.clone()
    }

    /// Checks that the server answers, speaks R4, and lets the station in.
    ///
    /// # Errors
    /// A transient fault if not.
    pub fn reach(&self) -> Result<(), StoreFault> {
        let statement = self.ask(Method::GET, "metadata", None, &[])?;
        let version = statement["fhirVersion"].as_str().unwrap_or_default();
        if statement["resourceType"] != "CapabilityStatement" {
            let why = "the base address gives no capability statement".to_owned();
            return Err(ServerFault::Answer(why).into());
        }
        if !version.starts_with(fhir::VERSION) {
            let version: String = version.chars().take(20).collect();
            return Err(ServerFault::Answer(format!("it speaks FHIR {version:?}, not R4")).into());
        }
        Ok(())
    }

    /// Checks what [`FhirStore::reach`] does, and that the station may search for patients: for one whom no
    /// server knows.
    ///
    /// # Errors
    /// A fault if not.
    pub fn try_out(&self) -> Result<(), StoreFault> {
        self.reach()?;
        match self.subject(TRIAL_PATIENT) {
            Err(StoreFault::Permanent(Misfit::NotRegistered)) => Ok(()),
            tried => tried.map(|_| ()),
        }
    }

    /// Sends a record, or finds that it is there.
    pub fn put(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
        let misfit = |misfit| StoreFault::Permanent(misfit);
        let patient = delivery.patient.ok_or(misfit(Misfit::Unassigned))?;
        let json = delivery.files.iter().find(|file| file.name == "record.json");
        let record = json.and_then(|file| serde_json::from_slice::<Record>(&file.bytes).ok());
        let record = record.ok_or(misfit(Misfit::NoRecord))?;
        // The record must match the delivery: another patient's figures must never go out under this id.
        if record.patient.as_ref().map(|patient| patient.id.as_str()) != Some(patient) {
            return Err(misfit(Misfit::OtherPatient));
        }
        let subject = self.subject(patient)?;
        let key = FhirKey::of(delivery.scan.as_str(), patient);
        let mut entries = fhir::entries(
            &Sent {
                record: &record,
                files: delivery.files,
                first_seen: delivery.first_seen,
                subject: &subject.reference(),
                key: &key,
            },
            &self.rules,
        );
        entries.splice(0..0, subject.created());
        let answer = self.ask(Method::POST, "", Some(&fhir::created(&entries)), &[patient])?;
        let done = Asked::of(&answer, &entries)?;
        let is_new = done.iter().any(|of| of.is_new);
        let stale = self.stale(&entries, &done, &key, record.revision, patient)?;
        if !stale.is_empty() {
            let known: Vec<(String, String)> = entries
                .iter()
                .zip(&done)
                .map(|(entry, of)| (entry.reference(), of.reference.clone()))
                .collect();
            let answer = fhir::replaced(&stale, &known);
            let answer = self.ask(Method::POST, "", Some(&answer), &[patient])?;
            Asked::all(&answer, stale.len())?;
        }
        let report = entries.iter().zip(&done).find(|(of, _)| of.kind() == "DiagnosticReport");
        let place = report.map(|(_, of)| of.reference.clone()).unwrap_or_default();
        let already_there = !is_new && stale.is_empty();
        Ok(Receipt { folder: PathBuf::from(place), already_there })
    }

    /// Marks what was made of a scan for a patient as entered in error. Nothing is deleted.
    pub fn withdraw(&self, scan: &ScanId, from: Option<&str>) -> Result<(), StoreFault> {
        let Some(patient) = from else { return Ok(()) };
        let key = FhirKey::of(scan.as_str(), patient);
        let marked = self.marked_in_error(&key, patient)?;
        if marked.is_empty() {
            return Ok(());
        }
        let answer = fhir::replaced(&marked, &[]);
        let answer = self.ask(Method::POST, "", Some(&answer), &[patient])?;
        Asked::all(&answer, marked.len())?;
        Ok(())
    }

    /// Asks the server for a path below its base, with a body or without, and reads the answer as JSON. One with
    /// another status than 2xx is a fault, told without the words of `secret`.
    fn ask(
        &self,
        method: Method,
        path: &str,
        body: Option<&Value>,
        secret: &[&str],
    ) -> Result<Value, StoreFault> {
        let body = body.map(Value::to_string).unwrap_or_default().into_bytes();
        let mut answer = self.send(&method, path, &body)?;
        if answer.status == 401 && self.forget_token() {
            answer = self.send(&method, path, &body)?;
        }
        let json: Value = serde_json::from_slice(&answer.body).unwrap_or_default();
        match answer.is_success() {
            true => Ok(json),
            false => Err(outcome_of(answer.status, &json, secret)),
        }
    }

    fn send(&self, method: &Method, path: &str, body: &[u8]) -> Result<HttpAnswer, StoreFault> {
        let client = self.client();
        let mut headers: Vec<(HeaderName, HeaderValue)> = vec![(ACCEPT, JSON)];
        if !body.is_empty() {
            headers.push((CONTENT_TYPE, JSON));
        }
        headers.extend(self.authorization(&client)?);
        let address = match path.is_empty() {
            true => self.server.base.clone(),
            false => format!("{}/{path}", self.server.base),
        };
        let uri = address
            .parse()
            .map_err(|_| ServerFault::Http(HttpFault::from(EndpointFault::Address)))?;
        let request = HttpRequest { method: method.clone(), uri, headers, body: body.to_vec() };
        Ok(client.send(request).map_err(ServerFault::Http)?)
    }

    fn client(&self) -> HttpClient {
        let FhirServer { tls, proxy, limit, .. } = &self.server;
        HttpClient::new(tls.clone(), proxy.clone(), *limit)
    }
}
