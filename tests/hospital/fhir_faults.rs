//! A server that is busy, dies, hangs or lies: nothing is lost, nothing is there twice, and the fault is named.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::time::Duration;

use gaiter::flow::server::fhir::FhirServer;
use gaiter::store::{FhirStore, Misfit, StoreFault};

use crate::fhir::{ONE, SCAN, counts, put, register, rules, server_at, store};
use crate::server::Server;

/// A store whose server is not waited for long.
fn hasty(server: &Server) -> FhirStore {
    let limit = Duration::from_secs(2);
    FhirStore::new(FhirServer { limit, ..server_at(server) }, rules(&["report.pdf", "record.json"]))
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn whatever_a_server_does_in_between_the_record_is_there_once_in_the_end() {
    for (mode, said) in [
        ("busy", "503): transient: come back later"),
        ("full", "507): no-store: no space left on device"),
        ("error-after", "500): exception: the answer was lost"),
        ("cut-after", "the connection failed"),
        ("hang", "no whole answer within 2 s"),
        ("drip", "no whole answer within 2 s"),
        ("huge", "more than 16777216 bytes"),
        ("redirect", "a redirect, which is not followed"),
        ("unauthorized", "(401): login: log in first"),
    ] {
        let server = Server::fhir(false, |_| {});
        register(&server, "4711");
        let store = hasty(&server);
        server.becomes(mode);
        for _ in 0..2 {
            match store.put(&SCAN.delivery()) {
                Err(fault @ StoreFault::Server(_)) => {
                    let told = fault.to_string();
                    assert!(told.contains(said), "{mode}: {told}");
                }
                other => panic!("{mode}: {other:?}"),
            }
        }
        server.becomes("");
        put(&store, &SCAN);
        assert_eq!(counts(&server), ONE, "{mode}");
    }
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn an_answer_that_is_lost_after_each_step_leaves_one_record() {
    let server = Server::fhir(false, |_| {});
    register(&server, "4711");
    let store = hasty(&server);
    let later = SCAN.amended(391.0);
    // The search, the transaction, and with a correction what is there and its replacement.
    for mode in ["error-after", "cut-after"] {
        for scan in [&*SCAN, &later] {
            for _ in 0..3 {
                server.becomes(mode);
                assert!(matches!(store.put(&scan.delivery()), Err(StoreFault::Server(_))));
                server.becomes("");
            }
            put(&store, scan);
            assert_eq!(counts(&server), ONE, "{mode}");
        }
    }
    assert_eq!(server.resources("DiagnosticReport")[0]["status"], "amended");
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn what_a_server_will_never_take_waits_for_a_person_and_says_why_without_the_patient() {
    let server = Server::fhir(false, |_| {});
    register(&server, "4711");
    let store = hasty(&server);
    for (mode, status, said) in [
        ("unsafe", 422, "business-rule: patient … has no open case"),
        ("precondition", 412, "multiple-matches: not selective enough"),
    ] {
        server.becomes(mode);
        match store.put(&SCAN.delivery()) {
            Err(StoreFault::Permanent(Misfit::ServerRefused { status: found, why })) => {
                assert_eq!((found, why.as_str()), (status, said));
            }
            other => panic!("{mode}: {other:?}"),
        }
    }
    server.becomes("");
    put(&store, &SCAN);
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_server_that_does_not_search_for_what_is_asked_gets_nothing() {
    let server = Server::fhir(false, |_| {});
    register(&server, "4712");
    server.becomes("deaf-search");
    let store = store(&server);
    match store.put(&SCAN.delivery()) {
        Err(StoreFault::Server(fault)) => {
            assert!(fault.to_string().contains("finds what does not have it"), "{fault}");
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(counts(&server), [0; 4]);
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_server_of_another_version_or_none_at_all_is_named() {
    let server = Server::fhir(false, |_| {});
    let store = hasty(&server);
    store.reach().unwrap();
    fs::write(server.path("version"), "5.0.0").unwrap();
    let fault = store.reach().unwrap_err().to_string();
    assert!(fault.contains("FHIR \"5.0.0\", not R4"), "{fault}");
    let base = server.address();
    drop(server);
    let fault = store.reach().unwrap_err().to_string();
    let port = base.rsplit(':').next().unwrap();
    assert!(fault.contains(port) && fault.contains("cannot be reached"), "{fault}");
}
