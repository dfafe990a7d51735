//! Objects of DICOM, judged by dciodvfy and read by dsrdump, and stored in Orthanc.
//!
//! Orthanc listens at every address: it is started in a network of its own alone (`unshare -n`), in which the tests must
//! run, too.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use gaiter::store::DicomStore;
use gaiter::store::dicom::{DicomAccess, DicomServer, DicomWay, DimseServer};
use gaiter_dicom::dimse::{AeTitle, Titles};
use gaiter_dicom::{DicomObject, DicomRules, Sent, SopClass, Study, objects};
use gaiter_https::{Secret, TlsFiles};
use gaiter_leg::Side;
use gaiter_record::RecordFile;
use serde_json::{Value, json};
use support::records::dicom_rules;
use tempfile::TempDir;

use crate::fhir_house::{Store, put, setback};
use crate::records::{PATIENT, SCANS, SMALL, Scan};

/// How long Orthanc may take until it answers, and until it has ended.
const SOON: Duration = Duration::from_secs(60);

/// Deliveries that are replayed.
const REPLAYS: usize = 1000;

/// An STL file without a triangle.
const NO_TRIANGLES: [u8; 84] = [0; 84];

fn rules() -> DicomRules {
    DicomRules { issuer: "KIS".to_owned(), ..dicom_rules(&["report.pdf", "left.stl"]) }
}

/// A scan whose record has a mesh, too.
fn with_mesh(scan: &Scan) -> Scan {
    let mut scan = scan.with(scan.record.clone(), &[]);
    scan.files.push(RecordFile { name: "left.stl".to_owned(), bytes: NO_TRIANGLES.to_vec() });
    scan
}

fn objects_of(scan: &Scan) -> Vec<DicomObject> {
    let study = Study::new(scan.id.as_str(), PATIENT).unwrap();
    let first_seen = scan.delivery().first_seen;
    let (record, files) = (&scan.record, &scan.files);
    objects(&Sent { record, files, first_seen, study: &study, withdrawals: 0 }, &rules())
}

/// What a program says about a file.
fn told(program: &str, words: &[&str], file: &Path) -> String {
    let done = Command::new(program).args(words).arg(file).output().unwrap();
    let both = [done.stdout, done.stderr].concat();
    String::from_utf8_lossy(&both).into_owned()
}

#[test]
#[ignore = "needs dciodvfy and dsrdump, run by .ci/run"]
fn every_object_is_valid_and_the_report_is_read_with_all_figures_of_the_sheet() {
    let folder = tempfile::tempdir().unwrap();
    for scan in &*SCANS {
        for object in objects_of(&with_mesh(scan)) {
            let file = folder.path().join(object.uid());
            fs::write(&file, object.file().unwrap()).unwrap();
            let judged = told("dciodvfy", &[], &file);
            assert!(!judged.contains("Error"), "{:?}: {judged}", object.class());
            if object.class() == SopClass::Measurements {
                assert_eq!(figures(&told("dsrdump", &["+Pl"], &file)), expected(scan));
            }
        }
    }
}

/// The figures in a report as dsrdump writes it, by leg and box.
fn figures(report: &str) -> BTreeMap<String, String> {
    let (mut side, mut last) = ("", None);
    let mut figures = BTreeMap::new();
    for line in report.lines().map(str::trim) {
        let quoted = line.rsplit_once("=\"").and_then(|(_, rest)| rest.split('"').next());
        if line.contains("\"Laterality\")") {
            side = if line.contains("24028007") { "right" } else { "left" };
        } else if line.starts_with("<contains NUM:") {
            let letter = if line.contains("\"Circumference\"") { 'c' } else { 'l' };
            last = quoted.map(|cm| (letter, cm));
        } else if line.contains("\"Topographical modifier\")") {
            let level = line.split("=(").nth(1).and_then(|code| code.split(',').next()).unwrap();
            let (letter, cm) = last.take().unwrap();
            figures.insert(format!("{side} {letter}{level}"), cm.to_owned());
        }
    }
    figures
}

/// The figures of a record's sheet by leg and box.
fn expected(scan: &Scan) -> BTreeMap<String, String> {
    let of = |side: Side| {
        let sheet = scan.sheet(side).into_iter();
        sheet.map(move |(code, cm)| (format!("{} {code}", side.word()), cm))
    };
    of(Side::Right).chain(of(Side::Left)).collect()
}

/// Orthanc with an empty folder of its own.
struct Orthanc {
    folder: TempDir,
    port: u16,
    dicom_port: u16,
    process: Child,
}

/// A port that nobody has.
fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

impl Orthanc {
    fn new() -> Orthanc {
        // A heading and no route: nothing leads out.
        let routes = fs::read_to_string("/proc/net/route").unwrap();
        assert!(routes.lines().count() <= 1, "run it by unshare -n, with the interface lo up");
        let folder = tempfile::tempdir().unwrap();
        let (port, dicom_port) = (free_port(), free_port());
        let path = |name: &str| folder.path().join(name);
        let settings = json!({
            "StorageDirectory": path("db"), "IndexDirectory": path("index"),
            "Plugins": ["/usr/share/orthanc/plugins/libOrthancDicomWeb.so"],
            "HttpPort": port, "DicomPort": dicom_port, "RemoteAccessAllowed": false,
            "DicomAlwaysAllowStore": true, "DicomAlwaysAllowFind": true,
            "AuthenticationEnabled": true, "RegisteredUsers": {"clinic": "pw"},
            "DicomWeb": {"Enable": true, "Root": "/dicom-web/"},
        });
        fs::write(path("orthanc.json"), settings.to_string()).unwrap();
        fs::write(path("secret"), "pw\n").unwrap();
        let process = Orthanc::started(folder.path());
        let orthanc = Orthanc { folder, port, dicom_port, process };
        orthanc.is_up();
        orthanc
    }

    fn started(folder: &Path) -> Child {
        let mut command = Command::new("/usr/sbin/Orthanc");
        command.arg(folder.join("orthanc.json")).stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().unwrap()
    }

    fn is_up(&self) {
        let (store, began) = (self.store(), Instant::now());
        while let Err(fault) = store.reach() {
            assert!(began.elapsed() < SOON, "{fault}");
            sleep(Duration::from_millis(50));
        }
    }

    /// Killed, and up again with what it has on its disk.
    fn killed(&mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
        self.process = Orthanc::started(self.folder.path());
        self.is_up();
    }

    fn store(&self) -> Store {
        let password = Secret::File(self.folder.path().join("secret"));
        let server = DicomServer {
            way: DicomWay::Web {
                base: format!("http://127.0.0.1:{}/dicom-web", self.port),
                access: DicomAccess::Basic { user: "clinic".to_owned(), password },
                tls: TlsFiles::default(),
            },
            limit: Duration::from_secs(50),
        };
        Box::new(DicomStore::new(server, rules(), "booth-1"))
    }

    /// The same server, asked over associations.
    fn by_associations(&self) -> Store {
        let title = |text: &str| AeTitle::new(text).unwrap();
        let server = DimseServer {
            host: "127.0.0.1".to_owned(),
            port: self.dicom_port,
            titles: Titles { calling: title("GAITER"), called: title("ORTHANC") },
            tls: None,
        };
        let server = DicomServer { way: DicomWay::Dimse(server), limit: Duration::from_secs(50) };
        Box::new(DicomStore::new(server, rules(), "booth-1"))
    }

    /// How many objects it has.
    fn count(&self) -> u64 {
        let address = format!("http://127.0.0.1:{}/statistics", self.port);
        let done = Command::new("curl").args(["-s", "-u", "clinic:pw"]).arg(address).output();
        let told: Value = serde_json::from_slice(&done.unwrap().stdout).unwrap();
        told["CountInstances"].as_u64().unwrap()
    }
}

impl Drop for Orthanc {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_has_each_object_once_however_often_it_is_sent_and_after_it_was_killed() {
    let mut orthanc = Orthanc::new();
    let scan = with_mesh(&SCANS[1]);
    assert!(!put(&orthanc.store(), &scan).already_there);
    assert_eq!(orthanc.count(), 3);
    orthanc.killed();
    let store = orthanc.store();
    for _ in 0..REPLAYS {
        assert!(put(&store, &scan).already_there);
    }
    assert_eq!(orthanc.count(), 3);
    // Small: the figures alone.
    assert!(!put(&store, &SMALL.amended(391.0)).already_there);
    assert_eq!(orthanc.count(), 4);
}

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_keeps_what_was_taken_back_with_its_mark_and_takes_it_again() {
    let orthanc = Orthanc::new();
    let store = orthanc.store();
    let receipt = put(&store, &SMALL).folder;
    for _ in 0..2 {
        store.withdraw(&SMALL.id, Some(PATIENT), None, receipt.to_str()).unwrap();
        assert_eq!(orthanc.count(), 2);
    }
    assert!(!put(&store, &SMALL).already_there);
    assert_eq!(orthanc.count(), 3);
}

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_that_wants_another_password_is_asked_again_and_gets_nothing() {
    let orthanc = Orthanc::new();
    fs::write(orthanc.folder.path().join("secret"), "other\n").unwrap();
    let fault = setback(&orthanc.store(), &SMALL);
    assert!(fault.contains("401") && !fault.contains("other"), "{fault}");
    fs::write(orthanc.folder.path().join("secret"), "pw\n").unwrap();
    assert_eq!(orthanc.count(), 0);
}

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_over_associations_has_the_same_objects_once_and_takes_them_back() {
    let orthanc = Orthanc::new();
    let scan = with_mesh(&SCANS[1]);
    let store = orthanc.by_associations();
    store.reach().unwrap();
    let receipt = put(&store, &scan);
    assert!(!receipt.already_there);
    assert_eq!(orthanc.count(), 3);
    for _ in 0..REPLAYS {
        assert!(put(&store, &scan).already_there);
    }
    // Over DICOMweb, too, it is there already.
    assert!(put(&orthanc.store(), &scan).already_there);
    assert_eq!(orthanc.count(), 3);
    store.withdraw(&scan.id, Some(PATIENT), None, receipt.folder.to_str()).unwrap();
    assert_eq!(orthanc.count(), 4);
}
