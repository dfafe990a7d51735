//! The store against a server of prepared answers: what it asks, and what it makes of each answer.

use std::path::PathBuf;
use std::sync::mpsc::Receiver;
use std::time::Duration;

use gaiter_flow::ScanId;
use gaiter_https::{Secret, TlsFiles};
use gaiter_language::Language;
use gaiter_record::fhir::{Entry, FhirKey, FhirRules, Identifier};
use gaiter_sizes::Garment;
use serde_json::{Value, json};
use support::http_server::{answer, serve_answers};

use super::answers::Asked;
use super::{FhirAccess, FhirServer, FhirStore, SmartAccess};
use crate::store::server::ServerFault;
use crate::store::{HttpAccess, RecordStore, Rejection, StoreFault, TakeBack};

const PATIENTS: &str = "urn:oid:1.2.276.0.76.3.1.999.1";
const RECORDS: &str = "urn:gaiter:record";

/// A store that asks at this port.
fn store(port: u16, access: FhirAccess) -> FhirStore {
    let server = FhirServer {
        base: format!("http://127.0.0.1:{port}/r4"),
        access,
        tls: TlsFiles::default(),
        proxy: None,
        limit: Duration::from_secs(30),
        patients: PATIENTS.to_owned(),
    };
    let rules = FhirRules {
        identifiers: RECORDS.to_owned(),
        codes: "urn:gaiter:measure".to_owned(),
        language: Language::En,
        garment: Garment::default(),
        attach: Vec::new(),
    };
    FhirStore::new(server, rules, "")
}

/// A store whose server gives these answers, and the requests.
fn answered(answers: Vec<String>) -> (FhirStore, Receiver<String>) {
    let (port, requests) = serve_answers(answers);
    (store(port, FhirAccess::Http(HttpAccess::Open)), requests)
}

/// A store that is let in by SMART, whose server gives these answers.
fn smart(answers: Vec<String>) -> (FhirStore, Receiver<String>) {
    let (port, requests) = serve_answers(answers);
    let key = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures/tls/rsa.key");
    let access = SmartAccess {
        client: "gaiter-booth-1".to_owned(),
        key: Secret::File(key),
        key_id: String::new(),
        scope: "system/Patient.rs".to_owned(),
        token_address: Some(format!("http://127.0.0.1:{port}/token")),
    };
    (store(port, FhirAccess::Smart(access)), requests)
}

fn token(value: &str) -> String {
    answer("200 OK", &json!({ "access_token": value, "expires_in": 300 }).to_string())
}

fn capable() -> String {
    let statement = json!({ "resourceType": "CapabilityStatement", "fhirVersion": "4.0.1" });
    answer("200 OK", &statement.to_string())
}

fn outcome(status: &str, text: &str) -> String {
    let issue = json!({ "severity": "error", "code": "security", "diagnostics": text });
    let outcome = json!({ "resourceType": "OperationOutcome", "issue": [issue] });
    answer(status, &outcome.to_string())
}

fn found(resources: &[Value]) -> String {
    let entry: Vec<Value> = resources.iter().map(|of| json!({ "resource": of })).collect();
    let bundle = json!({ "resourceType": "Bundle", "type": "searchset", "entry": entry });
    answer("200 OK", &bundle.to_string())
}

fn patient(id: &str, value: &str) -> Value {
    let identifier = json!([{ "system": PATIENTS, "value": value }]);
    json!({ "resourceType": "Patient", "id": id, "identifier": identifier })
}

/// The first line and the header `Authorization` of each request.
fn asked(requests: &Receiver<String>) -> Vec<(String, Option<String>)> {
    let told = |request: String| {
        let shown = request.lines().find_map(|line| line.strip_prefix("authorization: "));
        let first = request.lines().next().unwrap_or_default();
        (first.to_owned(), shown.map(str::to_owned))
    };
    requests.try_iter().map(told).collect()
}

#[test]
fn an_expired_token_is_renewed_once_and_then_kept() {
    let expired = outcome("401 Unauthorized", "token expired");
    let (store, requests) = smart(vec![token("one"), expired, token("two"), capable(), capable()]);
    store.reach().unwrap();
    store.reach().unwrap();
    let metadata = "GET /r4/metadata HTTP/1.1".to_owned();
    let place = "POST /token HTTP/1.1".to_owned();
    let shown = |token: &str| Some(format!("Bearer {token}"));
    let expected = [
        (place.clone(), None),
        (metadata.clone(), shown("one")),
        (place, None),
        (metadata.clone(), shown("two")),
        (metadata, shown("two")),
    ];
    assert_eq!(asked(&requests), expected);
}

#[test]
fn a_token_that_is_refused_twice_is_not_renewed_again() {
    let refused = || outcome("401 Unauthorized", "no");
    let (store, requests) =
        smart(vec![token("one"), refused(), token("two"), refused(), capable()]);
    let fault = store.reach().unwrap_err();
    assert!(matches!(fault, StoreFault::Server(ServerFault::Forbidden { status: 401, .. })));
    assert_eq!(requests.try_iter().count(), 4);
}

#[test]
fn where_tokens_are_given_is_asked_of_the_server() {
    let (port, requests) = serve_answers(vec![answer("200 OK", "{}")]);
    let (mut store, _) = smart(Vec::new());
    store.server.base = format!("http://127.0.0.1:{port}/r4");
    if let FhirAccess::Smart(smart) = &mut store.server.access {
        smart.token_address = None;
    }
    let fault = store.reach().unwrap_err();
    assert!(matches!(fault, StoreFault::Server(ServerFault::NoToken(_))), "{fault}");
    let place = "GET /r4/.well-known/smart-configuration HTTP/1.1".to_owned();
    assert_eq!(asked(&requests), [(place, None)]);
}

#[test]
fn no_fault_tells_token_password_or_patient() {
    let dir = tempfile::tempdir().unwrap();
    let secret = dir.path().join("secret");
    std::fs::write(&secret, "hidden-word\n").unwrap();
    let secret = Secret::File(secret);
    let bearer = HttpAccess::Bearer { token: secret.clone() };
    let basic = HttpAccess::Basic { user: "station".to_owned(), password: secret };
    let encoded = "c3RhdGlvbjpoaWRkZW4td29yZA==";
    for (access, shown) in [(bearer, "hidden-word"), (basic, encoded)] {
        let said = format!(
            "{shown} (hidden-word) is not let in to \
             Patient?identifier=urn%3Aoid%3A1.2.276.0.76.3.1.999.1%7CP%2F4711 of P/4711"
        );
        let (port, _requests) = serve_answers(vec![outcome("403 Forbidden", &said)]);
        let fault = store(port, FhirAccess::Http(access)).subject("P/4711").unwrap_err();
        assert!(fault.to_string().contains("is not let in to"), "{fault}");
        for told in [fault.to_string(), fault.cause().to_string(), format!("{fault:?}")] {
            for word in ["hidden-word", encoded.trim_end_matches('='), "4711"] {
                assert!(!told.contains(word), "{told}");
            }
        }
    }
}

#[test]
fn a_patient_is_found_by_the_whole_identifier_or_not_at_all() {
    let (store, requests) = answered(vec![found(&[patient("17", "P/4711")])]);
    assert_eq!(store.subject("P/4711").unwrap(), "Patient/17");
    let path = "GET /r4/Patient?identifier=urn%3Aoid%3A1.2.276.0.76.3.1.999.1%7CP%2F4711&_count=10 HTTP/1.1";
    assert_eq!(asked(&requests), [(path.to_owned(), None)]);
    let of = |answer: String| answered(vec![answer]).0.subject("P/4711").unwrap_err();
    assert_eq!(of(found(&[])).code(), "patient-not-registered");
    let two = of(found(&[patient("17", "P/4711"), patient("18", "P/4711")]));
    assert!(matches!(two, StoreFault::Permanent(Rejection::RegisteredTwice(2))), "{two}");
    let mut closed = patient("17", "P/4711");
    closed["active"] = false.into();
    assert_eq!(of(found(&[closed])).code(), "patient-not-in-use");
}

#[test]
fn a_patient_whose_id_differs_in_capital_letters_is_another_and_keeps_nobody_waiting() {
    let of = |all: &[Value]| answered(vec![found(all)]).0.subject("P4711");
    let (theirs, other) = (patient("17", "P4711"), patient("18", "p4711"));
    assert_eq!(of(std::slice::from_ref(&other)).unwrap_err().code(), "patient-not-registered");
    assert_eq!(of(&[theirs, other]).unwrap(), "Patient/17");
}

#[test]
fn of_patients_who_were_merged_the_one_that_is_left_counts() {
    let of = |all: &[Value]| answered(vec![found(all)]).0.subject("P4711");
    let (left, mut merged) = (patient("17", "P4711"), patient("18", "P4711"));
    merged["active"] = false.into();
    merged["link"] = json!([{ "type": "replaced-by", "other": { "reference": "Patient/17" } }]);
    assert_eq!(of(&[merged.clone(), left.clone()]).unwrap(), "Patient/17");
    assert_eq!(of(std::slice::from_ref(&merged)).unwrap_err().code(), "patient-not-in-use");
    // The id was the merged one's, and is not in use any more.
    let mut old = left.clone();
    old["identifier"][0]["use"] = "old".into();
    assert_eq!(of(&[merged.clone(), old]).unwrap_err().code(), "patient-not-in-use");
    let two = of(&[merged, left.clone(), patient("19", "P4711")]).unwrap_err();
    assert!(matches!(two, StoreFault::Permanent(Rejection::RegisteredTwice(2))), "{two}");
}

#[test]
fn no_answer_of_a_search_is_one_that_the_server_had_kept() {
    let (store, requests) = answered(vec![found(&[patient("17", "4711")])]);
    store.subject("4711").unwrap();
    let request = requests.try_iter().next().unwrap();
    assert!(request.lines().any(|line| line == "cache-control: no-cache"), "{request}");
}

#[test]
fn a_server_that_ignores_what_was_searched_for_is_not_believed() {
    let more = json!({
        "resourceType": "Bundle", "type": "searchset", "link": [{ "relation": "next", "url": "x" }],
    });
    let odd = json!({
        "resourceType": "Bundle", "entry": ["x", 7, { "resource": { "resourceType": "Patient" } }],
    });
    for sent in [
        found(&[patient("17", "P/4711"), patient("18", "P/4712")]),
        found(&[patient("../17", "P/4711")]),
        answer("200 OK", &patient("17", "P/4711").to_string()),
        answer("200 OK", &more.to_string()),
        answer("200 OK", &odd.to_string()),
        answer("200 OK", "<html>"),
    ] {
        let fault = answered(vec![sent.clone()]).0.subject("P/4711").unwrap_err();
        assert!(matches!(fault, StoreFault::Server(ServerFault::Answer(_))), "{sent}: {fault}");
    }
}

#[test]
fn a_server_is_tried_out_by_its_version_and_a_search_for_nobody() {
    let (store, _requests) = answered(vec![capable(), found(&[])]);
    store.try_out().unwrap();
    let r5 = json!({ "resourceType": "CapabilityStatement", "fhirVersion": "5.0.0" }).to_string();
    for sent in [answer("200 OK", &r5), answer("200 OK", "{}"), answer("200 OK", "Welcome")] {
        let fault = answered(vec![sent]).0.try_out().unwrap_err();
        assert!(matches!(fault, StoreFault::Server(ServerFault::Answer(_))), "{fault}");
    }
    let (store, _requests) = answered(vec![capable(), outcome("403 Forbidden", "scope")]);
    assert!(store.try_out().is_err());
}

/// An observation of a record on the server.
fn observation(key: &FhirKey, status: &str) -> Value {
    json!({
        "resourceType": "Observation", "id": "7", "meta": { "versionId": "3" }, "status": status,
        "identifier": [{ "system": RECORDS, "value": key.record() }],
    })
}

#[test]
fn a_withdrawal_marks_what_holds_and_asks_nothing_of_what_is_marked() {
    let scan: ScanId = ScanId::parse(&"ab".repeat(32)).unwrap();
    let key = FhirKey::new(scan.as_str(), "4711");
    let replaced = json!({
        "resourceType": "Bundle", "type": "transaction-response",
        "entry": [{ "response": { "status": "200 OK" } }],
    });
    let holds = found(&[observation(&key, "final")]);
    let done = answer("200 OK", &replaced.to_string());
    let (store, requests) = answered(vec![holds.clone(), found(&[]), found(&[]), done]);
    store.withdraw(&TakeBack::new(&scan, Some("4711"))).unwrap();
    let request = requests.try_iter().last().unwrap();
    let (_, body) = request.split_once("\r\n\r\n").unwrap();
    let sent: Value = serde_json::from_str(body).unwrap();
    let [entry] = sent["entry"].as_array().unwrap().as_slice() else { panic!("{sent}") };
    assert_eq!(entry["resource"]["status"], "entered-in-error");
    assert_eq!(entry["request"]["method"], "PUT");
    assert_eq!(entry["request"]["url"], "Observation/7");
    assert_eq!(entry["request"]["ifMatch"], "W/\"3\"");

    let mut marked = observation(&key, "entered-in-error");
    let mark = json!({ "system": RECORDS, "value": key.withdrawal("") });
    assert_eq!(entry["resource"]["identifier"][1], mark);
    marked["identifier"].as_array_mut().unwrap().push(mark);
    let marked = found(&[marked]);
    let (store, requests) = answered(vec![marked, found(&[]), found(&[])]);
    store.withdraw(&TakeBack::new(&scan, Some("4711"))).unwrap();
    assert_eq!(requests.try_iter().count(), 3);

    // Another changed it between the search and the transaction: the next try reads it again.
    let changed = outcome("412 Precondition Failed", "version");
    let (store, _requests) = answered(vec![holds, found(&[]), found(&[]), changed]);
    let fault = store.withdraw(&TakeBack::new(&scan, Some("4711"))).unwrap_err();
    assert_eq!(fault.code(), "store-unavailable");
}

#[test]
fn a_take_back_that_does_not_find_what_the_server_has_confirmed_is_not_done() {
    let scan: ScanId = ScanId::parse(&"ab".repeat(32)).unwrap();
    let key = FhirKey::new(scan.as_str(), "4711");
    let mark = json!({ "system": RECORDS, "value": key.withdrawal("") });
    let marked = |kind: &str, id: &str| {
        json!({
            "resourceType": kind, "id": id, "status": "entered-in-error",
            "identifier": [{ "system": RECORDS, "value": key.record() }, mark],
            "result": [{ "reference": "Observation/7/_history/1" }],
        })
    };
    let (report, leg) = (marked("DiagnosticReport", "5"), marked("Observation", "7"));
    let take_back = |leg: &[Value], report: &[Value], read: Option<String>| {
        let searches = [found(leg), found(report), found(&[])];
        let (store, requests) = answered(searches.into_iter().chain(read).collect());
        let receipt = Some("DiagnosticReport/5");
        let done = store.withdraw(&TakeBack { receipt, ..TakeBack::new(&scan, Some("4711")) });
        (done, requests.try_iter().count())
    };
    let (all, none): ([Value; 2], &[Value]) = ([leg, report], &[]);
    let [leg, report] = all.each_ref().map(std::slice::from_ref);
    let (done, requests) = take_back(leg, report, None);
    done.unwrap();
    assert_eq!(requests, 3, "all of it was found");
    // Its index is late, it hides what is there, or it has lost it.
    let there = answer("200 OK", &report[0].to_string());
    let lost = outcome("404 Not Found", "no such report");
    for (leg, report, read) in
        [(none, none, Some(there)), (none, none, Some(lost)), (none, report, None)]
    {
        let (done, _) = take_back(leg, report, read);
        let fault = done.unwrap_err();
        assert!(matches!(fault, StoreFault::Server(ServerFault::Answer(_))), "{fault}");
    }
    take_back(none, none, Some(outcome("410 Gone", "deleted"))).0.unwrap();
}

#[test]
fn a_take_back_of_what_was_not_confirmed_waits_until_it_is_found_or_cannot_be_there() {
    let scan: ScanId = ScanId::parse(&"ab".repeat(32)).unwrap();
    let key = FhirKey::new(scan.as_str(), "4711");
    let identifier = |value: String| json!({ "system": RECORDS, "value": value });
    let report = json!({
        "resourceType": "DiagnosticReport", "id": "5", "status": "entered-in-error",
        "identifier": [identifier(key.record()), identifier(key.withdrawal(""))],
    });
    let take_back = |reports: &[Value], patients: Option<&[Value]>| {
        let searches = [found(&[]), found(reports), found(&[])];
        let (store, _requests) =
            answered(searches.into_iter().chain(patients.map(found)).collect());
        store.withdraw(&TakeBack { receipt: Some(""), ..TakeBack::new(&scan, Some("4711")) })
    };
    take_back(&[report], None).unwrap();
    take_back(&[], Some(&[])).unwrap();
    for patients in [Some(&[patient("17", "4711")][..]), None] {
        let fault = take_back(&[], patients).unwrap_err();
        assert!(matches!(fault, StoreFault::Server(ServerFault::NotShown)), "{fault}");
    }
}

#[test]
fn what_another_took_back_is_not_brought_back_by_a_later_revision() {
    let of = |station: Option<&str>| {
        let key = FhirKey::new("ab", "4711");
        let identifier = |value: String| json!({ "system": RECORDS, "value": value });
        let mark = station.map(|station| identifier(key.withdrawal(station)));
        let own = identifier(key.part("report"));
        let resource = json!({ "resourceType": "DiagnosticReport", "status": "amended" });
        let mut there = resource.clone();
        there["id"] = "5".into();
        there["status"] = "entered-in-error".into();
        there["identifier"] = [own].into_iter().chain(mark).collect();
        let (store, _requests) = answered(vec![answer("200 OK", &there.to_string())]);
        let store = FhirStore { station: "booth-2".to_owned(), ..store };
        let value = key.part("report");
        let entry = Entry::new(Identifier { system: RECORDS.to_owned(), value }, resource);
        let asked = Asked { reference: "DiagnosticReport/5".to_owned(), is_new: false };
        store.stale(&[(entry, asked)], &key, 2, "4711")
    };
    for other in [Some("booth-1"), None] {
        assert_eq!(of(other).unwrap_err().code(), "taken-back-there", "{other:?}");
    }
    assert_eq!(of(Some("booth-2")).unwrap().len(), 1, "it decided otherwise since");
}

#[test]
fn a_step_that_makes_several_requests_has_not_stalled_while_each_is_answered_in_time() {
    let (store, requests) = answered(vec![found(&[]), found(&[]), found(&[])]);
    let scan: ScanId = ScanId::parse(&"ab".repeat(32)).unwrap();
    store.withdraw(&TakeBack::new(&scan, Some("4711"))).unwrap();
    let requests = u32::try_from(requests.try_iter().count()).unwrap();
    assert!(requests > 2 && store.step_most() > Duration::from_secs(30) * requests);
}
