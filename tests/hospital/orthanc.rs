//! Orthanc, an archive of images. It listens at every address: it is started in a network of its own alone
//! (`unshare -n`), in which the tests must run, too. Their names begin with `orthanc_`.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::thread::sleep;
use std::time::{Duration, Instant};

use gaiter::store::dicom::DicomServer;
use gaiter::store::{HttpAccess, Peer};
use gaiter_https::{Secret, TlsFiles};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::dicom_house::{Way, dimse_section, dimse_server, plain_peer, store_at};
use crate::fhir_house::Store;
use crate::server::certificates;

/// How long it may take until it answers.
const SOON: Duration = Duration::from_secs(60);

/// For a whole exchange.
const LIMIT: Duration = Duration::from_secs(50);

/// Its title.
const TITLE: &str = "ORTHANC";

/// Orthanc with an empty folder of its own.
pub struct Orthanc {
    folder: TempDir,
    port: u16,
    dimse_port: u16,
    process: Mutex<Child>,
}

/// A port that nobody has.
fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

impl Orthanc {
    pub fn new() -> Orthanc {
        Orthanc::with(tempfile::tempdir().unwrap(), &json!({}))
    }

    /// One that takes associations over TLS alone, and may ask for a certificate. It shows that of this name for
    /// `localhost`.
    pub fn over_tls(shown: &str, asks: bool) -> Orthanc {
        let folder = tempfile::tempdir().unwrap();
        certificates(folder.path());
        let path = |name: &str| folder.path().join(name);
        let further = json!({
            "DicomTlsEnabled": true,
            "DicomTlsCertificate": path(&format!("{shown}.pem")),
            "DicomTlsPrivateKey": path(&format!("{shown}.key")),
            "DicomTlsTrustedCertificates": path("ca.pem"),
            "DicomTlsRemoteCertificateRequired": asks,
        });
        Orthanc::with(folder, &further)
    }

    fn with(folder: TempDir, further: &Value) -> Orthanc {
        // A heading and no route: nothing leads out.
        let routes = fs::read_to_string("/proc/net/route").unwrap();
        assert!(routes.lines().count() <= 1, "run it by unshare -n, with the interface lo up");
        let (port, dimse_port) = (free_port(), free_port());
        let path = |name: &str| folder.path().join(name);
        let mut settings = json!({
            "StorageDirectory": path("db"), "IndexDirectory": path("index"),
            "Plugins": ["/usr/share/orthanc/plugins/libOrthancDicomWeb.so"],
            "HttpPort": port, "DicomPort": dimse_port, "RemoteAccessAllowed": false,
            "DicomAet": TITLE, "DicomCheckCalledAet": true,
            "DicomAlwaysAllowStore": true, "DicomAlwaysAllowFind": true,
            "AuthenticationEnabled": true, "RegisteredUsers": {"clinic": "pw"},
            "DicomWeb": {"Enable": true, "Root": "/dicom-web/"},
        });
        let further = further.as_object().cloned().unwrap_or_default();
        settings.as_object_mut().unwrap().extend(further);
        fs::write(path("orthanc.json"), settings.to_string()).unwrap();
        fs::write(path("secret"), "pw\n").unwrap();
        let process = Mutex::new(started(folder.path()));
        let orthanc = Orthanc { folder, port, dimse_port, process };
        orthanc.is_up();
        orthanc
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn is_up(&self) {
        let (store, began) = (self.store(), Instant::now());
        while let Err(fault) = store.reach() {
            assert!(began.elapsed() < SOON, "{fault}");
            sleep(Duration::from_millis(50));
        }
    }

    pub fn is_killed(&self) {
        let mut process = self.process.lock().unwrap();
        process.kill().unwrap();
        process.wait().unwrap();
    }

    /// Up again after it was killed, with what it has on its disk.
    pub fn starts_again(&self) {
        *self.process.lock().unwrap() = started(self.folder.path());
        self.is_up();
    }

    /// A store that asks it over DICOMweb.
    pub fn store(&self) -> Store {
        store_at(DicomServer::Web {
            base: self.base(),
            access: HttpAccess::Basic {
                user: "clinic".to_owned(),
                password: Secret::File(self.path("secret")),
            },
            tls: TlsFiles::default(),
            limit: LIMIT,
        })
    }

    /// The same server, asked over associations.
    pub fn by_associations(&self) -> Store {
        self.by_title(TITLE)
    }

    /// The same, called by this title.
    pub fn by_title(&self, called: &str) -> Store {
        store_at(dimse_server(plain_peer(self.dimse_port, LIMIT), called))
    }

    /// The same, by TLS.
    pub fn by_tls(&self, host: &str, tls: TlsFiles) -> Store {
        let (host, port) = (host.to_owned(), self.dimse_port);
        store_at(dimse_server(Peer { host, port, tls: Some(tls), limit: LIMIT }, TITLE))
    }

    /// Whom a store trusts that asks it by TLS, with a certificate of its own or without.
    pub fn tls(&self, own: bool) -> TlsFiles {
        let own = own.then(|| (self.path("client.pem"), Secret::File(self.path("client.key"))));
        TlsFiles { authorities: Some(self.path("ca.pem")), own }
    }

    /// The configuration of a station that sends to it.
    pub fn section(&self, way: Way) -> String {
        match way {
            Way::Web => format!(
                "[store.dicom]\naddress = \"{}\"\naccess = \"basic\"\nuser = \"clinic\"\n\
                 secret = \"{}\"\nattach = [\"report.pdf\"]\n",
                self.base(),
                self.path("secret").display()
            ),
            Way::Dimse => dimse_section(self.dimse_port, TITLE),
        }
    }

    fn base(&self) -> String {
        format!("http://127.0.0.1:{}/dicom-web", self.port)
    }

    /// How many objects it has.
    pub fn count(&self) -> u64 {
        self.asked("statistics")["CountInstances"].as_u64().unwrap()
    }

    /// How many objects it shows of a patient.
    pub fn count_of(&self, patient: &str) -> usize {
        self.asked(&format!("dicom-web/instances?PatientID={patient}")).as_array().unwrap().len()
    }

    fn asked(&self, path: &str) -> Value {
        let address = format!("http://127.0.0.1:{}/{path}", self.port);
        let done = Command::new("curl").args(["-s", "-u", "clinic:pw"]).arg(address).output();
        serde_json::from_slice(&done.unwrap().stdout).unwrap()
    }
}

fn started(folder: &Path) -> Child {
    let mut command = Command::new("/usr/sbin/Orthanc");
    command.arg(folder.join("orthanc.json")).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().unwrap()
}

impl Drop for Orthanc {
    fn drop(&mut self) {
        if let Ok(process) = self.process.get_mut() {
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}
