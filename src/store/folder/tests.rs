//! The folder store on real folders.

use gaiter_flow::ScanId;
use gaiter_record::{Acquired, AcquiredFrom, FIRST_REVISION, ImagingRequest, RecordFile};

use super::*;
use crate::store::StoredScan;
use crate::store::sums::SumsFault;

struct Case {
    dir: tempfile::TempDir,
    scan_file: PathBuf,
    scan: ScanId,
    files: Vec<RecordFile>,
}

impl Case {
    fn new() -> Case {
        let bytes = b"v 0 0 0\n".to_vec();
        let scan = sums::scan_id(&bytes);
        let record = b"{}".to_vec();
        let listing = format!("{}  record.json\n{scan}  scan.obj\n", sums::scan_id(&record));
        let file = |name: &str, bytes| RecordFile { name: name.to_owned(), bytes };
        let files = vec![file("record.json", record), file(SUMS, listing.into_bytes())];
        let dir = tempfile::tempdir().unwrap();
        let scan_file = dir.path().join("spooled.obj");
        fs::write(&scan_file, bytes).unwrap();
        fs::create_dir(dir.path().join("records")).unwrap();
        let case = Case { dir, scan_file, scan, files };
        case.store().begin(false).unwrap();
        case
    }

    fn store(&self) -> FolderStore {
        FolderStore::new("folder", self.dir.path().join("records"), "booth-1", Access::Private)
    }

    fn delivery(&self) -> Delivery<'_> {
        let first_seen = "2026-11-21T09:15:00Z".parse().unwrap();
        Delivery {
            scan: &self.scan,
            patient: Some("4711"),
            person: None,
            first_seen,
            revision: FIRST_REVISION,
            turn: 0,
            files: &self.files,
            scan_file: &self.scan_file,
            ending: "obj",
        }
    }

    fn place(&self) -> PathBuf {
        self.dir.path().join(format!("records/4711/20261121T091500Z_{}", self.scan.short()))
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_record_put_twice_is_there_once_and_whole() {
    let case = Case::new();
    let first = case.store().put(&case.delivery()).unwrap();
    assert_eq!(first, Receipt { folder: case.place(), already_there: false });
    let again = case.store().put(&case.delivery()).unwrap();
    assert_eq!(again, Receipt { folder: case.place(), already_there: true });
    assert_eq!(names(&case.place()), ["SHA256SUMS", "record.json", "scan.obj"]);
    assert_eq!(names(&case.dir.path().join("records/4711")).len(), 1);
    assert_eq!(sums::check(&case.place(), &case.scan).unwrap(), Ok(()));
}

#[test]
fn a_person_s_note_in_the_folder_does_not_matter() {
    let case = Case::new();
    case.store().put(&case.delivery()).unwrap();
    fs::write(case.place().join("note.txt"), "left leg in a cast").unwrap();
    assert!(case.store().put(&case.delivery()).unwrap().already_there);
}

#[test]
fn an_occupied_place_is_a_permanent_fault_and_never_overwritten() {
    let case = Case::new();
    case.store().put(&case.delivery()).unwrap();
    let record = case.place().join("record.json");
    fs::write(&record, "changed by hand").unwrap();
    let fault = case.store().put(&case.delivery()).unwrap_err();
    let expected = SumsFault::Differs { name: "record.json".to_owned() };
    assert!(
        matches!(&fault, StoreFault::Permanent(Rejection::Occupied(f)) if *f == expected),
        "{fault:?}"
    );
    assert_eq!(fs::read(&record).unwrap(), b"changed by hand");

    fs::remove_file(&record).unwrap();
    let fault = case.store().put(&case.delivery()).unwrap_err();
    assert_eq!(fault.code(), "store-place-occupied");
    fs::remove_file(case.place().join(SUMS)).unwrap();
    let fault = case.store().put(&case.delivery()).unwrap_err();
    assert!(matches!(fault, StoreFault::Permanent(Rejection::Occupied(SumsFault::NoSums))));
    fs::create_dir(case.place().join(SUMS)).unwrap();
    let fault = case.store().put(&case.delivery()).unwrap_err();
    assert!(matches!(fault, StoreFault::Permanent(Rejection::Occupied(SumsFault::NoSums))));
    assert_eq!(case.store().records().unwrap(), [], "one odd record does not hide the store");
}

#[test]
fn another_scan_in_the_place_is_seen() {
    let case = Case::new();
    case.store().put(&case.delivery()).unwrap();
    let other = sums::scan_id(b"other bytes");
    assert_eq!(sums::check(&case.place(), &other).unwrap(), Err(SumsFault::OtherScan));
}

#[test]
fn what_a_crash_left_staged_is_cleared_and_other_stations_staging_is_not() {
    let case = Case::new();
    let patient = case.dir.path().join("records/4711");
    for station in ["booth-1", "booth-1-b"] {
        let staged = patient.join(format!(".staging.{station}.20261121T091500Z_01234567"));
        fs::create_dir_all(&staged).unwrap();
        fs::write(staged.join("record.json"), "{").unwrap();
    }
    case.store().open().unwrap();
    assert_eq!(names(&patient), [".staging.booth-1-b.20261121T091500Z_01234567"]);
}

#[test]
fn a_half_staged_attempt_does_not_hinder_the_next() {
    let case = Case::new();
    let name = format!(".staging.booth-1.20261121T091500Z_{}", case.scan.short());
    let staged = case.dir.path().join("records/4711").join(name);
    fs::create_dir_all(&staged).unwrap();
    fs::write(staged.join("record.json"), "{").unwrap();
    assert!(!case.store().put(&case.delivery()).unwrap().already_there);
    assert_eq!(names(&case.dir.path().join("records/4711")).len(), 1);
}

#[test]
fn a_missing_root_is_a_share_that_is_not_mounted_and_is_not_made() {
    let case = Case::new();
    let gone = case.dir.path().join("share");
    let store = FolderStore::new("folder", gone.clone(), "booth-1", Access::Private);
    let fault = store.put(&case.delivery()).unwrap_err();
    assert_eq!(fault.code(), "store-unavailable");
    assert!(!gone.exists());
    // Nor is anything written into the empty place that it leaves.
    fs::create_dir(&gone).unwrap();
    let fault = store.put(&case.delivery()).unwrap_err();
    assert_eq!(fault.code(), "store-unavailable");
    assert_eq!(names(&gone), [""; 0]);
}

#[test]
fn a_record_without_sums_or_with_a_name_that_leaves_its_folder_is_refused() {
    let mut case = Case::new();
    let listing = case.files.pop().unwrap();
    let fault = case.store().put(&case.delivery()).unwrap_err();
    assert!(matches!(fault, StoreFault::Permanent(Rejection::NoSums)));
    for name in ["../x", ".hidden", "a/b", "", "ä"] {
        case.files = vec![
            RecordFile { name: name.to_owned(), bytes: Vec::new() },
            RecordFile { name: SUMS.to_owned(), bytes: listing.bytes.clone() },
        ];
        let fault = case.store().put(&case.delivery()).unwrap_err();
        assert!(matches!(fault, StoreFault::Permanent(Rejection::FileName { .. })), "{name}");
    }
    assert_eq!(names(&case.dir.path().join("records")), [".gaiter-store"]);
}

#[test]
fn spooled_bytes_that_are_not_the_scan_s_make_no_record() {
    let case = Case::new();
    fs::write(&case.scan_file, "v 0 0 1\n").unwrap();
    let fault = case.store().put(&case.delivery()).unwrap_err();
    assert!(matches!(fault, StoreFault::Permanent(Rejection::OtherBytes)), "{fault:?}");
    assert_eq!(names(&case.dir.path().join("records/4711")), [""; 0]);
}

#[test]
fn a_scan_that_is_seen_again_for_the_first_time_is_not_stored_twice() {
    let case = Case::new();
    case.store().put(&case.delivery()).unwrap();
    let later = "2027-01-01T00:00:00Z".parse().unwrap();
    let again = case.store().put(&Delivery { first_seen: later, ..case.delivery() }).unwrap();
    assert_eq!(again, Receipt { folder: case.place(), already_there: true });
}

#[test]
fn a_record_that_another_station_stores_meanwhile_is_found_and_not_stored_twice() {
    let case = Case::new();
    let root = case.dir.path().join("records");
    let elsewhere = root.join("4711").join(format!("20261121T091459Z_{}", case.scan.short()));
    let mark = fs::OpenOptions::new().write(true).open(root.join(MARK)).unwrap();
    mark.lock().unwrap();
    let receipt = std::thread::scope(|threads| {
        let put = threads.spawn(|| case.store().put(&case.delivery()));
        let staged = root
            .join("4711")
            .join(format!(".staging.booth-1.20261121T091500Z_{}", case.scan.short()));
        while !staged.join(SUMS).exists() && !put.is_finished() {
            std::thread::yield_now();
        }
        // The other station's turn: its record comes under the time at which it saw the scan.
        fs::create_dir(&elsewhere).unwrap();
        fs::copy(&case.scan_file, elsewhere.join("scan.obj")).unwrap();
        for file in &case.files {
            fs::write(elsewhere.join(&file.name), &file.bytes).unwrap();
        }
        mark.unlock().unwrap();
        put.join().unwrap().unwrap()
    });
    assert_eq!(receipt, Receipt { folder: elsewhere, already_there: true });
    assert_eq!(names(&root.join("4711")).len(), 1, "nothing is left staged");
}

#[test]
fn two_stations_that_store_a_scan_at_once_make_one_record() {
    for _ in 0..50 {
        let case = Case::new();
        let root = case.dir.path().join("records");
        std::thread::scope(|threads| {
            for (station, first_seen) in [("booth-1", 0), ("booth-2", 1), ("booth-3", 1)] {
                let store = FolderStore::new("folder", root.clone(), station, Access::Private);
                let mut delivery = case.delivery();
                delivery.first_seen += jiff::SignedDuration::from_secs(first_seen);
                threads.spawn(move || store.put(&delivery).unwrap());
            }
        });
        assert_eq!(names(&root.join("4711")).len(), 1);
    }
}

#[test]
fn every_record_in_the_store_is_found_and_nothing_else() {
    let case = Case::new();
    case.store().put(&case.delivery()).unwrap();
    case.store().put(&Delivery { patient: None, ..case.delivery() }).unwrap();
    for stray in ["notes", "4711/.staging.booth-1.x", "4711/20261121T091500Z_deadbeef", "%zz/x"] {
        fs::create_dir_all(case.dir.path().join("records").join(stray)).unwrap();
    }
    let found = case.store().records().unwrap();
    let whose: Vec<Option<String>> = found.iter().map(|record| record.patient.clone()).collect();
    assert_eq!(found.len(), 2);
    assert!(whose.contains(&None) && whose.contains(&Some("4711".to_owned())), "{whose:?}");
    assert!(found.iter().all(|record| record.scan == case.scan && record.size == 8));
    assert!(found.iter().all(|record| record.first_seen == case.delivery().first_seen));
}

#[test]
fn a_record_tells_when_its_scan_was_taken_and_which_request_it_answers_for_its_own_patient() {
    let mut case = Case::new();
    let record = br#"{"patient": {"id": "4711", "sources": [{"kind": "reader", "request":
        {"study_instance_uid": "1.2.276.4711", "accession_number": "A1"}}]}, "revision": 1,
        "acquired": {"at": "2026-11-21T09:14:00Z", "from": "press"}, "legs": []}"#;
    let listing = format!("{}  record.json\n{}  scan.obj\n", sums::scan_id(record), case.scan);
    let file = |name: &str, bytes| RecordFile { name: name.to_owned(), bytes };
    case.files = vec![file("record.json", record.to_vec()), file(SUMS, listing.into_bytes())];
    case.store().put(&case.delivery()).unwrap();
    case.store().put(&Delivery { patient: Some("0815"), ..case.delivery() }).unwrap();
    let at = "2026-11-21T09:14:00Z".parse().unwrap();
    let taken = Some(Acquired::new(at, AcquiredFrom::Press));
    let found = case.store().records().unwrap();
    assert!(found.len() == 2 && found.iter().all(|of| of.acquired == taken), "{found:?}");
    let mut requests: Vec<_> =
        found.into_iter().map(|of| (of.patient.unwrap(), of.request)).collect();
    requests.sort();
    let theirs = ImagingRequest::new("1.2.276.4711", "A1");
    assert_eq!(requests, [("0815".to_owned(), None), ("4711".to_owned(), theirs)]);
    // What a person has done to it hides no record.
    fs::write(case.place().join("record.json"), "changed by hand").unwrap();
    let found = case.store().records().unwrap();
    let told: Vec<bool> = found.iter().map(|of| of.acquired.is_some()).collect();
    assert_eq!(told.iter().filter(|told| **told).count(), 1, "{found:?}");
    assert_eq!(told.len(), 2);
}

#[test]
fn a_record_for_nobody_is_taken_back_with_its_notes_once_the_patient_has_it() {
    let case = Case::new();
    let nobody = Delivery { patient: None, ..case.delivery() };
    let old = case.store().put(&nobody).unwrap().folder;
    fs::write(old.join("note.txt"), "left leg in a cast").unwrap();
    let stored = case.store().stored_scan(&case.scan, None).unwrap().unwrap();
    assert_eq!(stored, StoredScan { bytes: b"v 0 0 0\n".to_vec(), ord: None });
    let early = case
        .store()
        .withdraw(&TakeBack { keeper: Some("4711"), ..TakeBack::new(&case.scan, None) });
    assert!(early.is_err() && old.exists(), "nobody has it yet");

    let new = case.store().put(&case.delivery()).unwrap().folder;
    for _ in 0..2 {
        case.store()
            .withdraw(&TakeBack { keeper: Some("4711"), ..TakeBack::new(&case.scan, None) })
            .unwrap();
        assert!(!old.exists());
        assert_eq!(fs::read_to_string(new.join("note.txt")).unwrap(), "left leg in a cast");
    }
    assert_eq!(case.store().stored_scan(&case.scan, None).unwrap(), None);
}

#[test]
fn a_record_for_nobody_that_somebody_changed_is_left_as_it_is() {
    let case = Case::new();
    let old = case.store().put(&Delivery { patient: None, ..case.delivery() }).unwrap().folder;
    case.store().put(&case.delivery()).unwrap();
    fs::write(old.join("record.json"), "changed by hand").unwrap();
    let fault = case
        .store()
        .withdraw(&TakeBack { keeper: Some("4711"), ..TakeBack::new(&case.scan, None) })
        .unwrap_err();
    assert_eq!(fault.code(), "store-place-occupied");
    assert_eq!(fs::read(old.join("record.json")).unwrap(), b"changed by hand");
}

/// The place of a later revision, written as re-extraction would: another record, the same scan.
fn revised(case: &Case, number: u32) -> PathBuf {
    let place =
        case.place().with_file_name(format!("20261121T091500Z_{}_r{number}", case.scan.short()));
    fs::create_dir(&place).unwrap();
    let record = format!("{{\"revision\": {number}}}").into_bytes();
    let listing = format!("{}  record.json\n{}  scan.obj\n", sums::scan_id(&record), case.scan);
    fs::write(place.join("record.json"), record).unwrap();
    fs::write(place.join("scan.obj"), "v 0 0 0\n").unwrap();
    fs::write(place.join(SUMS), listing).unwrap();
    place
}

#[test]
fn a_record_with_revisions_is_put_once_and_found_once() {
    let case = Case::new();
    case.store().put(&case.delivery()).unwrap();
    let second = revised(&case, 2);
    revised(&case, 10);
    let there = Receipt { folder: case.place(), already_there: true };
    assert_eq!(case.store().put(&case.delivery()).unwrap(), there);
    let later = "2027-01-01T00:00:00Z".parse().unwrap();
    let delivery = Delivery { first_seen: later, ..case.delivery() };
    assert_eq!(case.store().put(&delivery).unwrap(), there);
    let found = |folder: &Path| {
        let records = case.store().records().unwrap();
        assert_eq!(records.len(), 1, "{records:?}");
        assert_eq!((&records[0].scan, records[0].folder.as_path()), (&case.scan, folder));
    };
    found(&case.place());
    // A person who removes the first record leaves the scan recorded by its revisions.
    fs::remove_dir_all(case.place()).unwrap();
    found(&second);
    let again = case.store().put(&delivery).unwrap();
    assert_eq!(again, Receipt { folder: second, already_there: true });
    assert!(case.store().stored_scan(&case.scan, Some("4711")).unwrap().is_some());
}

#[test]
fn a_record_is_taken_back_with_all_its_revisions_and_their_notes() {
    let case = Case::new();
    let keeper = case.store().put(&Delivery { patient: None, ..case.delivery() }).unwrap().folder;
    let first = case.store().put(&case.delivery()).unwrap().folder;
    let second = revised(&case, 2);
    for place in [&first, &second, &revised(&case, 3)] {
        fs::write(place.join("note.txt"), place.to_string_lossy().as_bytes()).unwrap();
    }
    case.store().withdraw(&TakeBack::new(&case.scan, Some("4711"))).unwrap();
    assert_eq!(names(&case.dir.path().join("records/4711")), [""; 0]);
    let notes: Vec<String> =
        names(&keeper).into_iter().filter(|name| name.contains("note")).collect();
    let short = case.scan.short();
    let named = |number| format!("20261121T091500Z_{short}_r{number}.note.txt");
    assert_eq!(notes, [named(2), named(3), "note.txt".to_owned()]);
    let second = second.to_string_lossy().into_owned();
    assert_eq!(fs::read_to_string(keeper.join(named(2))).unwrap(), second);
}

#[test]
fn notes_of_one_name_go_from_record_to_record_and_none_is_lost_or_doubled() {
    let case = Case::new();
    let (theirs, nobodys) = (case.delivery(), Delivery { patient: None, ..case.delivery() });
    let mut folder = case.store().put(&theirs).unwrap().folder;
    for round in 0..7 {
        let unassigned = case.store().put(&nobodys).unwrap().folder;
        fs::write(unassigned.join("note.txt"), format!("{}", round % 3)).unwrap();
        case.store().withdraw(&TakeBack::new(&case.scan, Some("4711"))).unwrap();
        folder = case.store().put(&theirs).unwrap().folder;
        case.store()
            .withdraw(&TakeBack { keeper: Some("4711"), ..TakeBack::new(&case.scan, None) })
            .unwrap();
    }
    let record = folder.file_name().unwrap().to_str().unwrap();
    let named = |number: &str| format!("{record}{number}.note.txt");
    let notes: Vec<String> =
        names(&folder).into_iter().filter(|name| name.contains("note")).collect();
    assert_eq!(notes, [named(".2"), named(""), "note.txt".to_owned()]);
    let read = |name: &String| fs::read_to_string(folder.join(name)).unwrap();
    let mut said: Vec<String> = notes.iter().map(read).collect();
    said.sort();
    assert_eq!(said, ["0", "1", "2"]);
}

#[test]
fn what_is_in_the_way_of_one_record_is_no_fault_of_the_store() {
    let case = Case::new();
    let records = case.dir.path().join("records");
    fs::write(records.join("0815"), "a file").unwrap();
    let fault = case.store().put(&Delivery { patient: Some("0815"), ..case.delivery() });
    assert_eq!(fault.unwrap_err().code(), "store-place-occupied");

    let kept = case.store().put(&Delivery { patient: None, ..case.delivery() }).unwrap().folder;
    case.store().put(&case.delivery()).unwrap();
    let stone = format!(".staging.booth-1.withdrawn_{}", case.scan.short());
    let stone = records.join("_unassigned").join(stone);
    fs::write(&stone, "a file").unwrap();
    let fault = case
        .store()
        .withdraw(&TakeBack { keeper: Some("4711"), ..TakeBack::new(&case.scan, None) })
        .unwrap_err();
    assert!(matches!(fault, StoreFault::Permanent(Rejection::InTheWay { .. })), "{fault:?}");
    assert!(kept.exists());
    fs::remove_file(stone).unwrap();
    case.store()
        .withdraw(&TakeBack { keeper: Some("4711"), ..TakeBack::new(&case.scan, None) })
        .unwrap();
    assert!(!kept.exists());

    // The store itself is another matter.
    let mark = records.join(MARK);
    fs::remove_file(&mark).unwrap();
    fs::create_dir(&mark).unwrap();
    let fault = case.store().put(&Delivery { patient: Some("4712"), ..case.delivery() });
    assert_eq!(fault.unwrap_err().code(), "store-unavailable");
}

#[test]
fn where_one_revision_was_changed_by_hand_none_is_taken_back() {
    let case = Case::new();
    case.store().put(&Delivery { patient: None, ..case.delivery() }).unwrap();
    let first = case.store().put(&case.delivery()).unwrap().folder;
    let second = revised(&case, 2);
    fs::write(second.join("record.json"), "changed by hand").unwrap();
    let fault = case.store().withdraw(&TakeBack::new(&case.scan, Some("4711"))).unwrap_err();
    assert_eq!(fault.code(), "store-place-occupied");
    assert!(first.exists() && second.exists());
}

#[test]
fn a_patients_folder_that_is_a_link_takes_and_gives_nothing() {
    let case = Case::new();
    let records = case.dir.path().join("records");
    fs::create_dir(records.join("0815")).unwrap();
    std::os::unix::fs::symlink("0815", records.join("4711")).unwrap();
    let fault = case.store().put(&case.delivery()).unwrap_err();
    assert_eq!(fault.code(), "patient-folder-is-a-link");
    assert_eq!(names(&records.join("0815")), [""; 0]);
    // Nor is another patient's record taken back through it.
    let theirs = case.store().put(&Delivery { patient: Some("0815"), ..case.delivery() }).unwrap();
    let fault = case
        .store()
        .withdraw(&TakeBack { keeper: Some("0815"), ..TakeBack::new(&case.scan, Some("4711")) })
        .unwrap_err();
    assert_eq!(fault.code(), "patient-folder-is-a-link");
    assert!(theirs.folder.exists());
    assert!(case.store().stored_scan(&case.scan, Some("4711")).is_err());
}

#[test]
fn ids_that_differ_in_case_only_are_refused_and_never_merged() {
    let case = Case::new();
    let delivery = |id| Delivery { patient: Some(id), ..case.delivery() };
    for id in ["P1", "p2"] {
        case.store().put(&delivery(id)).unwrap();
    }
    for id in ["p1", "P2"] {
        let fault = case.store().put(&delivery(id)).unwrap_err();
        assert_eq!(fault.code(), "patient-folder-clash", "{id}");
    }
    let records = case.dir.path().join("records");
    assert_eq!(names(&records), [".gaiter-store", "P1", "p2"], "no empty folder is left");
    assert!(case.store().put(&delivery("P1")).unwrap().already_there);
    assert_eq!(case.store().stored_scan(&case.scan, Some("p1")).unwrap(), None);
}

#[test]
fn an_erasure_that_was_cut_off_while_it_removed_a_record_is_carried_on_to_its_end() {
    let case = Case::new();
    let store = case.store();
    store.put(&case.delivery()).unwrap();
    // The station ended between the renaming of the record and its removal, later than the erasure was asked for.
    let folder = case.dir.path().join("records/4711");
    fs::rename(case.place(), folder.join(".staging.booth-1.erasing")).unwrap();
    store.erase("4711", "2026-11-22T09:15:00Z".parse().unwrap(), &[]).unwrap();
    assert!(!folder.exists(), "{:?}", names(&folder));
}
