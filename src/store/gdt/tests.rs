//! The GDT store on real folders: every place where it can be cut off, and a practice software that
//! deletes what it has read.

use std::fs;
use std::path::{Path, PathBuf};

use gaiter_record::gdt::{AttachmentFields, Charset, Reference};
use gaiter_record::{FIRST_REVISION, RecordFile};
use gaiter_sizes::Garment;
use support::records::without_legs;

use super::*;
use crate::store::sums;

struct Case {
    dir: tempfile::TempDir,
    names: &'static str,
    attach: Attach,
}

impl Case {
    fn new(names: &'static str) -> Case {
        let attach = Attach { files: Vec::new(), reference: Reference::Full, root: String::new() };
        let case = Case { dir: tempfile::tempdir().unwrap(), names, attach };
        fs::create_dir(case.dir.path().join("state")).unwrap();
        fs::write(case.scan_file(), "v 0 0 0\n").unwrap();
        case.store().begin(true).unwrap();
        case
    }

    /// As a station finds it after a start.
    fn store(&self) -> GdtStore {
        let rules = GdtRules {
            receiver: "PRAX_EDV".into(),
            sender: "LEGSCAN1".into(),
            version: "02.10".into(),
            charset: Charset::Cp1252,
            procedure: "ALLG00".into(),
            attachment_fields: AttachmentFields::default(),
        };
        let names = FileName::new(self.names, &rules.receiver, &rules.sender).unwrap();
        let state = self.dir.path().join("state");
        let (rules, place) = ((rules, Garment::default(), self.attach.clone()), self.exchange());
        let store = GdtStore::new(place, names, rules, ("booth-1", state), TimeZone::UTC);
        if self.staging().exists() {
            store.open().unwrap();
        }
        store
    }

    fn exchange(&self) -> PathBuf {
        self.dir.path().join("exchange")
    }

    fn staging(&self) -> PathBuf {
        self.exchange().join(".gaiter.booth-1")
    }

    fn scan_file(&self) -> PathBuf {
        self.dir.path().join("spooled.obj")
    }

    /// What the practice software sees, and takes away.
    fn fetch(&self) -> Vec<(String, Vec<u8>)> {
        let mut fetched = Vec::new();
        for name in visible(&self.exchange()) {
            let path = self.exchange().join(&name);
            fetched.push((name, fs::read(&path).unwrap()));
            fs::remove_file(path).unwrap();
        }
        fetched
    }

    fn put(&self, patient: Option<&str>, scan: &[u8]) -> Result<Receipt, StoreFault> {
        self.put_by(&self.store(), patient, scan)
    }

    fn put_by(
        &self,
        store: &GdtStore,
        patient: Option<&str>,
        scan: &[u8],
    ) -> Result<Receipt, StoreFault> {
        let scan = sums::scan_id(scan);
        store.put(&Delivery {
            scan: &scan,
            patient,
            person: None,
            first_seen: "2026-11-21T09:15:00Z".parse().unwrap(),
            revision: FIRST_REVISION,
            turn: 0,
            files: &files(patient, &scan),
            scan_file: &self.scan_file(),
            ending: "obj",
        })
    }
}

fn files(patient: Option<&str>, scan: &ScanId) -> Vec<RecordFile> {
    let record = without_legs(scan.as_str(), patient, FIRST_REVISION);
    let file = |name: &str, bytes: &[u8]| RecordFile { name: name.into(), bytes: bytes.into() };
    vec![file("record.json", &record), file("legs.svg", b"<svg/>"), file(sums::SUMS, b"")]
}

fn visible(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let names = names.map(|name| name.into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| !name.starts_with('.')).collect();
    names.sort();
    names
}

const FIXED: &str = "{receiver}{sender}.GDT";
const COUNTED: &str = "{receiver}{sender}.{counter}";

#[test]
fn a_result_is_handed_over_once_although_its_file_goes_away() {
    let case = Case::new(FIXED);
    let first = case.put(Some("4711"), b"a").unwrap();
    assert_eq!(first.folder, case.exchange().join("PRAXLEGS.GDT"));
    assert!(!first.already_there);
    // Before it is fetched, and after; in one run and in the next.
    assert!(case.put(Some("4711"), b"a").unwrap().already_there);
    let fetched = case.fetch();
    assert_eq!(fetched.len(), 1);
    let message = String::from_utf8_lossy(&fetched[0].1).into_owned();
    assert!(message.contains("0133000") && message.contains("30004711\r\n"), "{message}");
    assert!(message.contains("620021112026\r\n") && message.contains("6201091400\r\n"));
    let again = case.put(Some("4711"), b"a").unwrap();
    assert_eq!(again, Receipt { already_there: true, ..first });
    assert_eq!(case.fetch(), []);
}

#[test]
fn a_result_that_was_not_fetched_is_never_overwritten() {
    let case = Case::new(FIXED);
    let store = case.store();
    case.put_by(&store, Some("4711"), b"a").unwrap();
    let waiting = fs::read(case.exchange().join("PRAXLEGS.GDT")).unwrap();
    for _ in 0..2 {
        let fault = case.put_by(&store, Some("0815"), b"b").unwrap_err();
        assert_eq!(fault.code(), "result-not-fetched");
        assert_eq!(store.reach().unwrap_err().code(), "result-not-fetched");
    }
    assert_eq!(fs::read(case.exchange().join("PRAXLEGS.GDT")).unwrap(), waiting);
    assert_eq!(case.fetch().len(), 1);
    store.reach().unwrap();
    assert!(!case.put_by(&store, Some("0815"), b"b").unwrap().already_there);
    let fetched = case.fetch();
    assert!(String::from_utf8_lossy(&fetched[0].1).contains("30000815"));
}

#[test]
fn numbered_results_wait_beside_each_other_and_go_on_after_a_start() {
    let case = Case::new(COUNTED);
    for scan in [b"a", b"b"] {
        case.put(Some("4711"), scan).unwrap();
    }
    assert_eq!(visible(&case.exchange()), ["PRAXLEGS.001", "PRAXLEGS.002"]);
    case.fetch();
    case.put(Some("4711"), b"c").unwrap();
    assert_eq!(visible(&case.exchange()), ["PRAXLEGS.003"]);
}

#[test]
fn after_the_last_number_comes_the_first_free_one() {
    let case = Case::new(COUNTED);
    let free = |last: u16| case.store().free_name(last).unwrap().1;
    fs::write(case.exchange().join("PRAXLEGS.001"), "").unwrap();
    assert_eq!(
        (free(0), free(998), free(999)),
        ("PRAXLEGS.002".into(), "PRAXLEGS.999".into(), "PRAXLEGS.002".into())
    );
}

/// Cut off while the message was being staged: there is a piece of it, and no entry.
#[test]
fn half_a_staged_result_is_made_anew() {
    let case = Case::new(FIXED);
    let staged = case
        .staging()
        .join(format!("{}.staged", key(&sums::scan_id(b"a"), "4711", FIRST_REVISION)));
    fs::write(&staged, "0138000").unwrap();
    assert!(!case.put(Some("4711"), b"a").unwrap().already_there);
    assert!(!staged.exists());
    assert!(case.fetch()[0].1.len() > 100);
    fs::write(&staged, "0138000").unwrap();
    let other = case.staging().join("01234567-89abcdef.staged");
    fs::write(&other, "0138000").unwrap();
    let _ = case.store();
    assert!(!other.exists(), "the start clears what is not registered");
}

/// Cut off between the entry and the rename: it is staged whole and was never seen.
#[test]
fn a_registered_result_that_is_still_staged_is_given_its_name() {
    let case = Case::new(FIXED);
    case.put(Some("4711"), b"a").unwrap();
    let [(name, message)] = case.fetch().try_into().unwrap();
    let staged = case
        .staging()
        .join(format!("{}.staged", key(&sums::scan_id(b"a"), "4711", FIRST_REVISION)));
    fs::write(&staged, &message).unwrap();
    assert_eq!(case.store().records().unwrap(), [], "it was not handed over");
    assert!(!case.put(Some("4711"), b"a").unwrap().already_there);
    assert_eq!(case.fetch(), [(name, message)]);
    assert_eq!(case.store().records().unwrap().len(), 1);
    assert!(case.put(Some("4711"), b"a").unwrap().already_there);
}

/// Cut off between the rename and the receipt, and the practice software was quick.
#[test]
fn a_registered_result_that_is_gone_was_handed_over() {
    let case = Case::new(COUNTED);
    case.put(Some("4711"), b"a").unwrap();
    assert_eq!(case.fetch().len(), 1);
    assert!(case.put(Some("4711"), b"a").unwrap().already_there);
    assert_eq!(case.fetch(), []);
}

#[test]
fn a_share_that_is_not_mounted_says_nothing_of_what_was_handed_over() {
    let case = Case::new(FIXED);
    let store = case.store();
    case.put_by(&store, Some("4711"), b"a").unwrap();
    fs::rename(case.exchange(), case.dir.path().join("away")).unwrap();
    for made in [false, true] {
        if made {
            fs::create_dir(case.exchange()).unwrap();
        }
        for scan in [b"a", b"b"] {
            let fault = case.put_by(&store, Some("4711"), scan).unwrap_err();
            assert_eq!(fault.code(), "store-unavailable");
        }
        assert!(store.reach().is_err() && store.records().is_err());
    }
    // Nor does a folder under the right name that is not the one that was begun.
    fs::create_dir(case.staging()).unwrap();
    assert!(store.reach().is_err());
    assert_eq!(visible(&case.exchange()), [""; 0]);
}

#[test]
fn a_journal_that_was_lost_finds_what_was_handed_over() {
    let case = Case::new(COUNTED);
    case.put(Some("4711"), b"a").unwrap();
    case.put(Some("0815"), b"a").unwrap();
    case.fetch();
    let mut found = case.store().records().unwrap();
    found.sort_by(|a, b| a.patient.cmp(&b.patient));
    let whose: Vec<Option<&str>> = found.iter().map(|record| record.patient.as_deref()).collect();
    assert_eq!(whose, [Some("0815"), Some("4711")]);
    let expected = FoundRecord {
        scan: sums::scan_id(b"a"),
        patient: Some("4711".into()),
        request: None,
        acquired: None,
        first_seen: "2026-11-21T09:15:00Z".parse().unwrap(),
        format: "obj".into(),
        size: 8,
        folder: case.exchange().join("PRAXLEGS.001"),
    };
    assert_eq!(found[1], expected);
}

#[test]
fn what_is_nobody_s_or_another_s_is_not_handed_over() {
    let case = Case::new(FIXED);
    let fault = case.put(None, b"a").unwrap_err();
    assert!(matches!(fault, StoreFault::Permanent(Rejection::Unassigned)));
    let scan = sums::scan_id(b"a");
    let others = Delivery {
        scan: &scan,
        patient: Some("4711"),
        person: None,
        first_seen: Timestamp::UNIX_EPOCH,
        revision: FIRST_REVISION,
        turn: 0,
        files: &files(Some("0815"), &scan),
        scan_file: &case.scan_file(),
        ending: "obj",
    };
    let fault = case.store().put(&others).unwrap_err();
    assert!(matches!(fault, StoreFault::Permanent(Rejection::OtherPatient)));
    let fault = case.store().put(&Delivery { files: &[], ..others }).unwrap_err();
    assert!(matches!(fault, StoreFault::Permanent(Rejection::NoRecord)));
    let fault = case.put(Some("Ł"), b"a").unwrap_err();
    assert_eq!(fault.code(), "store-misfit");
    assert_eq!(visible(&case.exchange()), [""; 0]);
    assert_eq!(case.store().records().unwrap(), []);
}

#[test]
fn attachments_lie_there_before_the_result_and_are_told_as_the_practice_sees_them() {
    for (folder, reference, root, told) in [
        ("", Reference::Full, r"\\srv\gdt\", r"\\srv\gdt\KEY_legs.svg"),
        ("anhang", Reference::Full, r"G:\gdt", r"G:\gdt\anhang\KEY_legs.svg"),
        ("anhang", Reference::Relative, r"G:\gdt", r"anhang\KEY_legs.svg"),
        ("anhang", Reference::Name, "", "KEY_legs.svg"),
    ] {
        let mut case = Case::new(FIXED);
        let file = |name: &str| Attached { folder: folder.into(), name: name.into() };
        let files = vec![file("legs.svg"), file("not-there.pdf")];
        case.attach = Attach { files, reference, root: root.into() };
        case.put(Some("4711"), b"a").unwrap();
        let key = key(&sums::scan_id(b"a"), "4711", FIRST_REVISION);
        let file = case.exchange().join(folder).join(format!("{key}_legs.svg"));
        assert_eq!(fs::read(&file).unwrap(), b"<svg/>");
        let message = fs::read(case.exchange().join("PRAXLEGS.GDT")).unwrap();
        let message = String::from_utf8_lossy(&message);
        let told = told.replace("KEY", &key);
        let line = format!("{:03}6305{told}\r\n", told.len() + 9);
        assert!(message.ends_with(&line), "{message}");
        assert!(message.contains("6303SVG\r\n"), "{message}");
    }
}

#[test]
fn no_file_or_folder_is_called_after_the_patient() {
    let mut case = Case::new(COUNTED);
    case.attach.files = vec![Attached { folder: String::new(), name: "legs.svg".into() }];
    case.put(Some("987654"), b"a").unwrap();
    let handed_over = case.dir.path().join("state/handed-over");
    for name in visible(&case.exchange()).into_iter().chain(visible(&handed_over)) {
        assert!(!name.contains("987654"), "{name}");
    }
}

#[test]
fn nothing_is_seen_of_a_result_that_could_not_be_registered() {
    let case = Case::new(FIXED);
    let key = key(&sums::scan_id(b"a"), "4711", FIRST_REVISION);
    let hindrance = case.dir.path().join(format!("state/handed-over/.{key}.json"));
    fs::create_dir_all(&hindrance).unwrap();
    let store = case.store();
    for _ in 0..2 {
        let fault = case.put_by(&store, Some("4711"), b"a").unwrap_err();
        assert_eq!(fault.code(), "store-unavailable");
        assert_eq!(visible(&case.exchange()), [""; 0]);
    }
    fs::remove_dir(&hindrance).unwrap();
    assert!(!case.put_by(&store, Some("4711"), b"a").unwrap().already_there);
    assert_eq!(case.fetch().len(), 1);
}
