//! One run of a station from export to record, to be struck by a fault at each of its calls, and
//! what must hold after each.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use crate::invariants::{self, Moment, PutKind};
use crate::station::{Booth, PATIENCE, Setting, names};
use support::coarse_body;

use crate::faults::tracer::{self, BEHIND_A_GATE, Call, CallFate, Kind, Run};

/// How often it is looked whether a station rests whose log says nothing new. A look reads every
/// file, and many stations share the machine.
const LOOK_AGAIN: Duration = Duration::from_millis(200);

/// Fewer points than this and a matrix has not seen the run. The issue asks for so many.
pub const POINTS_MIN: usize = 150;

/// Runs of a day at a time: each waits most of the time, for looks and, with a button, until the station
/// is sure that it hears every press.
pub const DAY_HANDS: usize = 8;

/// Only every so many-th call is struck where `GAITER_FAULTS` is "few"; the others in other runs, for
/// `GAITER_FAULTS_SEED` says where to begin.
const FEW: usize = 15;

/// A day takes seconds, so only every so many-th of its calls is struck, or each where `GAITER_FAULTS` is
/// "all".
pub fn day_step() -> usize {
    if strikes_all() { 1 } else { 9 }
}

/// Whether `GAITER_FAULTS` asks for every strike that there is.
pub fn strikes_all() -> bool {
    extent() == "all"
}

/// Every so many-th of the calls of a matrix is struck.
pub fn thinned() -> usize {
    if extent() == "few" { FEW } else { 1 }
}

fn extent() -> String {
    env::var("GAITER_FAULTS").unwrap_or_default()
}

/// The first call that is struck, from 1 to `step`.
fn first(step: usize) -> usize {
    let seed = env::var("GAITER_FAULTS_SEED").ok();
    1 + seed.and_then(|seed| seed.parse::<usize>().ok()).unwrap_or(0) % step
}

/// The folders whose calls count; that of orders, too, where there is one.
pub const FOLDERS: [&str; 3] = ["export", "state", "records"];

/// The folder of orders.
pub const ORDERS: &str = "orders";

/// A scan to be delivered and, for another patient, held; one to be delivered and given up by the
/// spool; one to be refused; one to be awaited.
pub const SCANS: [(&str, PutKind); 5] = [
    ("4711_Mustermann.obj", PutKind::Whole),
    ("0815_Musterfrau.obj", PutKind::Whole),
    ("4714_Mustermann.obj", PutKind::Whole),
    ("4712_Mustermann.obj", PutKind::Whole),
    ("4713_Mustermann.obj", PutKind::Short),
];

/// How often the log tells of each end of a scan in a run without faults.
const DONE: [(&str, usize); 3] = [("scan-delivered", 2), ("scan-held", 1), ("scan-refused", 1)];

/// A booth that settles as quickly as the configuration allows, on however small a disk.
pub fn booth() -> Booth {
    let booth = Booth::set(&Setting {
        quiet: Duration::from_millis(50),
        rescan: Duration::from_millis(250),
        short_wait: Duration::from_secs(3600),
        files: "[]",
    });
    // The disks of the power cut are small.
    booth.reconfigure(|config| config.replace("[station]", "[station]\ndisk_floor = \"0B\""));
    booth
}

/// Puts the scans of one run into the export folder.
pub fn put_scans(booth: &Booth) {
    let body = coarse_body(1);
    let short = body[..body.len() / 2].to_vec();
    let bytes = [body.clone(), body, coarse_body(2), b"v 1 2 3\nMustermann\n".to_vec(), short];
    for ((name, kind), bytes) in SCANS.into_iter().zip(bytes) {
        fs::write(booth.path("export").join(name), &bytes).unwrap();
        booth.has_put(name, &bytes, kind);
    }
}

/// Runs the station under the tracer.
pub fn struck_until(
    booth: &Booth,
    finished: impl Fn() -> bool + Sync,
    answer: impl FnMut(&Call) -> CallFate,
) -> Run {
    let folders: Vec<PathBuf> =
        FOLDERS.iter().chain(&[ORDERS]).map(|name| booth.path(name)).collect();
    tracer::run(booth.command_behind(&BEHIND_A_GATE), &folders, finished, answer)
}

/// Runs the station up to its nth call, which is answered by `stroke`, the others by `usual`. Gives
/// what was struck; none where the run came to its end before.
pub fn struck_at(
    booth: &Booth,
    nth: usize,
    stroke: CallFate,
    usual: impl Fn(&Call) -> CallFate,
) -> (Option<String>, Run) {
    struck_at_until(booth, || all_done(booth), nth, stroke, usual)
}

/// As [`struck_at`], where the run comes to its end otherwise.
pub fn struck_at_until(
    booth: &Booth,
    finished: impl Fn() -> bool + Sync,
    nth: usize,
    stroke: CallFate,
    usual: impl Fn(&Call) -> CallFate,
) -> (Option<String>, Run) {
    let (mut at, mut count) = (None, 0);
    let run = struck_until(booth, finished, |call| {
        // A changed mode is nothing that a crash could leave half done.
        if call.kind == Kind::Mode {
            return CallFate::Do;
        }
        count += 1;
        if count == nth {
            at = Some(what(booth, call));
            return stroke;
        }
        usual(call)
    });
    (at, run)
}

/// What does not hold right after a run that was struck, before anything puts it in order.
pub fn found_at_once(booth: &Booth, run: &Run) -> Vec<String> {
    let mut found = acknowledged(booth);
    found.extend(faults(booth, Moment::Any));
    if run.hung {
        found.push("it did not end".to_owned());
    }
    found
}

/// Looks whether the station of a booth rests, as often as its log says something new.
pub fn rests(booth: &Booth) -> impl Fn() -> bool + Sync {
    let last = Mutex::new((None, Instant::now()));
    move || {
        let said = fs::metadata(booth.path("log")).map(|log| log.len()).ok();
        let mut last = last.lock().unwrap();
        if last.0 == said && last.1.elapsed() < LOOK_AGAIN {
            return false;
        }
        *last = (said, Instant::now());
        booth.violations(Moment::Rest).is_empty()
    }
}

/// Whether the log says that every scan of the run has come to its end.
pub fn all_done(booth: &Booth) -> bool {
    let log = booth.log();
    DONE.iter().all(|(event, times)| log.matches(event).count() >= *times)
}

/// Whether the log says that the station has started.
pub fn is_ready(booth: &Booth) -> bool {
    booth.log().contains("station-ready")
}

/// What does not hold at this moment, as text.
pub fn faults(booth: &Booth, moment: Moment) -> Vec<String> {
    booth.violations(moment).iter().map(ToString::to_string).collect()
}

/// What the station has acknowledged in its log and what is not there, with the bytes it spoke of.
pub fn acknowledged(booth: &Booth) -> Vec<String> {
    let (state, log) = (booth.path("state"), booth.log());
    let [spool, quarantine] = ["spool", "quarantine"].map(|name| names(&state.join(name)));
    let store: Vec<String> =
        invariants::records(&booth.path("records")).0.into_iter().map(|(_, sum)| sum).collect();
    let mut lost = Vec::new();
    for line in log.lines() {
        let word = |key: &str| line.split_once(key)?.1.split_once('"').map(|(word, _)| word);
        let (Some(event), Some(scan)) = (word("event=\""), word("scan=\"")) else { continue };
        let places: &[&Vec<String>] = match event {
            "scan-delivered" => &[&store],
            "scan-refused" => &[&quarantine],
            "scan-spooled" | "scan-held" => &[&spool, &quarantine, &store],
            _ => continue,
        };
        if !places.iter().any(|place| place.iter().any(|sum| sum.starts_with(scan))) {
            lost.push(format!("{event} was said of {scan}, and it is not there"));
        }
    }
    lost
}

/// Starts the station without faults, gives it its time, and stops it; what does not hold then.
pub fn restarted(booth: &Booth) -> Vec<String> {
    let mut found = Vec::new();
    let ready = || booth.log().matches("station-ready").count();
    let before = ready();
    let mut daemon = booth.start();
    let deadline = Instant::now() + PATIENCE;
    // Before it is ready it neither heeds SIGTERM nor has the journal for itself.
    let rests = rests(booth);
    let settled = || ready() > before && rests();
    let mut has_settled = settled();
    while !has_settled && !daemon.has_ended() && Instant::now() < deadline {
        sleep(Duration::from_millis(10));
        has_settled = settled();
    }
    if has_settled {
        booth.asks();
    }
    let code = daemon.stop().code();
    if code != Some(0) {
        found.push(format!("the station without faults ended with {code:?}"));
    }
    found.extend(faults(booth, Moment::Rest));
    found
}

/// A call by what it does to what, without what chance has named: for counting kinds of points.
pub fn what(booth: &Booth, call: &Call) -> String {
    let root = booth.path("");
    let path = call.path.strip_prefix(&root).unwrap_or(&call.path).to_string_lossy();
    let plain = |part: &str| {
        let digits = part.bytes().filter(|byte| byte.is_ascii_digit()).count();
        let named_by_chance = part.len() > 12 && digits > 3;
        if named_by_chance { "…".to_owned() } else { part.to_owned() }
    };
    let path: Vec<String> = path.split('/').map(plain).collect();
    format!("{:?} {}{}", call.kind, path.join("/"), if call.folder { "/" } else { "" })
}

/// One strike: its name, and what did not hold after it. None where the run ended before it.
pub type Struck = Option<(String, Vec<String>)>;

/// The outcome of a matrix.
#[derive(Debug, Default)]
pub struct Tally {
    /// Strikes that fell.
    pub points: usize,
    /// How often each kind of call was struck.
    pub kinds: BTreeMap<String, usize>,
    /// What did not hold, and after which strike.
    pub violations: Vec<String>,
}

/// Strikes at every `step`th place, or fewer as [`thinned`] says, until runs end without being struck.
/// Several `workers` work at a time, each in a place of its own that `make` makes.
pub fn strike_everywhere<Place>(
    name: &str,
    workers: usize,
    step: usize,
    make: impl Fn() -> Place + Sync,
    strike: impl Fn(&mut Place, usize) -> Struck + Sync,
) -> Tally {
    let step = step * thinned();
    strike_while(name, workers, (first(step), step), |_| true, make, strike)
}

/// As [`strike_everywhere`], until the first violation: what a control is to find.
pub fn strike_until_violated<Place>(
    name: &str,
    workers: usize,
    step: usize,
    make: impl Fn() -> Place + Sync,
    strike: impl Fn(&mut Place, usize) -> Struck + Sync,
) -> Tally {
    let none_found = |tally: &Tally| tally.violations.is_empty();
    strike_while(name, workers, (1, step), none_found, make, strike)
}

fn strike_while<Place>(
    name: &str,
    workers: usize,
    (first, step): (usize, usize),
    goes_on: impl Fn(&Tally) -> bool + Sync,
    make: impl Fn() -> Place + Sync,
    strike: impl Fn(&mut Place, usize) -> Struck + Sync,
) -> Tally {
    let began = Instant::now();
    let (next, end) = (Mutex::new(first), Mutex::new(usize::MAX));
    let tally = Mutex::new(Tally::default());
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                let mut place = make();
                loop {
                    let nth = {
                        let mut next = next.lock().unwrap();
                        *next += step;
                        *next - step
                    };
                    if nth >= *end.lock().unwrap() || !goes_on(&tally.lock().unwrap()) {
                        return;
                    }
                    match strike(&mut place, nth) {
                        None => {
                            let mut end = end.lock().unwrap();
                            *end = nth.min(*end);
                        }
                        Some((kind, found)) => {
                            let mut tally = tally.lock().unwrap();
                            tally.points += 1;
                            let violations =
                                found.iter().map(|what| format!("{nth} {kind}: {what}"));
                            tally.violations.extend(violations);
                            *tally.kinds.entry(kind).or_default() += 1;
                        }
                    }
                }
            });
        }
    });
    let tally = tally.into_inner().unwrap();
    println!(
        "{name}: {} points of {} kinds, {} violations, {:.0} s",
        tally.points,
        tally.kinds.len(),
        tally.violations.len(),
        began.elapsed().as_secs_f64()
    );
    tally
}

/// Empties the folders of a booth for the next strike and puts the scans there anew.
pub fn renew(booth: &Booth) {
    empty_folders(booth);
    put_scans(booth);
}

/// Empties the folders of a booth, and forgets what was put there.
pub fn empty_folders(booth: &Booth) {
    for folder in FOLDERS.iter().chain(&[ORDERS]) {
        empty(&booth.path(folder));
    }
    let _ = fs::remove_file(booth.path("log"));
    booth.forget();
}

fn empty(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => fs::remove_dir_all(path).unwrap(),
            false => fs::remove_file(path).unwrap(),
        }
    }
}

/// Whether a program is there and works; else says that the test is skipped.
pub fn there_is(program: &str, arguments: &[&str]) -> bool {
    let there = Command::new(program).args(arguments).output().is_ok_and(|o| o.status.success());
    if !there {
        println!("{program} is not there or does not work");
    }
    there
}
