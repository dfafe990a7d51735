//! What an archive does on a usual day, and after the usual mishaps.

use std::fs;
use std::process::Command;

use gaiter_record::ScanId;
use gaiter_record::archive::{ObjectKey, Outcome, packed};
use serde_json::Value;

use crate::gate::Gate;
use crate::place::{Place, Ports, crop, method, wait_for, whole};

/// Enough that several workers meet, and no more than one claims at a time.
const SCANS: usize = 12;

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn every_scan_gets_one_result_whether_one_worker_measures_or_two() {
    let place = Place::new();
    for workers in [1, 2] {
        place.renew(SCANS);
        place.verb(&["index", "--once"]);
        let start = |_| place.start(place.ports, &["work", "--until-empty"]);
        let mut running: Vec<_> = (0..workers).map(start).collect();
        running.iter_mut().for_each(|worker| worker.ends());
        assert_eq!(place.wrong(SCANS), Vec::<String>::new(), "{workers} workers");
    }
    let output = place.verb(&["status", "--json"]);
    let status: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(status["scans"], SCANS);
    assert_eq!(status["methods"][0]["results"], SCANS);
    assert_eq!(status["stations"][0]["scans"], SCANS);
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn what_a_station_has_taken_back_is_no_visit_whichever_is_indexed_first() {
    let place = Place::new();
    let visits = || -> i64 {
        place.verb(&["index", "--once"]);
        place.client().query_one("select count(*) from visit", &[]).unwrap().get(0)
    };
    place.renew(2);
    assert_eq!(visits(), 2);
    place.withdraw(&crop(0));
    assert_eq!(visits(), 1);
    place.client().batch_execute("drop schema gaiter cascade").unwrap();
    place.verb(&["index", "--once", "--reconcile"]);
    assert_eq!(visits(), 1);
    place.renew(0);
    place.withdraw(&crop(0));
    assert_eq!(visits(), 0);
    place.announce(&crop(0));
    assert_eq!(visits(), 0);
    place.announce(&crop(1));
    assert_eq!(visits(), 1);
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn a_lost_database_comes_back_from_the_objects() {
    let place = Place::new();
    place.renew(3);
    place.verb(&["index", "--once"]);
    place.verb(&["work", "--until-empty"]);
    // One that nobody has measured yet.
    place.announce(&crop(3));
    place.verb(&["index", "--once"]);
    let before = place.rows();
    assert_eq!(before.len(), 4 + 4 + 3);
    place.client().batch_execute("drop schema gaiter cascade").unwrap();
    place.verb(&["index", "--once", "--reconcile"]);
    assert_eq!(place.rows(), before);
    place.verb(&["work", "--until-empty"]);
    assert_eq!(place.wrong(4), Vec::<String>::new());
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn a_refusal_is_a_result_and_a_damaged_scan_a_dead_letter() {
    let place = Place::new();
    place.renew(1);
    // No legs are in three points.
    let mut few = whole().crop();
    few.points.truncate(3);
    few.triangles = vec![[0, 1, 2]];
    let empty = few.to_ply();
    place.announce(&(empty.clone(), crop(0).1));
    // The bytes of another scan.
    let (ply, whole) = crop(2);
    place.announce(&(ply.clone(), whole));
    let damaged = ScanId::of_bytes(&ply);
    place.bucket.put(&ObjectKey::Scan(damaged.clone()).to_string(), packed(&crop(1).0)).unwrap();
    place.verb(&["index", "--once"]);
    let worker = place.start(place.ports, &["work"]);
    let mut client = place.client();
    wait_for("the dead letter", || {
        place.time_passes();
        let rows =
            client.query("select encode(scan, 'hex'), reason from dead_letter", &[]).unwrap();
        rows.iter().any(|row| row.get::<_, String>(0) == damaged.as_str())
    });
    drop(worker);
    let statement = "select encode(scan, 'hex'), reason from dead_letter";
    let rows = client.query(statement, &[]).unwrap();
    assert_eq!(rows.len(), 1);
    let reason: String = rows[0].get(1);
    assert_eq!(reason, "the scan: its bytes are not those of its hash");
    let refused = ObjectKey::Result { method: method(), scan: ScanId::of_bytes(&empty) };
    let refused = place.result(&refused.to_string());
    assert!(matches!(refused.outcome, Outcome::Refused { .. }), "{refused:?}");
    let outcomes = "select count(*) from result where outcome = 'measured'";
    assert_eq!(client.query_one(outcomes, &[]).unwrap().get::<_, i64>(0), 1);
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn while_a_server_is_away_no_attempt_counts() {
    let place = Place::new();
    place.renew(2);
    place.verb(&["index", "--once"]);
    let gate = Gate::open(place.ports.store);
    gate.close(true);
    let through = Ports { store: gate.port, ..place.ports };
    let mut worker = place.start(through, &["work", "--until-empty"]);
    wait_for("a second try", || gate.sent_away() > 2);
    let attempts: i16 =
        place.client().query_one("select max(attempts) from job", &[]).unwrap().get(0);
    assert!(attempts <= 1, "{attempts}");
    gate.close(false);
    worker.ends();
    assert_eq!(place.wrong(2), Vec::<String>::new());
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn a_worker_that_is_asked_to_end_hands_back_what_it_has_claimed() {
    let place = Place::new();
    place.renew(SCANS);
    place.verb(&["index", "--once"]);
    let count =
        |statement: &str| -> i64 { place.client().query_one(statement, &[]).unwrap().get(0) };
    let results = || count("select count(*) from result");
    // The worker measures one scan, and cannot enter the result.
    let mut holder = place.client();
    let mut held = holder.transaction().unwrap();
    held.batch_execute("lock table result in exclusive mode").unwrap();
    let mut worker = place.start(place.ports, &["work"]);
    let waiting = "select count(*) from pg_stat_activity where datname = current_database() \
                   and application_name = 'gaiter-archive' and wait_event_type = 'Lock'";
    wait_for("a result that cannot be entered", || count(waiting) == 1);
    let claimed = count("select count(*) from job where due > now()");
    assert_eq!((claimed, results()), (SCANS as i64, 0));
    // The thread that hears the signal ends when it has said so to the others.
    let tasks = format!("/proc/{}/task", worker.0.id());
    let threads = || fs::read_dir(&tasks).unwrap().count();
    let before = threads();
    let asked = Command::new("kill").arg(worker.0.id().to_string()).status().unwrap();
    assert!(asked.success());
    wait_for("a worker that has heard the signal", || threads() < before);
    held.rollback().unwrap();
    worker.ends();
    // Nobody need wait for a lease, and no attempt counts.
    let free = count("select count(*) from job where due <= now() and attempts = 0");
    let code = worker.0.wait().unwrap().code();
    assert_eq!((code, results(), free), (Some(75), 1, SCANS as i64 - 1));
    place.verb(&["work", "--until-empty"]);
    assert_eq!(place.wrong(SCANS), Vec::<String>::new());
}
