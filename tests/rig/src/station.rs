//! A station on temporary folders, started as the real program, and the oracle over what it left.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs::{self, File};
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rusqlite::{Connection, OpenFlags};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use tempfile::TempDir;

use crate::invariants::{
    self, Delivered, Evidence, Left, Moment, Put, PutKind, StatusCounts, Violation,
};
use crate::verb;
pub use crate::whole::{names, sha256};

/// How long what must happen is waited for before the test fails. It costs nothing where it happens: a busy
/// machine may be slow, and a store that was away is asked again at growing pauses.
pub const PATIENCE: Duration = Duration::from_secs(300);

/// The quiet time of the stations under test.
pub const QUIET: Duration = Duration::from_millis(300);

/// The folders of one station, and what was put before it.
pub struct Booth {
    dir: TempDir,
    puts: Mutex<Vec<Put>>,
    told: Mutex<Option<StatusCounts>>,
}

/// How the station of a booth is set.
pub struct Setting {
    pub quiet: Duration,
    pub rescan: Duration,
    pub short_wait: Duration,
    /// The CAD files of each record.
    pub files: &'static str,
}

impl Default for Setting {
    fn default() -> Setting {
        Setting {
            quiet: QUIET,
            rescan: Duration::from_secs(1),
            short_wait: Duration::from_secs(3),
            files: r#"["step"]"#,
        }
    }
}

/// A running station.
pub struct Daemon {
    child: Child,
}

impl Booth {
    /// Empty folders and a configuration that settles quickly.
    pub fn new() -> Booth {
        Booth::set(&Setting::default())
    }

    /// Empty folders and a configuration.
    pub fn set(setting: &Setting) -> Booth {
        let dir = TempDir::new().unwrap();
        let at = dir.path().display();
        let config = format!(
            r#"[station]
id = "booth-1"
state_dir = "{at}/state"
[scanner]
export_dirs = ["{at}/export"]
quiet = "{quiet}ms"
rescan = "{rescan}ms"
short_wait = "{short_wait}ms"
max_scan = "20MB"
file_name = '^(?<patient>P?[0-9]+)_'
[patient]
pattern = '^P?[0-9]{{1,12}}$'
[store.folder]
path = "{at}/records"
[output]
files = {files}
"#,
            quiet = setting.quiet.as_millis(),
            rescan = setting.rescan.as_millis(),
            short_wait = setting.short_wait.as_millis(),
            files = setting.files,
        );
        fs::write(dir.path().join("station.toml"), config).unwrap();
        for folder in ["export", "records"] {
            fs::create_dir(dir.path().join(folder)).unwrap();
        }
        Booth { dir, puts: Mutex::default(), told: Mutex::default() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub fn command(&self) -> Command {
        self.command_behind(&[])
    }

    /// The station as the argument of another program.
    pub fn command_behind(&self, front: &[&str]) -> Command {
        let station = verb::program();
        let mut words = front.iter().map(AsRef::as_ref).chain([station.as_os_str()]);
        let mut command = Command::new(words.next().unwrap());
        let log = File::options().create(true).append(true).open(self.path("log")).unwrap();
        let config = self.path("station.toml");
        command.args(words).arg("run").arg("--config").arg(config).stdin(Stdio::null());
        command.stdout(log.try_clone().unwrap()).stderr(log);
        command
    }

    /// Runs a verb with the configuration of this station; it is told nothing.
    pub fn gaiter(&self, args: &[&str]) -> Output {
        verb::gaiter_told(&self.path("station.toml"), args, "")
    }

    /// Waits until the station says of a file in the export folder why it is where it is.
    #[track_caller]
    pub fn wait_until_explained(&self, name: &str, why: &str) {
        let file = self.path("export").join(name);
        let explained = || verb::stdout(&self.gaiter(&["explain", file.to_str().unwrap()]));
        self.wait_for(&format!("\"{why}\" of {name}"), || explained().contains(why));
    }

    /// Rewrites the configuration for stations to be started.
    pub fn reconfigure(&self, change: impl FnOnce(String) -> String) {
        let file = self.path("station.toml");
        fs::write(&file, change(fs::read_to_string(&file).unwrap())).unwrap();
    }

    /// Has the station send its scans to an archive, too, by a key of its own, `archive.key`. `further` are more lines
    /// of `[store.archive]`.
    pub fn send_to_archive(
        &self,
        address: &str,
        bucket: &str,
        station: &str,
        site_key: &str,
        further: &str,
    ) {
        let (key, site) = (self.path("archive.key"), self.path("site.key"));
        fs::write(&key, "word\n").unwrap();
        fs::write(&site, site_key).unwrap();
        self.reconfigure(|config| {
            format!(
                "{config}[store.archive]\naddress = \"{address}\"\nbucket = \"{bucket}\"\n\
                 station = \"{station}\"\nkey_id = \"key\"\nkey = \"{}\"\nsite_key = \"{}\"\n{further}",
                key.display(),
                site.display()
            )
        });
    }

    pub fn start(&self) -> Daemon {
        *self.told() = None;
        Daemon::start(self.command())
    }

    /// Starts the station and waits until it is ready. The log may tell of earlier starts.
    #[track_caller]
    pub fn start_ready(&self) -> Daemon {
        let starts = || self.log().matches("station-ready").count();
        let before = starts();
        let daemon = self.start();
        self.wait_for("the station", || starts() > before);
        daemon
    }

    /// Waits for a look at the export folder that begins from now on. A station that does not answer has not
    /// looked.
    #[track_caller]
    pub fn wait_for_look(&self) {
        let look = || self.status()["sources"][0]["last_look"].as_str().map(str::to_owned);
        let mut last = None;
        // The second that ends from now on began after the first.
        for _ in 0..3 {
            let before = last.take();
            self.wait_for("a look", || {
                last = look();
                last.is_some() && last != before
            });
        }
    }

    /// What `gaiter status --json` says; null while no station answers.
    pub fn status(&self) -> Value {
        serde_json::from_slice(&self.gaiter(&["status", "--json"]).stdout).unwrap_or_default()
    }

    /// Writes an export in one go.
    pub fn export(&self, name: &str, bytes: &[u8]) {
        fs::write(self.path("export").join(name), bytes).unwrap();
        self.has_put(name, bytes, PutKind::Whole);
    }

    /// Notes what was put into the export folder, for the invariants. What was there under this
    /// name is gone.
    pub fn has_put(&self, name: &str, bytes: &[u8], kind: PutKind) {
        let left = invariants::left_at(&self.path("export").join(name));
        self.note_put(name, bytes, kind, left);
    }

    /// As [`Booth::has_put`] into another folder than that of the booth, which is not looked at: it
    /// may be a share that does not answer.
    pub fn has_put_elsewhere(&self, name: &str, bytes: &[u8]) {
        self.note_put(name, bytes, PutKind::Whole, None);
    }

    /// Notes that the scanner has removed or renamed a file of this name.
    pub fn has_gone(&self, name: &str) {
        let mut puts = self.puts.lock().unwrap_or_else(PoisonError::into_inner);
        for put in puts.iter_mut().filter(|put| put.name == name) {
            put.left = None;
        }
    }

    fn note_put(&self, name: &str, bytes: &[u8], kind: PutKind, left: Option<Left>) {
        self.has_gone(name);
        let mut puts = self.puts.lock().unwrap_or_else(PoisonError::into_inner);
        let (patient, sha256) = (invariants::patient_of(name), sha256(bytes));
        puts.push(Put { name: name.to_owned(), patient, sha256, kind, left });
    }

    /// Notes that the scanner has emptied its export folder.
    pub fn has_emptied_the_export(&self) {
        for put in self.puts.lock().unwrap_or_else(PoisonError::into_inner).iter_mut() {
            put.left = None;
        }
    }

    /// Forgets what was put, for another run in the same folders.
    pub fn forget(&self) {
        self.puts.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }

    /// Asks the running station how it is. It must rest, and what it said must be so when the
    /// invariants are read at rest.
    pub fn asks(&self) {
        let config = self.path("station.toml");
        let output = verb::gaiter_told(&config, &["status", "--json"], "");
        let status: serde_json::Value = serde_json::from_slice(&output.stdout)
            .unwrap_or_else(|error| panic!("{error}: {}", verb::stderr(&output)));
        let count = |state: &str| {
            let count = status["scans"][state].as_u64();
            usize::try_from(count.unwrap_or_else(|| panic!("{state}: {status}"))).unwrap()
        };
        let (pending, held, refused) = (count("spooled"), count("held"), count("refused"));
        *self.told() = Some(StatusCounts { pending, held, refused });
    }

    fn told(&self) -> MutexGuard<'_, Option<StatusCounts>> {
        self.told.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The invariants that do not hold.
    pub fn violations(&self, moment: Moment) -> Vec<Violation> {
        let evidence = Evidence {
            puts: &self.puts.lock().unwrap_or_else(PoisonError::into_inner),
            released: &[],
            export: &self.path("export"),
            state: &self.path("state"),
            records: &self.path("records"),
            log: &self.log(),
            planted: &[],
            told: *self.told(),
        };
        invariants::violations(&evidence, moment)
    }

    pub fn log(&self) -> String {
        String::from_utf8_lossy(&fs::read(self.path("log")).unwrap_or_default()).into_owned()
    }

    /// Whether the log names this patient. Digits within a longer number, as a time or a hash has them, are
    /// no name.
    pub fn log_names(&self, id: &str) -> bool {
        let log = self.log();
        let is_free = |neighbour: Option<char>| !neighbour.is_some_and(|c| c.is_ascii_hexdigit());
        log.match_indices(id).any(|(at, _)| {
            let (before, after) = (&log[..at], &log[at + id.len()..]);
            is_free(before.chars().next_back()) && is_free(after.chars().next())
        })
    }

    /// Waits until a condition holds; fails with the log where it never does.
    #[track_caller]
    pub fn wait_for(&self, what: &str, mut holds: impl FnMut() -> bool) {
        let (deadline, mut pause) = (Instant::now() + PATIENCE, Duration::from_millis(10));
        while !holds() {
            assert!(Instant::now() < deadline, "{what} never came; log:\n{}", self.log());
            sleep(pause);
            // Some of these questions start a process each time.
            pause = (pause * 3 / 2).min(Duration::from_millis(100));
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

    /// Waits until the station has begun a store: until then it makes and marks whatever is at its place.
    #[track_caller]
    pub fn wait_until_begun(&self, store: &str) {
        let begun = format!("SELECT count(*) FROM meta WHERE name = 'begun:{store}'");
        self.wait_for_journal(&begun, 1);
    }

    /// Takes the folder of records away, once the station has begun its store there and has noted the last
    /// delivery: a record is visible before it is synced, and a delivery whose folder goes in between is
    /// made again.
    #[track_caller]
    pub fn take_records_away(&self) {
        self.wait_until_begun("folder");
        self.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'pending'", 0);
        fs::rename(self.path("records"), self.path("unmounted")).unwrap();
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

    /// The records in the store, each of them whole.
    #[track_caller]
    pub fn records(&self) -> Vec<Delivered> {
        let (records, partial) = invariants::records(&self.path("records"));
        assert_eq!(partial, []);
        records
    }

    /// After a stop: every invariant holds, the store has exactly these records, and the journal
    /// agrees.
    #[track_caller]
    pub fn assert_settled(&self, expected: &[(&str, &[u8])]) {
        let mut expected: Vec<Delivered> =
            expected.iter().map(|(id, bytes)| ((*id).to_owned(), sha256(bytes))).collect();
        expected.sort();
        assert_eq!(self.records(), expected, "log:\n{}", self.log());
        let delivered = self.journal("SELECT count(*) FROM deliveries WHERE state = 'delivered'");
        assert_eq!(delivered, i64::try_from(expected.len()).ok());
        assert_eq!(self.violations(Moment::Rest), [], "log:\n{}", self.log());
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
    pub fn start(mut command: Command) -> Daemon {
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
        if !self.has_ended() {
            kill_process(Pid::from_child(&self.child), Signal::TERM).unwrap();
        }
        self.child.wait().unwrap()
    }

    /// Whether it has ended by itself.
    pub fn has_ended(&mut self) -> bool {
        self.child.try_wait().unwrap().is_some()
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
