//! The servers, as processes of their own, and certificates for them.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use gaiter::flow::server::TlsFiles;
use gaiter::store::http::{HttpClient, HttpRequest};
use hyper::Method;
use serde_json::Value;
use tempfile::TempDir;

/// How long a server may take until it is up: it reads the definitions of R4 first.
const UP: Duration = Duration::from_secs(120);

/// A server in a folder of its own.
pub struct Server {
    process: Child,
    pub folder: TempDir,
    is_encrypted: bool,
}

impl Server {
    /// Medplum's FHIR router; `prepare` puts files into its folder before it starts.
    pub fn fhir(is_encrypted: bool, prepare: impl FnOnce(&Path)) -> Server {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hospital/fhir_server.mjs");
        let mut command = Command::new("node");
        command.arg(script);
        Server::started(command, is_encrypted, prepare)
    }

    /// A receiver of HL7 v2.
    pub fn hl7(is_encrypted: bool, prepare: impl FnOnce(&Path)) -> Server {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hospital/hl7_receiver.py");
        let mut command = Command::new(python());
        command.arg(script);
        Server::started(command, is_encrypted, prepare)
    }

    fn started(mut command: Command, is_encrypted: bool, prepare: impl FnOnce(&Path)) -> Server {
        let folder = tempfile::tempdir().unwrap();
        prepare(folder.path());
        command.arg(folder.path());
        if is_encrypted {
            command.arg("tls");
        }
        let said = fs::File::create(folder.path().join("said")).unwrap();
        command.stdin(Stdio::null()).stdout(said.try_clone().unwrap()).stderr(said);
        let mut server = Server { process: command.spawn().unwrap(), folder, is_encrypted };
        let began = Instant::now();
        while !server.path("port").exists() {
            let ended = server.process.try_wait().unwrap();
            let said = fs::read_to_string(server.path("said")).unwrap_or_default();
            let said = said.chars().rev().take(2000).collect::<String>();
            let said: String = said.chars().rev().collect();
            assert!(ended.is_none() && began.elapsed() < UP, "the server is not up:\n{said}");
            sleep(Duration::from_millis(50));
        }
        server
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn port(&self) -> u16 {
        fs::read_to_string(self.path("port")).unwrap().parse().unwrap()
    }

    /// Its address; the name is one that its certificate has.
    pub fn address(&self) -> String {
        match self.is_encrypted {
            true => format!("https://localhost:{}", self.port()),
            false => format!("http://127.0.0.1:{}", self.port()),
        }
    }

    /// From now on it answers like this.
    pub fn becomes(&self, mode: &str) {
        fs::write(self.path("mode"), mode).unwrap();
    }

    /// The lines of its log.
    pub fn log(&self) -> Vec<String> {
        let log = fs::read_to_string(self.path("log")).unwrap_or_default();
        log.lines().map(str::to_owned).collect()
    }

    /// The resources of a kind that it has, for a server that is asked without TLS.
    pub fn resources(&self, kind: &str) -> Vec<Value> {
        let bundle = self.get(&format!("{kind}?_count=1000"));
        let entries = bundle["entry"].as_array().cloned().unwrap_or_default();
        entries.into_iter().map(|mut entry| entry["resource"].take()).collect()
    }

    pub fn get(&self, path: &str) -> Value {
        self.asked(Method::GET, path, Vec::new())
    }

    /// Creates a resource.
    pub fn create(&self, resource: &Value) -> Value {
        let kind = resource["resourceType"].as_str().unwrap();
        self.asked(Method::POST, kind, resource.to_string().into_bytes())
    }

    fn asked(&self, method: Method, path: &str, body: Vec<u8>) -> Value {
        let client = HttpClient::new(TlsFiles::default(), None, Duration::from_secs(30));
        let uri = format!("{}/{path}", self.address()).parse().unwrap();
        let answer = client.send(HttpRequest { method, uri, headers: Vec::new(), body }).unwrap();
        serde_json::from_slice(&answer.body).unwrap()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A Python with hl7apy and jsonschema.
pub fn python() -> PathBuf {
    env::var_os("GAITER_PYTHON").map_or_else(|| PathBuf::from("python3"), PathBuf::from)
}

/// Makes an authority, a server's certificate for `localhost` and a client's, as PEM in a folder: `ca.pem`,
/// `server.pem` and `server.key`, `client.pem` and `client.key`.
pub fn certificates(folder: &Path) {
    let openssl = |args: &[&str]| {
        let done = Command::new("openssl").args(args).current_dir(folder).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    };
    let curve = ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "30"];
    let ca = ["-x509", "-subj", "/CN=House CA", "-keyout", "ca.key", "-out", "ca.pem"];
    openssl(&[&["req"], &curve[..], &ca].concat());
    for (name, subject, alternative) in
        [("server", "/CN=localhost", "DNS:localhost"), ("client", "/CN=gaiter", "DNS:gaiter")]
    {
        let (key, request) = (format!("{name}.key"), format!("{name}.csr"));
        let asked = ["-subj", subject, "-keyout", &key, "-out", &request];
        openssl(&[&["req"], &curve[..], &asked].concat());
        let extension = folder.join(format!("{name}.ext"));
        fs::write(&extension, format!("subjectAltName={alternative}\n")).unwrap();
        let signed = format!("{name}.pem");
        let extension = format!("{name}.ext");
        openssl(&[
            "x509",
            "-req",
            "-in",
            &request,
            "-CA",
            "ca.pem",
            "-CAkey",
            "ca.key",
            "-CAcreateserial",
            "-days",
            "30",
            "-extfile",
            &extension,
            "-out",
            &signed,
        ]);
    }
}
