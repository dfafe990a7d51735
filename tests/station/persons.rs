//! All of one person: disclosed and erased, while the station runs and while it does not.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::thread;

use rig::verb::{code, gaiter_told, stderr, stdout};
use rig::{Booth, Daemon, names, sha256};
use serde_json::Value;
use support::coarse_body;

/// An id that nothing else in a station's folders holds.
const ID: &str = "73190426";

const OTHER: &str = "51660018";

/// Not a scan: it is refused.
const REFUSED: &[u8] = b"v 1 2 3\nno scan\n";

/// Every file below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        match entry.file_type().unwrap().is_dir() {
            true => found.extend(files(&entry.path())),
            false => found.push(entry.path()),
        }
    }
    found
}

/// The paths below these folders that name an id or hold it.
fn naming(booth: &Booth, folders: &[&str], id: &str) -> Vec<PathBuf> {
    let all = folders.iter().flat_map(|folder| files(&booth.path(folder)));
    all.filter(|path| {
        let held = fs::read(path).unwrap_or_default();
        let in_bytes = held.windows(id.len()).any(|part| part == id.as_bytes());
        in_bytes || path.to_string_lossy().contains(id)
    })
    .collect()
}

fn told(booth: &Booth, args: &[&str], lines: &str) -> (Option<i32>, String, String) {
    let output = gaiter_told(&booth.path("station.toml"), args, lines);
    (code(&output), stdout(&output), stderr(&output))
}

fn erase(booth: &Booth) -> (Option<i32>, String, String) {
    told(booth, &["patient", "erase"], &format!("{ID}\n{ID}\n"))
}

/// A station with a second folder store that has seen two scans of the person, one that was refused, one of
/// another, and one that both have.
fn booth() -> (Booth, Daemon) {
    let booth = Booth::new();
    fs::create_dir(booth.path("copy")).unwrap();
    let copy = booth.path("copy").display().to_string();
    booth.reconfigure(|config| {
        config.replace("[output]", &format!("[store.copy]\npath = \"{copy}\"\n[output]"))
    });
    let daemon = booth.start_ready();
    booth.export(&format!("{ID}_a.obj"), &coarse_body(1));
    booth.export(&format!("{OTHER}_b.obj"), &coarse_body(2));
    booth.export(&format!("{ID}_c.obj"), &coarse_body(3));
    booth.export(&format!("{ID}_d.obj"), REFUSED);
    let delivered = "SELECT count(*) FROM deliveries WHERE state = 'delivered'";
    booth.wait_for_journal(delivered, 6);
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 1);
    // The same bytes for the other, too.
    booth.export(&format!("{OTHER}_e.obj"), &coarse_body(3));
    booth.wait_for_journal("SELECT count(DISTINCT sha256) FROM deliveries WHERE state = 'held'", 1);
    let shared = sha256(&coarse_body(3));
    let (released, _, said) = told(&booth, &["release", &shared], "");
    assert_eq!(released, Some(0), "{said}");
    booth.wait_for_journal(delivered, 8);
    let (named, said, faults) = told(&booth, &["patient", "affected", "left"], ID);
    assert_eq!(named, Some(0), "{said}{faults}");
    (booth, daemon)
}

/// What must hold of a disclosure of the person.
fn assert_disclosed(booth: &Booth) {
    let folder = booth.path("access");
    let person: Value =
        serde_json::from_slice(&fs::read(folder.join("person.json")).unwrap()).unwrap();
    let whose: Vec<&str> =
        person["scans"].as_array().unwrap().iter().map(|s| s["whose"].as_str().unwrap()).collect();
    assert_eq!(whose, ["theirs", "shared", "theirs"]);
    for store in ["folder", "copy"] {
        let records = names(&folder.join("records").join(store));
        assert_eq!(records.len(), 2, "{records:?}");
        let record = folder.join("records").join(store).join(&records[0]);
        for file in ["record.json", "report.html", "scan.obj", "SHA256SUMS"] {
            assert!(record.join(file).is_file(), "{file}");
        }
    }
    let quarantined = folder.join("scans/quarantine").join(sha256(REFUSED));
    assert_eq!(fs::read(quarantined.join("scan.obj")).unwrap(), REFUSED);
    assert_eq!(person["affected"]["affected"], "left");
    let mut events = person["history"].as_array().unwrap().iter();
    assert!(events.any(|of| of["event"] == "affected-named"), "{person}");
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    assert!(page.contains("Affected leg, as named: left"), "{page}");
    assert!(page.contains(ID) && page.contains("delivered"), "{page}");
    // Nothing of another, and every file has its sum.
    assert!(naming(booth, &["access"], OTHER).is_empty());
    let sums = fs::read_to_string(folder.join("SHA256SUMS")).unwrap();
    let listed = sums.lines().filter(|line| {
        let (sum, name) = line.split_once("  ").unwrap();
        sha256(&fs::read(folder.join(name)).unwrap()) == sum
    });
    assert_eq!(listed.count() + 1, files(&folder).len());
}

#[test]
fn a_person_is_disclosed_whole_and_nothing_of_another_with_it() {
    let (booth, daemon) = booth();
    let out = booth.path("access").display().to_string();
    let args = ["patient", "disclose", "--out", &out];
    let (exit, said, faults) = told(&booth, &args, &format!("{ID}\n"));
    assert_eq!(exit, Some(0), "{faults}");
    assert!(said.contains("index.html"), "{said}");
    assert_disclosed(&booth);
    booth.wait_for_journal("SELECT count(*) FROM history WHERE event = 'disclosed'", 1);
    // A folder that is there is not written into.
    let (exit, _, faults) = told(&booth, &args, &format!("{ID}\n"));
    assert_eq!(exit, Some(64), "{faults}");
    assert_eq!(daemon.stop().code(), Some(0));
    // The same from a station that does not run.
    fs::remove_dir_all(booth.path("access")).unwrap();
    let (exit, _, faults) = told(&booth, &args, &format!("{ID}\n"));
    assert_eq!(exit, Some(0), "{faults}");
    assert_disclosed(&booth);
    let (exit, _, faults) = told(&booth, &["patient", "disclose", "--out", "x"], "999\n");
    assert_eq!(exit, Some(66), "{faults}");
    assert!(!booth.log_names(ID));
}

/// What must hold after the person was erased: the id is in no file that gaiter keeps, and the other has what
/// they had.
fn assert_erased(booth: &Booth) {
    let naming = naming(booth, &["state", "records", "copy"], ID);
    assert!(naming.is_empty(), "{naming:?}");
    assert!(names(&booth.path("state/affected")).is_empty(), "the affected leg is erased, too");
    for store in ["records", "copy"] {
        assert_eq!(names(&booth.path(store).join(OTHER)).len(), 2, "{store}");
        assert!(!booth.path(store).join(ID).exists());
    }
    assert!(!booth.log_names(ID), "{}", booth.log());
}

#[test]
fn a_person_is_erased_and_the_scans_at_the_scanner_are_not_taken_in_again() {
    let (booth, daemon) = booth();
    let (exit, said, shown) = erase(&booth);
    assert_eq!(exit, Some(0), "{said}{shown}\n{}", booth.log());
    // It named what goes, what stays, and the law.
    for part in ["§ 630f", "Annex XIII", &format!("{ID}_a.obj"), "2 record folders"] {
        assert!(shown.contains(part), "no {part:?} in:\n{shown}");
    }
    assert!(said.contains("Erased"), "{said}");
    assert_erased(&booth);
    booth.wait_for_journal("SELECT count(*) FROM history WHERE event = 'erasure-ended'", 1);
    assert_eq!(booth.status()["alarms"]["erasure-pending"], Value::Null);
    assert_eq!(daemon.stop().code(), Some(0));
    // The exports are still there, and known by their hashes.
    let daemon = booth.start_ready();
    assert!(booth.path("export").join(format!("{ID}_a.obj")).is_file());
    let looked = booth.log().matches("scan-known").count();
    booth.export("55555555_z.obj", &coarse_body(1));
    booth.wait_for("the copy of an erased scan", || {
        booth.log().matches("scan-known").count() > looked
    });
    assert_erased(&booth);
    // Other bytes of the same body are a new scan of the person.
    booth.export(&format!("{ID}_f.obj"), &coarse_body(9));
    booth.wait_for("the new scan", || names(&booth.path("records").join(ID)).len() == 1);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_person_is_erased_while_no_station_runs() {
    let (booth, daemon) = booth();
    assert_eq!(daemon.stop().code(), Some(0));
    let (exit, said, shown) = erase(&booth);
    assert_eq!(exit, Some(0), "{said}{shown}");
    assert_erased(&booth);
    let log = booth.log();
    let daemon = booth.start_ready();
    // The heads of the history in the stores are new, too: the journal is not taken for an older copy.
    booth.export("4711_z.obj", &coarse_body(7));
    booth.wait_for("a record", || names(&booth.path("copy").join("4711")).len() == 1);
    let since = booth.log().split_off(log.len());
    assert!(!since.contains("journal-set-aside") && !since.contains("journal-ruined"), "{since}");
    assert_eq!(daemon.stop().code(), Some(0));
    assert_erased(&booth);
}

/// The station is killed once its own folder is cleared, while the verb waits, and started again or not.
#[test]
fn a_station_that_is_killed_in_the_middle_leaves_the_verb_asking_until_it_knows() {
    for starts_again in [true, false] {
        let (booth, daemon) = booth();
        let ((exit, said, shown), daemon) = thread::scope(|scope| {
            let verb = scope.spawn(|| erase(&booth));
            booth.wait_for("its own folder", || booth.log().contains("person-erased-here"));
            daemon.kill();
            let daemon = starts_again.then(|| booth.start_ready());
            (verb.join().unwrap(), daemon)
        });
        assert_eq!(exit, Some(0), "{said}{shown}\n{}", booth.log());
        assert!(said.contains("Erased.") && !said.contains("at the station"), "{said}");
        assert_erased(&booth);
        if let Some(daemon) = daemon {
            assert_eq!(daemon.stop().code(), Some(0));
        }
    }
}

#[test]
fn an_erasure_that_something_in_the_persons_folder_stops_keeps_no_record_from_the_store() {
    let (booth, daemon) = booth();
    let (folder, elsewhere) = (booth.path("copy").join(ID), booth.path("elsewhere"));
    fs::rename(&folder, &elsewhere).unwrap();
    symlink(&elsewhere, &folder).unwrap();
    let (_, said, shown) = erase(&booth);
    assert!(said.contains("copy"), "{said}{shown}");
    booth.wait_for("the attempt", || booth.log().contains("erasure-failed"));
    // The store takes another's record, and its own fault is none.
    booth.export("4711_z.obj", &coarse_body(7));
    booth.wait_for("a record", || names(&booth.path("copy").join("4711")).len() == 1);
    let status = booth.status();
    assert_eq!(status["stores"]["copy"]["fault"], Value::Null);
    let alarm = status["alarms"]["erasure-pending"]["message"].to_string();
    assert!(alarm.contains("copy") && !alarm.contains(ID), "{alarm}");
    assert_eq!(daemon.stop().code(), Some(0));
    // Put right, the next start ends it.
    fs::remove_file(&folder).unwrap();
    fs::rename(&elsewhere, &folder).unwrap();
    let daemon = booth.start_ready();
    booth.wait_for("its end", || booth.status()["alarms"]["erasure-pending"] == Value::Null);
    assert_erased(&booth);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn what_a_receiver_was_sent_is_disclosed_and_named_before_an_erasure_and_its_notes_go() {
    let booth = Booth::new();
    let messages = booth.path("messages");
    fs::create_dir(&messages).unwrap();
    booth.reconfigure(|config| {
        config + &format!("[store.hl7]\npath = \"{}\"\n", messages.display())
    });
    let daemon = booth.start_ready();
    for (file, number) in [("a", 1), ("b", 2)] {
        booth.export(&format!("{ID}_{file}.obj"), &coarse_body(number));
    }
    let sent = "SELECT count(*) FROM deliveries WHERE store = 'hl7' AND state = 'delivered'";
    booth.wait_for_journal(sent, 2);
    let sent = || {
        let mut all = files(&messages);
        all.retain(|path| path.extension().is_some_and(|ending| ending == "hl7"));
        all.sort();
        all
    };
    let [fetched, waiting] = &sent()[..] else { panic!("not two messages") };
    fs::remove_file(fetched).unwrap();

    let out = booth.path("access").display().to_string();
    let args = ["patient", "disclose", "--out", &out];
    let (exit, _, faults) = told(&booth, &args, &format!("{ID}\n"));
    assert_eq!(exit, Some(0), "{faults}");
    let person = fs::read(booth.path("access/person.json")).unwrap();
    let person: Value = serde_json::from_slice(&person).unwrap();
    let given = person["on_servers"].as_array().unwrap();
    let control = |path: &Path| path.file_stem().unwrap().to_str().unwrap().to_owned();
    for path in [fetched, waiting] {
        let of = given.iter().find(|of| of["reference"] == control(path).as_str()).unwrap();
        let unfetched = of["unfetched"].as_str().map(Path::new);
        assert_eq!(unfetched, (path == waiting).then_some(waiting.as_path()));
    }
    let page = fs::read_to_string(booth.path("access/index.html")).unwrap();
    assert!(page.contains(&control(fetched)) && page.contains("servers of the hospital"), "{page}");

    let (exit, said, shown) = erase(&booth);
    assert_eq!(exit, Some(0), "{said}{shown}");
    let (fetched, waiting) = (control(fetched), control(waiting));
    for part in [format!("{fetched}, given on"), format!("message {waiting} of")] {
        assert!(shown.contains(&part), "no {part:?} in:\n{shown}");
    }
    booth.wait_for_journal("SELECT count(*) FROM history WHERE event = 'erasure-ended'", 1);
    let notes = names(&booth.path("state/hl7-sent"));
    assert!(notes.is_empty(), "{notes:?}");
    let left = naming(&booth, &["state", "records"], ID);
    assert!(left.is_empty(), "{left:?}");
    assert_eq!(sent().len(), 1, "what was sent is the receiver's");
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_store_out_of_reach_is_waited_for_and_cleared_once_it_is_back() {
    let (booth, daemon) = booth();
    fs::rename(booth.path("copy"), booth.path("away")).unwrap();
    assert_eq!(daemon.stop().code(), Some(0));
    let (exit, said, shown) = erase(&booth);
    assert_eq!(exit, Some(74), "{said}{shown}");
    assert!(said.contains("copy"), "{said}");
    let daemon = booth.start_ready();
    let alarm = || booth.status()["alarms"]["erasure-pending"]["message"].clone();
    booth.wait_for("its alarm", || alarm().as_str().unwrap_or_default().contains("\"copy\""));
    assert!(!alarm().to_string().contains(ID));
    assert!(stdout(&booth.gaiter(&["status"])).contains("erasure-pending"));
    fs::rename(booth.path("away"), booth.path("copy")).unwrap();
    booth.wait_for("its end", || {
        booth.log().contains("person-erased-in-store") && {
            booth.status()["alarms"]["erasure-pending"] == Value::Null
        }
    });
    assert_erased(&booth);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_erased(&booth);
}

#[test]
fn nothing_is_erased_unless_the_id_comes_twice_in_the_same_way() {
    let (booth, daemon) = booth();
    let before = naming(&booth, &["state", "records", "copy"], ID).len();
    for lines in [format!("{ID}\n"), format!("{ID}\nyes\n"), format!("{ID}\n{OTHER}\n")] {
        let (exit, _, faults) = told(&booth, &["patient", "erase"], &lines);
        assert_eq!(exit, Some(64), "{faults}");
    }
    let (exit, _, faults) = told(&booth, &["patient", "erase", ID], "");
    assert_eq!(exit, Some(64), "{faults}");
    // While the patient is named for the next scan.
    let (named, _, faults) = told(&booth, &["patient", "set"], ID);
    assert_eq!(named, Some(0), "{faults}");
    let (exit, _, faults) = erase(&booth);
    assert_eq!(exit, Some(64), "{faults}");
    assert!(faults.contains("gaiter patient clear"), "{faults}");
    assert_eq!(naming(&booth, &["state", "records", "copy"], ID).len(), before);
    assert_eq!(booth.journal("SELECT count(*) FROM history WHERE event = 'erasing'"), Some(0));
    assert_eq!(daemon.stop().code(), Some(0));
}
