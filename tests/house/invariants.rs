//! The checker of the invariants can see: each of them is broken by hand, and found broken.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

use rig::invariants;
use rig::invariants::{
    Evidence, Moment, NOBODY, Put, PutKind, StatusCounts, Vitals, left_at, patient_of,
};
use rig::whole::{names, sha256};
use rusqlite::Connection;
use tempfile::TempDir;

const DELIVERED: &[u8] = b"v 1";
const REFUSED: &[u8] = b"v 2";
const SHORT: &[u8] = b"v";

/// A station at rest: a scan delivered and, for another patient, held; one refused; one awaited.
struct World {
    dir: TempDir,
    puts: Vec<Put>,
    log: String,
    told: Option<StatusCounts>,
    released: Vec<(String, String)>,
}

impl World {
    fn at_rest() -> World {
        let dir = TempDir::new().unwrap();
        for folder in ["export", "state/spool", "state/quarantine", "records/lost+found"] {
            fs::create_dir_all(dir.path().join(folder)).unwrap();
        }
        let log = "event=\"station-ready\"\n".to_owned();
        let mut world = World { dir, puts: vec![], log, told: None, released: vec![] };
        world.put("4711_a.obj", DELIVERED, PutKind::Whole);
        world.put("0815_a.obj", DELIVERED, PutKind::Whole);
        world.put("nobody.obj", DELIVERED, PutKind::Whole);
        world.put("4711_bad.obj", REFUSED, PutKind::Whole);
        world.put("4711_short.obj", SHORT, PutKind::Short);
        world.record("4711", "20261121T091500Z", DELIVERED);
        world.entry("spool", DELIVERED, "intake.json");
        world.entry("quarantine", REFUSED, "reason.json");
        world.journal(&format!(
            "CREATE TABLE scans (sha256, state, closed);
             CREATE TABLE deliveries (sha256, patient, state);
             INSERT INTO scans (sha256, state) VALUES ('{0}', 'delivered'), ('{1}', 'refused');
             INSERT INTO deliveries VALUES ('{0}', '4711', 'delivered'), ('{0}', '0815', 'held'),
                                           ('{1}', '4711', 'refused');",
            sha256(DELIVERED),
            sha256(REFUSED)
        ));
        world
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn put(&mut self, name: &str, bytes: &[u8], kind: PutKind) {
        let path = self.path("export").join(name);
        fs::write(&path, bytes).unwrap();
        self.puts.push(Put {
            name: name.to_owned(),
            patient: patient_of(name),
            sha256: sha256(bytes),
            kind,
            left: left_at(&path),
        });
    }

    fn record(&self, patient: &str, time: &str, bytes: &[u8]) -> PathBuf {
        let sum = sha256(bytes);
        let record = self.path("records").join(patient).join(format!("{time}_{}", &sum[..8]));
        fs::create_dir_all(&record).unwrap();
        fs::write(record.join("scan.obj"), bytes).unwrap();
        fs::write(record.join("SHA256SUMS"), format!("{sum}  scan.obj\n")).unwrap();
        record
    }

    fn entry(&self, folder: &str, bytes: &[u8], document: &str) -> PathBuf {
        let entry = self.path("state").join(folder).join(sha256(bytes));
        fs::create_dir_all(&entry).unwrap();
        fs::write(entry.join("scan.obj"), bytes).unwrap();
        fs::write(entry.join(document), r#"{"schema": "gaiter.test/1"}"#).unwrap();
        entry
    }

    fn journal(&self, statements: &str) {
        Connection::open(self.path("state/journal.db")).unwrap().execute_batch(statements).unwrap();
    }

    /// The invariants that do not hold, by number, each once.
    fn broken_at(&self, moment: Moment) -> Vec<u8> {
        let violations = invariants::violations(
            &Evidence {
                puts: &self.puts,
                released: &self.released,
                export: &self.path("export"),
                state: &self.path("state"),
                records: &self.path("records"),
                log: &self.log,
                planted: &["Mustermann"],
                told: self.told,
            },
            moment,
        );
        let mut broken: Vec<u8> = violations.iter().map(|violation| violation.invariant).collect();
        broken.sort_unstable();
        broken.dedup();
        broken
    }

    fn broken(&self) -> Vec<u8> {
        self.broken_at(Moment::Rest)
    }
}

fn remove(path: &Path) {
    fs::remove_dir_all(path).unwrap();
}

#[test]
fn a_station_at_rest_breaks_nothing() {
    assert_eq!(World::at_rest().broken(), [0; 0]);
}

#[test]
fn i1_a_scan_that_is_nowhere_is_seen() {
    let world = World::at_rest();
    remove(&world.path("records/4711"));
    assert_eq!(world.broken(), [1], "a lost record");
    assert_eq!(world.broken_at(Moment::Any), [0; 0], "not before the station had its time");

    let world = World::at_rest();
    remove(&world.path("state/quarantine").join(sha256(REFUSED)));
    assert_eq!(world.broken(), [1], "a lost refusal");

    let world = World::at_rest();
    world.journal("DELETE FROM deliveries WHERE state = 'held'");
    assert!(world.broken().contains(&1), "a decision nobody will be asked for");

    let world = World::at_rest();
    remove(&world.path("state/spool").join(sha256(DELIVERED)));
    assert_eq!(world.broken(), [1], "held, and its bytes gone");

    let mut world = World::at_rest();
    world.put("4711_huge.obj", b"v 9", PutKind::Huge);
    assert_eq!(world.broken(), [1], "too large, and not noted");
    let note = world.path("state/quarantine/unread-1");
    fs::create_dir(&note).unwrap();
    fs::write(note.join("reason.json"), r#"{"schema": "gaiter.reason/1"}"#).unwrap();
    assert_eq!(world.broken(), [0; 0]);
}

#[test]
fn i2_a_second_record_is_seen() {
    let world = World::at_rest();
    world.record("4711", "20261121T091501Z", DELIVERED);
    assert_eq!(world.broken(), [2], "the same again");

    let mut world = World::at_rest();
    world.record("0815", "20261121T091500Z", DELIVERED);
    assert_eq!(world.broken(), [2], "the held one delivered by itself");
    world.released = vec![("0815".to_owned(), sha256(DELIVERED))];
    assert_eq!(world.broken(), [0; 0], "released by a person");

    let world = World::at_rest();
    let record = world.path("records/4711");
    fs::rename(record, world.path("records/4712")).unwrap();
    assert!(world.broken().contains(&2), "for somebody whom nobody named");
}

#[test]
fn i3_something_partial_under_a_final_name_is_seen_at_any_moment() {
    let whole = |world: &World| {
        let patient = world.path("records/4711");
        patient.join(&names(&patient)[0])
    };
    let damages: [fn(&Path); 5] = [
        |record| fs::remove_file(record.join("SHA256SUMS")).unwrap(),
        |record| fs::remove_file(record.join("scan.obj")).unwrap(),
        |record| fs::write(record.join("scan.obj"), "v").unwrap(),
        |record| fs::write(record.join("more"), "").unwrap(),
        |record| fs::rename(record, record.with_file_name("20261121T091500Z_00000000")).unwrap(),
    ];
    for damage in damages {
        let world = World::at_rest();
        damage(&whole(&world));
        assert_eq!(world.broken_at(Moment::Any), [3]);
    }
    for (folder, bytes, document) in
        [("spool", DELIVERED, "intake.json"), ("quarantine", REFUSED, "reason.json")]
    {
        let damages: [fn(&Path, &str); 3] = [
            |entry, document| fs::write(entry.join(document), "{").unwrap(),
            |entry, document| fs::remove_file(entry.join(document)).unwrap(),
            |entry, _| fs::write(entry.join("scan.obj"), "v").unwrap(),
        ];
        for damage in damages {
            let world = World::at_rest();
            damage(&world.path("state").join(folder).join(sha256(bytes)), document);
            assert_eq!(world.broken_at(Moment::Any), [3], "{folder}");
        }
    }
}

#[test]
fn i4_a_touched_export_is_seen() {
    let damages: [fn(&Path); 5] = [
        |export| fs::remove_file(export.join("4711_a.obj")).unwrap(),
        |export| fs::write(export.join("4711_a.obj"), DELIVERED).unwrap(),
        |export| fs::rename(export.join("4711_a.obj"), export.join("4711_b.obj")).unwrap(),
        |export| {
            fs::copy(export.join("4711_a.obj"), export.join("x")).unwrap();
            fs::rename(export.join("x"), export.join("4711_a.obj")).unwrap();
        },
        |export| fs::write(export.join(".gaiter"), "").unwrap(),
    ];
    for damage in damages {
        let world = World::at_rest();
        damage(&world.path("export"));
        assert_eq!(world.broken(), [4]);
    }
    let mut world = World::at_rest();
    world.puts[0].left = None;
    fs::remove_file(world.path("export/4711_a.obj")).unwrap();
    assert_eq!(world.broken(), [0; 0], "what the scanner itself removed");
}

#[test]
fn i5_an_incomplete_scan_in_the_store_is_seen() {
    let world = World::at_rest();
    world.record("4711", "20261121T091500Z", SHORT);
    assert_eq!(world.broken(), [5]);
}

#[test]
fn i6_work_that_is_left_is_seen() {
    let world = World::at_rest();
    world.journal("UPDATE deliveries SET state = 'pending' WHERE state = 'delivered'");
    assert_eq!(world.broken(), [6], "a delivery");

    let world = World::at_rest();
    world.journal("UPDATE scans SET state = 'spooled' WHERE state = 'delivered'");
    assert_eq!(world.broken(), [6], "a scan");

    let world = World::at_rest();
    world.entry("spool", b"v 7", "intake.json");
    assert_eq!(world.broken(), [6], "spooled bytes");

    for rest in ["records/4711/.staging.x", "state/spool/.tmp-1", "state/quarantine/.tmp-1"] {
        let world = World::at_rest();
        fs::create_dir(world.path(rest)).unwrap();
        assert_eq!(world.broken(), [6], "{rest}");
    }

    let world = World::at_rest();
    fs::remove_file(world.path("state/journal.db")).unwrap();
    assert_eq!(world.broken(), [6], "no journal");
}

#[test]
fn i7_open_files_threads_and_memory_are_counted() {
    let myself = std::process::id();
    let before = Vitals::read(myself).unwrap();
    // More than all tests beside it close meanwhile.
    let open: Vec<_> = (0..400).map(|_| fs::File::open("/dev/null").unwrap()).collect();
    let memory = vec![1_u8; 64 << 20];
    let after = Vitals::read(myself).unwrap();
    assert!(after.files >= before.files + 200, "{before:?} {after:?}");
    assert!(after.resident_kb >= before.resident_kb + 50_000, "{before:?} {after:?}");
    assert!(after.threads > 0);
    drop((open, memory));
    assert_eq!(Vitals::read(u32::MAX), None);
}

#[test]
fn i8_a_name_in_the_log_is_seen() {
    for line in ["reading /export/4711_a.obj failed\n", "patient Mustermann\n"] {
        let mut world = World::at_rest();
        world.log.push_str(line);
        assert_eq!(world.broken(), [8]);
    }
}

#[test]
fn i9_a_station_that_tells_something_else_is_seen() {
    let mut world = World::at_rest();
    let so = StatusCounts { pending: 0, held: 1, refused: 1 };
    world.told = Some(so);
    assert_eq!(world.broken(), [0; 0]);
    for told in [
        StatusCounts { pending: 1, ..so },
        StatusCounts { held: 0, ..so },
        StatusCounts { refused: 0, ..so },
    ] {
        world.told = Some(told);
        assert_eq!(world.broken(), [9]);
    }
}

#[test]
fn a_name_is_read_as_the_stations_under_test_read_it() {
    let patients = ["4711_a.obj", "P1_a.obj", "nobody.obj", "1234567890123_a.obj", "_a.obj"];
    let expected = ["4711", "P1", NOBODY, NOBODY, NOBODY];
    assert_eq!(patients.map(patient_of), expected);
}
