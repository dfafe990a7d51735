//! What of a record leaves its house.

#![allow(clippy::unwrap_used)]

use gaiter_record::archive::{Pseudonym, SiteKey, pseudonymous};
use gaiter_record::schema::{Amendment, Deed};
use gaiter_record::{Confidence, ImagingRequest, Patient, Record, Source, SourceKind};
use jiff::Timestamp;
use support::records::measured;

#[test]
fn the_figures_leave_their_house_but_no_id_no_name_and_no_words() {
    let (_, record) = measured("f_average_clean");
    let set = Amendment {
        leg: "left".to_owned(),
        measure: "C".to_owned(),
        is: Deed::Measured,
        girth_mm: Some(367.0),
        height_mm: None,
        length_mm: None,
        reason: "Frau Mustermann: geschwollen".to_owned(),
        by: "Quastenflosser".to_owned(),
        at: Timestamp::UNIX_EPOCH,
    };
    let request = ImagingRequest::new("1.2.276.4242", "ACC0815");
    let sources = vec![Source::from_kind(SourceKind::Reader).with_request(request)];
    let patient = Some(Patient { id: "P-4711".to_owned(), sources });
    let record = Record { patient, amendments: vec![set], ..record.clone() };
    let site = SiteKey::parse(&"0b".repeat(32)).unwrap();
    let (sent, pseudonym) = pseudonymous(record.clone(), &site);
    let text = serde_json::to_string(&sent).unwrap();
    for secret in ["4711", "Mustermann", "Quastenflosser", "1.2.276.4242", "ACC0815"] {
        assert!(!text.contains(secret), "{secret}");
    }
    assert_eq!(pseudonym, Some(Pseudonym::of(&site, "P-4711")));
    assert_eq!(sent.patient.unwrap().id, pseudonym.unwrap().as_str());
    assert_eq!(sent.amendments[0].girth_mm, Some(367.0));
    assert_eq!(sent.legs, record.legs);
    let nobodys = Record { patient: None, ..record };
    let (sent, pseudonym) = pseudonymous(nobodys, &site);
    assert_eq!((sent.patient, pseudonym), (None, None));
}

#[test]
fn a_choice_makes_its_source_a_high_one_and_a_request_alone_does_not() {
    let request = ImagingRequest::new(" 1.2.276.4242 ", "ACC0815 ").unwrap();
    let typed = Source::from_kind(SourceKind::Operator);
    assert_eq!(typed.confidence, Some(Confidence::Medium));
    let with_request = typed.clone().with_request(Some(request.clone()));
    assert_eq!(with_request.confidence, Some(Confidence::Medium), "its id may be mistyped");
    let chosen = with_request.chosen();
    assert_eq!(chosen.confidence, Some(Confidence::High));
    let written = serde_json::json!({
        "kind": "operator", "confidence": "high",
        "request": { "study_instance_uid": "1.2.276.4242", "accession_number": "ACC0815" },
    });
    assert_eq!(serde_json::to_value(&chosen).unwrap(), written);
    // Without one a record is as it was.
    let bare = serde_json::json!({ "kind": "operator", "confidence": "medium" });
    assert_eq!(serde_json::to_value(&typed).unwrap(), bare);
    let patient = Patient { id: "4711".to_owned(), sources: vec![typed, chosen] };
    assert_eq!(patient.request(), Some(&request));
}

#[test]
fn what_is_no_uid_and_no_number_is_no_request() {
    let long = "1".repeat(65);
    for (uid, number) in [
        ("", "1"),
        ("1..2", "1"),
        ("1.2.", "1"),
        ("1.2a", "1"),
        (long.as_str(), "1"),
        ("1.2", "A\\B"),
        ("1.2", "A\nB"),
        ("1.2", long.as_str()),
    ] {
        assert_eq!(ImagingRequest::new(uid, number), None, "{uid} {number:?}");
    }
    let without = ImagingRequest::new("1.2", "  ").unwrap();
    assert_eq!(without.accession_number, None);
}
