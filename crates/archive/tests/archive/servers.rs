//! The servers, each as one process for all tests, or one of a test's own that may be killed. They end when nothing
//! holds their standard input any longer.

use std::env;
use std::fs::{self, File};
use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use postgres::{Client, NoTls};
use tempfile::TempDir;

/// How long a server may take until it is up, on a busy machine. Ceph takes 11 s to come back on an idle one.
const UP: Duration = Duration::from_secs(180);

/// The role that no process of root may be: PostgreSQL refuses to run as root.
const ROLE: &str = "postgres";

/// What tells one start of a server from the next; nothing while it is away.
type Start = Box<dyn Fn() -> Option<String> + Send + Sync>;

/// A server that is up.
pub struct Server {
    pub port: u16,
    folder: TempDir,
    process: Child,
    start: Start,
}

/// The store of objects that takes whatever it is sent, and keeps it in memory: moto.
pub fn store() -> &'static Server {
    static STORE: LazyLock<Server> = LazyLock::new(|| {
        let port = free_port();
        let mut command = Command::new(python());
        command.arg(beside("store.py")).arg(port.to_string());
        let start = move || TcpStream::connect(("127.0.0.1", port)).ok().map(|_| String::new());
        Server::new(port, tempfile::tempdir().unwrap(), command, Box::new(start))
    });
    &STORE
}

/// moto for one test, and its port by TLS. Its certificate is `localhost.pem`, which is its own authority.
pub fn tls_store() -> (Server, u16) {
    let (port, tls_port) = (free_port(), free_port());
    let mut command = Command::new(python());
    command.arg(beside("store.py")).arg(port.to_string()).arg(tls_port.to_string());
    command.arg(tls_file("localhost.pem")).arg(tls_file("localhost.key"));
    let start = move || {
        let is_up = |port| TcpStream::connect(("127.0.0.1", port)).is_ok();
        (is_up(port) && is_up(tls_port)).then(String::new)
    };
    (Server::new(port, tempfile::tempdir().unwrap(), command, Box::new(start)), tls_port)
}

/// The store of objects that checks what it is sent, and keeps it on a disk: Ceph. One test at a time has it.
pub fn ceph() -> MutexGuard<'static, Server> {
    static CEPH: LazyLock<Mutex<Server>> = LazyLock::new(|| {
        let (port, folder) = (free_port(), tempfile::tempdir().unwrap());
        let mut command = Command::new(beside("ceph.sh"));
        command.arg(folder.path()).arg(port.to_string()).arg(free_port().to_string());
        let up = folder.path().join("up");
        let start = move || fs::read_to_string(&up).ok();
        Mutex::new(Server::new(port, folder, command, Box::new(start)))
    });
    CEPH.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The database's server.
pub fn database() -> &'static Server {
    static DATABASE: LazyLock<Server> = LazyLock::new(new_database);
    &DATABASE
}

/// A server of databases for one test.
pub fn new_database() -> Server {
    let (port, folder) = (free_port(), tempfile::tempdir().unwrap());
    let (programs, place) = (programs(), folder.path());
    // Its processes need moments to see that their first has gone, and until then none starts.
    let script = format!(
        "set -e; cd {place}; {programs}/initdb -D data -A trust -U {ROLE}; \
         (while :; do {programs}/postgres -D data -p {port} -c listen_addresses=127.0.0.1 \
         -c unix_socket_directories= -c fsync=off </dev/null || sleep 0.1; done) & \
         kills() {{ kill -9 $(head -n 1 data/postmaster.pid) || true; }}; \
         while read -r _; do kills; done; kill -9 $!; kills",
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
    command.arg("-c").arg(script);
    let start = move || {
        let mut client = Client::connect(&address(port, "postgres"), NoTls).ok()?;
        let row = client.query_one("select pg_postmaster_start_time()::text", &[]).ok()?;
        Some(row.get(0))
    };
    Server::new(port, folder, command, Box::new(start))
}

/// A connection to a database of the server at this port.
pub fn client(port: u16, name: &str) -> Client {
    Client::connect(&address(port, name), NoTls).unwrap()
}

fn address(port: u16, name: &str) -> String {
    format!("host=127.0.0.1 port={port} user={ROLE} dbname={name}")
}

impl Server {
    fn new(port: u16, folder: TempDir, mut command: Command, start: Start) -> Server {
        let said = File::create(folder.path().join("said")).unwrap();
        command.stdin(Stdio::piped()).stdout(said.try_clone().unwrap()).stderr(said);
        let server = Server { port, folder, process: command.spawn().unwrap(), start };
        server.wait_until_up("");
        server
    }

    /// Kills all its processes with -9. It starts again with what is on its disk.
    pub fn kill(&mut self) {
        let before = (self.start)().unwrap();
        self.process.stdin.as_mut().unwrap().write_all(b"\n").unwrap();
        self.wait_until_up(&before);
    }

    fn wait_until_up(&self, before: &str) {
        let began = Instant::now();
        while (self.start)().is_none_or(|start| !before.is_empty() && start == before) {
            let said = fs::read_to_string(self.folder.path().join("said")).unwrap_or_default();
            assert!(began.elapsed() < UP, "a server is not up:\n{said}");
            sleep(Duration::from_millis(20));
        }
    }
}

/// A program or script of these tests.
pub fn beside(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/archive").join(name)
}

/// A certificate or key for 127.0.0.1, by its full path.
pub fn tls_file(name: &str) -> PathBuf {
    support::root().join("fixtures/tls").join(name).canonicalize().unwrap()
}

/// The Python that has moto and boto3.
pub fn python() -> PathBuf {
    env::var_os("GAITER_PYTHON").unwrap_or_else(|| "python3".into()).into()
}

/// A port that is free now; nobody else asks for one of these within the moment.
fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
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
