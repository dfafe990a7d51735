//! The erasure of a person cut off before every call that changes a file: either it was not noted, and
//! nothing is gone, or the next start ends it. The other person keeps what they have.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use rig::faults::disk::{Disk, can_be_cut, power_cut};
use rig::faults::matrix::{Struck, booth, empty_folders, strike_everywhere, thinned, what};
use rig::faults::tracer::{self, CallFate, Kind, Run, can_trace};
use rig::verb::program;
use rig::{Booth, PATIENCE, names};
use support::coarse_body;

/// Runs at a time: one waits while the other works.
const HANDS: usize = 3;

/// Fewer points than this and the matrix has not seen the erasure.
const POINTS_LEAST: usize = 30;

/// An id that nothing else holds.
const ID: &str = "73190426";

const OTHER: &str = "51660018";

/// The folders that gaiter writes.
const KEPT: [&str; 2] = ["state", "records"];

/// A station that is stopped and holds scans of two persons, and how it was before a strike.
struct StoppedStation {
    booth: Booth,
    before: PathBuf,
    disks: Vec<Disk>,
}

impl StoppedStation {
    fn new() -> StoppedStation {
        let booth = booth();
        let daemon = booth.start_ready();
        booth.export(&format!("{ID}_a.obj"), &coarse_body(1));
        booth.export(&format!("{OTHER}_b.obj"), &coarse_body(2));
        booth.export(&format!("{ID}_c.obj"), b"v 1 2 3\nno scan\n");
        booth.wait_for_records(2);
        booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 1);
        assert_eq!(daemon.stop().code(), Some(0));
        fs::write(booth.path("twice"), format!("{ID}\n{ID}\n")).unwrap();
        let before = booth.path("before");
        for folder in KEPT {
            copy(&booth.path(folder), &before.join(folder));
        }
        StoppedStation { booth, before, disks: Vec::new() }
    }

    /// The same on disks whose power can be cut.
    fn on_disks() -> StoppedStation {
        let mut place = StoppedStation::new();
        let disk = |name| Disk::new(place.booth.path(name));
        place.disks = KEPT.map(disk).into();
        place
    }

    /// Everything as it was before.
    fn renew(&self) {
        empty_folders(&self.booth);
        for folder in KEPT {
            copy(&self.before.join(folder), &self.booth.path(folder));
        }
        // The scanner's files were removed with the folders: they would name the person.
        self.disks.iter().for_each(Disk::sync);
    }

    /// Erases the person, struck before the nth call.
    fn strike(&mut self, nth: usize, stroke: CallFate) -> Struck {
        self.renew();
        let (mut at, mut count) = (None, 0);
        let run = erase(&self.booth, |call| {
            if call.kind == Kind::Mode {
                return CallFate::Do;
            }
            count += 1;
            if count == nth {
                at = Some(what(&self.booth, call));
                return stroke;
            }
            CallFate::Do
        });
        if !self.disks.is_empty() {
            power_cut(&self.disks);
        }
        let at = match at {
            Some(at) => at,
            None => {
                assert_eq!(run.code, Some(0), "without a fault");
                return None;
            }
        };
        Some((at, self.found()))
    }

    /// What does not hold once the station was started again.
    fn found(&self) -> Vec<String> {
        let was_noted = is_noted(&self.booth);
        let mut daemon = self.booth.start();
        let began = Instant::now();
        let is_over = || {
            let log = self.booth.log();
            log.contains("station-ready") && !is_pending(&self.booth)
        };
        while !is_over() && !daemon.has_ended() && began.elapsed() < PATIENCE {
            sleep(Duration::from_millis(10));
        }
        let code = daemon.stop().code();
        let mut found = Vec::new();
        if code != Some(0) {
            found.push(format!("the station without faults ended with {code:?}"));
        }
        let log = self.booth.log();
        if log.contains("journal-rebuilt") || log.contains("journal-set-aside") {
            found.push("the journal was given up".to_owned());
        }
        let records = |id: &str| names(&self.booth.path("records").join(id)).len();
        if records(OTHER) != 1 {
            found.push(format!("the other has {} records", records(OTHER)));
        }
        let naming = naming(&self.booth);
        match was_noted {
            true if !naming.is_empty() => found.push(format!("the id is still in {naming:?}")),
            false if records(ID) != 1 => found.push("gone without a note".to_owned()),
            _ => {}
        }
        found
    }
}

/// Runs the verb under the tracer.
fn erase(booth: &Booth, answer: impl FnMut(&tracer::Call) -> CallFate) -> Run {
    let gate = format!("read go; exec \"$0\" \"$@\" <{}", booth.path("twice").display());
    let mut command = Command::new("sh");
    command.arg("-c").arg(gate).arg(program()).args(["patient", "erase", "--config"]);
    let log = fs::File::options().create(true).append(true).open(booth.path("said")).unwrap();
    command.arg(booth.path("station.toml")).stdout(log.try_clone().unwrap()).stderr(log);
    let folders = KEPT.map(|folder| booth.path(folder));
    tracer::run(command, &folders, || false, answer)
}

/// The texts of the noted erasures.
fn erasures(booth: &Booth) -> Vec<String> {
    let files = files(&booth.path("state/erasures")).into_iter();
    let is_one = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy();
        name.ends_with(".json") && !name.starts_with('.')
    };
    files.filter(is_one).map(|path| fs::read_to_string(path).unwrap()).collect()
}

fn is_noted(booth: &Booth) -> bool {
    !erasures(booth).is_empty()
}

fn is_pending(booth: &Booth) -> bool {
    erasures(booth).iter().any(|text| text.contains("\"ended\": null"))
}

/// The files that name the person.
fn naming(booth: &Booth) -> Vec<PathBuf> {
    let all = KEPT.iter().flat_map(|folder| files(&booth.path(folder)));
    all.filter(|path| {
        let held = fs::read(path).unwrap_or_default();
        held.windows(ID.len()).any(|part| part == ID.as_bytes())
            || path.to_string_lossy().contains(ID)
    })
    .collect()
}

/// Every file below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        match entry.file_type().unwrap().is_dir() {
            true => found.extend(files(&entry.path())),
            false => found.push(entry.path()),
        }
    }
    found
}

/// Copies a folder; a socket, which a killed station leaves, is no file.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let place = to.join(path.file_name().unwrap());
        let kind = path.symlink_metadata().unwrap().file_type();
        if kind.is_dir() && path.file_name().unwrap() != "lost+found" {
            copy(&path, &place);
        } else if kind.is_file() {
            fs::copy(&path, &place).unwrap();
        }
    }
}

#[test]
#[ignore = "needs ptrace and minutes, run by .ci/run"]
fn an_erasure_killed_before_any_call_is_ended_by_the_next_start() {
    assert!(can_trace());
    let strike = |place: &mut StoppedStation, nth| place.strike(nth, CallFate::Kill);
    let tally = strike_everywhere("erasure, kill -9", HANDS, 1, StoppedStation::new, strike);
    assert!(tally.violations.is_empty(), "{:#?}", tally.violations);
    assert!(tally.points >= POINTS_LEAST / thinned(), "{} points", tally.points);
}

#[test]
#[ignore = "needs root, loop devices, ext4 and minutes, run by .ci/run"]
fn an_erasure_cut_off_before_any_call_is_ended_by_the_next_start() {
    assert!(can_trace() && can_be_cut());
    let strike = |place: &mut StoppedStation, nth| place.strike(nth, CallFate::KillAll);
    let tally = strike_everywhere("erasure, power cut", HANDS, 1, StoppedStation::on_disks, strike);
    assert!(tally.violations.is_empty(), "{:#?}", tally.violations);
    assert!(tally.points >= POINTS_LEAST / thinned(), "{} points", tally.points);
}
