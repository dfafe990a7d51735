//! An archive of images that is busy, full, dies, hangs, lies or takes some objects only, at each request or message
//! of a delivery, a correction and a take-back: nothing is lost, nothing is there twice, and the fault is named.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::net::TcpListener;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use gaiter::store::{Rejection, StoreFault, TakeBack};

use crate::dicom_house::{Way, dimse_server, plain_peer, store_at, with_mesh};
use crate::fhir_house::{Deed, put, setback};
use crate::records::{PATIENT, SMALL, Scan};
use crate::server::{House, Server, dicom, own_dicom};

/// How long an answer is waited for.
const LONG: Duration = Duration::from_secs(30);

/// How long one is waited for that does not come.
const SHORT: Duration = Duration::from_secs(2);

/// How long a store may take on a busy machine, besides the limits of its requests.
const SOON: Duration = Duration::from_secs(12);

/// A record of two objects, and a correction of it.
static TWO: LazyLock<Scan> = LazyLock::new(|| with_mesh(&SMALL));
static LATER: LazyLock<Scan> = LazyLock::new(|| with_mesh(&SMALL.amended(391.0)));

/// What is done, what was there before, and how many objects there are in the end.
struct Task {
    before: Option<&'static Scan>,
    deed: Deed<'static>,
    objects: usize,
}

/// A delivery, a correction, and a take-back, which adds its mark.
fn tasks() -> [Task; 3] {
    let before: Option<&'static Scan> = Some(&TWO);
    [
        Task { before: None, deed: &|store| store.put(&TWO.delivery()).map(drop), objects: 2 },
        Task { before, deed: &|store| store.put(&LATER.delivery()).map(drop), objects: 4 },
        Task {
            before,
            deed: &|store| store.withdraw(&TakeBack::new(&TWO.id, Some(PATIENT))),
            objects: 3,
        },
    ]
}

/// Strikes each request or message of a task in turn, in a house of its own, until it is done without being struck;
/// tells how many there were. `fault` may name a kind of them. Each time it is done again without a fault. A machine
/// may be so busy that `limit` runs out by itself; then there is a next try with twice of it.
fn struck_everywhere(
    server: &'static Server,
    (fault, mut limit): (&str, Duration),
    way: Way,
    task: &Task,
) -> usize {
    let mut nth = 0;
    loop {
        nth += 1;
        let house = House::new(server);
        if let Some(scan) = task.before {
            put(&house.images(way, LONG), scan);
        }
        house.becomes(&format!("{fault} {nth}"));
        let (began, what) = (Instant::now(), format!("{way:?}: {fault} at {nth}"));
        let done = (task.deed)(&house.images(way, limit));
        assert!(began.elapsed() < SOON + 5 * limit, "{what}: {:?}", began.elapsed());
        let strikes = house.strikes();
        house.becomes("");
        if strikes > 0 && fault.starts_with("kill-") {
            house.server.starts_again();
        }
        let is_too_busy = strikes == 0 && done.is_err() && limit < LONG;
        match done {
            Err(StoreFault::Server(_)) if strikes > 0 || is_too_busy => {}
            Ok(()) => {}
            other => panic!("{what}: {other:?}"),
        }
        assert!(house.image_count() <= task.objects, "{what}");
        (task.deed)(&house.images(way, LONG)).unwrap_or_else(|fault| panic!("{what}: {fault}"));
        assert_eq!(house.image_count(), task.objects, "{what}");
        if is_too_busy {
            (nth, limit) = (nth - 1, 2 * limit);
        } else if strikes == 0 {
            return nth - 1;
        }
    }
}

/// Strikes all tasks by each of these faults.
fn every_task_survives(server: &'static Server, faults: &[&str], way: Way) {
    for fault in faults {
        for task in &tasks() {
            assert!(struck_everywhere(server, (fault, LONG), way, task) > 0, "{way:?}: {fault}");
        }
    }
}

#[test]
#[ignore = "needs Python with pynetdicom, run by .ci/run"]
fn an_archive_that_is_busy_dies_or_lies_at_any_request_has_the_record_once_in_the_end() {
    let faults = ["503", "507", "cut-before", "cut-after", "garbage", "A700 STORE", "lose STORE"];
    every_task_survives(dicom(), &faults, Way::Web);
}

#[test]
#[ignore = "needs Python with pynetdicom, run by .ci/run"]
fn an_archive_that_aborts_dies_or_lies_at_any_message_has_the_record_once_in_the_end() {
    let faults = ["A700", "cut-before", "cut-after", "garbage", "abort", "lose STORE"];
    every_task_survives(dicom(), &faults, Way::Dimse);
}

#[test]
#[ignore = "needs Python with pynetdicom, run by .ci/run"]
fn an_archive_that_is_killed_has_the_record_once_in_the_end() {
    let server = own_dicom();
    let faults = ["kill-before STORE", "kill-torn STORE", "kill-after STORE", "kill-half STORE"];
    every_task_survives(server, &faults, Way::Web);
    every_task_survives(server, &["kill-after STORE", "kill-half STORE"], Way::Dimse);
    for way in Way::ALL {
        assert!(struck_everywhere(server, ("kill-half FIND", LONG), way, &tasks()[0]) > 0);
    }
}

#[test]
#[ignore = "needs Python with pynetdicom, run by .ci/run"]
fn an_archive_that_hangs_at_any_request_is_not_waited_for_and_has_the_record_once_in_the_end() {
    for way in Way::ALL {
        for fault in ["hang-before", "hang-after STORE", "drip STORE"] {
            assert!(struck_everywhere(dicom(), (fault, SHORT), way, &tasks()[0]) > 0, "{fault}");
        }
    }
}

#[test]
#[ignore = "needs Python with pynetdicom, run by .ci/run"]
fn an_archive_that_takes_some_objects_only_gets_the_others_once_it_takes_them() {
    for way in Way::ALL {
        let house = House::new(dicom());
        let store = house.images(way, LONG);
        house.becomes("A700 STORE 2");
        let told = setback(&store, &TWO);
        assert!(told.contains("1 of 2 objects were not stored, reason A700"), "{told}");
        assert_eq!(house.image_count(), 1);
        for reason in ["0122", "A900", "C000"] {
            // Now the one that is missing is the only one.
            house.becomes(&format!("{reason} STORE"));
            match store.put(&TWO.delivery()) {
                Err(StoreFault::Permanent(Rejection::ServerRefused { why, .. })) => {
                    assert!(why.contains(&format!("reason {reason}")), "{why}");
                }
                other => panic!("{way:?}, {reason}: {other:?}"),
            }
        }
        house.becomes("");
        assert!(!put(&store, &TWO).already_there);
        assert_eq!(house.image_count(), 2);
    }
}

#[test]
#[ignore = "needs Python with pynetdicom, run by .ci/run"]
fn an_endless_answer_is_not_read_to_its_end() {
    for way in Way::ALL {
        for kind in ["FIND", "STORE"] {
            let house = House::new(dicom());
            house.becomes(&format!("huge {kind}"));
            setback(&house.images(way, LONG), &TWO);
            let taken = house.said("huge ");
            let taken: u32 = taken.strip_suffix(" MB").unwrap().parse().unwrap();
            assert!(taken < 50, "{way:?}: {taken} of 100 MB were taken");
        }
    }
}

#[test]
#[ignore = "needs Python with pynetdicom, run by .ci/run"]
fn what_keeps_an_archive_from_taking_a_record_is_named_without_the_patient() {
    let house = House::new(dicom());
    let store = house.images(Way::Web, LONG);
    for fault in ["401", "403", "500", "503"] {
        house.becomes(fault);
        let told = setback(&store, &TWO);
        assert!(told.contains(fault) && !told.contains(PATIENT), "{fault}: {told}");
    }
    for status in [400, 413, 415, 422] {
        house.becomes(&format!("{status} STORE"));
        match store.put(&TWO.delivery()) {
            Err(StoreFault::Permanent(Rejection::ServerRefused { status: found, why })) => {
                assert!(found == status && !why.contains(PATIENT), "{found}: {why}");
            }
            other => panic!("{status}: {other:?}"),
        }
    }
    let store = house.images(Way::Dimse, LONG);
    for (fault, said) in [("abort FIND", "aborts"), ("A700 FIND", "A700"), ("A700 STORE", "A700")] {
        house.becomes(fault);
        let told = setback(&store, &TWO);
        assert!(told.contains(said) && !told.contains(PATIENT), "{fault}: {told}");
    }
    assert_eq!(house.image_count(), 0);
}

#[test]
#[ignore = "needs Python with pynetdicom, run by .ci/run"]
fn an_archive_that_lets_nobody_look_is_not_reached() {
    for way in Way::ALL {
        let house = House::new(dicom());
        let store = house.images(way, LONG);
        store.reach().unwrap();
        for fault in ["503", "cut-before", "garbage"] {
            house.becomes(fault);
            assert_eq!(store.reach().unwrap_err().code(), "store-unavailable", "{way:?}: {fault}");
        }
    }
}

#[test]
fn an_archive_that_is_away_is_named_and_waited_for() {
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let store = store_at(dimse_server(plain_peer(port, SHORT), "PACS"));
    assert_eq!(store.reach().unwrap_err().code(), "store-unavailable");
    let told = setback(&store, &TWO);
    assert!(told.contains(&port.to_string()), "{told}");
}
