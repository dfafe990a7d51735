//! What a record becomes on a FHIR server, and that it becomes it once.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;
use std::time::Duration;

use gaiter::cad::Output;
use gaiter::flow::ScanId;
use gaiter::flow::server::TlsFiles;
use gaiter::flow::server::fhir::{Access, FhirServer, Missing};
use gaiter::language::Language;
use gaiter::leg::{Level, Method, Side, extract};
use gaiter::record::fhir::{FhirKey, FhirRules, Sent, created, entries};
use gaiter::record::measure::Measure;
use gaiter::record::measure::amendment::{Amendment, Deed};
use gaiter::record::report::Mark;
use gaiter::record::rounding::cm;
use gaiter::record::{
    Acquired, AcquiredFrom, Patient, Provenance, Record, RecordFile, ReportChoice, ScanFile,
    Source, SourceKind, record_files, sha256,
};
use gaiter::scan::Format;
use gaiter::sizes::Garment;
use gaiter::store::{Delivery, FhirStore, Misfit, Receipt, StoreFault};
use serde_json::{Value, json};
use support::geometry::bodies::export;

use crate::server::{Server, python};

/// The system of patients' ids on the server.
pub const PATIENTS: &str = "urn:oid:1.2.276.0.76.3.1.999";

/// A scan that can be delivered, and its record for a patient.
pub struct Scan {
    pub id: ScanId,
    pub record: Record,
    pub files: Vec<RecordFile>,
}

/// The record of a body for a patient, as a station makes it.
pub fn scan_of(body: &str, patient: &str) -> Scan {
    let bytes = export(body);
    let method = Method::default();
    let extraction = extract(&bytes, Format::Obj, &method).unwrap();
    let sources = vec![Source::of(SourceKind::Reader)];
    let mut provenance = Provenance::of_scan(sha256(&bytes));
    provenance.station = Some("booth-1".to_owned());
    provenance.patient = Some(Patient { id: patient.to_owned(), sources });
    let at = "2026-11-19T23:30:00Z".parse().unwrap();
    let acquired = Acquired::new(at, AcquiredFrom::Press);
    provenance.acquired = Some(Acquired { utc_offset_min: Some(60), ..acquired });
    let scan = ScanFile { bytes: &bytes, format: Format::Obj, ord: None };
    let (output, choice) = (Output::default(), ReportChoice::default());
    let made = record_files(&extraction, &provenance, &method, &output, &choice, scan).unwrap();
    let files = made.1;
    let json = files.iter().find(|file| file.name == "record.json").unwrap();
    let record = serde_json::from_slice(&json.bytes).unwrap();
    Scan { id: ScanId::parse(&provenance.sha256).unwrap(), record, files }
}

/// The record of a whole body for the patient 4711.
pub static SCAN: LazyLock<Scan> = LazyLock::new(|| scan_of("f_average_tc2", "4711"));

impl Scan {
    pub fn delivery(&self) -> Delivery<'_> {
        Delivery {
            scan: &self.id,
            patient: self.record.patient.as_ref().map(|patient| patient.id.as_str()),
            first_seen: "2026-11-20T08:00:00Z".parse().unwrap(),
            revision: self.record.revision,
            files: &self.files,
            scan_file: Path::new("/dev/null"),
            ending: "obj",
        }
    }

    /// The same after a person set the girth of C on the right leg.
    pub fn amended(&self, girth_mm: f64) -> Scan {
        let amendment = Amendment {
            leg: "right".to_owned(),
            measure: "C".to_owned(),
            is: Deed::Measured,
            girth_mm: Some(girth_mm),
            height_mm: None,
            length_mm: None,
            reason: "swollen".to_owned(),
            by: "Anna Berg".to_owned(),
            at: "2026-11-20T10:00:00Z".parse().unwrap(),
        };
        let mut record = self.record.amended(&[amendment], true).unwrap();
        record.revision = self.record.revision + 1;
        self.with(record)
    }

    /// The same scan for another patient.
    pub fn of_patient(&self, patient: &str) -> Scan {
        let mut record = self.record.clone();
        record.patient.as_mut().unwrap().id = patient.to_owned();
        self.with(record)
    }

    fn with(&self, record: Record) -> Scan {
        let mut files = self.files.clone();
        let json = files.iter_mut().find(|file| file.name == "record.json").unwrap();
        json.bytes = serde_json::to_vec(&record).unwrap();
        Scan { id: self.id.clone(), record, files }
    }
}

pub fn rules(attach: &[&str]) -> FhirRules {
    FhirRules {
        identifiers: "urn:gaiter:record".to_owned(),
        codes: "urn:gaiter:measure".to_owned(),
        language: Language::En,
        garment: Garment::default(),
        attach: attach.iter().map(|name| (*name).to_owned()).collect(),
    }
}

pub fn server_at(server: &Server) -> FhirServer {
    FhirServer {
        base: server.address(),
        access: Access::Open,
        tls: TlsFiles::default(),
        proxy: None,
        limit: Duration::from_secs(20),
        patients: PATIENTS.to_owned(),
        missing: Missing::Wait,
    }
}

pub fn store(server: &Server) -> FhirStore {
    FhirStore::new(server_at(server), rules(&["report.pdf", "record.json"]))
}

/// Registers a patient.
pub fn register(server: &Server, id: &str) -> Value {
    server.create(&json!({
        "resourceType": "Patient", "identifier": [{ "system": PATIENTS, "value": id }],
    }))
}

/// How many resources of each kind the server has.
pub fn counts(server: &Server) -> [usize; 4] {
    ["Device", "Observation", "DiagnosticReport", "DocumentReference"]
        .map(|kind| server.resources(kind).len())
}

/// What a server has of one record.
pub const ONE: [usize; 4] = [1, 2, 1, 1];

#[track_caller]
pub fn put(store: &FhirStore, scan: &Scan) -> Receipt {
    store.put(&scan.delivery()).unwrap_or_else(|fault| panic!("{fault}"))
}

fn refused(store: &FhirStore, scan: &Scan) -> Misfit {
    match store.put(&scan.delivery()) {
        Err(StoreFault::Permanent(misfit)) => misfit,
        other => panic!("{other:?}"),
    }
}

/// The figures of an observation by their codes, cm.
fn figures(observation: &Value) -> BTreeMap<String, f64> {
    let components = observation["component"].as_array().unwrap().iter();
    components
        .map(|of| {
            let code = of["code"]["coding"][0]["code"].as_str().unwrap().to_owned();
            (code, of["valueQuantity"]["value"].as_f64().unwrap())
        })
        .collect()
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_record_is_there_once_however_often_it_is_sent_with_all_figures_of_the_sheet() {
    let server = Server::fhir(false, |_| {});
    register(&server, "4711");
    let store = store(&server);
    store.reach().unwrap();
    assert!(!put(&store, &SCAN).already_there);
    assert_eq!(counts(&server), ONE);
    for _ in 0..20 {
        assert!(put(&store, &SCAN).already_there);
    }
    assert_eq!(counts(&server), ONE);
    for side in Side::BOTH {
        let part = FhirKey::of(SCAN.id.as_str(), "4711").part(side.word());
        let observations = server.resources("Observation");
        let is_its = |of: &&Value| of["identifier"][1]["value"] == part.as_str();
        let told = figures(observations.iter().find(is_its).unwrap());
        let mut expected = BTreeMap::new();
        for level in Level::ALL {
            let Ok(measure) = Measure::of(&SCAN.record, side, level) else { continue };
            for (letter, length) in [('c', Some(measure.girth)), ('l', measure.height)] {
                let Some(length) = length else { continue };
                if measure.mark_of(length) != Mark::Estimated {
                    expected.insert(format!("{letter}{}", level.name()), cm(length.mm));
                }
            }
        }
        assert!(expected.len() > 6);
        assert_eq!(told, expected, "{}", side.word());
    }
    let report = server.resources("DiagnosticReport").remove(0);
    assert_eq!(
        (&report["status"], report["result"].as_array().unwrap().len()),
        (&json!("final"), 2)
    );
    assert_eq!(report["effectiveDateTime"], "2026-11-20T00:30:00+01:00");
    let document = server.resources("DocumentReference").remove(0);
    let reference = format!("DiagnosticReport/{}", report["id"].as_str().unwrap());
    assert_eq!(document["context"]["related"][0]["reference"], reference.as_str());
}

#[test]
#[ignore = "needs Medplum's FHIR router and a thousand deliveries, run by .ci/run"]
fn a_replay_of_a_thousand_deliveries_creates_nothing_twice() {
    let server = Server::fhir(false, |_| {});
    register(&server, "4711");
    let store = FhirStore::new(server_at(&server), rules(&[]));
    let scans: Vec<Scan> = (0..1000_u32)
        .map(|number| Scan {
            id: ScanId::parse(&format!("{number:064x}")).unwrap(),
            record: SCAN.record.clone(),
            files: vec![SCAN.files.iter().find(|of| of.name == "record.json").unwrap().clone()],
        })
        .collect();
    for round in 0..2 {
        for scan in &scans {
            assert_eq!(put(&store, scan).already_there, round == 1);
        }
    }
    assert_eq!(server.get("Observation?_summary=count&_total=accurate")["total"], 2000);
    assert_eq!(server.get("DiagnosticReport?_summary=count&_total=accurate")["total"], 1000);
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_correction_replaces_what_was_sent_and_an_older_revision_does_not_come_back() {
    let server = Server::fhir(false, |_| {});
    register(&server, "4711");
    let store = store(&server);
    put(&store, &SCAN);
    let later = SCAN.amended(391.0);
    put(&store, &later);
    put(&store, &SCAN);
    put(&store, &later);
    assert_eq!(counts(&server), ONE);
    let observations = server.resources("Observation");
    let right = observations.iter().find(|of| figures(of)["cC"] == 39.1).unwrap();
    assert_eq!(right["status"], "amended");
    assert_eq!(server.resources("DiagnosticReport")[0]["status"], "amended");
    let document = server.resources("DocumentReference").remove(0);
    assert_eq!(
        (&document["status"], &document["docStatus"]),
        (&json!("current"), &json!("amended"))
    );
    // References lead to the same resources as before.
    let report = server.resources("DiagnosticReport").remove(0);
    let results = report["result"].as_array().unwrap();
    assert!(results.iter().all(|of| of["reference"].as_str().unwrap().starts_with("Observation/")));
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn what_was_sent_for_the_wrong_patient_is_entered_in_error_and_can_come_back() {
    let server = Server::fhir(false, |_| {});
    register(&server, "4711");
    register(&server, "4712");
    let store = store(&server);
    put(&store, &SCAN);
    let other = SCAN.of_patient("4712");
    put(&store, &other);
    assert_eq!(counts(&server), [1, 4, 2, 2]);
    store.withdraw(&SCAN.id, Some("4711")).unwrap();
    store.withdraw(&SCAN.id, Some("4711")).unwrap();
    let status = |kind: &str, patient: &str| -> Vec<String> {
        let patients = server.resources("Patient");
        let is_its = |of: &&Value| of["identifier"][0]["value"] == patient;
        let id = patients.iter().find(is_its).unwrap()["id"].as_str().unwrap();
        let reference = format!("Patient/{id}");
        let resources = server.resources(kind).into_iter();
        resources
            .filter(|of| of["subject"]["reference"] == reference.as_str())
            .map(|of| of["status"].as_str().unwrap().to_owned())
            .collect()
    };
    for kind in ["Observation", "DiagnosticReport", "DocumentReference"] {
        assert!(status(kind, "4711").iter().all(|of| of == "entered-in-error"), "{kind}");
        assert!(status(kind, "4712").iter().all(|of| of != "entered-in-error"), "{kind}");
    }
    // The scan was the first patient's after all.
    assert!(!put(&store, &SCAN).already_there);
    assert_eq!(status("Observation", "4711"), ["final", "final"]);
    assert_eq!(counts(&server), [1, 4, 2, 2]);
    // Nothing is there of a scan that was never sent.
    store.withdraw(&ScanId::parse(&"1".repeat(64)).unwrap(), Some("4711")).unwrap();
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_record_goes_to_the_one_patient_of_its_id_and_to_no_other() {
    let server = Server::fhir(false, |_| {});
    let store = store(&server);
    register(&server, "47110");
    assert_eq!(refused(&store, &SCAN), Misfit::NotRegistered);
    let mut known = register(&server, "4711");
    put(&store, &SCAN);
    register(&server, "4711");
    assert_eq!(refused(&store, &SCAN), Misfit::RegisteredTwice(2));
    assert_eq!(counts(&server), ONE);
    // Of another system the same id is another patient.
    let server = Server::fhir(false, |_| {});
    let store = crate::fhir::store(&server);
    server.create(&json!({
        "resourceType": "Patient", "identifier": [{ "system": "urn:oid:1.2", "value": "4711" }],
    }));
    assert_eq!(refused(&store, &SCAN), Misfit::NotRegistered);
    known["active"] = false.into();
    server.create(&known);
    assert_eq!(refused(&store, &SCAN), Misfit::PatientNotInUse);
    assert_eq!(counts(&server), [0; 4]);
    // A record of another patient than the delivery is sent to neither.
    let wrong = Delivery { patient: Some("4712"), ..SCAN.delivery() };
    assert!(matches!(store.put(&wrong), Err(StoreFault::Permanent(Misfit::OtherPatient))));
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_patient_is_only_created_where_the_configuration_wants_it_and_only_once() {
    let server = Server::fhir(false, |_| {});
    let creating = FhirServer { missing: Missing::Create, ..server_at(&server) };
    let store = FhirStore::new(creating, rules(&["report.pdf", "record.json"]));
    put(&store, &SCAN);
    put(&store, &SCAN);
    let patients = server.resources("Patient");
    assert_eq!(patients.len(), 1);
    assert_eq!(patients[0]["identifier"], json!([{ "system": PATIENTS, "value": "4711" }]));
    assert_eq!(patients[0].get("name"), None);
    assert_eq!(counts(&server), ONE);
}

#[test]
#[ignore = "needs Python with jsonschema, and Medplum's definitions, run by .ci/run"]
fn every_resource_keeps_to_the_schema_of_r4() {
    let dir = tempfile::tempdir().unwrap();
    let mut names = Vec::new();
    let bodies = ["f_average_clean", "f_average_tc2", "m_average_clean"];
    let scans = bodies.map(|body| scan_of(body, "4711"));
    let mut bare = scans[0].record.clone();
    (bare.acquired, bare.station) = (None, None);
    bare.legs.iter_mut().for_each(|leg| {
        leg.landmarks.clear();
        leg.estimates.clear();
    });
    let bare = scans[0].with(bare);
    let all = [&scans[0], &scans[1], &scans[2], &scans[1].amended(402.0), &bare];
    for (number, scan) in all.into_iter().enumerate() {
        for language in [Language::En, Language::De] {
            let attach = ["report.pdf", "record.json", "left.step", "order.csv", "not-there.txt"];
            let rules = FhirRules { language, ..rules(&attach) };
            let sent = Sent {
                record: &scan.record,
                files: &scan.files,
                first_seen: "2026-11-20T08:00:00Z".parse().unwrap(),
                subject: "Patient/17",
                key: &FhirKey::of(scan.id.as_str(), "4711"),
            };
            let path = dir.path().join(format!("{number}-{}.json", language.tag()));
            fs::write(&path, created(&entries(&sent, &rules)).to_string()).unwrap();
            names.push(path);
        }
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hospital/r4_schema.py");
    let done = Command::new(python()).arg(script).args(&names).output().unwrap();
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{}", said.chars().take(3000).collect::<String>());
}
