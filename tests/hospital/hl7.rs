//! Results of HL7 v2 at a receiver that reads and validates each by hl7apy.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use gaiter::store::TakeBack;
use gaiter::store::hl7::Hl7Way;
use gaiter_flow::ScanId;
use gaiter_leg::Side;
use gaiter_record::hl7::{Charset, Hl7Rules, PdfForm};

use crate::fhir_house::put;
use crate::hl7_house::{LONG, Message, Sender, message, rules, segments_named};
use crate::records::{PATIENT, SCANS, SMALL, Scan};
use crate::server::House;

/// The figures of a message by their codes, as they stand in it.
fn figures(message: &Message) -> BTreeMap<String, String> {
    let numbers = segments_named(message, "OBX").into_iter().filter(|obx| obx[2] == "NM");
    let figure = |obx: &Vec<String>| {
        assert_eq!((obx[6].as_str(), obx[11].as_str()), ("cm^cm^UCUM", "F"));
        (code(obx).to_owned(), obx[5].clone())
    };
    numbers.map(figure).collect()
}

fn code(obx: &[String]) -> &str {
    obx[3].split('^').next().unwrap()
}

/// The figures of a record's sheet by their codes in messages.
fn expected(scan: &Scan) -> BTreeMap<String, String> {
    let sides = [(Side::Right, 'R'), (Side::Left, 'L')].into_iter();
    sides
        .flat_map(|(side, letter)| {
            let sheet = scan.sheet(side).into_iter();
            sheet.map(move |(code, cm)| (format!("{code}-{letter}"), cm))
        })
        .collect()
}

#[test]
#[ignore = "needs Python with hl7apy, run by .ci/run"]
fn a_result_is_valid_in_every_version_with_all_figures_of_the_sheet_and_is_sent_once() {
    for version in ["2.3.1", "2.4", "2.5", "2.6"] {
        for scan in &*SCANS {
            let house = House::of_hl7();
            let rules = Hl7Rules { version: version.to_owned(), ..rules(&house.name) };
            let sender = Sender::new(house.way("plain", None, LONG), rules);
            sender.store.reach().unwrap();
            assert!(!put(&sender.store, scan).already_there);
            assert!(put(&sender.store, scan).already_there, "it is sent once");
            let messages = house.messages();
            let [message] = &messages[..] else { panic!("{}", messages.len()) };
            assert_eq!(figures(message), expected(scan), "{version}");
            assert_eq!(segments_named(message, "PID")[0][3], "4711^^^KIS^PI");
            let head = &message[0];
            assert_eq!((head[5].as_str(), head[11].as_str()), (r"House \T\ Co", version));
            let pdf = &segments_named(message, "OBX").last().unwrap()[5];
            assert!(pdf.starts_with("^application^pdf^Base64^JVBER"), "{version}");
        }
    }
}

#[test]
#[ignore = "needs Python with hl7apy, run by .ci/run"]
fn a_result_is_valid_in_either_character_set_and_form_of_the_pdf() {
    for (charset, pdf, begin) in [
        (Charset::Latin1, PdfForm::Plain, Some("^PDF^^Base64^JVBER")),
        (Charset::Latin1, PdfForm::None, None),
        (Charset::Utf8, PdfForm::Plain, Some("^PDF^^Base64^JVBER")),
    ] {
        let house = House::of_hl7();
        let rules = Hl7Rules { charset, pdf, ..rules(&house.name) };
        put(&Sender::new(house.way("plain", None, LONG), rules).store, &SCANS[1]);
        let path = house.path("messages/0001.hl7");
        let bytes = fs::read(path).unwrap();
        // The words for girths hold an umlaut in German.
        assert_eq!(String::from_utf8(bytes.clone()).is_ok(), charset == Charset::Utf8);
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let found = text.split('\r').find(|segment| segment.contains("|ED|"));
        assert_eq!(found.is_some(), begin.is_some());
        assert!(found.zip(begin).is_none_or(|(segment, begin)| segment.contains(begin)));
    }
}

#[test]
#[ignore = "needs Python with hl7apy, run by .ci/run"]
fn a_correction_is_one_and_a_take_back_marks_all_that_was_sent_as_wrong() {
    let house = House::of_hl7();
    let sender = house.sender(LONG);
    let store = &sender.store;
    put(store, &SMALL);
    assert!(!put(store, &SMALL.amended(391.0)).already_there);
    assert!(put(store, &SMALL).already_there, "an older revision is not sent again");
    let never = ScanId::parse(&"1".repeat(64)).unwrap();
    for scan in [&SMALL.id, &SMALL.id, &never] {
        store.withdraw(&TakeBack::new(scan, Some(PATIENT))).unwrap();
    }
    let all = house.messages();
    let [first, correction, withdrawn] = &all[..] else { panic!("{}", all.len()) };
    assert!(segments_named(correction, "OBX").iter().all(|obx| obx[11] == "C"));
    let c = segments_named(correction, "OBX").into_iter().find(|obx| code(obx) == "cC-R").unwrap();
    assert_eq!(c[5], "39.1");
    let codes = |message: &Message| -> Vec<String> {
        segments_named(message, "OBX").into_iter().map(|obx| code(obx).to_owned()).collect()
    };
    assert_eq!(codes(withdrawn), codes(correction));
    assert!(segments_named(withdrawn, "OBX").iter().all(|obx| obx[11] == "W" && obx[5].is_empty()));
    assert_eq!(segments_named(first, "OBR")[0][3], segments_named(withdrawn, "OBR")[0][3]);
    // The scan was this patient's after all.
    assert!(!put(store, &SMALL).already_there);
    assert_eq!(house.controls().len(), 4);
}

/// The message files of a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    paths.filter(|path| path.extension().is_some_and(|ending| ending == "hl7")).collect()
}

#[test]
fn a_folder_gets_each_message_once_as_a_whole_file() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("messages");
    let Sender { store, state } = Sender::new(Hl7Way::Files(folder.clone()), rules("KIS"));
    store.begin(true).unwrap();
    store.open().unwrap();
    assert!(!put(&store, &SCANS[1]).already_there);
    assert!(put(&store, &SCANS[1]).already_there);
    let found = files(&folder);
    let [path] = &found[..] else { panic!("{found:?}") };
    let message = message(path);
    assert_eq!(path.file_stem().unwrap().to_str(), Some(message[0][9].as_str()));
    assert_eq!(figures(&message), expected(&SCANS[1]));
    // What the receiver has taken away does not come again.
    fs::remove_file(path).unwrap();
    assert!(put(&store, &SCANS[1]).already_there);
    assert_eq!(files(&folder).len(), 0);
    // A folder that is not there is waited for, and nothing is made in its place.
    fs::rename(&folder, root.path().join("unmounted")).unwrap();
    assert!(store.reach().is_err());
    assert!(store.put(&SMALL.amended(391.0).delivery()).is_err());
    assert!(!folder.exists() && state.path().exists());
    fs::rename(root.path().join("unmounted"), &folder).unwrap();
    put(&store, &SMALL.amended(391.0));
    assert_eq!(files(&folder).len(), 1);
}

#[test]
#[ignore = "a thousand durable deliveries, run by .ci/run"]
fn a_replay_of_a_thousand_deliveries_leaves_each_message_once() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("messages");
    let sender = Sender::new(Hl7Way::Files(folder.clone()), rules("KIS"));
    sender.store.begin(true).unwrap();
    let scans: Vec<Scan> = (0..1000).map(|number| SMALL.numbered(number)).collect();
    for round in 0..2 {
        for scan in &scans {
            assert_eq!(put(&sender.store, scan).already_there, round == 1);
        }
        assert_eq!(files(&folder).len(), 1000);
    }
}
