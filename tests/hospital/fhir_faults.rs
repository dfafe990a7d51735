//! A server that is busy, full, dies, hangs or lies, at each request of a delivery: nothing is lost, nothing is
//! there twice, and the fault is named.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::net::TcpListener;
use std::time::{Duration, Instant};

use gaiter::store::{Rejection, StoreFault, TakeBack};

use crate::fhir_house::{Deed, LONG, ONE, Store, put, server_at, setback, store_of};
use crate::records::{PATIENT, SMALL, Scan};
use crate::server::{House, own_fhir};

/// How long an answer is waited for that does not come.
const SHORT: Duration = Duration::from_secs(2);

/// How long a store may take on a busy machine, besides the limits of its requests.
const SOON: Duration = Duration::from_secs(12);

/// Requests of a delivery, a correction and a take-back, at least: a search and a transaction; a look at each
/// resource; a search for each kind.
const REQUESTS_LEAST: [usize; 3] = [2, 4, 2];

/// Transactions among them: one that creates; another that replaces; one that withdraws.
const TRANSACTIONS_LEAST: [usize; 3] = [1, 2, 1];

fn sent(store: &Store, scan: &Scan) -> Result<(), StoreFault> {
    store.put(&scan.delivery()).map(drop)
}

/// Houses that are struck, and how long an answer of theirs is waited for.
#[derive(Clone, Copy)]
struct Struck<'a> {
    house: &'a dyn Fn() -> House,
    limit: Duration,
}

const WITH_PATIENT: Struck<'_> = Struck { house: &House::with_patient, limit: LONG };

/// Strikes each request of a deed in turn, in a house of its own that `before` prepares, until the deed is done
/// without being struck; tells how many there were. Each time the deed is done again without a fault, and `after`
/// looks at the house. A machine may be so busy that the limit runs out by itself; then there is a next try with
/// twice of it.
fn struck_everywhere(
    (fault, struck): (&str, Struck<'_>),
    before: &[&Scan],
    deed: Deed<'_>,
    after: impl Fn(&House),
) -> usize {
    let (mut nth, mut limit) = (0, struck.limit);
    loop {
        nth += 1;
        let house = (struck.house)();
        for scan in before {
            put(&house.store(), scan);
        }
        house.becomes(&format!("{fault} {nth}"));
        let began = Instant::now();
        let done = deed(&house.store_within(limit));
        let took = began.elapsed();
        let strikes = house.strikes();
        house.becomes("");
        if strikes > 0 && fault.starts_with("kill-") {
            house.server.starts_again();
        }
        match done {
            Ok(()) | Err(StoreFault::Server(_)) => {}
            Err(other) => panic!("{fault} at request {nth}: {other:?}"),
        }
        assert!(took < SOON + 5 * limit, "{fault} at request {nth}: {took:?}");
        let counts = house.counts();
        let is_once = counts.iter().zip(ONE).all(|(found, most)| *found <= most);
        assert!(is_once, "{fault} at request {nth}: {counts:?}");
        let is_too_busy = strikes == 0 && done.is_err() && limit < LONG;
        if strikes == 0 && !is_too_busy {
            done.unwrap();
        }
        deed(&house.store()).unwrap_or_else(|fault| panic!("{fault}"));
        assert_eq!(house.counts(), ONE, "{fault} at request {nth}");
        after(&house);
        if is_too_busy {
            (nth, limit) = (nth - 1, 2 * limit);
        } else if strikes == 0 {
            return nth - 1;
        }
    }
}

/// Each of these faults, in a delivery, a correction and a take-back, of which it strikes at least so many requests.
fn every_deed_survives(faults: &[&str], struck: Struck<'_>, least: [usize; 3]) {
    let later = SMALL.amended(391.0);
    let has = |kind: &'static str, status: &'static str| {
        move |house: &House| {
            let found = house.statuses(kind, PATIENT);
            assert!(found.iter().any(|of| of == status), "{kind}: {found:?}");
        }
    };
    for &fault in faults {
        let delivery =
            struck_everywhere((fault, struck), &[], &|store| sent(store, &SMALL), |_| {});
        let amended = has("DiagnosticReport", "amended");
        let correction =
            struck_everywhere((fault, struck), &[&SMALL], &|store| sent(store, &later), amended);
        let withdrawn = |store: &Store| store.withdraw(&TakeBack::new(&SMALL.id, Some(PATIENT)));
        let in_error = has("DocumentReference", "entered-in-error");
        let take_back = struck_everywhere((fault, struck), &[&SMALL], &withdrawn, in_error);
        let requests = [delivery, correction, take_back];
        assert!(requests.iter().zip(least).all(|(is, least)| *is >= least), "{requests:?}");
    }
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_server_that_is_busy_or_full_at_any_request_has_the_record_once_in_the_end() {
    every_deed_survives(&["503", "429", "409", "507"], WITH_PATIENT, REQUESTS_LEAST);
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_server_that_dies_or_lies_at_any_request_has_the_record_once_in_the_end() {
    every_deed_survives(
        &["cut-before", "cut-after", "error-after", "login-page", "redirect"],
        WITH_PATIENT,
        REQUESTS_LEAST,
    );
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_server_that_is_killed_and_keeps_what_it_has_has_the_record_once_in_the_end() {
    let server = own_fhir();
    let struck = Struck { house: &|| House::that_keeps(server), ..WITH_PATIENT };
    // At the search for the patient, too.
    let delivery = struck_everywhere(("kill-half", struck), &[], &|of| sent(of, &SMALL), |_| {});
    assert!(delivery >= REQUESTS_LEAST[0], "{delivery}");
    // It starts in seconds, and what it keeps changes by transactions only.
    let faults = ["kill-before POST", "kill-torn POST", "kill-after POST", "kill-half POST"];
    every_deed_survives(&faults, struck, TRANSACTIONS_LEAST);
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_server_that_hangs_at_any_request_is_not_waited_for_and_has_the_record_once_in_the_end() {
    let struck = Struck { limit: SHORT, ..WITH_PATIENT };
    every_deed_survives(&["hang-before", "hang-after", "drip"], struck, REQUESTS_LEAST);
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn what_keeps_a_server_from_taking_a_record_now_is_named() {
    let house = House::with_patient();
    let store = house.store();
    for (fault, said) in [
        ("503", "come back later"),
        ("429", "too many requests"),
        ("507", "no space left on device"),
        ("500", "the answer was lost"),
        ("401", "log in first"),
        ("403", "not for this client"),
    ] {
        house.becomes(fault);
        let told = setback(&store, &SMALL);
        assert!(told.contains(fault) && told.contains(said), "{fault}: {told}");
    }
    // A transaction that says that it is done and tells nothing of its parts.
    house.becomes("empty POST");
    setback(&store, &SMALL);
    house.becomes("redirect");
    setback(&store, &SMALL);
    assert!(!house.server.path("elsewhere/log").exists(), "a redirect is not followed");
    house.becomes("");
    put(&store, &SMALL);
    assert_eq!(house.counts(), ONE);
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn an_endless_answer_is_not_read_to_its_end() {
    let house = House::with_patient();
    house.becomes("huge");
    setback(&house.store(), &SMALL);
    let taken = house.said("huge ");
    let taken: u32 = taken.strip_suffix(" MB").unwrap().parse().unwrap();
    assert!(taken < 50, "{taken} of 100 MB were taken");
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn what_a_server_will_never_take_waits_for_a_person_and_says_why_without_the_patient() {
    let house = House::with_patient();
    let store = house.store();
    for (status, said) in
        [(400, "this is no resource"), (412, "not selective enough"), (422, "has no open case")]
    {
        house.becomes(&format!("{status} POST"));
        match store.put(&SMALL.delivery()) {
            Err(StoreFault::Permanent(Rejection::ServerRefused { status: found, why })) => {
                assert!(found == status && why.contains(said), "{found}: {why}");
                assert!(!why.contains(PATIENT), "{why}");
            }
            other => panic!("{status}: {other:?}"),
        }
    }
    house.becomes("");
    put(&store, &SMALL);
    assert_eq!(house.counts(), ONE);
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_server_that_does_not_search_for_what_is_asked_gets_nothing() {
    let house = House::with_patient();
    house.becomes("deaf-search");
    house.register("4712");
    setback(&house.store(), &SMALL);
    house.becomes("");
    assert_eq!(house.counts(), [0; 4]);
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_server_of_another_version_or_none_at_all_is_named() {
    let house = House::with_patient();
    let store = house.store();
    store.reach().unwrap();
    fs::write(house.path("version"), "5.0.0").unwrap();
    let told = store.reach().unwrap_err().to_string();
    assert!(told.contains("5.0.0"), "{told}");
    for fault in ["login-page", "503", "cut-before"] {
        house.becomes(fault);
        assert_eq!(store.reach().unwrap_err().code(), "store-unavailable", "{fault}");
    }
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let nobody = store_of(server_at(format!("http://127.0.0.1:{port}/r4")));
    let told = setback(&nobody, &SMALL);
    assert!(told.contains(&port.to_string()), "{told}");
    assert_eq!(nobody.reach().unwrap_err().code(), "store-unavailable");
}
