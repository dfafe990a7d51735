//! What is true of the resources of every record.

#![allow(clippy::unwrap_used)]

use super::*;

#[test]
fn a_time_has_the_offset_of_the_scanners_clock() {
    let at: Timestamp = "2026-11-19T23:30:05.25Z".parse().unwrap();
    assert_eq!(moment(at, None), "2026-11-19T23:30:05Z");
    let offset = |minutes: i32| Offset::from_seconds(60 * minutes).ok();
    assert_eq!(moment(at, offset(60)), "2026-11-20T00:30:05+01:00");
    assert_eq!(moment(at, offset(-210)), "2026-11-19T20:00:05-03:30");
}

#[test]
fn a_key_shows_neither_scan_nor_patient_and_differs_for_each() {
    let key = |scan: &str, patient: &str| FhirKey::of(scan, patient).record();
    assert_eq!(key("ab", "4711").len(), 32);
    assert!(!key("ab", "4711").contains("4711"));
    assert_ne!(key("ab", "4711"), key("ab", "4712"));
    assert_ne!(key("ab", "4711"), key("a", "b\04711"));
    assert_eq!(uuid("x"), uuid("x"));
    assert_eq!(&uuid("x")[14..15], "8", "{}", uuid("x"));
}

#[test]
fn a_query_holds_nothing_that_is_a_sign_of_the_search() {
    let query = |system: &str, value: &str| {
        Identifier { system: system.to_owned(), value: value.to_owned() }.query()
    };
    assert_eq!(query("urn:oid:1.2", "P-4711"), "urn%3Aoid%3A1.2%7CP-4711");
    assert_eq!(
        query("https://a/b", "a,b|c$d&e=ü"),
        "https%3A%2F%2Fa%2Fb%7Ca%5C%2Cb%5C%7Cc%5C%24d%26e%3D%C3%BC"
    );
}
