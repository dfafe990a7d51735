//! A station on temporary folders, started as the real program, and the oracle over what it left.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rusqlite::{Connection, OpenFlags};
use rustix::process::{Pid, Signal, kill_process};
use sha2::{Digest, Sha256};
use tempfile::TempDir;

/// How long a condition is waited for before the test fails.
const PATIENCE: Duration = Duration::from_secs(120);

/// The quiet time of the stations under test.
pub const QUIET: Duration = Duration::from_millis(300);

/// A scan that can be measured; each `n` gives other bytes of the same body.
pub fn body(n: usize) -> Vec<u8> {
    let mut bytes = fixture();
    bytes.extend(format!("# {n}\n").bytes());
    bytes
}

fn fixture() -> Vec<u8> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/scans/f_average_clean.obj.gz");
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(File::open(file).unwrap()).read_to_end(&mut bytes).unwrap();
    bytes
}

/// SHA-256, lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The folders of one station, and what was put before it.
pub struct Booth {
    dir: TempDir,
}

/// A running station.
pub struct Daemon {
    child: Child,
}

/// A record in the store: its patient folder's name and the SHA-256 of its scan.
pub type Record = (String, String);

impl Booth {
    /// Empty folders and a configuration that settles quickly.
    pub fn new() -> Booth {
        let dir = TempDir::new().unwrap();
        let at = dir.path().display();
        let config = format!(
            r#"[station]
id = "booth-1"
state_dir = "{at}/state"
[scanner]
export_dirs = ["{at}/export"]
quiet = "{quiet}ms"
rescan = "1s"
short_wait = "3s"
max_scan = "20MB"
file_name = '^(?<patient>P?[0-9]+)_'
[patient]
pattern = '^P?[0-9]{{1,12}}$'
[store.folder]
path = "{at}/records"
"#,
            quiet = QUIET.as_millis()
        );
        fs::write(dir.path().join("station.toml"), config).unwrap();
        for folder in ["export", "records"] {
            fs::create_dir(dir.path().join(folder)).unwrap();
        }
        Booth { dir }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gaiter"));
        let log = File::options().create(true).append(true).open(self.path("log")).unwrap();
        let config = self.path("station.toml");
        command.arg("run").arg("--config").arg(config).stdin(Stdio::null());
        command.stdout(log.try_clone().unwrap()).stderr(log);
        command
    }

    /// Rewrites the configuration for stations to be started.
    pub fn reconfigure(&self, change: impl FnOnce(String) -> String) {
        let file = self.path("station.toml");
        fs::write(&file, change(fs::read_to_string(&file).unwrap())).unwrap();
    }

    pub fn start(&self) -> Daemon {
        Daemon::of(self.command())
    }

    /// Writes an export in one go.
    pub fn export(&self, name: &str, bytes: &[u8]) {
        fs::write(self.path("export").join(name), bytes).unwrap();
    }

    pub fn log(&self) -> String {
        String::from_utf8_lossy(&fs::read(self.path("log")).unwrap()).into_owned()
    }

    /// Waits until a condition holds; fails with the log where it never does.
    #[track_caller]
    pub fn wait_for(&self, what: &str, mut holds: impl FnMut() -> bool) {
        let deadline = Instant::now() + PATIENCE;
        while !holds() {
            assert!(Instant::now() < deadline, "{what} never came; log:\n{}", self.log());
            sleep(Duration::from_millis(20));
        }
    }

    /// Waits until the store holds so many records, each of them whole.
    #[track_caller]
    pub fn wait_for_records(&self, count: usize) {
        let records = self.path("records");
        let folders =
            || names(&records).into_iter().flat_map(|patient| names(&records.join(patient)));
        let final_names = || folders().filter(|name| !name.starts_with('.')).count();
        self.wait_for(&format!("{count} records"), || final_names() >= count);
        assert_eq!(self.records().len(), count);
    }

    /// Waits until a query on the journal gives a number.
    #[track_caller]
    pub fn wait_for_journal(&self, query: &str, number: i64) {
        self.wait_for(&format!("{number} from {query}"), || self.journal(query) == Some(number));
    }

    /// As [`Booth::wait_for_journal`], as long as the number still changes within [`PATIENCE`].
    #[track_caller]
    pub fn wait_long_for_journal(&self, query: &str, number: i64) {
        let (mut last, mut since) = (None, Instant::now());
        while last != Some(number) {
            let now = self.journal(query);
            if now != last {
                (last, since) = (now, Instant::now());
            }
            assert!(since.elapsed() < PATIENCE, "{query} stays {last:?}; log:\n{}", self.log());
            sleep(Duration::from_millis(200));
        }
    }

    /// The number a query on the journal gives; none while there is no journal.
    pub fn journal(&self, query: &str) -> Option<i64> {
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE;
        let journal = Connection::open_with_flags(self.path("state/journal.db"), flags).ok()?;
        journal.query_row(query, [], |row| row.get(0)).ok()
    }

    /// The oracle: what lies under a final name is whole, and nothing else lies there.
    #[track_caller]
    pub fn records(&self) -> Vec<Record> {
        let mut records = Vec::new();
        for patient in names(&self.path("records")) {
            let folder = self.path("records").join(&patient);
            for name in names(&folder).into_iter().filter(|name| !name.starts_with('.')) {
                let (time, scan) = name.split_once('_').expect("a time and a scan");
                assert_eq!((time.len(), scan.len()), (16, 8), "{name}");
                let sum = whole(&folder.join(&name));
                assert!(sum.starts_with(scan), "{name} holds {sum}");
                records.push((patient.clone(), sum));
            }
        }
        records.sort();
        records
    }

    /// The oracle after a stop: exactly one whole record per scan and patient, no rest of staging
    /// or spooling, and the journal agrees.
    #[track_caller]
    pub fn assert_settled(&self, expected: &[(&str, &[u8])]) {
        let mut expected: Vec<Record> =
            expected.iter().map(|(id, bytes)| ((*id).to_owned(), sha256(bytes))).collect();
        expected.sort();
        assert_eq!(self.records(), expected, "log:\n{}", self.log());
        for patient in names(&self.path("records")) {
            let folder = self.path("records").join(&patient);
            let staged: Vec<String> =
                names(&folder).into_iter().filter(|name| name.starts_with('.')).collect();
            assert!(staged.is_empty(), "{staged:?}");
        }
        let delivered = self.journal("SELECT count(*) FROM deliveries WHERE state = 'delivered'");
        assert_eq!(delivered, i64::try_from(expected.len()).ok());
        let pending = self.journal("SELECT count(*) FROM deliveries WHERE state = 'pending'");
        assert_eq!(pending, Some(0));
        let held =
            self.journal("SELECT count(DISTINCT sha256) FROM deliveries WHERE state = 'held'");
        let spooled = i64::try_from(names(&self.path("state/spool")).len()).ok();
        assert_eq!(spooled, held, "{:?}", names(&self.path("state/spool")));
    }

    /// The reason for which a scan lies in quarantine.
    #[track_caller]
    pub fn reason(&self, bytes: &[u8]) -> serde_json::Value {
        let place = self.path("state/quarantine").join(sha256(bytes));
        assert_eq!(fs::read(place.join("scan.obj")).unwrap(), bytes);
        serde_json::from_slice(&fs::read(place.join("reason.json")).unwrap()).unwrap()
    }
}

impl Daemon {
    /// Starts a command of the station.
    pub fn of(mut command: Command) -> Daemon {
        Daemon { child: command.spawn().unwrap() }
    }

    /// The process.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// SIGTERM, and the exit it leads to, if it comes in time.
    pub fn stop_within(&mut self, limit: Duration) -> Option<ExitStatus> {
        kill_process(Pid::from_child(&self.child), Signal::TERM).unwrap();
        let deadline = Instant::now() + limit;
        loop {
            let ended = self.child.try_wait().unwrap();
            if ended.is_some() || Instant::now() >= deadline {
                return ended;
            }
            sleep(Duration::from_millis(20));
        }
    }

    /// SIGTERM, and the exit it leads to.
    pub fn stop(mut self) -> ExitStatus {
        let pid = Pid::from_child(&self.child);
        kill_process(pid, Signal::TERM).unwrap();
        self.child.wait().unwrap()
    }

    /// SIGKILL.
    pub fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Daemon {
    /// A test that fails leaves no station running.
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// `sha256sum -c SHA256SUMS`, and that it lists every file; gives the sum of the scan.
#[track_caller]
fn whole(record: &Path) -> String {
    let sums = fs::read_to_string(record.join("SHA256SUMS")).expect("SHA256SUMS in every record");
    let mut listed = BTreeSet::from(["SHA256SUMS".to_owned()]);
    let mut scan = None;
    for line in sums.lines() {
        let (sum, name) = line.split_once("  ").expect("a sum and a name");
        assert_eq!(sha256(&fs::read(record.join(name)).unwrap()), sum, "{name}");
        assert!(listed.insert(name.to_owned()), "{name} is listed twice");
        if name == "scan.obj" {
            scan = Some(sum.to_owned());
        }
    }
    assert_eq!(names(record).into_iter().collect::<BTreeSet<_>>(), listed);
    scan.expect("the scan's own bytes in every record")
}

/// The names in a folder, sorted; none where there is no folder.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
