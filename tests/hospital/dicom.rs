//! Objects of DICOM, judged by dciodvfy, read by dsrdump and highdicom, and stored in Orthanc.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use gaiter::store::{Delivery, TakeBack};
use gaiter_dicom::{DicomObject, DicomRules, Person, Sent, SopClass, Study, objects};
use gaiter_https::TlsFiles;
use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_record::ImagingRequest;
use serde_json::{Value, json};

use crate::dicom_house::{rules, with_mesh};
use crate::fhir_house::{put, setback};
use crate::orthanc::Orthanc;
use crate::records::{PATIENT, SCANS, SMALL, Scan};
use crate::server::{python, script};

/// Deliveries that are replayed.
const REPLAYS: usize = 1000;

/// The same over associations, which take Orthanc a tenth of a second each.
const REPLAYS_BY_ASSOCIATIONS: usize = 100;

pub fn objects_of(scan: &Scan, person: Option<Person<'_>>, rules: &DicomRules) -> Vec<DicomObject> {
    let patient = scan.record.patient.as_ref().unwrap();
    let study = Study::new(scan.id.as_str(), &patient.id).unwrap().answering(patient.request());
    let first_seen = scan.delivery().first_seen;
    let (record, files) = (&scan.record, &scan.files);
    let study = &study;
    objects(&Sent { record, files, first_seen, study, person, turn: 0 }, rules)
}

/// What a program says about a file.
pub fn told(program: &str, words: &[&str], file: &Path) -> String {
    let done = Command::new(program).args(words).arg(file).output().unwrap();
    let both = [done.stdout, done.stderr].concat();
    String::from_utf8_lossy(&both).into_owned()
}

#[test]
#[ignore = "needs dciodvfy and dsrdump, run by .ci/run"]
fn every_object_is_valid_and_the_report_is_read_with_all_figures_of_the_sheet() {
    let folder = tempfile::tempdir().unwrap();
    let request = ImagingRequest::new("1.2.276.4711", "A1");
    let answering = SCANS[0].answering(request);
    for scan in SCANS.iter().chain([&answering]) {
        for object in objects_of(&with_mesh(scan), None, &rules()) {
            let file = folder.path().join(object.uid());
            fs::write(&file, object.file().unwrap()).unwrap();
            let judged = told("dciodvfy", &[], &file);
            assert!(!judged.contains("Error"), "{:?}: {judged}", object.class());
            if object.class() == SopClass::Measurements {
                assert_eq!(figures(&told("dsrdump", &["+Pl"], &file)), expected(scan));
            }
        }
    }
}

#[test]
#[ignore = "needs Python with highdicom, run by .ci/run"]
fn every_report_is_read_by_highdicom_with_all_figures_of_the_sheet_and_umlauts() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let rules = DicomRules { language: Language::De, ..rules() };
    for scan in &*SCANS {
        let objects = objects_of(&scan.of_patient("Müßig 4711"), None, &rules);
        let report = objects.iter().find(|of| of.class() == SopClass::Measurements).unwrap();
        fs::write(file.path(), report.file().unwrap()).unwrap();
        let mut reader = Command::new(python());
        let done = reader.arg(script("sr_figures.py")).arg(file.path()).output().unwrap();
        let said = String::from_utf8_lossy(&done.stderr);
        let read: Value = serde_json::from_slice(&done.stdout).unwrap_or_else(|_| panic!("{said}"));
        assert_eq!(read, json!({ "patient": "Müßig 4711", "figures": expected(scan) }));
    }
}

/// The figures in a report as dsrdump writes it, by leg and box.
fn figures(report: &str) -> BTreeMap<String, String> {
    let (mut side, mut last) = ("", None);
    let mut figures = BTreeMap::new();
    for line in report.lines().map(str::trim) {
        let quoted = line.rsplit_once("=\"").and_then(|(_, rest)| rest.split('"').next());
        if line.contains("\"Laterality\")") {
            side = if line.contains("24028007") { "right" } else { "left" };
        } else if line.starts_with("<contains NUM:") {
            let letter = if line.contains("\"Circumference\"") { 'c' } else { 'l' };
            last = quoted.map(|cm| (letter, cm));
        } else if line.contains("\"Topographical modifier\")") {
            let level = line.split("=(").nth(1).and_then(|code| code.split(',').next()).unwrap();
            let (letter, cm) = last.take().unwrap();
            figures.insert(format!("{side} {letter}{level}"), cm.to_owned());
        }
    }
    figures
}

/// The figures of a record's sheet by leg and box.
fn expected(scan: &Scan) -> BTreeMap<String, String> {
    let of = |side: Side| {
        let sheet = scan.sheet(side).into_iter();
        sheet.map(move |(code, cm)| (format!("{} {code}", side.word()), cm))
    };
    of(Side::Right).chain(of(Side::Left)).collect()
}

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_has_each_object_once_however_often_it_is_sent_and_after_it_was_killed() {
    let orthanc = Orthanc::new();
    let scan = with_mesh(&SCANS[1]);
    assert!(!put(&orthanc.store(), &scan).already_there);
    assert_eq!(orthanc.count(), 3);
    orthanc.is_killed();
    orthanc.starts_again();
    let store = orthanc.store();
    for _ in 0..REPLAYS {
        assert!(put(&store, &scan).already_there);
    }
    assert_eq!(orthanc.count(), 3);
    // Small: the figures alone.
    assert!(!put(&store, &SMALL.amended(391.0)).already_there);
    assert_eq!(orthanc.count(), 4);
}

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_keeps_what_was_taken_back_with_its_mark_and_takes_it_again() {
    let orthanc = Orthanc::new();
    let store = orthanc.store();
    let receipt = put(&store, &SMALL).folder;
    for _ in 0..2 {
        let taken_back = TakeBack::new(&SMALL.id, Some(PATIENT));
        store.withdraw(&TakeBack { receipt: receipt.to_str(), ..taken_back }).unwrap();
        assert_eq!(orthanc.count(), 2);
    }
    let again = Delivery { turn: 1, ..SMALL.delivery() };
    assert!(!store.put(&again).unwrap().already_there);
    assert_eq!(orthanc.count(), 3);
}

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_has_two_scans_in_the_study_of_a_request_and_gives_back_one() {
    let orthanc = Orthanc::new();
    let request = ImagingRequest::new("1.2.276.4711", "A1");
    let first = SMALL.answering(request.clone());
    let second = first.numbered(1);
    let (web, dimse) = (orthanc.store(), orthanc.by_associations());
    let receipt = put(&web, &first);
    assert_eq!(receipt.folder.to_str(), Some("1.2.276.4711"));
    assert!(!put(&dimse, &second).already_there);
    for store in [&web, &dimse] {
        assert!(put(store, &first).already_there && put(store, &second).already_there);
    }
    assert_eq!(orthanc.count(), 2);
    let taken_back = TakeBack::new(&first.id, Some(PATIENT));
    web.withdraw(&TakeBack { request: request.as_ref(), ..taken_back }).unwrap();
    assert_eq!(orthanc.count(), 3);
    assert!(put(&dimse, &second).already_there);
    let again = Delivery { turn: 1, ..first.delivery() };
    assert!(!dimse.put(&again).unwrap().already_there);
    assert_eq!(orthanc.count(), 4);
}

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_that_wants_another_password_is_asked_again_and_gets_nothing() {
    let orthanc = Orthanc::new();
    fs::write(orthanc.path("secret"), "other\n").unwrap();
    let fault = setback(&orthanc.store(), &SMALL);
    assert!(fault.contains("401") && !fault.contains("other"), "{fault}");
    fs::write(orthanc.path("secret"), "pw\n").unwrap();
    assert_eq!(orthanc.count(), 0);
}

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_over_associations_has_the_same_objects_once_and_takes_them_back() {
    let orthanc = Orthanc::new();
    let scan = with_mesh(&SCANS[1]);
    let store = orthanc.by_associations();
    store.reach().unwrap();
    let receipt = put(&store, &scan);
    assert!(!receipt.already_there);
    assert_eq!(orthanc.count(), 3);
    for _ in 0..REPLAYS_BY_ASSOCIATIONS {
        assert!(put(&store, &scan).already_there);
    }
    // Over DICOMweb, too, it is there already.
    assert!(put(&orthanc.store(), &scan).already_there);
    assert_eq!(orthanc.count(), 3);
    let taken_back = TakeBack::new(&scan.id, Some(PATIENT));
    store.withdraw(&TakeBack { receipt: receipt.folder.to_str(), ..taken_back }).unwrap();
    assert_eq!(orthanc.count(), 4);
}

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_by_another_title_rejects_the_association_and_is_asked_again() {
    let orthanc = Orthanc::new();
    let fault = setback(&orthanc.by_title("ANOTHER"), &SMALL);
    assert!(fault.contains("rejects the association"), "{fault}");
    assert_eq!(orthanc.count(), 0);
}

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_over_tls_must_have_the_right_certificate_and_may_ask_for_one() {
    let orthanc = Orthanc::over_tls("server", false);
    let trusted = orthanc.tls(false);
    let refusal = |host: &str, tls: TlsFiles| setback(&orthanc.by_tls(host, tls), &SMALL);
    let told = refusal("localhost", TlsFiles::default());
    assert!(told.contains("UnknownIssuer") || told.contains("no certificates"), "{told}");
    let told = refusal("127.0.0.1", trusted.clone());
    assert!(told.contains("no safe connection"), "the certificate is that of localhost: {told}");
    setback(&orthanc.by_associations(), &SMALL);
    assert_eq!(orthanc.count(), 0, "nothing was sent to a server that is not trusted");
    put(&orthanc.by_tls("localhost", trusted), &SMALL);
    assert_eq!(orthanc.count(), 1);

    let expired = Orthanc::over_tls("expired", false);
    let told = setback(&expired.by_tls("localhost", expired.tls(false)), &SMALL);
    assert!(told.to_lowercase().contains("expired"), "{told}");

    let asking = Orthanc::over_tls("server", true);
    setback(&asking.by_tls("localhost", asking.tls(false)), &SMALL);
    assert_eq!((expired.count(), asking.count()), (0, 0));
    let store = asking.by_tls("localhost", asking.tls(true));
    put(&store, &SMALL);
    assert!(put(&store, &SMALL).already_there);
    assert_eq!(asking.count(), 1);
}
