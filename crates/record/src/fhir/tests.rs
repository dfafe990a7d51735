//! What is true of every resource: its identity, and its place in a transaction.

use super::*;

#[test]
fn a_key_shows_neither_scan_nor_patient_and_differs_for_each() {
    let key = |scan: &str, patient: &str| FhirKey::new(scan, patient).record();
    assert_eq!(key("ab", "4711").len(), 32);
    assert!(!key("ab", "4711").contains("4711"));
    assert_ne!(key("ab", "4711"), key("ab", "4712"));
    assert_ne!(key("ab", "4711"), key("ac", "4711"));
    assert_ne!(key("ab", "4711"), key("a", "b4711"));
}

#[test]
fn a_uuid_is_always_the_same_for_one_text_and_of_version_8() {
    assert_eq!(uuid("x"), uuid("x"));
    assert_ne!(uuid("x"), uuid("y"));
    for text in ["", "x", "y", "z", "Observation\0urn:gaiter:record\0ab/right"] {
        let of = uuid(text);
        let parts: Vec<&str> = of.split('-').collect();
        assert_eq!(parts.iter().map(|part| part.len()).collect::<Vec<_>>(), [8, 4, 4, 4, 12]);
        assert!(parts[2].starts_with('8') && parts[3].starts_with(['8', '9', 'a', 'b']), "{of}");
        assert!(parts.concat().bytes().all(|digit| b"0123456789abcdef".contains(&digit)), "{of}");
    }
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

#[test]
fn only_a_resource_with_system_and_value_has_an_identifier() {
    let identifier = Identifier { system: "urn:a".to_owned(), value: "1".to_owned() };
    let of = |system: &str, value: &str| json!([{ "system": system, "value": value }]);
    assert!(identifier.is_of(&json!({ "identifier": of("urn:a", "1") })));
    for other in
        [of("urn:a", "10"), of("urn:b", "1"), json!([{ "value": "1" }]), json!("1"), json!([1])]
    {
        assert!(!identifier.is_of(&json!({ "identifier": other })), "{other}");
    }
    assert!(!identifier.is_of(&json!([])));
}

#[test]
fn what_takes_the_place_of_another_has_its_id_its_version_and_known_references() {
    let replacement = |resource: Value, version: Option<&str>| Replacement {
        resource,
        reference: "DiagnosticReport/17".to_owned(),
        version: version.map(str::to_owned),
    };
    let report = json!({
        "resourceType": "DiagnosticReport", "id": "stale", "status": "amended",
        "result": [{ "reference": "urn:uuid:1" }, { "reference": "urn:uuid:2" }],
    });
    let known = [("urn:uuid:1".to_owned(), "Observation/5".to_owned())];
    let bundle = replaced(
        &[
            replacement(report.clone(), Some("3")),
            replacement(report, None),
            replacement(json!("no resource"), None),
        ],
        &known,
    );
    assert_eq!(
        (&bundle["resourceType"], &bundle["type"]),
        (&json!("Bundle"), &json!("transaction"))
    );
    let [first, second, third] = &bundle["entry"].as_array().unwrap()[..] else { unreachable!() };
    let request = json!({ "method": "PUT", "url": "DiagnosticReport/17" });
    assert_eq!(second["request"], request);
    assert_eq!(third["request"], request);
    assert_eq!(third["resource"], "no resource");
    assert!(third["fullUrl"].as_str().unwrap().starts_with("urn:uuid:"), "{third}");
    let mut conditional = request;
    conditional["ifMatch"] = "W/\"3\"".into();
    assert_eq!(first["request"], conditional);
    assert_eq!(
        first["resource"],
        json!({
            "resourceType": "DiagnosticReport", "id": "17", "status": "amended",
            "result": [{ "reference": "Observation/5" }, { "reference": "urn:uuid:2" }],
        })
    );
}

#[test]
fn what_was_entered_in_error_is_so_in_every_resource() {
    let codes = |status: Status| [status.word(), status.of_document()];
    assert_eq!(codes(Status::Final), ["final", "current"]);
    assert_eq!(codes(Status::Amended), ["amended", "current"]);
    assert_eq!(codes(Status::EnteredInError), ["entered-in-error"; 2]);
}
