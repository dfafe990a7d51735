//! A siege: a hostile user of the machine, a failing disk, a lying clock, a restless exporter and a worklist
//! that hangs and dies at one time against one real station, which is reloaded and killed meanwhile. Its
//! page and its health answer within two seconds throughout, nobody else gets its port, and when all is over
//! it comes to rest by itself with every invariant.
//!
//! `GAITER_SIEGE_S` sets for how long, `GAITER_SEED` draws another plan of events; what was done and the
//! log of the station lie in the folder that the test names at its end. `GAITER_SIEGE_WITHOUT` leaves parts
//! out, to tell whose doing something is: any of keeper, crowd, thief, intruder, disk, clock, exporter,
//! worklist and retention.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod clock;
mod crowd;
mod exporter;
mod exports;
mod failing;
mod field;
mod intruder;
mod keeper;
mod plan;
mod watch;
mod worklist;

use std::thread;
use std::time::{Duration, Instant};

use exporter::Fleeting;
use failing::Disks;
use field::{Field, Tail};
use plan::Plan;
use rig::faults::{disk, share};
use rig::invariants::{Moment, Violation, Vitals};
use rig::process;
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use support::{chance, coarse_body};
use watch::{PAGES, Samples};

/// So many open files are allowed to the station by its unit, and are enough for the crowd.
const FILES: u64 = 4096;

/// How long the station may take to come to rest, besides a pause between attempts: those have grown as
/// long as the siege lasted, at most up to five minutes.
const REST: Duration = Duration::from_secs(150);
const SILENCE: Duration = Duration::from_secs(60);
const PAUSE_MOST: Duration = Duration::from_secs(300);

/// How long a station that has just been started may complain of what was.
const HEALTHY: Duration = Duration::from_secs(120);

/// How far above its beginning the station may be when all is over: threads that block end when they have
/// been idle, and whoever watches keeps some of them busy; the allocator keeps memory.
const FILES_UNREST: usize = 6;
const THREADS_UNREST: usize = 32;
const MEMORY_UNREST_KB: usize = 150_000;

#[test]
#[ignore = "needs root and a minute, run by .ci/run"]
fn a_station_under_siege_answers_and_comes_to_rest_with_all_that_it_was_given() {
    let plan = Plan::of_environment();
    println!("GAITER_SEED={} GAITER_SIEGE_S={}", plan.seed, plan.length.as_secs());
    allow_files();
    let mut field = Field::new(plan);
    let mut disks = Disks::under(&field);
    field.keeper.start(&field);
    let before = warmed_up(&field);
    field.begin();
    let samples: [Samples; 4] = Default::default();
    thread::scope(|scope| {
        let field = &field;
        let _ending = field.ending();
        let (soon, pace) = (Duration::from_secs(3), Duration::from_secs(5));
        let keeps = plan.events((1, "keeper"), soon, pace, keeper::draw);
        scope.spawn(move || keeper::keep(field, keeps));
        for ((path, good), samples) in PAGES.into_iter().zip(&samples) {
            scope.spawn(move || watch::watch(field, path, good, samples));
        }
        scope.spawn(|| watch::watch_the_machine(field, &samples[PAGES.len()]));
        let fleeting = attacked(field, &mut disks);
        println!("{:.0} s: all adversaries have stopped", field.elapsed().as_secs_f64());
        rests(field, fleeting);
        flat(field, before, &samples[0]);
    });
    told(&field, &samples);
    rests_after_another_start(&field);
    let faults = field.faults();
    let evidence = field.keep_evidence();
    println!("what was done, and the log: {}", evidence.display());
    drop(disks);
    assert!(
        faults.is_empty(),
        "GAITER_SEED={}: {} faults:\n{}",
        plan.seed,
        faults.len(),
        faults[..faults.len().min(60)].join("\n")
    );
}

fn allow_files() {
    let limit = getrlimit(Resource::Nofile);
    let current = limit.maximum.map_or(FILES, |most| most.min(FILES));
    setrlimit(Resource::Nofile, Rlimit { current: Some(current), ..limit }).unwrap();
}

/// A station that has delivered a few scans; what it holds then.
fn warmed_up(field: &Field) -> Vitals {
    let booth = &field.booth;
    booth.wait_for("the start", || booth.log().contains("station-ready"));
    field.keeper.look(field);
    for n in 0..3 {
        booth.export(&format!("4700_warm{n}.obj"), &coarse_body(900_000 + n));
    }
    booth.wait_for_records(3);
    let pid = field.keeper.life().pid.unwrap();
    Vitals::read(pid).unwrap()
}

/// All adversaries, each in its own thread.
fn attacked(field: &Field, disks: &mut Disks) -> Fleeting {
    let (plan, soon) = (field.plan, Duration::from_secs(1));
    let second = Duration::from_secs(1);
    let crowds = plan.events((2, "crowd"), soon, 4 * second, crowd::draw);
    let intrusions = plan.events((3, "intruder"), soon, 2 * second, intruder::draw);
    let failures = plan.events((4, "disk"), 5 * second, 8 * second, failing::draw);
    let lies = plan.events((5, "clock"), soon, 4 * second, clock::draw);
    let exports = plan.events((6, "exporter"), Duration::ZERO, second * 2 / 3, exports::draw);
    let manners = plan.events((7, "worklist"), soon, 3 * second, worklist::draw);
    thread::scope(|scope| {
        scope.spawn(|| crowd::besiege(field, crowds));
        if !Plan::is_without("thief") {
            scope.spawn(|| crowd::steal_the_port(field));
        }
        scope.spawn(|| intruder::intrude(field, intrusions));
        scope.spawn(|| disks.fail(field, failures));
        scope.spawn(|| clock::lie(field, lies));
        scope.spawn(|| worklist::change(field, manners));
        scope.spawn(|| exporter::export(field, exports)).join().unwrap()
    })
}

/// The station comes to rest by itself, with every invariant.
fn rests(field: &Field, mut fleeting: Fleeting) {
    let booth = &field.booth;
    let pause = field.plan.length.min(PAUSE_MOST).max(SILENCE);
    let (began, limit) = (Instant::now(), REST + pause);
    let (mut said, mut last_said) = (Tail::from_now(booth), Instant::now());
    loop {
        exporter::account_for(booth, &mut fleeting);
        let violations = booth.violations(Moment::Rest);
        let took = began.elapsed();
        if violations.is_empty() && field.keeper.life().is_ready {
            return println!("at rest after {:.0} s", took.as_secs_f64());
        }
        if !said.lines().is_empty() {
            last_said = Instant::now();
        }
        // A station that has nothing to do will not mend what is wrong.
        let is_idle = violations.iter().all(|violation| violation.invariant != 6);
        if took >= limit || is_idle && last_said.elapsed() >= pause {
            violations.iter().for_each(|violation| field.fault(format_args!("{violation}")));
            return field.fault(format_args!("no rest within {took:.0?}"));
        }
        field.wait_for(Duration::from_secs(1), || false);
    }
}

/// What the station says of itself is so; and once more after another start, when it looks for what may go.
fn rests_after_another_start(field: &Field) {
    let (booth, keeper) = (&field.booth, &field.keeper);
    for again in [false, true] {
        if again {
            keeper.start(field);
        }
        if !field.wait_for(Duration::from_secs(60), || {
            keeper.look(field);
            keeper.life().is_ready
        }) {
            return field.fault("it is not ready, although all is right again");
        }
        // What was found before is told already.
        let known = field.faults();
        let is_new = |found: &Violation| !known.iter().any(|k| k.ends_with(&found.to_string()));
        let rests = || !booth.violations(Moment::Rest).iter().any(is_new);
        field.wait_for(Duration::from_secs(30), rests);
        booth.asks();
        if again && !field.wait_for(HEALTHY, || watch::is_healthy(field)) {
            field.fault(format_args!("it is not healthy {HEALTHY:?} after another start"));
        }
        let code = keeper.stop();
        if code != Some(0) {
            field.fault(format_args!("the last stop ended with {code:?}"));
        }
        for violation in booth.violations(Moment::Rest).iter().filter(|found| is_new(found)) {
            let when = if again { "after another start" } else { "at the end" };
            field.fault(format_args!("{when}: {violation}"));
        }
    }
}

/// When all is over the station holds little more than it did before.
fn flat(field: &Field, before: Vitals, samples: &Samples) {
    let now = || field.keeper.life().pid.and_then(Vitals::read);
    let is_flat = |now: Vitals| {
        now.files <= before.files + FILES_UNREST
            && now.threads <= before.threads + THREADS_UNREST
            && now.resident_kb <= before.resident_kb + MEMORY_UNREST_KB
    };
    let flat = field.wait_for(Duration::from_secs(60), || now().is_some_and(is_flat));
    println!("before {before:?}\nmost   {:?}\nnow    {:?}", samples.most_held(), now());
    if !flat {
        field.fault(format_args!("it holds {:?}, before it was {before:?}", now()));
    }
}

/// What came of the watch, the keeper and the clock.
fn told(field: &Field, samples: &[Samples]) {
    for ((path, _), samples) in PAGES.iter().zip(samples) {
        println!("{}", samples.line(path));
    }
    println!("{}", samples[PAGES.len()].line("(machine)"));
    println!("{:?}", field.keeper.count());
    let log = field.booth.log();
    for line in log.lines().filter(|line| line.contains("panicked")) {
        field.fault(format_args!("a panic: {line}"));
    }
    worklist::judge(field, &log);
    if field.clock.is_some() && !Plan::is_without("clock") && !clock::was_asked(&log) {
        field.fault(
            "the station never asked the clock that lies: the test has tested nothing there",
        );
    }
}
