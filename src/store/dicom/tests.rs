//! The store against an archive of a few lines: what it sends, and what it makes of each answer.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use gaiter_dicom::SopClass;
use gaiter_dicom::dimse::{AeTitle, DimseFault, Titles};
use gaiter_flow::worklist::ListedPerson;
use gaiter_https::{HttpFault, TlsFiles};
use gaiter_record::RecordFile;
use serde_json::{Value, json};
use support::http_server::{answer, request_of, serve};
use support::records::{dicom_rules, without_legs};

use super::*;
use crate::store::sums;

/// What an archive does with objects.
#[derive(Debug, Clone, Copy)]
enum Mode {
    Keep,
    /// It answers as if it had kept them.
    Lose,
    /// It keeps all but reports, for this reason.
    RefuseReport(u16),
    /// It keeps them, and its answer is a fault.
    KeepAndFail,
    /// It answers so to everything.
    Say(&'static str, &'static str),
}

/// An archive on this machine, and the requests for storing that it had, of an object each.
struct Archive {
    port: u16,
    mode: Arc<Mutex<Mode>>,
    stored: Arc<Mutex<usize>>,
}

/// The value of a UID in a file of DICOM.
fn uid(file: &str, tag: &str) -> String {
    let at = file.find(&format!("{tag}UI")).unwrap() + tag.len() + 2;
    let length = usize::from(file.as_bytes()[at]);
    file[at + 2..at + 2 + length].trim_end_matches('\0').to_owned()
}

/// The objects in a request, as a search shows them.
fn sent(request: &str) -> Vec<Value> {
    let files = request.split("DICM").skip(1);
    let shown = |file: &str| {
        let of = |tag: &str| json!({ "vr": "UI", "Value": [uid(file, tag)] });
        json!({
            "00080016": of("\x08\0\x16\0"),
            "00080018": of("\x08\0\x18\0"),
            "0020000E": of("\x20\0\x0e\0"),
        })
    };
    files.map(shown).collect()
}

impl Archive {
    fn new() -> Archive {
        let (mode, stored) = (Arc::new(Mutex::new(Mode::Keep)), Arc::new(Mutex::new(0)));
        let (asked, count) = (Arc::clone(&mode), Arc::clone(&stored));
        let mut kept: Vec<Value> = Vec::new();
        let port = serve(move |mut stream| {
            let Ok(request) = request_of(&mut stream) else { return };
            let mode = *asked.lock().unwrap();
            let is_search = request.starts_with("GET ");
            *count.lock().unwrap() += usize::from(!is_search);
            let done = |body: Value| answer("200 OK", &body.to_string());
            let answer = match mode {
                Mode::Say(status, body) => answer(status, body),
                _ if is_search => done(json!(kept)),
                Mode::Lose => done(json!({})),
                Mode::Keep | Mode::KeepAndFail => {
                    kept.extend(sent(&request));
                    match mode {
                        Mode::Keep => done(json!({ "00081198": { "vr": "SQ" } })),
                        _ => answer("503 Service Unavailable", "restarting 4711"),
                    }
                }
                Mode::RefuseReport(reason) => {
                    let all = sent(&request).into_iter();
                    let is_report = |of: &Value| of["00080016"]["Value"][0] == SopClass::Pdf.uid();
                    let (refused, taken): (Vec<Value>, Vec<Value>) = all.partition(is_report);
                    kept.extend(taken);
                    let why = json!({ "00081197": { "vr": "US", "Value": [reason] } });
                    let failed = json!({ "00081198": { "Value": vec![why; refused.len()] } });
                    let status = if refused.is_empty() { "200 OK" } else { "409 Conflict" };
                    answer(status, &failed.to_string())
                }
            };
            let _ = stream.write_all(answer.as_bytes());
        });
        Archive { port, mode, stored }
    }

    fn becomes(&self, mode: Mode) {
        *self.mode.lock().unwrap() = mode;
    }

    /// How often it was asked to store something.
    fn stored(&self) -> usize {
        *self.stored.lock().unwrap()
    }

    fn store(&self) -> DicomStore {
        let server = DicomServer {
            way: DicomWay::Web {
                base: format!("http://127.0.0.1:{}/dicom-web", self.port),
                access: DicomAccess::Open,
                tls: TlsFiles::default(),
            },
            limit: Duration::from_secs(30),
        };
        DicomStore::new(server, dicom_rules(&["report.pdf"]), "booth-1")
    }
}

fn scan() -> ScanId {
    sums::scan_id(b"v 0 0 0\n")
}

fn put(store: &DicomStore, patient: &str, revision: u32) -> Result<Receipt, StoreFault> {
    let record = without_legs(scan().as_str(), Some(patient), revision);
    put_record(store, (patient, None), revision, &record)
}

/// Puts a record of 4711 that answers the request of this study.
fn put_answering(
    store: &DicomStore,
    study: &str,
    person: Option<&ListedPerson>,
) -> Result<Receipt, StoreFault> {
    let record = without_legs(scan().as_str(), Some("4711"), 1);
    let mut record: Value = serde_json::from_slice(&record).unwrap();
    record["patient"]["sources"][0]["request"] = json!({ "study_instance_uid": study });
    put_record(store, ("4711", person), 1, record.to_string().as_bytes())
}

fn put_record(
    store: &DicomStore,
    (patient, person): (&str, Option<&ListedPerson>),
    revision: u32,
    record: &[u8],
) -> Result<Receipt, StoreFault> {
    let file = |name: &str, bytes: &[u8]| RecordFile { name: name.into(), bytes: bytes.into() };
    store.put(&Delivery {
        scan: &scan(),
        patient: Some(patient),
        person,
        first_seen: "2026-11-21T09:15:00Z".parse().unwrap(),
        revision,
        files: &[file("record.json", record), file("report.pdf", b"%PDF-1.7")],
        scan_file: Path::new("/nowhere"),
        ending: "obj",
    })
}

fn withdraw(store: &DicomStore, receipt: Option<&str>) -> Result<(), StoreFault> {
    store.withdraw(&scan(), Some("4711"), None, receipt, None)
}

#[test]
fn a_record_is_stored_once_and_a_later_revision_beside_it() {
    let archive = Archive::new();
    let store = archive.store();
    store.reach().unwrap();
    let first = put(&store, "4711", 1).unwrap();
    assert!(!first.already_there);
    let again = put(&store, "4711", 1).unwrap();
    assert_eq!((again.already_there, &again.folder), (true, &first.folder));
    assert_eq!(archive.stored(), 2);
    assert!(!put(&store, "4711", 2).unwrap().already_there);
    assert_eq!(archive.stored(), 4);
    // At most two looks before, and two after.
    assert!(store.step_most() > Duration::from_secs(30) * (2 + 4));
}

#[test]
fn a_lost_answer_or_a_half_stored_record_is_completed_by_the_next_try() {
    let archive = Archive::new();
    let store = archive.store();
    archive.becomes(Mode::KeepAndFail);
    let fault = put(&store, "4711", 1).unwrap_err();
    assert!(matches!(fault, StoreFault::Server(ServerFault::Busy { status: 503, .. })), "{fault}");
    assert!(!fault.to_string().contains("4711"), "{fault}");
    archive.becomes(Mode::Keep);
    assert_eq!(archive.stored(), 1);
    assert!(!put(&store, "4711", 1).unwrap().already_there);
    assert_eq!(archive.stored(), 2, "what is there is not sent again");
    archive.becomes(Mode::RefuseReport(0xa700));
    let fault = put(&store, "4711", 2).unwrap_err();
    assert_eq!(fault.code(), "store-unavailable", "{fault}");
    archive.becomes(Mode::Keep);
    assert!(!put(&store, "4711", 2).unwrap().already_there);
}

#[test]
fn an_archive_that_says_yes_and_shows_nothing_has_stored_nothing() {
    let archive = Archive::new();
    archive.becomes(Mode::Lose);
    let fault = put(&archive.store(), "4711", 1).unwrap_err();
    assert!(matches!(fault, StoreFault::Server(ServerFault::Answer(_))), "{fault}");
    assert!(fault.to_string().contains("it does not show 2 of 2 objects"), "{fault}");
}

#[test]
fn an_object_that_the_archive_will_never_store_waits_for_a_person() {
    let archive = Archive::new();
    archive.becomes(Mode::RefuseReport(0x0122));
    let fault = put(&archive.store(), "4711", 1).unwrap_err();
    assert_eq!(fault.code(), "server-refused");
    assert!(fault.to_string().contains("1 of 2 objects were not stored, reason 0122"), "{fault}");
}

#[test]
fn a_withdrawn_record_is_marked_once_and_can_be_given_again() {
    let archive = Archive::new();
    let store = archive.store();
    let receipt = put(&store, "4711", 1).unwrap().folder;
    let receipt = receipt.to_str();
    for _ in 0..2 {
        withdraw(&store, receipt).unwrap();
        assert_eq!(archive.stored(), 3);
    }
    assert!(!put(&store, "4711", 1).unwrap().already_there);
    assert!(put(&store, "4711", 1).unwrap().already_there);
    withdraw(&store, receipt).unwrap();
    assert_eq!(archive.stored(), 6);
}

#[test]
fn a_record_in_the_study_of_a_request_is_stored_once_and_withdrawn_where_it_is() {
    const THEIRS: &str = "1.2.276.4711";
    let archive = Archive::new();
    let store = archive.store();
    let receipt = put_answering(&store, THEIRS, None).unwrap();
    assert_eq!((receipt.folder.to_str(), receipt.already_there), (Some(THEIRS), false));
    assert!(put_answering(&store, THEIRS, None).unwrap().already_there);
    // Of an answer that was lost there is no receipt, and after a lost journal no request.
    let request = ImagingRequest::new(THEIRS, "");
    for (receipt, request) in [(None, request.as_ref()), (Some(THEIRS), None)] {
        let before = archive.stored();
        for _ in 0..2 {
            store.withdraw(&scan(), Some("4711"), None, receipt, request).unwrap();
            assert_eq!(archive.stored(), before + 1);
        }
        assert!(!put_answering(&store, THEIRS, None).unwrap().already_there);
    }
}

#[test]
fn what_an_archive_says_of_objects_that_name_the_patient_is_not_repeated() {
    let archive = Archive::new();
    archive.becomes(Mode::KeepAndFail);
    let person = ListedPerson {
        dicom_name: "Gr\u{fc}nwald^J\u{f6}rg".to_owned(),
        ..ListedPerson::default()
    };
    for (names, study) in [(true, "1.2.276.1"), (false, "1.2.276.2")] {
        let mut store = archive.store();
        store.rules.names = names;
        let fault = put_answering(&store, study, Some(&person)).unwrap_err().to_string();
        assert!(fault.contains("503"), "{fault}");
        assert_eq!(fault.contains("restarting"), !names, "{fault}");
    }
}

#[test]
fn a_record_that_was_confirmed_and_is_not_shown_does_not_count_as_withdrawn() {
    let archive = Archive::new();
    let store = archive.store();
    withdraw(&store, None).unwrap();
    let fault = withdraw(&store, Some("2.25.1")).unwrap_err();
    assert!(matches!(fault, StoreFault::Server(ServerFault::Answer(_))), "{fault}");
    assert_eq!(archive.stored(), 0);
}

#[test]
fn an_id_that_dicom_cannot_write_waits_for_a_person_and_nothing_is_sent() {
    let archive = Archive::new();
    let fault = put(&archive.store(), "47\\11", 1).unwrap_err();
    assert_eq!((fault.code(), archive.stored()), ("store-misfit", 0));
}

#[test]
fn an_address_without_an_archive_is_told_apart_from_an_archive_without_the_study() {
    let archive = Archive::new();
    let store = archive.store();
    archive.becomes(Mode::Say("204 No Content", ""));
    store.reach().unwrap();
    for (status, body) in [("404 Not Found", ""), ("401 Unauthorized", "who are you?")] {
        archive.becomes(Mode::Say(status, body));
        for fault in [store.reach().unwrap_err(), withdraw(&store, None).unwrap_err()] {
            assert!(matches!(fault, StoreFault::Server(ServerFault::Forbidden { .. })), "{fault}");
        }
    }
    archive.becomes(Mode::Say("200 OK", "<html>welcome</html>"));
    let fault = store.reach().unwrap_err();
    assert!(matches!(fault, StoreFault::Server(ServerFault::Answer(_))), "{fault}");
}

/// A server of associations on this machine.
fn listening() -> (TcpListener, DimseServer) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let title = |text: &str| AeTitle::new(text).unwrap();
    let server = DimseServer {
        host: "127.0.0.1".to_owned(),
        port: listener.local_addr().unwrap().port(),
        titles: Titles { calling: title("GAITER"), called: title("PACS") },
        tls: None,
    };
    (listener, server)
}

/// A server of associations, and a store that has so long for it.
fn by_associations(limit: Duration) -> (TcpListener, DicomStore) {
    let (listener, server) = listening();
    let server = DicomServer { way: DicomWay::Dimse(server), limit };
    (listener, DicomStore::new(server, dicom_rules(&["report.pdf"]), "booth-1"))
}

#[test]
fn a_server_of_associations_that_hangs_or_dies_is_asked_again() {
    // Nobody accepts: the system does, and nothing is answered.
    let (_listener, store) = by_associations(Duration::from_millis(200));
    let fault = put(&store, "4711", 1).unwrap_err();
    assert!(
        matches!(fault, StoreFault::Server(ServerFault::Http(HttpFault::TimedOut { .. }))),
        "{fault}"
    );
    let (listener, store) = by_associations(Duration::from_secs(30));
    let dies = std::thread::spawn(move || drop(listener.accept()));
    let fault = put(&store, "4711", 1).unwrap_err();
    dies.join().unwrap();
    assert!(
        matches!(fault, StoreFault::Server(ServerFault::Http(HttpFault::Broken { .. }))),
        "{fault}"
    );
    assert!(store.place().starts_with("dicom://PACS@127.0.0.1:"), "{}", store.place());
}

/// What a server hears of the end of an association. It never says anything.
fn heard_of_the_end(answer: Result<(), DimseFault>) -> Vec<u8> {
    let (listener, server) = listening();
    let hears = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut heard = Vec::new();
        stream.read_to_end(&mut heard).unwrap();
        heard
    });
    let (began, is_done) = (Instant::now(), answer.is_ok());
    assert_eq!(server.asked(Duration::from_secs(60), |_, _| answer).is_ok(), is_done);
    assert!(began.elapsed() < Duration::from_secs(30), "the end is not waited for");
    hears.join().unwrap()
}

#[test]
fn an_association_is_ended_as_it_went_and_its_end_is_not_waited_for() {
    // PS3.8, 9.3.6 and 9.3.8: A-RELEASE-RQ, A-ABORT.
    assert_eq!(heard_of_the_end(Ok(())), [5, 0, 0, 0, 0, 4, 0, 0, 0, 0]);
    assert_eq!(heard_of_the_end(Err(DimseFault::Unexpected)), [7, 0, 0, 0, 0, 4, 0, 0, 0, 0]);
    let timed_out = DimseFault::Connection(ErrorKind::TimedOut.into());
    assert_eq!(heard_of_the_end(Err(timed_out)), [7, 0, 0, 0, 0, 4, 0, 0, 0, 0]);
    assert!(heard_of_the_end(Err(DimseFault::Aborted)).is_empty());
}
