//! What all who take part in the siege share: the booth, the time, what was done, and what was found.

use std::fmt::Display;
use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rig::worklist::WorklistServer;
use rig::{Booth, Setting};

use crate::clock::Clock;
use crate::keeper::Keeper;
use crate::plan::Plan;
use crate::worklist;

/// How often somebody who waits looks up.
const LOOK_UP: Duration = Duration::from_millis(20);

/// The siege's field.
pub struct Field {
    pub plan: Plan,
    pub keeper: Keeper,
    pub clock: Option<Clock>,
    pub worklist: WorklistServer,
    pub port: u16,
    began: Instant,
    done: AtomicBool,
    story: Mutex<Vec<String>>,
    faults: Mutex<Vec<String>>,
    pub booth: Booth,
}

impl Field {
    /// A booth whose state folder may lie on a disk of its own, with a page on a port that is its own, and a worklist.
    pub fn new(plan: Plan) -> Field {
        let booth = Booth::set(&Setting { files: "[]", ..Setting::default() });
        let (port, worklist) = (free_port(), worklist::server());
        let (at, state) = (booth.path("state"), booth.path("disk/state"));
        fs::create_dir(booth.path("disk")).unwrap();
        // The station is told the folder itself; whoever looks on finds it under its usual name.
        std::os::unix::fs::symlink(&state, &at).unwrap();
        booth.reconfigure(|config| {
            let config = config.replace(at.to_str().unwrap(), state.to_str().unwrap());
            let config = config.replace("[station]", "[station]\ndisk_floor = \"0B\"");
            let retention = match Plan::is_without("retention") {
                true => "",
                false => "[retention]\nquarantine = \"720h\"\njournal = \"720h\"\n",
            };
            // Short, so that many questions end, whatever becomes of them.
            let asks = worklist.section() + "timeout = \"2s\"\n";
            format!("{config}[status]\nlisten = \"127.0.0.1:{port}\"\n{retention}{asks}")
        });
        Field {
            plan,
            keeper: Keeper::default(),
            clock: Clock::new(booth.path("clock")),
            worklist,
            port,
            began: Instant::now(),
            done: AtomicBool::new(false),
            story: Mutex::default(),
            faults: Mutex::default(),
            booth,
        }
    }

    /// The siege begins now.
    pub fn begin(&mut self) {
        self.began = Instant::now();
    }

    /// How long it has lasted.
    pub fn elapsed(&self) -> Duration {
        self.began.elapsed()
    }

    /// Whether the adversaries go on.
    pub fn goes_on(&self) -> bool {
        self.elapsed() < self.plan.length
    }

    /// How long they still go on.
    pub fn left(&self) -> Duration {
        self.plan.length.saturating_sub(self.elapsed())
    }

    /// Waits until this time of the siege; says whether it goes on then.
    pub fn wait_until(&self, at: Duration) -> bool {
        while self.goes_on() && self.elapsed() < at {
            sleep(LOOK_UP.min(at.saturating_sub(self.elapsed())));
        }
        self.goes_on()
    }

    /// Lets a time pass, at most to the end of the siege.
    pub fn pass(&self, time: Duration) {
        self.wait_until(self.elapsed() + time);
    }

    /// Waits for a condition, at most so long; says whether it came.
    pub fn wait_for(&self, limit: Duration, mut holds: impl FnMut() -> bool) -> bool {
        let deadline = Instant::now() + limit;
        loop {
            if holds() {
                return true;
            }
            if Instant::now() >= deadline {
                return false;
            }
            sleep(LOOK_UP);
        }
    }

    /// Everything is over when this is dropped, also where a part of the siege panics: nobody watches any
    /// more.
    pub fn ending(&self) -> Ending<'_> {
        Ending(self)
    }

    pub fn is_done(&self) -> bool {
        self.done.load(Ordering::Relaxed)
    }

    /// Notes what was done.
    pub fn tell(&self, what: impl Display) {
        let line = format!("{:8.3} {what}", self.elapsed().as_secs_f64());
        self.story.lock().unwrap().push(line);
    }

    /// Notes what must not be.
    pub fn fault(&self, what: impl Display) {
        self.tell(format_args!("FAULT {what}"));
        let line = format!("{:8.3} {what}", self.elapsed().as_secs_f64());
        self.faults.lock().unwrap().push(line);
    }

    pub fn faults(&self) -> Vec<String> {
        self.faults.lock().unwrap().clone()
    }

    /// Keeps story and log where they outlast the test; where that is.
    pub fn keep_evidence(&self) -> PathBuf {
        let folder =
            Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("siege-{}", self.plan.seed));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("story"), self.story.lock().unwrap().join("\n")).unwrap();
        fs::write(folder.join("log"), self.booth.log()).unwrap();
        // What the violations were read from, as far as the disk still gives it.
        for name in ["journal.db", "journal.db-wal"] {
            let _ = fs::copy(self.booth.path("state").join(name), folder.join(name));
        }
        let quarantined = rig::names(&self.booth.path("state/quarantine")).join("\n");
        fs::write(folder.join("quarantine"), quarantined).unwrap();
        folder
    }
}

/// See [`Field::ending`].
pub struct Ending<'a>(&'a Field);

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        self.0.done.store(true, Ordering::Relaxed);
        if std::thread::panicking() {
            println!("what was done, and the log: {}", self.0.keep_evidence().display());
        }
    }
}

/// A free port that the kernel gives to no connection: one of those would keep the station from it.
fn free_port() -> u16 {
    let first = 20_000 + u16::try_from(std::process::id() % 8_000).unwrap();
    let is_free = |port: &u16| TcpListener::bind(("127.0.0.1", *port)).is_ok();
    (first..32_000).find(is_free).unwrap()
}

/// The log from some point on, read as it grows.
#[derive(Debug)]
pub struct Tail {
    path: PathBuf,
    at: u64,
    rest: Vec<u8>,
}

impl Tail {
    /// What is said from now on.
    pub fn from_now(booth: &Booth) -> Tail {
        let path = booth.path("log");
        let at = fs::metadata(&path).map_or(0, |log| log.len());
        Tail { path, at, rest: Vec::new() }
    }

    /// The lines that have been added since this was asked last.
    pub fn lines(&mut self) -> Vec<String> {
        let Ok(mut log) = File::open(&self.path) else { return Vec::new() };
        log.seek(SeekFrom::Start(self.at)).unwrap();
        let read = log.read_to_end(&mut self.rest).unwrap();
        self.at += u64::try_from(read).unwrap();
        let whole = self.rest.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        let text: Vec<u8> = self.rest.drain(..whole).collect();
        String::from_utf8_lossy(&text).lines().map(str::to_owned).collect()
    }
}
