//! A FHIR server of a test's own: stores that send to it, and what it has.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::time::Duration;

use gaiter::store::fhir::{FhirAccess, FhirServer, FhirStore};
use gaiter::store::{HttpAccess, Receipt, RecordStore, StoreFault};
use gaiter_https::TlsFiles;
use rig::web::Site;
use serde_json::{Value, json};
use support::records::fhir_rules;

use crate::records::{PATIENT, Scan};
use crate::server::{House, Server, fhir};

/// How long an answer is waited for.
pub const LONG: Duration = Duration::from_secs(30);

/// The system of patients' ids on the server.
pub const PATIENTS: &str = "urn:oid:1.2.276.0.76.3.1.999";

/// How many resources of each kind a server has of one record with one document: devices, observations, reports,
/// documents.
pub const ONE: [usize; 4] = [1, 2, 1, 1];

/// Resources that are made of records, in the order of [`ONE`].
const KINDS: [&str; 4] = ["Device", "Observation", "DiagnosticReport", "DocumentReference"];

/// A store, as the station has it.
pub type Store = Box<dyn RecordStore>;

/// What a store does that may fail, and is done again.
pub type Deed<'a> = &'a dyn Fn(&Store) -> Result<(), StoreFault>;

/// The server at this base address, which lets everybody in.
pub fn server_at(base: String) -> FhirServer {
    FhirServer {
        base,
        access: FhirAccess::Http(HttpAccess::Open),
        tls: TlsFiles::default(),
        proxy: None,
        limit: LONG,
        patients: PATIENTS.to_owned(),
    }
}

/// A store that sends report and record.
pub fn store_of(server: FhirServer) -> Store {
    Box::new(FhirStore::new(server, fhir_rules(&["report.pdf", "record.json"]), ""))
}

#[track_caller]
pub fn put(store: &Store, scan: &Scan) -> Receipt {
    store.put(&scan.delivery()).unwrap_or_else(|fault| panic!("{fault}"))
}

/// Why a server does not take a record now.
#[track_caller]
pub fn setback(store: &Store, scan: &Scan) -> String {
    match store.put(&scan.delivery()) {
        Err(StoreFault::Server(fault)) => fault.to_string(),
        other => panic!("{other:?}"),
    }
}

impl House {
    /// A FHIR server that knows this patient.
    pub fn with_patient() -> House {
        let house = House::new(fhir());
        house.register(PATIENT);
        house
    }

    /// One that has what it was given after it was killed, too.
    pub fn that_keeps(server: &'static Server) -> House {
        let house = House::new(server);
        fs::write(house.path("kept"), "").unwrap();
        house.register(PATIENT);
        house
    }

    /// Its base address without TLS.
    pub fn base(&self) -> String {
        format!("http://127.0.0.1:{}/{}", self.server.port("http"), self.name)
    }

    /// Its base address for a way in by TLS.
    pub fn base_by(&self, way: &str) -> String {
        format!("https://localhost:{}/{}", self.server.port(way), self.name)
    }

    /// A store that sends report and record to it.
    pub fn store(&self) -> Store {
        self.store_within(LONG)
    }

    /// A store that waits for it no longer than this.
    pub fn store_within(&self, limit: Duration) -> Store {
        store_of(FhirServer { limit, ..server_at(self.base()) })
    }

    pub fn register(&self, patient: &str) -> Value {
        self.create(&json!({
            "resourceType": "Patient", "identifier": [{ "system": PATIENTS, "value": patient }],
        }))
    }

    /// Creates a resource, beside every store.
    pub fn create(&self, resource: &Value) -> Value {
        let kind = resource["resourceType"].as_str().unwrap();
        self.asked("POST", kind, &resource.to_string())
    }

    pub fn get(&self, path: &str) -> Value {
        self.asked("GET", path, "")
    }

    /// The resources of a kind that it has, at most 1000.
    pub fn resources(&self, kind: &str) -> Vec<Value> {
        let bundle = self.get(&format!("{kind}?_count=1000"));
        let entries = bundle["entry"].as_array().cloned().unwrap_or_default();
        entries.into_iter().map(|mut entry| entry["resource"].take()).collect()
    }

    /// How many resources of each kind it has, in the order of [`ONE`].
    pub fn counts(&self) -> [usize; 4] {
        KINDS.map(|kind| {
            let counted = self.get(&format!("{kind}?_summary=count&_total=accurate"));
            usize::try_from(counted["total"].as_u64().unwrap()).unwrap()
        })
    }

    /// The status of each resource of a kind about a patient.
    pub fn statuses(&self, kind: &str, patient: &str) -> Vec<String> {
        let is_its = |of: &&Value| of["identifier"][0]["value"] == patient;
        let id = self.resources("Patient").iter().find(is_its).unwrap()["id"].clone();
        let reference = format!("Patient/{}", id.as_str().unwrap());
        let of_patient = |of: &Value| of["subject"]["reference"] == reference.as_str();
        let all = self.resources(kind).into_iter().filter(of_patient);
        all.map(|of| of["status"].as_str().unwrap().to_owned()).collect()
    }

    fn asked(&self, method: &str, path: &str, body: &str) -> Value {
        let site = Site { port: self.server.port("http"), token: String::new() };
        let headers = [
            ("Connection", "close".to_owned()),
            ("Content-Type", "application/fhir+json".to_owned()),
        ];
        let answer = site.request(method, &format!("/{}/{path}", self.name), body, &headers);
        assert!(answer.status < 300, "{method} {path}: {} {}", answer.status, answer.body);
        serde_json::from_str(&answer.body).unwrap()
    }
}
