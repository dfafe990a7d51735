//! A full, failing or read-only disk at every call of a run that changes a file, once and for
//! good: the station puts off or ends by name, loses nothing, and goes on when the fault is gone.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::cell::Cell;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use nix::errno::Errno;
use rig::Booth;
use rig::day::Day;
use rig::faults::matrix;
use rig::faults::matrix::{
    DAY_HANDS, Struck, Tally, acknowledged, booth, day_step, faults, is_ready, renew, restarted,
    rests, strike_everywhere, strikes_all, struck_at_until, struck_until, what,
};
use rig::faults::tracer::{Call, CallFate, Kind, Run, can_trace};
use rig::invariants::Moment;

/// Runs at a time: most of them wait most of the time.
const HANDS: usize = 4;

/// Full, failing, over quota, read-only.
const ERRORS: [Errno; 4] = [Errno::ENOSPC, Errno::EIO, Errno::EDQUOT, Errno::EROFS];

/// Within this the station must have got over an error that came once, on a busy machine, too: its own pauses end
/// within 25 seconds.
const OVER: Duration = Duration::from_secs(60);

/// How long an error for good is kept up.
const KEPT_UP: Duration = Duration::from_secs(1);

/// More failing calls than this while an error is kept up are a hot loop. A delivery and four
/// intakes that each fail at once and pause make some ten.
const FAILING_MOST: usize = 100;

/// One error, or one short write, after which all goes on as usual.
fn once(booth: &mut Booth, nth: usize, answer: CallFate, counts: fn(&Call) -> bool) -> Struck {
    renew(booth);
    let (mut at, mut count) = (None, 0);
    let began = Instant::now();
    let rests = rests(booth);
    let run = struck_until(
        booth,
        || began.elapsed() > OVER || (is_ready(booth) && rests()),
        |call| {
            count += usize::from(counts(call));
            if counts(call) && count == nth {
                at = Some(call.clone());
                return answer;
            }
            CallFate::Do
        },
    );
    let at = at?;
    let mut found = ended_by_name(booth, &run);
    if is_ready(booth) {
        found.extend(faults(booth, Moment::Rest));
    }
    found.extend(acknowledged(booth));
    if at.kind == Kind::Sync && synced_again(&run.calls, &at) {
        found.push("what failed to be synced was synced again, not written again".to_owned());
    }
    found.extend(restarted(booth));
    Some((format!("{answer:?} {}", what(booth, &at)), found))
}

/// From the nth call on every call fails, until the station is stopped.
fn for_good(booth: &mut Booth, nth: usize, errno: Errno, most: &AtomicUsize) -> Struck {
    renew(booth);
    let since = Mutex::new(None::<Instant>);
    let (at, failing) = (Cell::new(None), Cell::new(0));
    let over = || since.lock().unwrap().is_some_and(|since| since.elapsed() > KEPT_UP);
    let run = struck_until(
        booth,
        || over() || matrix::all_done(booth),
        |call| {
            if call.nth < nth {
                return CallFate::Do;
            }
            if call.nth == nth {
                at.set(Some(what(booth, call)));
                *since.lock().unwrap() = Some(Instant::now());
            }
            if !over() {
                failing.set(failing.get() + 1);
            }
            CallFate::Fail(errno)
        },
    );
    let at = at.take()?;
    let mut found = ended_by_name(booth, &run);
    most.fetch_max(failing.get(), Ordering::Relaxed);
    if failing.get() > FAILING_MOST {
        found.push(format!("{} calls failed in {KEPT_UP:?}", failing.get()));
    }
    found.extend(acknowledged(booth));
    found.extend(faults(booth, Moment::Any));
    found.extend(restarted(booth));
    Some((format!("{errno:?} from {at} on"), found))
}

/// One error on a day with names, after which all goes on as usual.
fn once_on_a_day(day: &mut Day, nth: usize, errno: Errno) -> Struck {
    day.renew();
    let began = Instant::now();
    let is_over = || began.elapsed() > OVER || day.goes_on();
    let (at, run) =
        struck_at_until(&day.booth, is_over, nth, CallFate::Fail(errno), |_| CallFate::Do);
    let at = at?;
    let mut found = ended_by_name(&day.booth, &run);
    found.extend(day.found_at_once(&run));
    found.extend(day.goes_on_restarted());
    Some((format!("{errno:?} {at}"), found))
}

/// A run ends by an exit code, without a panic, and within its time.
fn ended_by_name(booth: &Booth, run: &Run) -> Vec<String> {
    let mut found = Vec::new();
    if run.hung {
        found.push("it did not end".to_owned());
    }
    if run.code.is_none() {
        found.push("a signal ended it".to_owned());
    }
    if booth.log().contains("panic") {
        found.push(format!("it panicked:\n{}", booth.log()));
    }
    found
}

/// Whether a file is synced again after it failed, without anything written to it in between: its
/// pages count as clean then, and the sync says nothing. Folders are the file system's own log.
fn synced_again(calls: &[Call], failed: &Call) -> bool {
    let after = calls.iter().filter(|call| call.nth > failed.nth && call.path == failed.path);
    !failed.folder && after.map(|call| call.kind).next() == Some(Kind::Sync)
}

fn assert_clean(tally: &Tally) {
    assert!(tally.violations.is_empty(), "{:#?}", tally.violations);
    assert!(tally.points > 0, "nothing was struck");
}

/// The errors of a matrix, as functions of the place of the call: one pass in which the four take
/// turns, or, where GAITER_FAULTS is "all", each of them at every call.
fn passes() -> Vec<(String, Vec<Errno>)> {
    if strikes_all() {
        return ERRORS.map(|errno| (format!("{errno:?}"), vec![errno])).into();
    }
    println!("each call with one of {ERRORS:?} in turn; GAITER_FAULTS=all for each with each");
    vec![("errors in turn".to_owned(), ERRORS.to_vec())]
}

#[test]
#[ignore = "needs ptrace and minutes, run by .ci/run"]
fn an_error_at_any_call_is_got_over() {
    assert!(can_trace());
    for (name, errors) in passes() {
        let errno = |nth: usize| errors[nth % errors.len()];
        let strike =
            |booth: &mut Booth, nth| once(booth, nth, CallFate::Fail(errno(nth)), |_| true);
        assert_clean(&strike_everywhere(&format!("{name}, once"), HANDS, 1, booth, strike));
    }
}

#[test]
#[ignore = "needs ptrace and minutes, run by .ci/run"]
fn an_error_on_a_day_with_names_gives_nobody_the_scan_of_another() {
    assert!(can_trace());
    for (name, errors) in passes() {
        let errno = |nth: usize| errors[nth % errors.len()];
        let strike = |day: &mut Day, nth| once_on_a_day(day, nth, errno(nth));
        let name = format!("{name}, once on a day with names");
        assert_clean(&strike_everywhere(&name, DAY_HANDS, day_step(), Day::without_button, strike));
    }
}

#[test]
#[ignore = "needs ptrace and minutes, run by .ci/run"]
fn an_error_that_stays_loses_nothing_and_the_next_start_goes_on() {
    assert!(can_trace());
    for (name, errors) in passes() {
        let most = AtomicUsize::new(0);
        let errno = |nth: usize| errors[nth % errors.len()];
        let strike = |booth: &mut Booth, nth| for_good(booth, nth, errno(nth), &most);
        let tally = strike_everywhere(&format!("{name}, for good"), HANDS, 1, booth, strike);
        println!("  at most {} failing calls in {KEPT_UP:?}", most.load(Ordering::Relaxed));
        assert_clean(&tally);
    }
}

#[test]
#[ignore = "needs ptrace and minutes, run by .ci/run"]
fn a_short_write_is_finished() {
    assert!(can_trace());
    let writes = |call: &Call| call.kind == Kind::Write;
    let strike = |booth: &mut Booth, nth: usize| once(booth, nth, CallFate::Short, writes);
    assert_clean(&strike_everywhere("short write", HANDS, 1, booth, strike));
}
