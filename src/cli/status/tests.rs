//! The screen as a person sees it.

use std::collections::BTreeMap;

use gaiter_flow::account::Seen;
use gaiter_flow::complaint::{Complaint, ComplaintFigures};
use gaiter_flow::confinement::{Confinement, Enforced};
use gaiter_flow::views::ViewsSeries;
use gaiter_flow::{Disposition, ScanState};
use gaiter_record::gdt::OrderFault;

use super::*;
use crate::station::operator::control::status::{BoothStatus, StoreStatus};

fn at(second: i64) -> Timestamp {
    Timestamp::from_second(1_800_000_000 + second).unwrap()
}

fn status() -> Status {
    let seen = Seen { scan: "abcd1234".into(), first_seen: at(0), state: ScanState::Spooled };
    let counts = [("spooled", 1), ("delivered", 20), ("refused", 2), ("held", 0)];
    let port = TriggerStatus {
        state: "open".into(),
        why: None,
        cause: None,
        since: at(0),
        presses: 21,
        ids: 0,
        garbage: 3,
    };
    let store = StoreStatus { fault: None, cause: None, waits_for_fetch: false, since: at(0) };
    Status {
        schema: "gaiter.status/1".into(),
        ready: true,
        complaints: Vec::new(),
        station: "booth-1".into(),
        gaiter: "0.1.0".into(),
        pid: 77,
        started: at(-7200),
        running_s: 7380,
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
            cause: None,
            since: at(0),
            file_system: Some("SMB".into()),
            polled: true,
            last_look: Some(at(175)),
            waiting: 2,
            overdue: 1,
            ignored: 0,
            unread: BTreeMap::new(),
            gone: 0,
        }],
        stores: BTreeMap::from([("folder".into(), store)]),
        triggers: BTreeMap::from([("serial".into(), port)]),
        booth: BoothStatus {
            light: "armed".into(),
            awaited: 2,
            named: true,
            in_doubt: false,
            advice: None,
            orders_come_late: None,
        },
        disk_free_bytes: Some(12_000_000_000),
        disk_bytes: Some(100_000_000_000),
        confinement: Some(Confinement { landlock: Enforced::Fully, seccomp: true }),
        measured: 22,
        last_measurement_s: Some(2.13),
        phantom: None,
        worklist: None,
        views: ViewsSeries::default(),
        alarms: BTreeMap::new(),
        refused_reload: None,
    }
}

fn scan(state: ScanState) -> Listed {
    Listed {
        scan: "abcd1234".into(),
        first_seen: at(0),
        state,
        disposition: match state {
            ScanState::Spooled => Disposition::Spooled,
            ScanState::Delivered => Disposition::Delivered,
            ScanState::Refused => Disposition::Refused,
        },
        held: false,
        closed: None,
        withdrawing: false,
        format: "obj".into(),
        size: 4_500_000,
        code: None,
        attempts: 0,
        next_at: None,
    }
}

#[test]
fn held_scans_stand_first_and_nothing_is_listed_twice() {
    let named = |name: &str| Listed { scan: name.into(), ..scan(ScanState::Delivered) };
    let list = |names: &[&str]| names.iter().map(|name| named(name)).collect::<Vec<_>>();
    let shown = held_first(list(&["h1", "h2"]), list(&["a", "h1", "b", "c", "d"]));
    let names: Vec<&str> = shown.iter().map(|scan| scan.scan.as_str()).collect();
    assert_eq!(names, ["h1", "h2", "a", "b", "c"]);
}

/// The screen without its colours.
fn screen(status: Status, scans: Vec<Listed>, columns: Option<usize>) -> String {
    anstream::adapter::strip_str(&table(&Look { status, scans }, Language::En, columns)).to_string()
}

const READY: &str = "\
ready
light      waits for the export of a press, 2 exports are awaited, a patient is named for the next press
intake     scans are taken in
export 0   looked through, last 5 seconds ago, SMB (polled), 2 waiting (1 for too long)
trigger    serial: open for 3 minutes, 21 presses, 3 bytes of garbage
store      folder: has accepted records for 3 minutes
oldest     abcd1234 has waited 3 minutes for its record
scans      1 spooled, 20 delivered, 2 refused, 0 held
last scan  abcd1234 seen 2027-01-15 08:00:00, 3 minutes ago: spooled
measured   22 in this run, the last in 2.1 s
disk       12.0 GB free of 100.0 GB
station    booth-1, gaiter 0.1.0, process 77, running for 2 hours

scan      first seen           state        format      size  why
abcd1234  2027-01-15 08:00:00  spooled      obj       4.5 MB
";

#[test]
fn a_station_in_order_says_so_first_and_its_last_scans_at_the_end() {
    // Times are shown in the zone of the machine that runs the test.
    let ready = READY.replace("2027-01-15 08:00:00", &local(at(0)));
    assert_eq!(screen(status(), vec![scan(ScanState::Spooled)], None), ready);
}

#[test]
fn on_a_terminal_it_fits_one_screen_and_every_id_stays_whole() {
    let scans = (0..LAST_SCANS).map(|_| scan(ScanState::Delivered)).collect();
    let said = screen(status(), scans, Some(80));
    assert!(said.lines().count() < 24, "{said}");
    assert!(said.lines().all(|line| line.chars().count() <= 80), "{said}");
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let piped = screen(status(), vec![scan(ScanState::Delivered)], None);
    let (said, piped) = (words(&said), words(&piped));
    assert_eq!(said[..piped.len()], piped, "wrapping parts words only at spaces");
}

#[test]
fn what_may_be_an_export_and_is_not_read_is_counted_and_so_is_what_is_gone() {
    let mut status = status();
    let unread = BTreeMap::from([("link".to_owned(), 1), ("sub_folder".to_owned(), 2)]);
    let source = status.sources.remove(0);
    status.sources.push(SourceStatus { ignored: 4, unread, gone: 1, ..source });
    let said = screen(status, Vec::new(), None);
    let expected =
        "4 passed over (may be exports: links 1, sub-folders 2), 1 gone before they were";
    assert!(said.contains(expected), "{said}");
}

#[test]
fn what_is_wrong_and_what_to_do_stands_first() {
    let mut status = status();
    status.ready = false;
    for code in ["paused", "journal-failed"] {
        status.complaints.push(Complaint::new(code, ComplaintFigures::default()).into());
    }
    let said = screen(status, Vec::new(), None);
    let first = "not ready: the operator has paused the station; exports stay where they are [paused]\n    \
                 do: gaiter resume\nnot ready: the station's journal cannot be read [journal-failed]\n";
    assert!(said.starts_with(first), "{said}");
    assert!(!said.contains("\nready"), "{said}");
}

#[test]
fn in_german_every_row_is_german() {
    let mut status = status();
    status.complaints.push(Complaint::new("paused", ComplaintFigures::default()).into());
    let look = Look { status, scans: vec![scan(ScanState::Spooled)] };
    let said = anstream::adapter::strip_str(&table(&look, Language::De, None)).to_string();
    for part in [
        "nicht bereit: Die Station macht Pause; Exporte bleiben, wo sie sind [paused]\n    Abhilfe: gaiter",
        "\nLicht      wartet auf den Export zum Knopfdruck, 2 Exporte werden erwartet, ",
        "\nExport 0   durchgesehen, zuletzt vor 5 Sekunden, SMB (abgefragt), 2 warten (1 zu lange)\n",
        "\nAnschluss  serial: offen seit 3 Minuten, 21 Knopfdrücke, 3 Bytes ohne Bedeutung\n",
        "\nScans      1 unterwegs, 20 gespeichert, 2 abgelehnt, 0 zurückgehalten\n",
        "\ngemessen   22 in diesem Lauf, zuletzt in 2,1 s\n",
        "  unterwegs ",
    ] {
        assert!(said.contains(part), "no {part:?} in\n{said}");
    }
}

/// Red while reasons were English words: a German sentence ended in English.
#[test]
fn why_a_part_does_not_work_is_german_in_a_german_sentence() {
    let mut status = status();
    let lacks = Cause::known("no-marker", []);
    let source = status.sources.remove(0);
    let (state, why) = ("not_mounted".to_owned(), Some(lacks.to_string()));
    status.sources.push(SourceStatus { state, why, cause: Some(lacks), ..source });
    let full = Cause::of_system(&std::io::Error::from_raw_os_error(28)).after("writing failed");
    let (fault, cause) = (Some(full.to_string()), Some(full));
    let store = StoreStatus { fault, cause, waits_for_fetch: false, since: at(0) };
    status.stores.insert("folder".to_owned(), store);
    let order = Cause::from(&OrderFault::NoPatient);
    let figures =
        ComplaintFigures::default().words("fault", "order-without-patient").words("place", "aside");
    status.complaints.push(Complaint::new("order-refused", figures.cause("said", &order)).into());
    // As another process reads it.
    let status = serde_json::from_str(&serde_json::to_string(&status).unwrap()).unwrap();
    let look = Look { status, scans: Vec::new() };
    let said = anstream::adapter::strip_str(&table(&look, Language::De, None)).to_string();
    for part in [
        "Export 0   Freigabe nicht eingehängt seit 3 Minuten: ihm fehlt die Datei, die scanner.marker nennt",
        "folder: nimmt seit 3 Minuten keine Messakten an: der Datenträger ist voll (Systemfehler 28)",
        "(order-without-patient): er nennt keinen Patienten: Feld 3000 fehlt oder ist leer; er liegt",
    ] {
        assert!(said.contains(part), "no {part:?} in\n{said}");
    }
    let said = anstream::adapter::strip_str(&table(&look, Language::En, None)).to_string();
    assert!(said.contains("writing failed: No space left on device (os error 28)"), "{said}");
}

#[test]
fn the_worklist_is_told_by_how_many_are_on_it_or_since_when_it_does_not_answer() {
    let row = |fault: Option<Cause>, answered: Option<Timestamp>, language| {
        let (cause, fault) = (fault.clone(), fault.map(|why| why.to_string()));
        let since = at(0);
        let worklist = WorklistStatus { fault, cause, since, answered, entries: 7, left_out: 1 };
        let look = Look { status: Status { worklist: Some(worklist), ..status() }, scans: vec![] };
        anstream::adapter::strip_str(&table(&look, language, None)).to_string()
    };
    let said = row(None, Some(at(120)), Language::En);
    assert!(said.contains("\nworklist   7 entries for today, as of 60 seconds ago\n"), "{said}");
    let said = row(Some(Cause::known("no-answer", [])), Some(at(0)), Language::De);
    assert!(said.contains("\nArbeitsliste  antwortet seit 3 Minuten nicht: "), "{said}");
    assert!(row(None, None, Language::En).contains("\nworklist   not asked yet\n"));
}
