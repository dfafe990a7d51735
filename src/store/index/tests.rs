#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::os::unix::fs::PermissionsExt;

use super::*;
use crate::flow::access::Access;

/// A store with records that are written by hand, and its index.
struct Case {
    dir: tempfile::TempDir,
    index: RecordIndex,
}

impl Case {
    fn new() -> Case {
        let dir = tempfile::tempdir().unwrap();
        let state = dir.path().join("state");
        fs::create_dir(&state).unwrap();
        let root = dir.path().join("records");
        let store = FolderStore::new(FolderStore::FIRST, root, "booth-1", Access::Private);
        store.make_root().unwrap();
        store.mark().unwrap();
        let index = RecordIndex::new(store, &state);
        Case { dir, index }
    }

    fn root(&self) -> PathBuf {
        self.dir.path().join("records")
    }

    /// Writes a record of day `day` of January 2027 for a patient.
    fn write(&self, folder: &str, patient: &str, day: u8, revision: u32) -> PathBuf {
        let suffix = if revision > 1 { format!("_r{revision}") } else { String::new() };
        let place =
            self.root().join(folder).join(format!("202701{day:02}T080000Z_{day:08x}{suffix}"));
        fs::create_dir_all(&place).unwrap();
        let patient = match patient {
            "" => "null".to_owned(),
            id => format!("{{\"id\": \"{id}\", \"sources\": []}}"),
        };
        let json = format!(
            "{{\"schema\": \"x\", \"revision\": {revision}, \"patient\": {patient},
              \"acquired\": {{\"at\": \"2027-01-{day:02}T08:00:00Z\", \"from\": \"press\"}},
              \"scan\": {{\"sha256\": \"{day:064x}\"}}, \"legs\": []}}"
        );
        fs::write(place.join(RECORD), json).unwrap();
        place
    }

    fn of(&self, patient: &str) -> RecordsOf {
        self.index.records_of(Some(patient)).unwrap()
    }

    /// The days of a patient's records, oldest first.
    fn days(&self, patient: &str) -> Vec<i8> {
        let of = self.of(patient);
        of.records.iter().map(|record| record.acquired.as_ref().unwrap().local().day()).collect()
    }

    /// The one file of the index.
    fn file(&self) -> PathBuf {
        let mut files = fs::read_dir(self.dir.path().join("state/record-index")).unwrap();
        let file = files.next().unwrap().unwrap().path();
        assert!(files.next().is_none());
        file
    }
}

#[test]
fn a_patients_records_come_oldest_first_with_their_latest_revisions() {
    let case = Case::new();
    for day in [7, 2, 5] {
        case.write("4711", "4711", day, 1);
    }
    let amended = case.write("4711", "4711", 5, 2);
    case.write("4712", "4712", 3, 1);
    for _ in 0..2 {
        assert_eq!(case.days("4711"), [2, 5, 7]);
        let second = case.of("4711").records.remove(1);
        assert_eq!((second.folder, second.revision), (amended.clone(), 2));
        assert_eq!(second.scan_sha256, format!("{:064x}", 5));
    }
    assert_eq!(case.days("4713"), [0; 0]);
}

#[test]
fn what_a_person_changes_in_the_store_is_noticed() {
    let case = Case::new();
    let place = case.write("4711", "4711", 2, 1);
    case.write("4711", "4711", 5, 1);
    assert_eq!(case.days("4711"), [2, 5]);
    // Added, changed in place without another size, renamed, moved away, removed.
    case.write("4711", "4711", 9, 1);
    assert_eq!(case.days("4711"), [2, 5, 9]);
    let json = fs::read_to_string(place.join(RECORD)).unwrap();
    fs::write(place.join(RECORD), json.replace("2027-01-02", "2027-01-07")).unwrap();
    assert_eq!(case.days("4711"), [5, 7, 9]);
    let renamed = place.with_file_name("20270103T080000Z_00000002");
    fs::rename(&place, &renamed).unwrap();
    assert_eq!(case.of("4711").records[1].folder, renamed);
    fs::create_dir(case.root().join("4712")).unwrap();
    fs::rename(&renamed, case.root().join("4712").join(renamed.file_name().unwrap())).unwrap();
    assert_eq!(case.days("4711"), [5, 9]);
    assert_eq!(case.of("4712").left_out[0].1, LeftOut::OfAnother, "it still names 4711");
    fs::remove_dir_all(case.root().join("4711")).unwrap();
    assert_eq!(case.of("4711"), RecordsOf::default());
}

#[test]
fn a_record_that_cannot_be_understood_is_named_and_read_again_once_it_can() {
    let case = Case::new();
    let place = case.write("4711", "4711", 2, 1);
    let json = fs::read(place.join(RECORD)).unwrap();
    fs::write(place.join(RECORD), "{").unwrap();
    assert_eq!(case.of("4711").left_out, [(place.clone(), LeftOut::Unreadable)]);
    fs::remove_file(place.join(RECORD)).unwrap();
    assert_eq!(case.of("4711").left_out, [(place.clone(), LeftOut::Unreadable)]);
    fs::write(place.join(RECORD), json).unwrap();
    assert_eq!(case.days("4711"), [2]);
}

#[test]
fn an_index_that_is_removed_or_damaged_is_made_anew() {
    let case = Case::new();
    case.write("4711", "4711", 2, 1);
    case.write("4711", "4711", 5, 1);
    assert_eq!(case.days("4711"), [2, 5]);
    let sound = fs::read_to_string(case.file()).unwrap();
    let damaged = ["", "{", "\u{0}", &sound.replacen("2027-01-02", "2027-01-09", 1)];
    for text in damaged {
        fs::write(case.file(), text).unwrap();
        assert_eq!(case.days("4711"), [2, 5]);
        assert_eq!(fs::read_to_string(case.file()).unwrap(), sound, "written again");
    }
    fs::remove_dir_all(case.file().parent().unwrap()).unwrap();
    assert_eq!(case.days("4711"), [2, 5]);
    assert_eq!(fs::read_to_string(case.file()).unwrap(), sound);
}

#[test]
fn an_index_that_holds_answers_without_a_record_being_opened() {
    let case = Case::new();
    let place = case.write("4711", "4711", 2, 1);
    assert_eq!(case.days("4711"), [2]);
    // The same state with other bytes: only one who opens the file would notice. The ctime cannot be set, so
    // the index is told the new one.
    let known = case.index.known(Some("4711"));
    let json = fs::read_to_string(place.join(RECORD)).unwrap();
    fs::write(place.join(RECORD), json.replace("2027-01-02", "2027-01-07")).unwrap();
    let state = sight(&place).unwrap().state.unwrap();
    case.index.keep(Some("4711"), &[Entry { state, ..known[0].clone() }]).unwrap();
    assert_eq!(case.days("4711"), [2]);
}

#[test]
fn the_index_names_no_patient_and_is_for_its_owner_only() {
    let case = Case::new();
    case.write("P-123456789", "P-123456789", 2, 1);
    case.of("P-123456789");
    let (file, mode) = (case.file(), |path: &Path| fs::metadata(path).unwrap().mode() & 0o777);
    assert!(!fs::read_to_string(&file).unwrap().contains("123456789"));
    assert!(!file.to_string_lossy().contains("123456789"));
    assert_eq!((mode(&file), mode(file.parent().unwrap())), (0o600, 0o700));
    case.index.forget(Some("P-123456789"));
    assert!(!file.exists());
}

#[test]
fn without_a_state_folder_the_answer_is_the_same() {
    let case = Case::new();
    case.write("4711", "4711", 2, 1);
    fs::remove_dir(case.dir.path().join("state")).unwrap();
    assert_eq!(case.days("4711"), [2]);
    assert!(!case.dir.path().join("state").exists(), "none is made");
    // Nor where it cannot be written.
    let state = case.dir.path().join("state");
    fs::create_dir(&state).unwrap();
    fs::write(state.join("record-index"), "").unwrap();
    fs::set_permissions(&state, fs::Permissions::from_mode(0o500)).unwrap();
    assert_eq!(case.days("4711"), [2]);
}

#[test]
fn unassigned_records_are_asked_for_by_no_patient() {
    let case = Case::new();
    let place = case.write("_unassigned", "", 2, 1);
    let of = case.index.records_of(None).unwrap();
    assert_eq!(of.records[0].folder, place);
}
