//! Revisions on real folders.

use super::*;
use crate::store::sums::{self, SUMS};

struct Store {
    dir: tempfile::TempDir,
}

impl Store {
    /// A store with these record folders, each with one file.
    fn with(records: &[&str]) -> Store {
        let dir = tempfile::tempdir().unwrap();
        for record in records {
            let folder = dir.path().join(record);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("record.json"), "{}").unwrap();
        }
        Store { dir }
    }

    fn at(&self, place: &str) -> PathBuf {
        self.dir.path().join(place)
    }

    /// The latest folders of the families at a place.
    fn latest(&self, place: &str) -> Vec<String> {
        let of = |family: &Family| {
            let folder = &family.latest().1;
            folder.strip_prefix(self.dir.path()).unwrap().to_string_lossy().into_owned()
        };
        families(&self.at(place)).unwrap().iter().map(of).collect()
    }

    fn names(&self, place: &str) -> Vec<String> {
        let entries = fs::read_dir(self.at(place)).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

fn files() -> Vec<RecordFile> {
    let file = |name: &str, bytes: &[u8]| RecordFile { name: name.into(), bytes: bytes.to_vec() };
    let sums = format!("{}  scan.obj\n", sums::scan_id(b"v"));
    vec![file("scan.obj", b"v"), file(SUMS, sums.as_bytes())]
}

const A: &str = "4711/20261121T091500Z_01234567";
const A2: &str = "4711/20261121T091500Z_01234567_r2";
const A10: &str = "4711/20261121T091500Z_01234567_r10";
const B: &str = "_unassigned/20261121T091500Z_89abcdef";

#[test]
fn records_are_found_in_a_store_at_a_patient_and_alone_and_nothing_else_is() {
    let staged = "4711/.reextract.1.20261121T091500Z_01234567_r11";
    let store = Store::with(&[A, A10, A2, B, "notes/x", "%zz/20261121T091500Z_89abcdef", staged]);
    assert_eq!(store.latest(""), [A10, B]);
    assert_eq!(store.latest("4711"), [A10]);
    assert_eq!(
        [A, A2, A10].map(|record| latest(&store.at(record))),
        [A10; 3].map(|of| store.at(of))
    );
    let elsewhere = store.at("nobody/20261121T091500Z_01234567");
    assert_eq!(latest(&elsewhere), elsewhere);
    assert_eq!((store.latest(A), store.latest(A2)), (vec![A10.into()], vec![A10.into()]));
    assert_eq!(store.latest("notes"), [""; 0]);
    assert!(families(&store.at("missing")).is_err());
    let patients = families(&store.at("")).unwrap();
    let patients: Vec<_> = patients.iter().map(|family| family.patient().unwrap()).collect();
    assert_eq!(patients, [Some("4711".to_owned()), None]);
}

#[test]
fn a_revision_lies_whole_beside_the_others_and_replaces_none() {
    let store = Store::with(&[A]);
    let family = families(&store.at(A)).unwrap().remove(0);
    assert_eq!(family.add(2, &files()).unwrap(), Added::There(store.at(A2)));
    let scan = sums::scan_id(b"v");
    assert_eq!(sums::check(&store.at(A2), &scan).unwrap(), Ok(()));
    let error = family.add(2, &files()).unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::AlreadyExists);
    assert_eq!(store.names("4711").len(), 2, "{:?}", store.names("4711"));
}

#[test]
fn where_the_record_was_taken_back_meanwhile_no_revision_of_it_is_left() {
    let store = Store::with(&[A, A2]);
    let family = families(&store.at(A)).unwrap().remove(0);
    let staged = store.at("4711/.reextract.1.x");
    write(&staged, &files(), &store.at(A2)).unwrap();
    // A station takes it back between the writing and the name.
    [A, A2].iter().for_each(|record| fs::remove_dir_all(store.at(record)).unwrap());
    let place = store.at("4711/20261121T091500Z_01234567_r3");
    assert_eq!(
        publish(&staged, place, &store.at(A2), &store.at("4711")).unwrap(),
        Added::Withdrawn
    );
    assert_eq!(store.names("4711"), [".reextract.1.x"]);
    assert!(family.add(3, &files()).is_err(), "there is nobody whose it could be");
    assert_eq!(store.names("4711"), [".reextract.1.x"]);
}

#[test]
fn what_a_killed_run_left_staged_is_cleared_and_what_a_living_one_holds_is_not() {
    let (dead, held) = ("4711/.reextract.1.x", "4711/.reextract.2.y");
    let store = Store::with(&[A, dead, held, "4711/.staging.booth-1.z"]);
    let lock = File::open(store.at(held)).unwrap();
    flock(&lock, FlockOperation::LockExclusive).unwrap();
    clear_staging(&store.at("4711")).unwrap();
    let left = [".reextract.2.y", ".staging.booth-1.z", "20261121T091500Z_01234567"];
    assert_eq!(store.names("4711"), left);
}
