//! What of a record leaves its house.

#![allow(clippy::unwrap_used)]

use gaiter_record::archive::{Pseudonym, SiteKey, pseudonymous};
use gaiter_record::schema::{Amendment, Deed};
use gaiter_record::{Patient, Record, Source, SourceKind};
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
    let sources = vec![Source::from_kind(SourceKind::Reader)];
    let patient = Some(Patient { id: "P-4711".to_owned(), sources });
    let record = Record { patient, amendments: vec![set], ..record.clone() };
    let site = SiteKey::parse(&"0b".repeat(32)).unwrap();
    let (sent, pseudonym) = pseudonymous(record.clone(), &site);
    let text = serde_json::to_string(&sent).unwrap();
    for secret in ["4711", "Mustermann", "Quastenflosser"] {
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
