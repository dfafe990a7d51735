//! What a record becomes as FHIR R4: which resources, with which figures, codes and identifiers, and what of it
//! stays the same when it is sent again or corrected.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gaiter_language::Language;
use gaiter_record::export::export_figures;
use gaiter_record::fhir::{Entry, FhirKey, FhirRules, Sent, created, entries};
use gaiter_record::{
    Acquired, AcquiredFrom, ImagingRequest, Patient, Record, RecordFile, Source, SourceKind,
};
use serde_json::{Value, json};
use support::records::{fhir_rules, marked, measured};

const SUBJECT: &str = "Patient/17";

/// The resources of a record with these files, each of which holds its own name.
fn sent(record: &Record, rules: &FhirRules, files: &[&str]) -> Vec<Entry> {
    let file =
        |name: &&str| RecordFile { name: (*name).to_owned(), bytes: name.as_bytes().to_vec() };
    let files: Vec<RecordFile> = files.iter().map(file).collect();
    let key = FhirKey::new(&record.scan.sha256, "4711");
    let first_seen = "2026-11-20T08:00:00Z".parse().unwrap();
    entries(&Sent { record, files: &files, first_seen, subject: SUBJECT, key: &key }, rules)
}

const FILES: [&str; 4] = ["record.json", "report.pdf", "left.step", "right.step"];

/// The resources of a record with all that can go along.
fn whole(record: &Record) -> Vec<Entry> {
    sent(record, &fhir_rules(&FILES), &FILES)
}

fn of_kind<'a>(entries: &'a [Entry], kind: &str) -> Vec<&'a Value> {
    entries.iter().filter(|of| of.kind() == kind).map(|of| &of.resource).collect()
}

/// Every value of a field of this name, at any depth.
fn values<'a>(of: &'a Value, name: &str) -> Vec<&'a Value> {
    match of {
        Value::Object(fields) => fields
            .iter()
            .flat_map(|(field, value)| {
                let own = (field == name).then_some(value);
                own.into_iter().chain(values(value, name))
            })
            .collect(),
        Value::Array(items) => items.iter().flat_map(|item| values(item, name)).collect(),
        _ => Vec::new(),
    }
}

fn texts(of: &Value, name: &str) -> BTreeSet<String> {
    values(of, name).into_iter().filter_map(Value::as_str).map(str::to_owned).collect()
}

#[test]
fn a_record_is_a_station_an_observation_per_leg_a_report_and_its_documents_and_never_a_patient() {
    let entries = whole(&measured("f_average_clean").1);
    let kinds: Vec<&str> = entries.iter().map(Entry::kind).collect();
    let documents = ["DocumentReference"; 3];
    let before = ["Device", "Observation", "Observation", "DiagnosticReport"];
    assert_eq!(kinds, [&before[..], &documents[..]].concat());
    for entry in entries.iter().filter(|of| of.kind() != "Device") {
        assert_eq!(entry.resource["subject"]["reference"], SUBJECT, "{}", entry.kind());
    }
}

#[test]
fn every_resource_is_created_only_if_none_has_its_own_identifier_yet() {
    let entries = whole(&measured("f_average_clean").1);
    let bundle = created(&entries);
    assert_eq!(
        (&bundle["resourceType"], &bundle["type"]),
        (&json!("Bundle"), &json!("transaction"))
    );
    let sent = bundle["entry"].as_array().unwrap();
    assert_eq!(sent.len(), entries.len());
    let (mut conditions, mut addresses) = (BTreeSet::new(), BTreeSet::new());
    for (sent, entry) in sent.iter().zip(&entries) {
        assert!(entry.identifier.is_of(&entry.resource), "{}", entry.kind());
        let query = format!("identifier={}", entry.identifier.query());
        let request = json!({ "method": "POST", "url": entry.kind(), "ifNoneExist": query });
        assert_eq!(sent["request"], request);
        assert_eq!(sent["fullUrl"], entry.reference());
        conditions.insert(format!("{}?{query}", entry.kind()));
        addresses.insert(entry.reference());
    }
    assert_eq!((conditions.len(), addresses.len()), (entries.len(), entries.len()));
    // What refers to another resource of the transaction finds it there.
    let references = texts(&bundle, "reference");
    let within: BTreeSet<String> =
        references.into_iter().filter(|of| of.starts_with("urn:uuid:")).collect();
    assert!(within.len() >= 4 && within.is_subset(&addresses), "{within:?}");
}

#[test]
fn the_same_record_gives_the_same_resources() {
    let record = marked();
    assert_eq!(whole(&record), whole(&record));
}

#[test]
fn a_leg_has_the_figures_that_go_out_with_their_marks_and_own_codes_first() {
    let record = marked();
    let entries = whole(&record);
    let figures = export_figures(&record);
    let observations = of_kind(&entries, "Observation");
    assert_eq!(observations.len(), 2);
    for (observation, side) in observations.into_iter().zip(record.sides()) {
        let site = &observation["bodySite"]["coding"];
        assert_eq!(site[0]["code"], format!("{}-leg", side.word()));
        assert_eq!((&site[1]["code"], site[2].is_null()), (&json!("61685007"), true));
        let own: Vec<_> = figures.iter().filter(|figure| figure.side == side).collect();
        let components = observation["component"].as_array().unwrap();
        assert_eq!(components.len(), own.len(), "{}", side.word());
        for (component, figure) in components.iter().zip(own) {
            let code = &component["code"]["coding"];
            assert_eq!(code[0]["system"], "urn:gaiter:measure");
            assert_eq!(code[0]["code"], figure.code());
            let girth = (!figure.code().starts_with('l')).then_some("413171006");
            assert_eq!(code[1]["code"].as_str(), girth, "{}", figure.code());
            let quantity = &component["valueQuantity"];
            assert_eq!((&quantity["value"], &quantity["code"]), (&json!(figure.cm), &json!("cm")));
            assert_eq!(quantity["extension"][0]["valueDecimal"].as_f64(), figure.sd_cm);
            let mark = match (figure.is_by_hand, figure.doubts.is_empty()) {
                (true, _) => Some("by-hand"),
                (false, false) => Some("doubtful"),
                (false, true) => None,
            };
            assert_eq!(component["interpretation"][0]["coding"][0]["code"].as_str(), mark);
        }
    }
    let notes = texts(&of_kind(&entries, "Observation")[0]["note"], "text");
    let expected = ["cC, lC: Skin partly not seen", "cC, lC: never-heard-of"];
    assert_eq!(notes, expected.map(str::to_owned).into());
}

#[test]
fn a_reader_of_the_narrative_sees_the_same_digits() {
    let record = marked();
    let told = |language| {
        let entries = sent(&record, &FhirRules { language, ..fhir_rules(&[]) }, &[]);
        let observation = of_kind(&entries, "Observation")[0];
        observation["text"]["div"].as_str().unwrap().to_owned()
    };
    let (english, german) = (told(Language::En), told(Language::De));
    assert!(english.contains("<p>Right leg</p>"), "{english}");
    assert!(english.contains("<li>cC 22.4 cm</li>"), "{english}");
    assert!(german.contains("<li>cC 22,4 cm</li>"), "{german}");
}

#[test]
fn no_code_of_others_is_sent_but_those_that_the_reference_calls_good() {
    let all = json!(whole(&marked()).into_iter().map(|of| of.resource).collect::<Vec<_>>());
    let allowed = [
        "urn:gaiter:measure",
        "urn:gaiter:record",
        "http://snomed.info/sct",
        "http://unitsofmeasure.org",
        "http://terminology.hl7.org/CodeSystem/observation-category",
    ];
    assert_eq!(texts(&all, "system"), allowed.map(str::to_owned).into());
    let codings = values(&all, "coding").into_iter().filter_map(Value::as_array).flatten();
    let snomed = codings.filter(|of| of["system"] == "http://snomed.info/sct");
    let codes: BTreeSet<&str> = snomed.filter_map(|of| of["code"].as_str()).collect();
    assert_eq!(codes, BTreeSet::from(["413171006", "61685007"]));
}

#[test]
fn the_pdf_is_in_the_report_and_the_other_files_are_documents_of_their_types() {
    let entries = whole(&measured("f_average_clean").1);
    let is_file = |attachment: &Value, name: &str, kind: &str| {
        assert_eq!(
            (&attachment["title"], &attachment["contentType"]),
            (&json!(name), &json!(kind))
        );
        let bytes = STANDARD.decode(attachment["data"].as_str().unwrap()).unwrap();
        assert_eq!((bytes.as_slice(), &attachment["size"]), (name.as_bytes(), &json!(name.len())));
    };
    let report = of_kind(&entries, "DiagnosticReport")[0];
    assert_eq!(report["presentedForm"].as_array().unwrap().len(), 1);
    is_file(&report["presentedForm"][0], "report.pdf", "application/pdf");
    let expected = [
        ("record.json", "application/json"),
        ("left.step", "model/step"),
        ("right.step", "model/step"),
    ];
    let documents = of_kind(&entries, "DocumentReference");
    assert_eq!(documents.len(), expected.len());
    for (document, (name, kind)) in documents.into_iter().zip(expected) {
        is_file(&document["content"][0]["attachment"], name, kind);
        assert_eq!(
            (&document["status"], &document["docStatus"]),
            (&json!("current"), &json!("final"))
        );
    }
}

#[test]
fn only_files_that_the_rules_name_and_the_record_has_go_along() {
    let record = &measured("f_average_clean").1;
    let entries = sent(record, &fhir_rules(&["left.step", "not-there.txt"]), &FILES);
    let report = of_kind(&entries, "DiagnosticReport")[0];
    assert!(report["presentedForm"].is_null());
    let documents = of_kind(&entries, "DocumentReference");
    assert_eq!(documents.len(), 1);
    assert_eq!(documents[0]["content"][0]["attachment"]["title"], "left.step");
    let nothing = sent(record, &fhir_rules(&[]), &FILES);
    assert!(of_kind(&nothing, "DocumentReference").is_empty());
}

#[test]
fn a_later_revision_is_amended_and_stands_in_the_place_of_the_first() {
    let first = measured("f_average_clean").1.clone();
    let mut measured_again = first.clone();
    measured_again.revision = 2;
    let by_hand = Record { revision: 2, ..marked() };
    let statuses = |record: &Record| texts(&created(&whole(record)), "status");
    assert_eq!(
        statuses(&first),
        ["active", "current", "final", "generated"].map(str::to_owned).into()
    );
    let places =
        |record: &Record| -> Vec<String> { whole(record).iter().map(Entry::reference).collect() };
    for later in [measured_again, by_hand] {
        let expected = ["active", "amended", "current", "generated"];
        assert_eq!(statuses(&later), expected.map(str::to_owned).into());
        assert_eq!(places(&later), places(&first));
        let documents = whole(&later);
        let document = of_kind(&documents, "DocumentReference")[0];
        assert_eq!(document["docStatus"], "amended");
        let key = FhirKey::new(&later.scan.sha256, "4711");
        let values: Vec<&str> = values(&document["identifier"], "value")
            .into_iter()
            .filter_map(Value::as_str)
            .collect();
        let expected = [key.record(), key.part("file/record.json"), key.revision(2)];
        assert_eq!(values, expected.each_ref().map(String::as_str));
    }
}

#[test]
fn a_time_has_the_offset_of_the_scanners_clock() {
    let mut record = measured("f_average_clean").1.clone();
    let effective = |record: &Record| texts(&created(&whole(record)), "effectiveDateTime");
    let one = |time: &str| BTreeSet::from([time.to_owned()]);
    assert_eq!(effective(&record), one("2026-11-20T08:00:00+00:00"), "when it was first seen");
    let at = "2026-11-19T23:30:05.25Z".parse().unwrap();
    for (utc_offset_min, time) in [
        (None, "2026-11-19T23:30:05+00:00"),
        (Some(60), "2026-11-20T00:30:05+01:00"),
        (Some(-210), "2026-11-19T20:00:05-03:30"),
    ] {
        record.acquired =
            Some(Acquired { utc_offset_min, ..Acquired::new(at, AcquiredFrom::Press) });
        assert_eq!(effective(&record), one(time));
    }
}

#[test]
fn a_leg_without_any_figure_says_that_it_has_none() {
    let mut record = measured("f_average_clean").1.clone();
    for leg in &mut record.legs {
        leg.landmarks.clear();
        leg.estimates.clear();
    }
    let entries = whole(&record);
    for observation in of_kind(&entries, "Observation") {
        assert!(observation["component"].is_null());
        assert_eq!(observation["dataAbsentReason"]["coding"][0]["code"], "unknown");
    }
    record.legs.clear();
    let entries = whole(&record);
    assert!(of_kind(&entries, "Observation").is_empty());
    assert!(of_kind(&entries, "DiagnosticReport")[0]["result"].is_null());
}

#[test]
fn the_report_names_study_and_order_of_the_request_that_it_answers() {
    let record = &measured("f_average_clean").1;
    let with = |number: &str| {
        let request = ImagingRequest::new("1.2.276.4242", number);
        let sources = vec![Source::from_kind(SourceKind::Operator).with_request(request)];
        let patient = Some(Patient { id: "4711".to_owned(), sources });
        of_kind(&whole(&Record { patient, ..record.clone() }), "DiagnosticReport")[0].clone()
    };
    let report = with("ACC0815");
    let study = json!({ "system": "urn:dicom:uid", "value": "urn:oid:1.2.276.4242" });
    assert_eq!(report["imagingStudy"], json!([{ "type": "ImagingStudy", "identifier": study }]));
    let order = &report["basedOn"][0];
    assert_eq!(
        (&order["type"], &order["identifier"]["value"]),
        (&json!("ServiceRequest"), &json!("ACC0815"))
    );
    let without = with("");
    assert!(without["basedOn"].is_null() && !without["imagingStudy"].is_null());
    let report = of_kind(&whole(record), "DiagnosticReport")[0].clone();
    assert!(report["basedOn"].is_null() && report["imagingStudy"].is_null());
}
