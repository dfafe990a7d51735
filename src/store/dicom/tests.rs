//! The store against an archive of a few lines: what it sends, and what it makes of each answer.

mod decisions;

use std::collections::BTreeSet;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Instant;

use gaiter_dicom::SopClass;
use gaiter_dicom::dimse::{AeTitle, DimseFault, Titles};
use gaiter_flow::ScanId;
use gaiter_https::{HttpFault, TlsFiles};
use gaiter_record::{ImagingRequest, RecordFile};
use serde_json::{Value, json};
use support::http_server::{answer, request_of, serve};
use support::records::{dicom_rules, without_legs};
use support::stow::SentObject;

use super::*;
use crate::store::{HttpAccess, Peer, sums};

/// What an archive does with objects.
#[derive(Debug, Clone, Copy)]
enum Mode {
    Keep,
    /// It answers as if it had kept them.
    Lose,
    /// It keeps all but reports, for this reason.
    RefuseReport(u16),
    /// It keeps them, and answers that it does not, for this reason.
    KeepAndRefuse(u16),
    /// It keeps them, and goes away before it answers.
    KeepAndDie,
    /// It keeps none, and answers each with a fault.
    Fail,
    /// It answers so to everything.
    Say(&'static str, &'static str),
}

/// It is away.
const AWAY: Mode = Mode::Say("503 Service Unavailable", "restarting 4711");

/// An object that an archive has.
#[derive(Debug, Clone)]
struct Kept {
    uid: String,
    /// As a search shows it.
    shown: Value,
    is_report: bool,
    /// The UIDs that it marks, if it is a mark.
    marks: BTreeSet<String>,
}

/// What an archive is and has.
#[derive(Debug)]
struct Place {
    mode: Mode,
    /// Whether it hides marks and what they mark, and refuses both afterwards, as dcm4chee does.
    is_hiding: bool,
    /// Whether what it keeps appears later.
    is_late: bool,
    kept: Vec<Kept>,
    late: Vec<Kept>,
    /// How often it was asked to store something.
    stored: usize,
}

/// An archive on this machine. It is sent an object with each request.
struct Archive {
    port: u16,
    place: Arc<Mutex<Place>>,
}

/// The objects in a request.
fn sent(request: &str) -> Vec<Kept> {
    let kept = |of: SentObject| {
        let is_mark = of.class == SopClass::Withdrawal.uid();
        Kept {
            shown: of.shown(),
            is_report: of.class == SopClass::Pdf.uid(),
            marks: of.references().filter(|_| is_mark).collect(),
            uid: of.uid,
        }
    };
    SentObject::all(request).into_iter().map(kept).collect()
}

impl Place {
    fn is_marked(&self, uid: &str) -> bool {
        self.kept.iter().any(|of| of.marks.contains(uid))
    }

    fn has(&self, uid: &str) -> bool {
        self.kept.iter().chain(&self.late).any(|of| of.uid == uid)
    }

    /// The objects of a record that no mark names.
    fn holding(&self) -> Vec<&str> {
        let records = self.kept.iter().filter(|of| of.marks.is_empty());
        records.map(|of| of.uid.as_str()).filter(|uid| !self.is_marked(uid)).collect()
    }

    fn found(&self) -> String {
        let is_shown =
            |of: &&Kept| !self.is_hiding || of.marks.is_empty() && !self.is_marked(&of.uid);
        json!(self.kept.iter().filter(is_shown).map(|of| &of.shown).collect::<Vec<_>>()).to_string()
    }

    /// Keeps an object, or tells why not, by the standard's code for a duplicate and those of dcm4chee for marks. What is
    /// sent again appears.
    fn keep(&mut self, of: Kept) -> Option<u16> {
        let has = self.has(&of.uid);
        let refused = match of.marks.is_empty() {
            true => self.is_marked(&of.uid).then_some(0xa771),
            false if has => Some(0xa770),
            false => of.marks.iter().any(|uid| !self.has(uid)).then_some(0xa772),
        };
        if self.is_hiding && refused.is_some() {
            return refused;
        }
        if has {
            self.kept.extend(self.late.extract_if(.., |late| late.uid == of.uid));
            return Some(0x0111);
        }
        match self.is_late {
            true => self.late.push(of),
            false => self.kept.push(of),
        }
        None
    }

    /// Does with an object what its mode says. Returns the reason for which it says that it does not keep it.
    fn refusal(&mut self, of: Kept) -> Option<u16> {
        match self.mode {
            Mode::Lose | Mode::Fail => None,
            Mode::RefuseReport(reason) if of.is_report => Some(reason),
            Mode::KeepAndRefuse(reason) => self.keep(of).or(Some(reason)),
            _ => self.keep(of),
        }
    }

    fn answer_to(&mut self, objects: Vec<Kept>) -> String {
        let refused: Vec<u16> = objects.into_iter().filter_map(|of| self.refusal(of)).collect();
        if !refused.is_empty() {
            let why = |reason: &u16| json!({ "00081197": { "vr": "US", "Value": [reason] } });
            let why: Vec<Value> = refused.iter().map(why).collect();
            return answer("409 Conflict", &json!({ "00081198": { "Value": why } }).to_string());
        }
        match self.mode {
            Mode::KeepAndDie => self.mode = AWAY,
            Mode::Fail => {}
            _ => return answer("200 OK", &json!({ "00081198": { "vr": "SQ" } }).to_string()),
        }
        answer("503 Service Unavailable", "restarting 4711")
    }
}

impl Archive {
    fn new() -> Archive {
        Archive::that_hides(false)
    }

    fn that_hides(is_hiding: bool) -> Archive {
        let place = Arc::new(Mutex::new(Place {
            mode: Mode::Keep,
            is_hiding,
            is_late: false,
            kept: Vec::new(),
            late: Vec::new(),
            stored: 0,
        }));
        let asked = Arc::clone(&place);
        let port = serve(move |mut stream| {
            let Ok(request) = request_of(&mut stream) else { return };
            let mut place = asked.lock().unwrap();
            let is_search = request.starts_with("GET ");
            place.stored += usize::from(!is_search);
            let mode = place.mode;
            let answer = match mode {
                Mode::Say(status, body) => answer(status, body),
                _ if is_search => answer("200 OK", &place.found()),
                _ => place.answer_to(sent(&request)),
            };
            drop(place);
            let _ = stream.write_all(answer.as_bytes());
        });
        Archive { port, place }
    }

    fn place(&self) -> MutexGuard<'_, Place> {
        self.place.lock().unwrap()
    }

    fn becomes(&self, mode: Mode) {
        self.place().mode = mode;
    }

    /// How often it was asked to store something.
    fn stored(&self) -> usize {
        self.place().stored
    }

    /// How many objects of a record hold there.
    fn holding(&self) -> usize {
        self.place().holding().len()
    }

    /// All that it has appears.
    fn catches_up(&self) {
        let mut place = self.place();
        let late = std::mem::take(&mut place.late);
        place.kept.extend(late);
        place.is_late = false;
    }

    fn store(&self) -> DicomStore {
        let server = DicomServer::Web {
            base: format!("http://127.0.0.1:{}/dicom-web", self.port),
            access: HttpAccess::Open,
            tls: TlsFiles::default(),
            limit: Duration::from_secs(30),
        };
        DicomStore::new(server, dicom_rules(&["report.pdf"]), "booth-1")
    }
}

fn scan() -> ScanId {
    sums::scan_id(b"v 0 0 0\n")
}

fn put(store: &DicomStore, patient: &str, revision: u32) -> Result<Receipt, StoreFault> {
    put_in(store, patient, revision, 0)
}

fn put_in(
    store: &DicomStore,
    patient: &str,
    revision: u32,
    turn: u32,
) -> Result<Receipt, StoreFault> {
    let record = without_legs(scan().as_str(), Some(patient), revision);
    put_record(store, patient, (revision, turn), &record)
}

/// Puts a record of 4711 that answers the request of this study.
fn put_answering(store: &DicomStore, study: &str, turn: u32) -> Result<Receipt, StoreFault> {
    let record = without_legs(scan().as_str(), Some("4711"), 1);
    let mut record: Value = serde_json::from_slice(&record).unwrap();
    record["patient"]["sources"][0]["request"] = json!({ "study_instance_uid": study });
    put_record(store, "4711", (1, turn), record.to_string().as_bytes())
}

fn put_record(
    store: &DicomStore,
    patient: &str,
    (revision, turn): (u32, u32),
    record: &[u8],
) -> Result<Receipt, StoreFault> {
    let file = |name: &str, bytes: &[u8]| RecordFile { name: name.into(), bytes: bytes.into() };
    store.put(&Delivery {
        scan: &scan(),
        patient: Some(patient),
        person: None,
        first_seen: "2026-11-21T09:15:00Z".parse().unwrap(),
        revision,
        turn,
        files: &[file("record.json", record), file("report.pdf", b"%PDF-1.7")],
        scan_file: Path::new("/nowhere"),
        ending: "obj",
    })
}

fn withdraw(store: &DicomStore, receipt: Option<&str>, turn: u32) -> Result<(), StoreFault> {
    store.withdraw(&TakeBack { receipt, turn, ..TakeBack::new(&scan(), Some("4711")) })
}

fn is_not_shown(done: &Result<(), StoreFault>) -> bool {
    matches!(done, Err(StoreFault::Server(ServerFault::NotShown)))
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
    // At most two looks before, a mark and two looks after it, and two looks in the end.
    assert!(store.step_most() > Duration::from_secs(30) * (2 + 7));
}

#[test]
fn a_lost_answer_or_a_half_stored_record_is_completed_by_the_next_try() {
    let archive = Archive::new();
    let store = archive.store();
    archive.becomes(Mode::KeepAndDie);
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
fn a_record_that_is_shown_is_stored_whatever_the_archive_answered() {
    for reason in [0xc000, 0x0122, 0xa700] {
        let archive = Archive::new();
        archive.becomes(Mode::KeepAndRefuse(reason));
        assert!(!put(&archive.store(), "4711", 1).unwrap().already_there, "{reason:04X}");
    }
}

#[test]
fn a_record_that_the_archive_keeps_late_and_refuses_as_a_duplicate_is_stored() {
    let archive = Archive::new();
    let store = archive.store();
    archive.place().is_late = true;
    put(&store, "4711", 1).unwrap_err();
    // Both objects are missing in the list, and each is there when it is sent again.
    assert!(!put(&store, "4711", 1).unwrap().already_there);
    assert_eq!((archive.stored(), archive.holding()), (4, 2));
}

#[test]
fn a_withdrawn_record_is_marked_once_and_can_be_given_again() {
    for is_hiding in [false, true] {
        let archive = Archive::that_hides(is_hiding);
        let store = archive.store();
        let receipt = put(&store, "4711", 1).unwrap().folder;
        let receipt = receipt.to_str();
        withdraw(&store, receipt, 0).unwrap();
        // The run ended before it noted that.
        let again = withdraw(&store, receipt, 0);
        assert!(if is_hiding { is_not_shown(&again) } else { again.is_ok() }, "{again:?}");
        assert_eq!((archive.stored(), archive.holding()), (3, 0));
        assert!(!put_in(&store, "4711", 1, 1).unwrap().already_there);
        assert!(put_in(&store, "4711", 1, 1).unwrap().already_there);
        assert_eq!(archive.holding(), 2);
        withdraw(&store, receipt, 1).unwrap();
        assert_eq!((archive.stored(), archive.holding()), (6, 0));
    }
}

#[test]
fn a_record_that_was_withdrawn_there_is_not_taken_for_stored() {
    let archive = Archive::new();
    let store = archive.store();
    put(&store, "4711", 1).unwrap();
    withdraw(&store, None, 0).unwrap();
    assert_eq!(put(&store, "4711", 1).unwrap_err().code(), "taken-back-there");
}

#[test]
fn a_mark_whose_answer_is_lost_or_a_refusal_is_there_if_nothing_is_shown_without_it() {
    for (is_hiding, reason) in [(false, 0xa770), (true, 0xa770), (true, 0xc000)] {
        let archive = Archive::that_hides(is_hiding);
        let store = archive.store();
        let receipt = put(&store, "4711", 1).unwrap().folder;
        archive.becomes(Mode::KeepAndRefuse(reason));
        withdraw(&store, receipt.to_str(), 0).unwrap();
        assert_eq!(archive.holding(), 0);
    }
}

#[test]
fn a_record_in_the_study_of_a_request_is_stored_once_and_withdrawn_where_it_is() {
    const THEIRS: &str = "1.2.276.4711";
    let archive = Archive::new();
    let store = archive.store();
    let receipt = put_answering(&store, THEIRS, 0).unwrap();
    assert_eq!((receipt.folder.to_str(), receipt.already_there), (Some(THEIRS), false));
    assert!(put_answering(&store, THEIRS, 0).unwrap().already_there);
    // Of an answer that was lost there is no receipt, and of a record that was confirmed the request is not needed.
    let request = ImagingRequest::new(THEIRS, "");
    let known = [(None, request.as_ref()), (Some(THEIRS), None)];
    for (turn, (receipt, request)) in (0..).zip(known) {
        let before = archive.stored();
        let scan = scan();
        let taken_back = TakeBack { receipt, request, turn, ..TakeBack::new(&scan, Some("4711")) };
        for _ in 0..2 {
            store.withdraw(&taken_back).unwrap();
            assert_eq!(archive.stored(), before + 1);
        }
        assert!(!put_answering(&store, THEIRS, turn + 1).unwrap().already_there);
    }
}

#[test]
fn what_an_archive_says_is_repeated_only_if_it_knows_no_name() {
    let archive = Archive::new();
    archive.becomes(Mode::Fail);
    for (names, request) in
        [(true, Some("1.2.276.1")), (false, Some("1.2.276.2")), (true, None), (false, None)]
    {
        let mut store = archive.store();
        store.rules.names = names;
        let fault = match request {
            Some(study) => put_answering(&store, study, 0),
            None => put(&store, "4711", 1),
        };
        let fault = fault.unwrap_err().to_string();
        assert!(fault.contains("503"), "{fault}");
        assert_eq!(fault.contains("restarting"), !names && request.is_none(), "{fault}");
    }
}

#[test]
fn what_was_sent_or_confirmed_and_is_not_shown_does_not_count_as_withdrawn() {
    let archive = Archive::new();
    let store = archive.store();
    withdraw(&store, None, 0).unwrap();
    for receipt in ["", "2.25.1"] {
        assert!(is_not_shown(&withdraw(&store, Some(receipt), 0)), "{receipt:?}");
    }
    assert_eq!(archive.stored(), 0);
}

#[test]
fn what_appears_after_its_take_back_was_begun_is_marked_by_the_next_try() {
    for is_hiding in [false, true] {
        let archive = Archive::that_hides(is_hiding);
        let store = archive.store();
        archive.becomes(Mode::RefuseReport(0xa700));
        put(&store, "4711", 1).unwrap_err();
        archive.becomes(Mode::KeepAndDie);
        archive.place().is_late = true;
        put(&store, "4711", 1).unwrap_err();
        archive.becomes(Mode::Keep);
        archive.place().is_late = false;
        assert!(is_not_shown(&withdraw(&store, Some(""), 0)));
        assert_eq!(archive.holding(), 0);
        archive.catches_up();
        assert_eq!(archive.holding(), 1);
        assert!(is_not_shown(&withdraw(&store, Some(""), 0)));
        assert_eq!(archive.holding(), 0);
    }
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
        for fault in [store.reach().unwrap_err(), withdraw(&store, None, 0).unwrap_err()] {
            assert!(matches!(fault, StoreFault::Server(ServerFault::Forbidden { .. })), "{fault}");
        }
    }
    archive.becomes(Mode::Say("200 OK", "<html>welcome</html>"));
    let fault = store.reach().unwrap_err();
    assert!(matches!(fault, StoreFault::Server(ServerFault::Answer(_))), "{fault}");
}

/// A server of associations on this machine, for which the station has so long.
fn listening(limit: Duration) -> (TcpListener, DimseServer) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let title = |text: &str| AeTitle::new(text).unwrap();
    let titles = Titles { calling: title("GAITER"), called: title("PACS") };
    let (host, port) = ("127.0.0.1".to_owned(), listener.local_addr().unwrap().port());
    (listener, DimseServer { peer: Peer { host, port, tls: None, limit }, titles })
}

/// A server of associations, and a store that has so long for it.
fn by_associations(limit: Duration) -> (TcpListener, DicomStore) {
    let (listener, server) = listening(limit);
    (listener, DicomStore::new(DicomServer::Dimse(server), dicom_rules(&["report.pdf"]), "booth-1"))
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
    let (listener, server) = listening(Duration::from_secs(60));
    let hears = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut heard = Vec::new();
        stream.read_to_end(&mut heard).unwrap();
        heard
    });
    let (began, is_done) = (Instant::now(), answer.is_ok());
    assert_eq!(server.asked(|_, _| answer).is_ok(), is_done);
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
