//! The screen as a person sees it.

use std::collections::BTreeMap;

use super::*;
use crate::flow::account::Seen;
use crate::flow::health::Complaint;
use crate::station::control::protocol::{BoothStatus, StoreStatus, TriggerStatus};

fn at(second: i64) -> Timestamp {
    Timestamp::from_second(1_800_000_000 + second).unwrap()
}

fn status() -> Status {
    let seen = Seen { scan: "abcd1234".into(), first_seen: at(0), state: "spooled".into() };
    let counts = [("spooled", 1), ("delivered", 20), ("refused", 2), ("held", 0)];
    let port = TriggerStatus {
        state: "open".into(),
        why: None,
        since: at(0),
        presses: 21,
        ids: 0,
        garbage: 3,
    };
    Status {
        schema: "gaiter.status/1".into(),
        ready: true,
        complaints: Vec::new(),
        station: "booth-1".into(),
        gaiter: "0.1.0".into(),
        pid: 77,
        started: at(-7200),
        now: at(180),
        intake: "open".into(),
        oldest: Some(seen.clone()),
        oldest_age_s: Some(180),
        last: Some(seen),
        scans: counts.map(|(word, count)| (word.to_owned(), count)).into(),
        sources: vec![SourceStatus {
            export_dir: 0,
            state: "watched".into(),
            why: None,
            since: at(0),
            file_system: Some("SMB".into()),
            polled: true,
            last_look: Some(at(175)),
            waiting: 2,
            overdue: 1,
            ignored: 0,
        }],
        stores: BTreeMap::from([("folder".into(), StoreStatus { fault: None, since: at(0) })]),
        triggers: BTreeMap::from([("serial".into(), port)]),
        booth: BoothStatus { light: "armed".into(), awaited: 2, named: true, in_doubt: false },
        disk_free_bytes: Some(12_000_000_000),
        disk_bytes: Some(100_000_000_000),
        measured: 22,
        last_measurement_s: Some(2.13),
        alarms: BTreeMap::new(),
        refused_reload: None,
    }
}

const READY: &str = "\
ready

station    booth-1, gaiter 0.1.0, process 77, running for 2 hours
oldest     abcd1234 has waited 3 minutes for its record
last scan  abcd1234 seen 2027-01-15 08:00:00 UTC, 3 minutes ago: spooled
scans      1 spooled, 20 delivered, 2 refused, 0 held
intake     scans are taken in
export 0   looked through, last 5 seconds ago, SMB (polled), 2 waiting (1 for too long)
store      folder: takes records since 3 minutes
booth      waits for the export of a press, 2 exports are awaited, a patient is named for the next press
trigger    serial: open since 3 minutes, 21 presses, 3 bytes of garbage
disk       12.0 GB free of 100.0 GB
measured   22 in this run, the last in 2.1 s
";

#[test]
fn a_station_in_order_fills_one_screen_and_says_so_first() {
    assert_eq!(table(&status()), READY);
}

#[test]
fn what_is_wrong_and_what_to_do_stands_first() {
    let mut status = status();
    status.ready = false;
    for code in ["paused", "store-fault"] {
        let (message, remedy) = (format!("it is {code}"), "gaiter resume".to_owned());
        status.complaints.push(Complaint { code: code.into(), message, remedy });
    }
    let said = table(&status);
    let first = "not ready: it is paused [paused]\n    do: gaiter resume\nnot ready: it is store";
    assert!(said.starts_with(first), "{said}");
    assert!(!said.contains("\nready"), "{said}");
}
