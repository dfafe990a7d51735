//! The servers, each as one process for all tests but those that kill it, and the houses in them: every test has one
//! of its own.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{LazyLock, Mutex};
use std::thread::sleep;
use std::time::{Duration, Instant};

use nix::sys::signal::Signal;
use tempfile::TempDir;

/// How long a server may take until it is up: one reads the definitions of R4 first.
const UP: Duration = Duration::from_secs(120);

/// How long a line of a log is waited for.
const SOON: Duration = Duration::from_secs(120);

/// A server that is up.
pub struct Server {
    folder: TempDir,
    life: Mutex<Life>,
}

/// A server from its start to its end.
struct Life {
    command: Command,
    /// It ends when nothing holds its standard input any longer, which is when the tests end.
    process: Child,
    ports: BTreeMap<String, u16>,
}

/// A server of its own within one: its files, and what was sent to it.
pub struct House {
    pub server: &'static Server,
    pub name: String,
}

/// Medplum's FHIR router.
pub fn fhir() -> &'static Server {
    static FHIR: LazyLock<Server> = LazyLock::new(new_fhir);
    &FHIR
}

/// Medplum's FHIR router for one test, which may kill it.
pub fn own_fhir() -> &'static Server {
    Box::leak(Box::new(new_fhir()))
}

fn new_fhir() -> Server {
    Server::started(Command::new("node"), "fhir_server.mjs")
}

/// A receiver of HL7 v2.
pub fn hl7() -> &'static Server {
    static HL7: LazyLock<Server> = LazyLock::new(new_hl7);
    &HL7
}

/// A receiver of HL7 v2 for one test, which may kill it.
pub fn own_hl7() -> &'static Server {
    Box::leak(Box::new(new_hl7()))
}

fn new_hl7() -> Server {
    Server::started(Command::new(python()), "hl7_receiver.py")
}

/// An archive of images.
pub fn dicom() -> &'static Server {
    static DICOM: LazyLock<Server> = LazyLock::new(new_dicom);
    &DICOM
}

/// An archive of images for one test, which may kill it.
pub fn own_dicom() -> &'static Server {
    Box::leak(Box::new(new_dicom()))
}

fn new_dicom() -> Server {
    Server::started(Command::new(python()), "dicom_archive.py")
}

/// A Python with hl7apy, jsonschema, pynetdicom and highdicom.
pub fn python() -> PathBuf {
    env::var_os("GAITER_PYTHON").map_or_else(|| PathBuf::from("python3"), PathBuf::from)
}

/// A file beside these tests.
pub fn script(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hospital").join(name)
}

impl Server {
    fn started(mut command: Command, name: &str) -> Server {
        let folder = tempfile::tempdir().unwrap();
        certificates(folder.path());
        fs::write(folder.path().join("temporary"), "").unwrap();
        // Where a redirect leads.
        fs::create_dir(folder.path().join("elsewhere")).unwrap();
        let said = fs::File::create(folder.path().join("said")).unwrap();
        command.arg(script(name)).arg(folder.path()).stdin(Stdio::piped());
        command.stdout(said.try_clone().unwrap()).stderr(said);
        let (process, ports) = up(&mut command, folder.path());
        Server { folder, life: Mutex::new(Life { command, process, ports }) }
    }

    /// Starts it again after it was killed, with what it has in its folder and at other ports.
    #[track_caller]
    pub fn starts_again(&self) {
        let mut life = self.life.lock().unwrap();
        // This closes its standard input: one that was not killed ends, too.
        let ended = life.process.wait().unwrap();
        assert_eq!(ended.signal(), Some(Signal::SIGKILL as i32), "{ended}");
        fs::remove_file(self.path("ports")).unwrap();
        (life.process, life.ports) = up(&mut life.command, self.folder.path());
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The port of a way in: `http`, `https`, `plain`, `tls`, `mutual`, `expired`, `proxy`, `dimse`.
    pub fn port(&self, way: &str) -> u16 {
        self.life.lock().unwrap().ports[way]
    }
}

/// Starts a server and waits until it is up. Tells its ports.
fn up(command: &mut Command, folder: &Path) -> (Child, BTreeMap<String, u16>) {
    let mut process = command.spawn().unwrap();
    let (ports, began) = (folder.join("ports"), Instant::now());
    while !ports.exists() {
        let ended = process.try_wait().unwrap();
        let said = fs::read_to_string(folder.join("said")).unwrap_or_default();
        assert!(ended.is_none() && began.elapsed() < UP, "the server is not up:\n{said}");
        sleep(Duration::from_millis(20));
    }
    (process, serde_json::from_slice(&fs::read(ports).unwrap()).unwrap())
}

impl House {
    pub fn new(server: &'static Server) -> House {
        static COUNT: AtomicUsize = AtomicUsize::new(1);
        let name = format!("house-{}", COUNT.fetch_add(1, Ordering::Relaxed));
        fs::create_dir(server.path(&name)).unwrap();
        House { server, name }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.server.path(&self.name).join(name)
    }

    /// From now on it has this fault; empty for none. The scripts say which there are.
    pub fn becomes(&self, fault: &str) {
        let new = self.path("mode.new");
        fs::write(&new, fault).unwrap();
        fs::rename(new, self.path("mode")).unwrap();
    }

    /// How often a fault has struck.
    pub fn strikes(&self) -> usize {
        self.log().iter().filter(|line| line.starts_with("strikes ")).count()
    }

    pub fn log(&self) -> Vec<String> {
        let log = fs::read_to_string(self.path("log")).unwrap_or_default();
        log.lines().map(str::to_owned).collect()
    }

    /// The rest of a line of the log that begins like this, once it is there.
    #[track_caller]
    pub fn said(&self, begin: &str) -> String {
        let began = Instant::now();
        loop {
            let log = self.log();
            if let Some(rest) = log.iter().find_map(|line| line.strip_prefix(begin)) {
                return rest.to_owned();
            }
            assert!(began.elapsed() < SOON, "no {begin:?} in {log:?}");
            sleep(Duration::from_millis(20));
        }
    }
}

/// Runs openssl in a folder.
pub fn openssl(folder: &Path, words: &str) {
    let done = Command::new("openssl").args(words.split(' ')).current_dir(folder).output().unwrap();
    assert!(done.status.success(), "openssl {words}: {}", String::from_utf8_lossy(&done.stderr));
}

/// How the authority signs.
const AUTHORITY: &str = "[ca]\ndefault_ca=own\n[own]\nnew_certs_dir=.\ndatabase=index.txt\n\
    serial=serial.txt\ndefault_md=sha256\npolicy=any\ncopy_extensions=copy\nunique_subject=no\n\
    [any]\ncommonName=supplied\n";

/// Makes an authority, `ca.pem`; a server's certificate for `localhost`, the same that ran out years ago, and a
/// client's; each with its key: `server.pem` and `server.key`, `expired.…`, `client.…`.
pub fn certificates(folder: &Path) {
    const CURVE: &str = "-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes";
    for (name, text) in [("ca.cnf", AUTHORITY), ("index.txt", ""), ("serial.txt", "01\n")] {
        fs::write(folder.join(name), text).unwrap();
    }
    let own = format!("req -x509 {CURVE} -days 30 -subj /CN=House -keyout ca.key -out ca.pem");
    openssl(folder, &own);
    for (name, host, end) in [
        ("server", "localhost", "2049"),
        ("expired", "localhost", "2021"),
        ("client", "gaiter", "2049"),
    ] {
        let asked = format!(
            "req {CURVE} -subj /CN={host} -addext subjectAltName=DNS:{host} -keyout {name}.key -out {name}.csr"
        );
        openssl(folder, &asked);
        let signed = format!(
            "ca -batch -notext -config ca.cnf -cert ca.pem -keyfile ca.key -in {name}.csr -out {name}.pem \
             -startdate 20200101000000Z -enddate {end}0101000000Z"
        );
        openssl(folder, &signed);
    }
}
