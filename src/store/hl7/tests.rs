//! Messages to a receiver that answers, hangs, drips and floods, and to a folder: every place where a crash may come.

use std::fs;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::os::unix::fs::symlink;
use std::sync::{Arc, Mutex};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use gaiter_record::RecordFile;
use support::records::{hl7_rules, without_legs};
use tempfile::TempDir;

use super::*;
use crate::store::sums;

/// How long an answer is waited for that does not come.
const SHORT: Duration = Duration::from_secs(3);

/// What a receiver does with a message.
#[derive(Debug, Clone, Copy)]
enum Mode {
    Accept,
    Refuse,
    /// It answers that the record is locked.
    Locked,
    /// It answers nothing and keeps the connection.
    Silent,
    /// It closes the connection within the answer.
    Half,
    /// It sends a byte now and then.
    Drip,
    /// It sends without end.
    Flood,
}

/// A receiver on this machine, and what it was sent.
struct Receiving {
    port: u16,
    mode: Arc<Mutex<Mode>>,
    messages: Arc<Mutex<Vec<String>>>,
}

impl Receiving {
    fn new() -> Receiving {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let mode = Arc::new(Mutex::new(Mode::Accept));
        let messages: Arc<Mutex<Vec<String>>> = Arc::default();
        let kept = (Arc::clone(&mode), Arc::clone(&messages));
        thread::spawn(move || {
            for stream in listener.incoming() {
                let (mode, messages) = kept.clone();
                thread::spawn(move || receive(stream.unwrap(), &mode, &messages));
            }
        });
        Receiving { port, mode, messages }
    }

    fn becomes(&self, mode: Mode) {
        *self.mode.lock().unwrap() = mode;
    }

    fn store(&self, state: &Path) -> Hl7Store {
        self.store_that_waits(Duration::from_secs(20), state)
    }

    fn store_that_waits(&self, limit: Duration, state: &Path) -> Hl7Store {
        let host = "localhost".to_owned();
        let way = Hl7Way::Mllp(Peer { host, port: self.port, tls: None, limit });
        Hl7Store::new(way, hl7_rules("KIS"), state, "")
    }

    /// The last message that it was sent.
    fn last(&self) -> String {
        self.messages.lock().unwrap().last().cloned().unwrap_or_default()
    }

    /// The control ids of what it was sent, in order.
    fn controls(&self) -> Vec<String> {
        let messages = self.messages.lock().unwrap();
        messages.iter().map(|message| message.split('|').nth(9).unwrap().to_owned()).collect()
    }
}

/// OBX-3 and OBX-11 of each observation of a message: its code, and its status in the message.
fn observations(message: &str) -> Vec<(String, String)> {
    let observations = message.split('\r').filter(|segment| segment.starts_with("OBX|"));
    let fields = observations.map(|obx| obx.split('|').collect::<Vec<_>>());
    let of = |obx: Vec<&str>| (obx[3].split('^').next().unwrap().to_owned(), obx[11].to_owned());
    fields.map(of).collect()
}

fn pairs(all: &[(&str, &str)]) -> Vec<(String, String)> {
    all.iter().map(|(code, status)| ((*code).to_owned(), (*status).to_owned())).collect()
}

fn receive(mut stream: TcpStream, mode: &Mutex<Mode>, messages: &Mutex<Vec<String>>) {
    let (mut bytes, mut part) = (Vec::new(), [0; 4096]);
    while !bytes.ends_with(b"\x1c\r") {
        match stream.read(&mut part) {
            Ok(0) | Err(_) => return,
            Ok(count) => bytes.extend_from_slice(&part[..count]),
        }
    }
    let message = String::from_utf8(bytes[1..bytes.len() - 2].to_vec()).unwrap();
    let control = message.split('|').nth(9).unwrap().to_owned();
    messages.lock().unwrap().push(message);
    let head = "MSH|^~\\&|KIS||GAITER||20261128||ACK^R01^ACK|1|P|2.5";
    let answer = |rest: &str| format!("\x0b{head}\rMSA|{rest}\r\x1c\r").into_bytes();
    let accepted = answer(&format!("AA|{control}"));
    let mode = *mode.lock().unwrap();
    // Whether anybody listens still is none of the receiver's business.
    let _ = match mode {
        Mode::Accept => stream.write_all(&[accepted.as_slice(), b"\x0bmore\x1c\r"].concat()),
        Mode::Refuse => stream.write_all(&answer(&format!("AE|{control}|no case of 4711"))),
        Mode::Locked => stream.write_all(&answer(&format!("AE|{control}\rERR|||206|E"))),
        Mode::Silent => stream.read(&mut part).map(drop),
        Mode::Half => stream.write_all(&accepted[..20]),
        Mode::Drip => accepted.iter().try_for_each(|byte| {
            sleep(Duration::from_millis(100));
            stream.write_all(&[*byte])
        }),
        Mode::Flood => (0..1_000).try_for_each(|_| stream.write_all(&[b'x'; 4096])),
    };
}

fn scan() -> ScanId {
    sums::scan_id(b"v 0 0 0\n")
}

/// The files of a record of this revision.
fn files(revision: u32) -> Vec<RecordFile> {
    let record = without_legs(scan().as_str(), Some("4711"), revision);
    let file = |name: &str, bytes: &[u8]| RecordFile { name: name.into(), bytes: bytes.into() };
    vec![file("record.json", &record), file("report.pdf", b"%PDF-1.7")]
}

fn put(store: &Hl7Store, patient: Option<&str>, revision: u32) -> Result<Receipt, StoreFault> {
    store.put(&Delivery {
        scan: &scan(),
        patient,
        person: None,
        first_seen: "2026-11-21T09:15:00Z".parse().unwrap(),
        revision,
        turn: 0,
        files: &files(revision),
        scan_file: Path::new("/nowhere"),
        ending: "obj",
    })
}

fn is_new(store: &Hl7Store, revision: u32) -> bool {
    !put(store, Some("4711"), revision).unwrap_or_else(|fault| panic!("{fault}")).already_there
}

/// Why a receiver takes nothing now.
fn passing(store: &Hl7Store) -> String {
    match put(store, Some("4711"), 1) {
        Err(StoreFault::Server(fault)) => fault.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_message_is_sent_until_it_is_accepted_and_never_again_whatever_becomes_of_the_answers() {
    let (receiver, state) = (Receiving::new(), TempDir::new().unwrap());
    let store = receiver.store(state.path());
    store.reach().unwrap();
    let hasty = receiver.store_that_waits(SHORT, state.path());
    for (mode, store, said) in [
        (Mode::Silent, &hasty, "no whole answer within 3 s"),
        (Mode::Drip, &hasty, "no whole answer within 3 s"),
        (Mode::Half, &store, "end of file"),
        (Mode::Flood, &store, "more than 262144 bytes"),
        (Mode::Locked, &store, "AE: 206"),
    ] {
        receiver.becomes(mode);
        let began = Instant::now();
        let fault = passing(store);
        assert!(fault.contains(said), "{mode:?}: {fault}");
        assert!(began.elapsed() < Duration::from_secs(60), "{mode:?} took {:?}", began.elapsed());
    }
    receiver.becomes(Mode::Accept);
    assert!(is_new(&store, 1));
    assert!(!is_new(&store, 1) && !is_new(&receiver.store(state.path()), 1), "in no later run");
    let controls = receiver.controls();
    assert_eq!(controls.len(), 6);
    assert!(controls.iter().all(|control| *control == controls[0]), "{controls:?}");
}

#[test]
fn a_receiver_that_is_not_there_is_out_of_reach() {
    let (listener, state) = (TcpListener::bind("127.0.0.1:0").unwrap(), TempDir::new().unwrap());
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    for host in ["127.0.0.1", "localhost"] {
        let limit = Duration::from_secs(20);
        let way = Hl7Way::Mllp(Peer { host: host.to_owned(), port, tls: None, limit });
        let fault = Hl7Store::new(way, hl7_rules("KIS"), state.path(), "").reach().unwrap_err();
        assert!(matches!(fault, StoreFault::Server(_)), "{host}: {fault}");
    }
}

#[test]
fn a_refused_message_waits_for_a_person_who_reads_why_without_the_id() {
    let (receiver, state) = (Receiving::new(), TempDir::new().unwrap());
    let store = receiver.store(state.path());
    receiver.becomes(Mode::Refuse);
    match put(&store, Some("4711"), 1) {
        Err(StoreFault::Permanent(Rejection::ReceiverRefused { code, why })) => {
            assert_eq!(code, "AE");
            assert!(why.contains("no case of") && !why.contains("4711"), "{why}");
        }
        other => panic!("{other:?}"),
    }
    receiver.becomes(Mode::Accept);
    assert!(is_new(&store, 1), "it was not noted as sent");
}

#[test]
fn what_names_nobody_or_somebody_else_is_not_sent() {
    let (receiver, state) = (Receiving::new(), TempDir::new().unwrap());
    let store = receiver.store(state.path());
    let rejection = |patient| match put(&store, patient, 1) {
        Err(StoreFault::Permanent(rejection)) => rejection,
        other => panic!("{other:?}"),
    };
    assert_eq!(rejection(None), Rejection::Unassigned);
    assert_eq!(rejection(Some("4712")), Rejection::OtherPatient);
    assert!(receiver.controls().is_empty());
}

#[test]
fn a_correction_a_withdrawal_and_a_result_after_it_are_messages_of_their_own() {
    let (receiver, state) = (Receiving::new(), TempDir::new().unwrap());
    let store = receiver.store(state.path());
    let withdraw = || store.withdraw(&TakeBack::new(&scan(), Some("4711"))).unwrap();
    withdraw();
    assert!(receiver.controls().is_empty(), "nothing was sent that could be withdrawn");
    assert!(is_new(&store, 1) && is_new(&store, 2));
    assert!(!is_new(&store, 1), "an older revision is not sent again");
    withdraw();
    withdraw();
    // The scan was this patient's after all: a record of the first revision, and a correction of it.
    assert!(is_new(&store, 1) && !is_new(&store, 1) && is_new(&store, 2));
    withdraw();
    let controls = receiver.controls();
    assert_eq!(controls.len(), 6, "{controls:?}");
    let mut different = controls.clone();
    different.sort();
    different.dedup();
    assert_eq!(different.len(), controls.len(), "{controls:?}");
}

#[test]
fn a_result_whose_answer_was_lost_is_taken_back_and_one_that_was_refused_is_not() {
    let (receiver, state) = (Receiving::new(), TempDir::new().unwrap());
    let store = receiver.store(state.path());
    let hasty = receiver.store_that_waits(SHORT, state.path());
    let withdraw = |store: &Hl7Store| store.withdraw(&TakeBack::new(&scan(), Some("4711")));
    receiver.becomes(Mode::Refuse);
    assert!(put(&store, Some("4711"), 1).is_err());
    receiver.becomes(Mode::Accept);
    withdraw(&store).unwrap();
    assert_eq!(receiver.controls().len(), 1, "the receiver has said that it has nothing");
    // It has taken the result, and nobody knows.
    receiver.becomes(Mode::Silent);
    passing(&hasty);
    assert!(withdraw(&hasty).is_err());
    receiver.becomes(Mode::Accept);
    withdraw(&receiver.store(state.path())).unwrap();
    withdraw(&store).unwrap();
    let controls = receiver.controls();
    assert_eq!(controls.len(), 4, "{controls:?}");
    assert_eq!(controls[0], controls[1], "the same result");
    assert_eq!(controls[2], controls[3], "the same take-back, until it is accepted");
    assert_eq!(observations(&receiver.last()), pairs(&[("VERDICT", "W"), ("PDF", "W")]));
    assert!(is_new(&store, 1), "it is this patient's after all");
    assert!(!controls.contains(&receiver.controls()[4]));
}

#[test]
fn what_a_correction_no_longer_holds_is_wrong_there_and_is_taken_back_with_it() {
    let (receiver, state) = (Receiving::new(), TempDir::new().unwrap());
    let store = receiver.store(state.path());
    assert!(is_new(&store, 1));
    let mut without = store.clone();
    without.rules.pdf = PdfForm::None;
    assert!(is_new(&without, 2));
    assert_eq!(observations(&receiver.last()), pairs(&[("VERDICT", "C"), ("PDF", "W")]));
    without.withdraw(&TakeBack::new(&scan(), Some("4711"))).unwrap();
    assert_eq!(observations(&receiver.last()), pairs(&[("VERDICT", "W"), ("PDF", "W")]));
}

#[test]
fn another_receiver_has_neither_the_result_nor_its_withdrawal() {
    let (first, second, state) = (Receiving::new(), Receiving::new(), TempDir::new().unwrap());
    let stores = [&first, &second].map(|receiver| receiver.store(state.path()));
    let withdraw =
        |store: &Hl7Store| store.withdraw(&TakeBack::new(&scan(), Some("4711"))).unwrap();
    assert!(stores.iter().all(|store| is_new(store, 1)));
    assert_eq!(first.controls(), second.controls(), "it is the same message");
    stores.iter().for_each(withdraw);
    let controls = first.controls();
    assert_eq!((controls.len(), &controls), (2, &second.controls()));
}

#[test]
fn stations_beside_each_other_have_control_ids_of_their_own() {
    let receiver = Receiving::new();
    let states = [TempDir::new().unwrap(), TempDir::new().unwrap()];
    for (state, name) in states.iter().zip(["booth-1", "booth-2"]) {
        let store = Hl7Store { station: name.to_owned(), ..receiver.store(state.path()) };
        assert!(is_new(&store, 1) && !is_new(&store, 1));
    }
    let controls = receiver.controls();
    assert_eq!(controls.len(), 2);
    assert_ne!(controls[0], controls[1]);
}

#[test]
fn nothing_is_sent_that_cannot_be_noted() {
    let (receiver, state) = (Receiving::new(), TempDir::new().unwrap());
    // The folder of notes can neither be used nor made, as on a full disk.
    symlink("/nowhere/at/all", state.path().join("hl7-sent")).unwrap();
    let store = receiver.store(state.path());
    assert!(matches!(put(&store, Some("4711"), 1), Err(StoreFault::Transient { .. })));
    assert!(receiver.controls().is_empty());
    fs::remove_file(state.path().join("hl7-sent")).unwrap();
    assert!(is_new(&store, 1));
}

#[test]
fn the_notes_of_what_was_sent_name_nobody_and_are_forgotten_with_a_person() {
    let (receiver, state) = (Receiving::new(), TempDir::new().unwrap());
    let store = receiver.store(state.path());
    assert!(is_new(&store, 1));
    let notes = || {
        let files = fs::read_dir(state.path().join("hl7-sent")).unwrap();
        files.map(|file| file.unwrap().path()).collect::<Vec<_>>()
    };
    let [note] = &notes()[..] else { panic!("{:?}", notes()) };
    assert!(!fs::read_to_string(note).unwrap().contains("4711"));
    let erase = |patient| store.erase(patient, Timestamp::now(), &[scan()]).unwrap();
    erase("4712");
    assert_eq!(notes().len(), 1, "it is another person's");
    erase("4711");
    erase("4711");
    assert!(notes().is_empty());
    assert!(is_new(&store, 1));
}

/// The message files that are there.
fn messages(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let names = names.map(|name| name.into_string().unwrap());
    names.filter(|name| !name.starts_with('.')).collect()
}

/// A store of message files in `folder`, with its state folder.
fn of_files(folder: &Path, state: &Path) -> Hl7Store {
    Hl7Store::new(Hl7Way::Files(folder.to_owned()), hl7_rules("KIS"), state, "booth-1")
}

#[test]
fn a_folder_gets_each_message_once_although_its_file_goes_away() {
    let (state, root) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    let folder = root.path().join("messages");
    let store = of_files(&folder, state.path());
    store.begin(true).unwrap();
    let receipt = put(&store, Some("4711"), 1).unwrap();
    let reference = receipt.folder.to_str().unwrap().to_owned();
    assert_eq!(messages(&folder), [format!("{reference}.hl7")]);
    let file = store.unfetched(&reference).unwrap();
    let message = fs::read_to_string(&file).unwrap();
    assert!(message.starts_with("MSH|") && message.contains(&reference), "{message}");
    assert!(!is_new(&store, 1));
    fs::remove_file(file).unwrap();
    assert_eq!(store.unfetched(&reference), None);
    assert!(!is_new(&store, 1) && messages(&folder).is_empty(), "it was fetched");
}

#[test]
fn a_message_file_that_a_crash_left_is_named_if_it_was_noted_and_made_again_if_not() {
    let (state, root) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    let store = of_files(root.path(), state.path());
    store.begin(false).unwrap();
    let (key, folder) = (key(&scan(), "4711"), store.folder().unwrap());
    let staged = || messages(&root.path().join(".gaiter.booth-1")).len();
    let name = staged_name(&key, "0123");
    // Before the note.
    folder.stage(&name, b"half").unwrap();
    store.open().unwrap();
    assert_eq!((staged(), messages(root.path()).len()), (0, 0));
    // Behind it: by the next attempt, and by the next run.
    let sent = Sent {
        revision: 1,
        number: 1,
        control: "0123".into(),
        place: store.place(),
        holds: true,
        is_answered: true,
        codes: vec![],
    };
    let attempt: fn(&Hl7Store) = |store| assert!(!is_new(store, 1));
    let run: fn(&Hl7Store) = |store| store.open().unwrap();
    for next in [attempt, run] {
        folder.stage(&name, b"whole").unwrap();
        store.sent.note(&key, &sent).unwrap();
        next(&store);
        assert_eq!((staged(), messages(root.path())), (0, vec!["0123.hl7".to_owned()]));
        fs::remove_file(root.path().join("0123.hl7")).unwrap();
    }
}

#[test]
fn a_folder_whose_share_is_gone_takes_nothing() {
    let (state, root) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    let folder = root.path().join("messages");
    let store = of_files(&folder, state.path());
    store.begin(true).unwrap();
    // The empty folder on which the share was mounted.
    fs::rename(&folder, root.path().join("share")).unwrap();
    fs::create_dir(&folder).unwrap();
    assert!(matches!(store.reach(), Err(StoreFault::Transient { .. })));
    assert!(matches!(put(&store, Some("4711"), 1), Err(StoreFault::Transient { .. })));
    fs::remove_dir(&folder).unwrap();
    fs::rename(root.path().join("share"), &folder).unwrap();
    assert!(is_new(&store, 1));
}
