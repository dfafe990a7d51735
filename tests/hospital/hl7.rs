//! Results of HL7 v2 at a receiver that reads and validates each by hl7apy.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::time::Duration;

use gaiter::flow::ScanId;
use gaiter::flow::server::TlsFiles;
use gaiter::flow::server::hl7::Way;
use gaiter::language::Language;
use gaiter::leg::{Level, Side};
use gaiter::record::hl7::{Charset, Hl7Rules, PdfForm};
use gaiter::record::measure::Measure;
use gaiter::record::report::Mark;
use gaiter::record::rounding::cm_words;
use gaiter::sizes::Garment;
use gaiter::store::{Hl7Store, Misfit, StoreFault};
use tempfile::TempDir;

use crate::fhir::{SCAN, Scan, scan_of};
use crate::server::{Server, certificates};

fn rules(version: &str) -> Hl7Rules {
    Hl7Rules {
        sender: ["GAITER".to_owned(), "booth-1".to_owned()],
        receiver: ["KIS".to_owned(), "House & Co".to_owned()],
        processing: 'P',
        version: version.to_owned(),
        authority: "KIS".to_owned(),
        coding: "99GTR".to_owned(),
        pdf: PdfForm::MediaType,
        charset: Charset::Utf8,
        language: Language::De,
        garment: Garment::default(),
    }
}

fn way(server: &Server, tls: Option<TlsFiles>) -> Way {
    let host = "localhost".to_owned();
    Way::Mllp { host, port: server.port(), tls, limit: Duration::from_secs(3) }
}

/// A store with a state folder of its own.
fn store(server: &Server, version: &str) -> (Hl7Store, TempDir) {
    let state = tempfile::tempdir().unwrap();
    (Hl7Store::new(way(server, None), rules(version), state.path()), state)
}

/// The messages that the receiver has found valid, in their order.
fn messages(server: &Server) -> Vec<Vec<Vec<String>>> {
    assert!(
        !server.path("faults").exists(),
        "{}",
        fs::read_to_string(server.path("faults")).unwrap()
    );
    let mut paths: Vec<_> =
        fs::read_dir(server.path("messages")).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| fields(&fs::read_to_string(path).unwrap())).collect()
}

fn fields(message: &str) -> Vec<Vec<String>> {
    let segments = message.split('\r').filter(|segment| !segment.is_empty());
    segments.map(|segment| segment.split('|').map(str::to_owned).collect()).collect()
}

fn of<'a>(message: &'a [Vec<String>], name: &str) -> Vec<&'a Vec<String>> {
    message.iter().filter(|segment| segment[0] == name).collect()
}

fn put(store: &Hl7Store, scan: &Scan) -> bool {
    store.put(&scan.delivery()).unwrap_or_else(|fault| panic!("{fault}")).already_there
}

#[test]
#[ignore = "needs Python with hl7apy, run by .ci/run"]
fn a_result_is_valid_in_every_version_with_all_figures_of_the_sheet_and_is_sent_once() {
    let server = Server::hl7(false, |_| {});
    let bodies = ["f_average_clean", "f_average_tc2", "m_average_clean"];
    let mut count = 0;
    for version in ["2.3.1", "2.4", "2.5", "2.6"] {
        for body in bodies {
            let scan = scan_of(body, "4711");
            let (store, _state) = store(&server, version);
            store.reach().unwrap();
            assert!(!put(&store, &scan));
            assert!(put(&store, &scan), "it is sent once");
            count += 1;
            let all = messages(&server);
            assert_eq!(all.len(), count);
            let message = all.last().unwrap();
            let mut told = Vec::new();
            for obx in of(message, "OBX").into_iter().filter(|obx| obx[2] == "NM") {
                told.push((obx[3].split('^').next().unwrap().to_owned(), obx[5].clone()));
                assert_eq!((obx[6].as_str(), obx[11].as_str()), ("cm^cm^UCUM", "F"));
            }
            told.sort();
            let mut expected = Vec::new();
            for (side, letter) in [(Side::Right, 'R'), (Side::Left, 'L')] {
                for level in Level::ALL {
                    let Ok(measure) = Measure::of(&scan.record, side, level) else { continue };
                    for (what, length) in [('c', Some(measure.girth)), ('l', measure.height)] {
                        let length = length.filter(|of| measure.mark_of(*of) != Mark::Estimated);
                        let Some(length) = length else { continue };
                        let code = format!("{what}{}-{letter}", level.name());
                        expected.push((code, cm_words(length.mm, Language::En)));
                    }
                }
            }
            expected.sort();
            assert_eq!(told, expected, "{version} {body}");
            assert_eq!(of(message, "PID")[0][3], "4711^^^KIS^PI");
            assert_eq!(of(message, "MSH")[0][5], r"House \T\ Co");
            assert!(of(message, "OBX").last().unwrap()[5].starts_with("^application^pdf^Base64^"));
        }
    }
}

#[test]
#[ignore = "needs Python with hl7apy, run by .ci/run"]
fn a_message_whose_answer_is_lost_is_sent_again_with_the_same_control_id() {
    let server = Server::hl7(false, |_| {});
    let (store, _state) = store(&server, "2.5");
    for (mode, said) in [
        ("hang", "no whole answer within 3 s"),
        ("half", "cannot be reached"),
        ("cut-after", "cannot be reached"),
        ("garbage", "no acknowledgement"),
        ("huge", "more than 262144 bytes"),
        ("other", "for another message"),
        ("locked", "cannot take the message now: AE: 206"),
    ] {
        server.becomes(mode);
        match store.put(&SCAN.delivery()) {
            Err(StoreFault::Server(fault)) => {
                assert!(fault.to_string().contains(said), "{mode}: {fault}");
            }
            other => panic!("{mode}: {other:?}"),
        }
    }
    server.becomes("");
    assert!(!put(&store, &SCAN));
    assert!(put(&store, &SCAN));
    let all = messages(&server);
    let controls: Vec<&str> = all.iter().map(|of| of[0][9].as_str()).collect();
    assert_eq!(controls.len(), 8);
    assert!(controls.iter().all(|control| *control == controls[0]), "{controls:?}");
}

#[test]
#[ignore = "needs Python with hl7apy, run by .ci/run"]
fn a_refused_message_waits_for_a_person_with_the_receivers_reason() {
    let server = Server::hl7(false, |_| {});
    let (store, _state) = store(&server, "2.5");
    for code in ["AE", "AR", "CE"] {
        server.becomes(code);
        match store.put(&SCAN.delivery()) {
            Err(StoreFault::Permanent(Misfit::ReceiverRefused { code: found, why })) => {
                assert_eq!((found.as_str(), why.as_str()), (code, "the patient has no open case"));
            }
            other => panic!("{other:?}"),
        }
    }
    server.becomes("");
    assert!(!put(&store, &SCAN));
}

#[test]
#[ignore = "needs Python with hl7apy, run by .ci/run"]
fn a_correction_is_one_and_a_take_back_marks_all_that_was_sent_as_wrong() {
    let server = Server::hl7(false, |_| {});
    let (store, _state) = store(&server, "2.5");
    put(&store, &SCAN);
    let later = SCAN.amended(391.0);
    assert!(!put(&store, &later));
    assert!(put(&store, &SCAN), "an older revision is not sent again");
    store.withdraw(&SCAN.id, Some("4711")).unwrap();
    store.withdraw(&SCAN.id, Some("4711")).unwrap();
    store.withdraw(&ScanId::parse(&"1".repeat(64)).unwrap(), Some("4711")).unwrap();
    let all = messages(&server);
    let [first, correction, withdrawn] = &all[..] else { panic!("{}", all.len()) };
    assert!(of(correction, "OBX").iter().all(|obx| obx[11] == "C"));
    let c = of(correction, "OBX").into_iter().find(|obx| obx[3].starts_with("cC-R^")).unwrap();
    assert_eq!(c[5], "39.1");
    let codes = |message: &[Vec<String>]| -> Vec<String> {
        let obx = of(message, "OBX").into_iter();
        obx.map(|obx| obx[3].split('^').next().unwrap().to_owned()).collect()
    };
    assert_eq!(codes(withdrawn), codes(correction));
    assert!(of(withdrawn, "OBX").iter().all(|obx| obx[11] == "W" && obx[5].is_empty()));
    assert_eq!(of(first, "OBR")[0][3], of(withdrawn, "OBR")[0][3]);
    // The scan was this patient's after all.
    assert!(!put(&store, &SCAN));
}

#[test]
#[ignore = "needs Python with hl7apy and openssl, run by .ci/run"]
fn an_encrypted_receiver_must_have_the_right_certificate() {
    let server = Server::hl7(true, certificates);
    let state = tempfile::tempdir().unwrap();
    let of = |authorities: Option<&Path>| {
        let tls = TlsFiles { authorities: authorities.map(Path::to_owned), own: None };
        Hl7Store::new(way(&server, Some(tls)), rules("2.5"), state.path())
    };
    assert!(!put(&of(Some(&server.path("ca.pem"))), &SCAN));
    let told = of(None).reach().unwrap_err().to_string();
    assert!(told.contains("UnknownIssuer") || told.contains("no certificates"), "{told}");
    assert_eq!(messages(&server).len(), 1);
}

#[test]
fn a_folder_gets_each_message_once_as_a_whole_file() {
    let (state, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let way = Way::Files(folder.path().to_owned());
    let store = Hl7Store::new(way, rules("2.5"), state.path());
    store.begin(true).unwrap();
    assert!(!put(&store, &SCAN));
    assert!(put(&store, &SCAN));
    let mut files = fs::read_dir(folder.path()).unwrap();
    let file = files.next().unwrap().unwrap();
    assert!(files.next().is_none());
    let message = fields(&fs::read_to_string(file.path()).unwrap());
    assert_eq!(file.file_name().to_str().unwrap(), format!("{}.hl7", message[0][9]));
    // What the receiver has taken away does not come again.
    fs::remove_file(file.path()).unwrap();
    assert!(put(&store, &SCAN));
    fs::remove_dir(folder.path()).unwrap();
    assert!(store.reach().is_err());
    fs::create_dir(folder.path()).unwrap();
}
