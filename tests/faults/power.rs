//! The power cut before every call of a run that changes a file: what was acknowledged is there
//! afterwards, and the station puts the rest in order. Without the folders' syncs, and without the
//! files', it must not hold: else the matrix would see nothing.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use rig::Booth;
use rig::day::Day;
use rig::faults::disk::{Disk, can_be_cut, power_cut};
use rig::faults::matrix::{
    DAY_HANDS, FOLDERS, POINTS_MIN, Struck, booth, day_step, found_at_once, renew, restarted,
    strike_everywhere, strike_until_violated, struck_at, struck_at_until, thinned,
};
use rig::faults::tracer::{Call, CallFate, Kind, can_trace};

/// Runs at a time: one waits while the other works.
const HANDS: usize = 3;

/// The controls cut at every so many-th call only.
const CONTROL_STEP: usize = 4;

/// A booth whose folders are disks. A disk of its own for each: the sync of a file makes the names
/// of its whole file system durable, so the journal would hide a folder that was never synced.
struct BoothOnDisks {
    disks: Vec<Disk>,
    booth: Booth,
}

impl BoothOnDisks {
    fn new() -> BoothOnDisks {
        let booth = booth();
        BoothOnDisks { disks: disks(&booth), booth }
    }

    /// Cuts the power before the nth call, where `pretended` calls are not made at all.
    fn cut(&mut self, nth: usize, pretended: fn(&Call) -> bool) -> Struck {
        let BoothOnDisks { disks, booth } = self;
        renew(booth);
        disks.iter().for_each(Disk::sync);
        let usual = |call: &Call| if pretended(call) { CallFate::Pretend } else { CallFate::Do };
        let (at, run) = struck_at(booth, nth, CallFate::KillAll, usual);
        power_cut(disks);
        let mut found = found_at_once(booth, &run);
        if found.is_empty() {
            found = restarted(booth);
        }
        Some((at?, found))
    }
}

fn disks(booth: &Booth) -> Vec<Disk> {
    let disk = |name| {
        std::fs::create_dir_all(booth.path(name)).unwrap();
        Disk::new(booth.path(name))
    };
    FOLDERS.map(disk).into()
}

/// A day with names on such disks.
struct DayPlace {
    disks: Vec<Disk>,
    day: Day,
}

impl DayPlace {
    fn new() -> DayPlace {
        let day = Day::without_button();
        DayPlace { disks: disks(&day.booth), day }
    }

    fn cut(&mut self, nth: usize) -> Struck {
        let DayPlace { disks, day } = self;
        day.renew();
        disks.iter().for_each(Disk::sync);
        let usual = |_: &Call| CallFate::Do;
        let (at, run) =
            struck_at_until(&day.booth, || day.goes_on(), nth, CallFate::KillAll, usual);
        if at.is_none() {
            assert!(day.is_all_delivered(), "without a fault; log:\n{}", day.booth.log());
        }
        power_cut(disks);
        let mut found = day.found_at_once(&run);
        if found.is_empty() {
            found = day.goes_on_restarted();
        }
        Some((at?, found))
    }
}

#[test]
#[ignore = "needs root, loop devices, ext4 and minutes, run by .ci/run"]
fn a_power_cut_on_a_day_with_names_gives_nobody_the_scan_of_another() {
    assert!(can_trace() && can_be_cut());
    let (name, step) = ("power cut on a day with names", day_step());
    let tally = strike_everywhere(name, DAY_HANDS, step, DayPlace::new, DayPlace::cut);
    assert!(tally.violations.is_empty(), "{:#?}", tally.violations);
    assert!(tally.points > 0, "nothing was struck");
}

#[test]
#[ignore = "needs root, loop devices, ext4 and minutes, run by .ci/run"]
fn a_power_cut_before_any_call_loses_nothing_that_was_acknowledged() {
    assert!(can_trace() && can_be_cut());
    let cut = |place: &mut BoothOnDisks, nth| place.cut(nth, |_| false);
    let tally = strike_everywhere("power cut", HANDS, 1, BoothOnDisks::new, cut);
    assert!(tally.violations.is_empty(), "{:#?}", tally.violations);
    assert!(tally.points * thinned() >= POINTS_MIN, "{} points", tally.points);
}

#[test]
#[ignore = "needs root, loop devices, ext4 and minutes, run by .ci/run"]
fn without_the_syncs_of_folders_power_cuts_lose_records() {
    assert!(can_trace() && can_be_cut());
    let cut = |place: &mut BoothOnDisks, nth| place.cut(nth, |call| call.folder);
    let name = "control: power cut without folder syncs";
    let tally = strike_until_violated(name, HANDS, CONTROL_STEP, BoothOnDisks::new, cut);
    assert!(!tally.violations.is_empty(), "the matrix sees nothing");
}

#[test]
#[ignore = "needs root, loop devices, ext4 and minutes, run by .ci/run"]
fn without_the_syncs_of_files_power_cuts_leave_partial_records() {
    assert!(can_trace() && can_be_cut());
    let sync = |call: &Call| call.kind == Kind::Sync && !call.folder;
    let cut = |place: &mut BoothOnDisks, nth| place.cut(nth, sync);
    let name = "control: power cut without file syncs";
    let tally = strike_until_violated(name, HANDS, CONTROL_STEP, BoothOnDisks::new, cut);
    assert!(!tally.violations.is_empty(), "the matrix sees nothing");
}
