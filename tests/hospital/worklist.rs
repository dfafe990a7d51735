//! The worklist of wlmscpfs, and servers of worklists that hang or send without an end.
//!
//! wlmscpfs listens at every address: it is started in a network of its own alone (`unshare -n`), in which its test
//! must run, too.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use gaiter::config::WorklistConfig;
use gaiter::station::booth::worklist::ask;
use gaiter::store::Peer;
use gaiter::store::dicom::DimseServer;
use gaiter_dicom::dimse::{AeTitle, Titles};
use gaiter_dicom::{DicomRules, Person};
use gaiter_flow::worklist::{WorklistEntry, WorklistFilter};
use jiff::civil::{Date, date, time};
use rig::worklist::{accepts, part, pending};
use tempfile::TempDir;

use crate::dicom::{objects_of, told};
use crate::dicom_house::rules;
use crate::records::SMALL;

/// How long wlmscpfs may take until it answers.
const UP: Duration = Duration::from_secs(60);

/// How long an answer is waited for.
const LONG: Duration = Duration::from_secs(120);

/// How long one is waited for that does not come.
const SHORT: Duration = Duration::from_secs(1);

/// How long a question that waits for [`SHORT`] may take, on a busy machine.
const SOON: Duration = Duration::from_secs(15);

const DAY: Date = date(2026, 11, 28);

/// What a server without an end would like to send, bytes.
const ENDLESS: usize = 100 << 20;

/// What is read of a server at most, and what is on its way then, bytes.
const READ_MOST: usize = 32 << 20;

fn worklist(port: u16, limit: Duration) -> WorklistConfig {
    let title = |text: &str| AeTitle::new(text).unwrap();
    WorklistConfig {
        server: DimseServer {
            peer: Peer { host: "127.0.0.1".to_owned(), port, tls: None, limit },
            titles: Titles { calling: title("LEGSCAN"), called: title("RIS") },
        },
        filter: WorklistFilter { station: "LEGSCAN".to_owned(), modality: None },
        every: Duration::from_secs(60),
    }
}

/// wlmscpfs with the entries of its folder.
struct Wlmscpfs {
    folder: TempDir,
    port: u16,
    process: Child,
}

impl Wlmscpfs {
    /// `charset` is what it does with character sets.
    fn new(charset: &str) -> Wlmscpfs {
        // A heading and no route: nothing leads out.
        let routes = fs::read_to_string("/proc/net/route").unwrap();
        assert!(routes.lines().count() <= 1, "run it by unshare -n, with the interface lo up");
        let folder = tempfile::tempdir().unwrap();
        let ris = folder.path().join("RIS");
        fs::create_dir(&ris).unwrap();
        fs::write(ris.join("lockfile"), "").unwrap();
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let mut command = Command::new("wlmscpfs");
        command.args(["--disable-file-reject", "--single-process", charset, "-dfp"]);
        command.arg(folder.path()).arg(port.to_string());
        let process = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let server = Wlmscpfs { folder, port, process };
        let began = Instant::now();
        while let Err(fault) = ask(&worklist(port, LONG), DAY) {
            assert!(began.elapsed() < UP, "{fault}");
            sleep(Duration::from_millis(50));
        }
        server
    }

    /// Makes an entry from its description.
    fn has(&self, name: &str, description: &[u8]) {
        let text = self.folder.path().join(name);
        fs::write(&text, description).unwrap();
        let entry = self.folder.path().join("RIS").join(name).with_extension("wl");
        made(&text, &entry);
    }

    fn entries(&self) -> Vec<WorklistEntry> {
        ask(&worklist(self.port, LONG), DAY).unwrap().entries
    }
}

impl Drop for Wlmscpfs {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn made(text: &Path, entry: &Path) {
    let done = Command::new("dump2dcm").arg("+te").arg(text).arg(entry).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

/// An entry for Jörg Grünwald as dump2dcm reads it.
fn described(charset: &str, station: &str, day: &str) -> String {
    format!(
        "(0008,0005) CS [{charset}]\n(0008,0050) SH [A1]\n(0010,0010) PN [Gr\u{fc}nwald^J\u{f6}rg]\n\
         (0010,0020) LO [4711]\n(0010,0021) LO [KIS]\n(0010,0030) DA [19500102]\n(0010,0040) CS [M]\n\
         (0020,000d) UI [1.2.276.4711]\n(0032,1060) LO [Kompressionsstr\u{fc}mpfe]\n(0040,0100) SQ\n\
         (fffe,e000) na\n(0008,0060) CS [OSS]\n(0040,0001) AE [{station}]\n(0040,0002) DA [{day}]\n\
         (0040,0003) TM [093000]\n(0040,0009) SH [S1]\n(fffe,e00d) na\n(fffe,e0dd) na\n"
    )
}

/// A text in ISO 8859-1, in which each sign is its number.
fn latin_1(text: &str) -> Vec<u8> {
    text.chars().map(|sign| u8::try_from(u32::from(sign)).unwrap()).collect()
}

/// What dcmtk reads in the report of a scan that answers an entry: whose it is, and all accession numbers.
fn report_of(entry: &WorklistEntry) -> [String; 2] {
    let person = Person {
        name: &entry.person.dicom_name,
        birth_date: entry.person.birth_date,
        sex: &entry.person.sex,
    };
    let scan = SMALL.answering(entry.request.clone());
    let objects = objects_of(&scan, Some(person), &DicomRules { names: true, ..rules() });
    let file = tempfile::NamedTempFile::new().unwrap();
    fs::write(file.path(), objects[0].file().unwrap()).unwrap();
    let report = told("dsrdump", &[], file.path());
    [report, told("dcmdump", &["+P", "0008,0050"], file.path())]
}

#[test]
#[ignore = "needs dcmtk in a network of its own, run by .ci/run"]
fn wlmscpfs_lists_who_is_expected_at_the_station_today_with_umlauts_in_each_character_set() {
    let in_latin_1 = latin_1(&described("ISO_IR 100", "LEGSCAN", "20261128"));
    let in_utf_8 = described("ISO_IR 192", "LEGSCAN", "20261128").into_bytes();
    let keeps = "--keep-char-set";
    for (charset, description) in
        [(keeps, &in_latin_1), (keeps, &in_utf_8), ("--return-no-char-set", &in_latin_1)]
    {
        let server = Wlmscpfs::new(charset);
        server.has("ours", description);
        server.has("other-station", &latin_1(&described("ISO_IR 100", "CT1", "20261128")));
        server.has("other-day", &latin_1(&described("ISO_IR 100", "LEGSCAN", "20261129")));
        let entries = server.entries();
        let [entry] = &entries[..] else { panic!("{} entries", entries.len()) };
        assert_eq!(entry.person.name, "Gr\u{fc}nwald, J\u{f6}rg");
        assert_eq!(entry.person.birth_date, Some(date(1950, 1, 2)));
        assert_eq!(entry.procedure, "Kompressionsstr\u{fc}mpfe");
        assert_eq!((entry.patient.as_str(), entry.issuer.as_str()), ("4711", "KIS"));
        assert_eq!(entry.accession_number(), Some("A1"));
        assert_eq!(entry.request.as_ref().unwrap().study_instance_uid, "1.2.276.4711");
        let step = &entry.scheduled;
        assert_eq!((&step.stations[..], step.step.as_str()), (&["LEGSCAN".to_owned()][..], "S1"));
        assert_eq!((step.modality.as_str(), step.date), ("OSS", Some(DAY)));
        assert_eq!(step.time, Some(time(9, 30, 0, 0)));
        // From there into the report.
        let [report, numbers] = report_of(entry);
        assert!(report.contains("Gr\u{fc}nwald^J\u{f6}rg (M, 1950-01-02, #4711:KIS)"), "{report}");
        // In the object, and in the request that it answers.
        assert_eq!(numbers.matches("[A1]").count(), 2, "{numbers}");
    }
}

/// A server for one connection. Tells how many bytes it could send.
fn server(
    send: impl FnOnce(&mut TcpStream) -> usize + Send + 'static,
) -> (u16, thread::JoinHandle<usize>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let sends = move || {
        let (mut stream, _) = listener.accept().unwrap();
        let _ = stream.read(&mut [0; 4096]);
        send(&mut stream)
    };
    (port, thread::spawn(sends))
}

/// Sends what it begins with, then the same again and again. Returns how many bytes it could.
fn endless(stream: &mut TcpStream, begins: &[u8], again: &[u8]) -> usize {
    let mut sent = 0;
    let mut bytes = begins;
    while sent < ENDLESS && stream.write_all(bytes).is_ok() {
        sent += bytes.len();
        bytes = again;
    }
    sent
}

#[test]
fn a_server_that_hangs_costs_no_more_than_the_limit() {
    for begins in [Vec::new(), accepts(), [accepts(), pending()].concat()] {
        let (port, thread) = server(move |stream| {
            let _ = stream.write_all(&begins);
            // Until the station has ended it.
            while stream.read(&mut [0; 4096]).is_ok_and(|count| count > 0) {}
            0
        });
        let began = Instant::now();
        let fault = ask(&worklist(port, SHORT), DAY).unwrap_err().to_string();
        assert!(began.elapsed() < SOON);
        assert_eq!(fault, "no whole answer within 1 s");
        thread.join().unwrap();
    }
}

#[test]
fn a_server_that_sends_without_an_end_is_not_read_to_the_end() {
    let long = vec![b'x'; 16_000];
    let entry = [pending(), part(2, b"\x10\0\x20\0\x04\0\0\x004711")].concat();
    let cases = [
        // One entry of 100 MB, in its parts.
        ([accepts(), pending()].concat(), part(0, &long), "the server sends "),
        // Entries of which none is the last.
        (accepts(), entry, "the server has more than 5000 answers"),
        // One packet.
        ([accepts(), vec![4, 0, 0x06, 0, 0, 0]].concat(), long, "the server sends 100663296 bytes"),
    ];
    for (begins, again, told) in cases {
        let (port, thread) = server(move |stream| endless(stream, &begins, &again));
        let began = Instant::now();
        let fault = ask(&worklist(port, LONG), DAY).unwrap_err().to_string();
        assert!(fault.contains(told), "{fault}");
        assert!(began.elapsed() < LONG);
        let sent = thread.join().unwrap();
        assert!(sent < READ_MOST, "{sent} bytes");
    }
}
