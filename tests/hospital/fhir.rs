//! What a record becomes on a FHIR server, and that it becomes it once.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use gaiter::store::fhir::FhirStore;
use gaiter::store::{Delivery, Rejection, StoreFault, TakeBack};
use gaiter_flow::ScanId;
use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_record::fhir::{FhirKey, FhirRules, Sent, created, entries};
use serde_json::{Value, json};
use support::records::fhir_rules;

use crate::fhir_house::{ONE, PATIENTS, Store, put, server_at};
use crate::records::{PATIENT, SCANS, SMALL, Scan};
use crate::server::{House, fhir, python, script};

#[track_caller]
fn rejection(store: &Store, scan: &Scan) -> Rejection {
    match store.put(&scan.delivery()) {
        Err(StoreFault::Permanent(rejection)) => rejection,
        other => panic!("{other:?}"),
    }
}

/// The figures of an observation by their codes, cm.
fn figures(observation: &Value) -> BTreeMap<String, f64> {
    let components = observation["component"].as_array().unwrap().iter();
    let figure = |of: &Value| {
        let quantity = &of["valueQuantity"];
        assert_eq!((&quantity["code"], &quantity["unit"]), (&json!("cm"), &json!("cm")));
        assert_eq!(quantity["system"], "http://unitsofmeasure.org");
        let code = of["code"]["coding"][0]["code"].as_str().unwrap().to_owned();
        (code, quantity["value"].as_f64().unwrap())
    };
    components.map(figure).collect()
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_record_is_there_once_however_often_it_is_sent_with_all_figures_of_the_sheet() {
    for scan in &*SCANS {
        let house = House::with_patient();
        let store = house.store();
        store.reach().unwrap();
        assert!(!put(&store, scan).already_there);
        for _ in 0..10 {
            assert!(put(&store, scan).already_there);
        }
        assert_eq!(house.counts(), ONE);
        let observations = house.resources("Observation");
        for side in Side::BOTH {
            let part = FhirKey::new(scan.id.as_str(), PATIENT).part(side.word());
            let identifiers = |of: &Value| of["identifier"].as_array().cloned().unwrap();
            let is_its =
                |of: &&Value| identifiers(of).iter().any(|id| id["value"] == part.as_str());
            let told = figures(observations.iter().find(is_its).unwrap());
            let sheet = scan.sheet(side).into_iter();
            let expected: BTreeMap<String, f64> =
                sheet.map(|(code, cm)| (code, cm.parse().unwrap())).collect();
            assert_eq!(told, expected, "{}", side.word());
        }
        let report = house.resources("DiagnosticReport").remove(0);
        assert_eq!(report["status"], "final");
        assert_eq!(report["result"].as_array().unwrap().len(), 2);
        assert_eq!(report["effectiveDateTime"], "2026-11-20T00:30:00+01:00");
        let form = &report["presentedForm"][0];
        assert_eq!(form["contentType"], "application/pdf");
        assert!(form["data"].as_str().unwrap().starts_with("JVBER"), "a PDF in base64");
        let document = house.resources("DocumentReference").remove(0);
        let reference = format!("DiagnosticReport/{}", report["id"].as_str().unwrap());
        assert_eq!(document["context"]["related"][0]["reference"], reference.as_str());
    }
}

#[test]
#[ignore = "needs Medplum's FHIR router and a thousand deliveries, run by .ci/run"]
fn a_replay_of_a_thousand_deliveries_creates_nothing_twice() {
    let house = House::with_patient();
    let store: Store = Box::new(FhirStore::new(server_at(house.base()), fhir_rules(&[]), ""));
    let scans: Vec<Scan> = (0..1000).map(|number| SMALL.numbered(number)).collect();
    for round in 0..2 {
        for scan in &scans {
            assert_eq!(put(&store, scan).already_there, round == 1);
        }
        assert_eq!(house.counts(), [1, 2000, 1000, 0]);
    }
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_correction_replaces_what_was_sent_and_an_older_revision_does_not_come_back() {
    let house = House::with_patient();
    let (store, scan) = (house.store(), &SCANS[1]);
    put(&store, scan);
    let later = scan.amended(391.0);
    for sent in [&later, scan, &later] {
        put(&store, sent);
    }
    assert_eq!(house.counts(), ONE);
    let observations = house.resources("Observation");
    let right = observations.iter().find(|of| figures(of)["cC"] == 39.1).unwrap();
    assert_eq!(right["status"], "amended");
    let report = house.resources("DiagnosticReport").remove(0);
    assert_eq!(report["status"], "amended");
    let document = house.resources("DocumentReference").remove(0);
    let status = (&document["status"], &document["docStatus"]);
    assert_eq!(status, (&json!("current"), &json!("amended")));
    // References lead to the same resources as before.
    let results = report["result"].as_array().unwrap();
    let ids: Vec<String> = observations.iter().map(|of| of["id"].to_string()).collect();
    for result in results {
        let id = result["reference"].as_str().unwrap().strip_prefix("Observation/").unwrap();
        assert!(ids.contains(&format!("\"{id}\"")), "{id} is none of {ids:?}");
    }
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn what_was_sent_for_the_wrong_patient_is_entered_in_error_and_can_come_back() {
    let house = House::with_patient();
    house.register("4712");
    let store = house.store();
    put(&store, &SMALL);
    put(&store, &SMALL.of_patient("4712"));
    assert_eq!(house.counts(), [1, 4, 2, 2]);
    for _ in 0..2 {
        store
            .withdraw(&TakeBack { keeper: Some("4712"), ..TakeBack::new(&SMALL.id, Some(PATIENT)) })
            .unwrap();
    }
    for kind in ["Observation", "DiagnosticReport", "DocumentReference"] {
        let (wrong, right) = (house.statuses(kind, PATIENT), house.statuses(kind, "4712"));
        assert!(wrong.iter().all(|of| of == "entered-in-error"), "{kind}: {wrong:?}");
        assert!(right.iter().all(|of| of != "entered-in-error"), "{kind}: {right:?}");
    }
    // The scan was the first patient's after all.
    assert!(!put(&store, &SMALL).already_there);
    assert_eq!(house.statuses("Observation", PATIENT), ["final", "final"]);
    assert_eq!(house.counts(), [1, 4, 2, 2], "nothing is deleted, and nothing is there twice");
    // Nothing is there of a scan that was never sent.
    let never = ScanId::parse(&"1".repeat(64)).unwrap();
    store.withdraw(&TakeBack::new(&never, Some(PATIENT))).unwrap();
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn what_one_station_took_back_another_brings_back_only_after_a_decision_of_its_own() {
    let house = House::with_patient();
    let [first, second] = ["booth-1", "booth-2"].map(|name| -> Store {
        let rules = fhir_rules(&["report.pdf", "record.json"]);
        Box::new(FhirStore::new(server_at(house.base()), rules, name))
    });
    let receipt = put(&first, &SMALL).folder;
    let withdraw = |store: &Store| {
        let taken_back = TakeBack::new(&SMALL.id, Some(PATIENT));
        store.withdraw(&TakeBack { receipt: receipt.to_str(), ..taken_back }).unwrap();
    };
    withdraw(&first);
    let later = SMALL.amended(391.0);
    for _ in 0..2 {
        assert_eq!(rejection(&second, &later), Rejection::TakenBackThere);
        for kind in ["Observation", "DiagnosticReport", "DocumentReference"] {
            let found = house.statuses(kind, PATIENT);
            assert!(found.iter().all(|of| of == "entered-in-error"), "{kind}: {found:?}");
        }
    }
    withdraw(&second);
    put(&second, &later);
    assert_eq!(house.statuses("DiagnosticReport", PATIENT), ["amended"]);
    assert!(put(&first, &later).already_there);
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_record_goes_to_the_one_patient_of_its_id_and_to_no_other_and_none_is_created() {
    let house = House::new(fhir());
    let store = house.store();
    house.register("47110");
    assert_eq!(rejection(&store, &SMALL), Rejection::NotRegistered);
    house.register(PATIENT);
    put(&store, &SMALL);
    house.register(PATIENT);
    assert_eq!(rejection(&store, &SMALL), Rejection::RegisteredTwice(2));
    assert_eq!((house.counts(), house.resources("Patient").len()), (ONE, 3));
    // In another system the same id is another patient.
    let house = House::new(fhir());
    let store = house.store();
    let id = json!({ "system": "urn:oid:1.2", "value": PATIENT });
    house.create(&json!({ "resourceType": "Patient", "identifier": [id] }));
    assert_eq!(rejection(&store, &SMALL), Rejection::NotRegistered);
    let id = json!({ "system": PATIENTS, "value": PATIENT });
    house.create(&json!({ "resourceType": "Patient", "active": false, "identifier": [id] }));
    assert_eq!(rejection(&store, &SMALL), Rejection::PatientNotInUse);
    assert_eq!((house.counts(), house.resources("Patient").len()), ([0; 4], 2));
    // A record of another patient than the delivery is sent to neither.
    let house = House::with_patient();
    house.register("4712");
    let wrong = Delivery { patient: Some("4712"), ..SMALL.delivery() };
    match house.store().put(&wrong) {
        Err(StoreFault::Permanent(Rejection::OtherPatient)) => {}
        other => panic!("{other:?}"),
    }
    assert_eq!(house.counts(), [0; 4]);
}

#[test]
#[ignore = "needs Python with jsonschema, and Medplum's definitions, run by .ci/run"]
fn every_resource_keeps_to_the_schema_of_r4() {
    let dir = tempfile::tempdir().unwrap();
    let mut bare = SMALL.record.clone();
    (bare.acquired, bare.station) = (None, None);
    for leg in &mut bare.legs {
        leg.landmarks.clear();
        leg.estimates.clear();
    }
    let (bare, amended) = (SMALL.with(bare, &[]), SCANS[1].amended(402.0));
    let mut names = Vec::new();
    let all = SCANS.iter().chain([&amended, &bare]).enumerate();
    for (number, scan) in all {
        for language in [Language::En, Language::De] {
            let attach = ["report.pdf", "record.json", "left.step", "order.csv", "not-there.txt"];
            let rules = FhirRules { language, ..fhir_rules(&attach) };
            let sent = Sent {
                record: &scan.record,
                files: &scan.files,
                first_seen: "2026-11-20T08:00:00Z".parse().unwrap(),
                subject: "Patient/17",
                key: &FhirKey::new(scan.id.as_str(), PATIENT),
            };
            let path = dir.path().join(format!("{number}-{}.json", language.tag()));
            fs::write(&path, created(&entries(&sent, &rules)).to_string()).unwrap();
            names.push(path);
        }
    }
    let done = Command::new(python()).arg(script("r4_schema.py")).args(&names).output().unwrap();
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{}", said.chars().take(3000).collect::<String>());
}
