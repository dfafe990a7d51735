//! The servers, each as one process for all tests. They end when nothing holds their standard input any longer.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::net::TcpListener;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::LazyLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

use postgres::{Client, NoTls};
use tempfile::TempDir;

/// How long a server may take until it is up.
const UP: Duration = Duration::from_secs(60);

/// The role that no process of root may be: PostgreSQL refuses to run as root.
const ROLE: &str = "postgres";

/// A server that is up.
pub struct Server {
    pub port: u16,
    _folder: TempDir,
    _process: Child,
}

/// The store of objects.
pub fn store() -> &'static Server {
    static STORE: LazyLock<Server> = LazyLock::new(started_store);
    &STORE
}

/// The database's server.
pub fn database() -> &'static Server {
    static DATABASE: LazyLock<Server> = LazyLock::new(started_database);
    &DATABASE
}

/// A connection to a database of the server.
pub fn client(name: &str) -> Client {
    let at = format!("host=127.0.0.1 port={} user={ROLE} dbname={name}", database().port);
    Client::connect(&at, NoTls).unwrap()
}

fn started_store() -> Server {
    let folder = tempfile::tempdir().unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/archive/store.py");
    let port = folder.path().join("port");
    let said = fs::File::create(folder.path().join("said")).unwrap();
    let mut command = Command::new(python());
    command.arg(script).arg(&port).stdin(Stdio::piped());
    let process = command.stdout(said.try_clone().unwrap()).stderr(said).spawn().unwrap();
    let began = Instant::now();
    let port = loop {
        if let Ok(port) = fs::read_to_string(&port) {
            break port.parse().unwrap();
        }
        let said = fs::read_to_string(folder.path().join("said")).unwrap_or_default();
        assert!(began.elapsed() < UP, "the store is not up:\n{said}");
        sleep(Duration::from_millis(20));
    };
    Server { port, _folder: folder, _process: process }
}

/// The Python that has moto and pyarrow.
pub fn python() -> OsString {
    env::var_os("GAITER_PYTHON").unwrap_or_else(|| "python3".into())
}

/// The folder of PostgreSQL's programs, which Debian has not in the path.
fn programs() -> PathBuf {
    if let Some(folder) = env::var_os("GAITER_POSTGRES") {
        return folder.into();
    }
    let versions = fs::read_dir("/usr/lib/postgresql").unwrap();
    let versions = versions.map(|entry| entry.unwrap().path().join("bin"));
    versions.filter(|folder| folder.join("initdb").exists()).max().unwrap()
}

fn started_database() -> Server {
    let folder = tempfile::tempdir().unwrap();
    // Free now, and nobody else asks for one of these within the moment.
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let (programs, place) = (programs(), folder.path());
    // The shell holds the input that the tests hold, and ends the server with it.
    let script = format!(
        "set -e; cd {place}; {programs}/initdb -D data -A trust -U {ROLE} >said 2>&1; \
         {programs}/postgres -D data -p {port} -c listen_addresses=127.0.0.1 \
         -c unix_socket_directories= -c fsync=off >>said 2>&1 & cat >/dev/null; kill -9 $!",
        place = place.display(),
        programs = programs.display()
    );
    let mut command = Command::new("sh");
    if fs::metadata("/proc/self").unwrap().uid() == 0 {
        let owned = Command::new("chown").arg(ROLE).arg(place).status().unwrap();
        assert!(owned.success(), "there is no role {ROLE} on this machine");
        command = Command::new("setpriv");
        command.arg(format!("--reuid={ROLE}")).arg(format!("--regid={ROLE}"));
        command.args(["--clear-groups", "sh"]);
    }
    let process = command.arg("-c").arg(script).stdin(Stdio::piped()).spawn().unwrap();
    let (began, at) = (Instant::now(), format!("host=127.0.0.1 port={port} user={ROLE}"));
    while let Err(why) = Client::connect(&at, NoTls) {
        let said = fs::read_to_string(place.join("said")).unwrap_or_default();
        assert!(began.elapsed() < UP, "the database is not up: {why}\n{said}");
        sleep(Duration::from_millis(50));
    }
    Server { port, _folder: folder, _process: process }
}
