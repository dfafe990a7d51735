//! A FHIR R4 server as a store: each record is a transaction of resources that are created if none has their
//! identifier yet, so that the same record can be sent again at any time.
//!
//! The server itself is the register. A resource that is there already is compared with what was sent: one of an
//! earlier revision, or one that this station withdrew, is replaced; one of a later revision stays, and so does a
//! record that another withdrew.

mod access;
mod answers;
mod existing;
mod patient;
mod server;
mod smart;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use gaiter_https::HttpsClient;
use gaiter_record::fhir::{self, Entry, FhirKey, FhirRules, Replacement, Sent};
use http::header::HeaderValue;
use http::{Method, StatusCode};
use serde_json::Value;

use self::access::Token;
use self::answers::{Asked, of_replacing, outcome_of};
use self::existing::REPORT;
use super::server::ServerFault;
use super::web::{asked, secret_words};
use super::{Delivery, Receipt, RecordStore, Rejection, StoreFault, TakeBack};
pub use server::{FhirAccess, FhirServer, SmartAccess};

/// The media type of FHIR as JSON.
const JSON: &str = "application/fhir+json";

/// The id of a patient whom no server knows.
const TRIAL_PATIENT: &str = "gaiter-check";

/// Requests of a long step: one for the patient, two that write, one for each resource that is there already, and two
/// for a token, which may have to be requested again.
const REQUESTS_MOST: u32 = 16;

/// A FHIR server as a store.
#[derive(Debug)]
pub struct FhirStore {
    server: FhirServer,
    rules: FhirRules,
    client: HttpsClient,
    /// The token in use.
    token: Mutex<Option<Token>>,
    /// The station's name: a withdrawal names it.
    station: String,
}

impl FhirStore {
    /// Its name in the journal.
    pub const NAME: &str = "fhir";

    /// The store of a station, of resources by `rules`, at this server.
    pub fn new(server: FhirServer, rules: FhirRules, station: &str) -> FhirStore {
        let client = HttpsClient::new(server.tls.clone(), server.proxy.clone(), server.limit);
        FhirStore { server, rules, client, token: Mutex::default(), station: station.to_owned() }
    }

    /// Creates what the server has not yet. Returns each entry with what became of it.
    fn create(
        &self,
        entries: Vec<Entry>,
        patient: &str,
    ) -> Result<Vec<(Entry, Asked)>, StoreFault> {
        let answer = self.ask(Method::POST, "", Some(&fhir::created(&entries)), &[patient])?;
        let done = Asked::read(&answer, &entries, &[patient])?;
        Ok(entries.into_iter().zip(done).collect())
    }

    /// Replaces what was read before. `known` gives the place of each reference within the transaction.
    fn replace(
        &self,
        replacements: &[Replacement],
        known: &[(String, String)],
        patient: &str,
    ) -> Result<(), StoreFault> {
        if replacements.is_empty() {
            return Ok(());
        }
        let body = fhir::replaced(replacements, known);
        let answer = self.ask(Method::POST, "", Some(&body), &[patient]).map_err(of_replacing)?;
        let done = Asked::all(&answer, replacements.len(), &[patient]);
        done.map(|_| ()).map_err(of_replacing)
    }

    /// Asks the server for a path below its base, with a body or without, and reads the answer as JSON. One with
    /// another status than 2xx is a fault, reported without the words of `secret`.
    fn ask(
        &self,
        method: Method,
        path: &str,
        body: Option<&Value>,
        secret: &[&str],
    ) -> Result<Value, StoreFault> {
        let address = match path.is_empty() {
            true => self.server.base.clone(),
            false => format!("{}/{path}", self.server.base),
        };
        let body = body.map(|body| (JSON.to_owned(), body.to_string().into_bytes()));
        let mut shown = self.authorization()?;
        let send = |shown: &Option<HeaderValue>| {
            asked(&self.client, method.clone(), &address, JSON, body.clone(), shown.clone())
        };
        let mut answer = send(&shown)?;
        if answer.status() == StatusCode::UNAUTHORIZED && self.forget_token() {
            shown = self.authorization()?;
            answer = send(&shown)?;
        }
        // What is no JSON is nothing that is looked for in it.
        let json: Value = serde_json::from_slice(answer.body()).unwrap_or_default();
        if answer.status().is_success() {
            return Ok(json);
        }
        let words = shown.as_ref().map(secret_words).unwrap_or_default();
        let secret = secret.iter().copied().chain(words.iter().map(String::as_str));
        Err(outcome_of(answer.status().as_u16(), &json, &secret.collect::<Vec<_>>()))
    }
}

impl RecordStore for FhirStore {
    fn name(&self) -> &'static str {
        FhirStore::NAME
    }

    fn place(&self) -> String {
        self.server.base.clone()
    }

    fn is_server(&self) -> bool {
        true
    }

    fn own_certificate(&self) -> Option<&Path> {
        self.server.tls.certificate()
    }

    /// Each request has the limit for itself.
    fn step_most(&self) -> Duration {
        self.server.limit * REQUESTS_MOST
    }

    /// Checks that the server answers, uses R4, and admits the station.
    fn reach(&self) -> Result<(), StoreFault> {
        let statement = self.ask(Method::GET, "metadata", None, &[])?;
        let not_usable = |why: String| Err(ServerFault::Answer(why).into());
        if statement["resourceType"] != "CapabilityStatement" {
            return not_usable("the base address gives no capability statement".to_owned());
        }
        let version = statement["fhirVersion"].as_str().unwrap_or_default();
        if !version.starts_with(fhir::VERSION) {
            let version: String = version.chars().take(20).collect();
            return not_usable(format!("it speaks FHIR {version:?}, not R4"));
        }
        Ok(())
    }

    /// Also that the station may search for patients: for one whom no server knows.
    fn try_out(&self) -> Result<(), StoreFault> {
        self.reach()?;
        match self.subject(TRIAL_PATIENT) {
            Err(StoreFault::Permanent(Rejection::NotRegistered)) => Ok(()),
            tried => tried.map(drop),
        }
    }

    fn put(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
        let (record, patient) = delivery.named_record().map_err(StoreFault::Permanent)?;
        let (subject, key) =
            (self.subject(patient)?, FhirKey::new(delivery.scan.as_str(), patient));
        let sent = Sent {
            record: &record,
            files: delivery.files,
            first_seen: delivery.first_seen,
            subject: &subject,
            key: &key,
        };
        let created = self.create(fhir::entries(&sent, &self.rules), patient)?;
        let stale = self.stale(&created, &key, record.revision, patient);
        if matches!(stale, Err(StoreFault::Permanent(Rejection::TakenBackThere))) {
            // Nothing that was created beside the report holds.
            let there = self.of_record(&key, patient)?;
            self.replace(&FhirStore::in_error(&there, None)?, &[], patient)?;
        }
        let stale = stale?;
        let known: Vec<(String, String)> =
            created.iter().map(|(entry, of)| (entry.reference(), of.reference.clone())).collect();
        self.replace(&stale, &known, patient)?;
        let report = created.iter().find(|(entry, _)| entry.kind() == REPORT);
        let place = report.map(|(_, of)| of.reference.clone()).unwrap_or_default();
        let already_there = created.iter().all(|(_, of)| !of.is_new) && stale.is_empty();
        Ok(Receipt { folder: PathBuf::from(place), already_there })
    }

    /// Marks what was made of the scan for the patient as entered in error, by this station. Nothing is deleted.
    fn withdraw(&self, record: &TakeBack<'_>) -> Result<(), StoreFault> {
        let Some(patient) = record.from else { return Ok(()) };
        let key = FhirKey::new(record.scan.as_str(), patient);
        let mark = self.identifier(key.withdrawal(&self.station));
        let there = self.of_record(&key, patient)?;
        self.replace(&FhirStore::in_error(&there, Some(&mark))?, &[], patient)?;
        self.all_found(&there, record.receipt, patient)
    }
}
