//! Settling: single claims, then any interleaving of writes, looks and outages.

use gaiter_language::Language;
use proptest::prelude::*;

use super::*;
use crate::export::companions::Companion;
use crate::export::stamp::Stamp;

mod beside;
mod brought_in;
mod departed;
mod gone;

const QUIET: Duration = Duration::from_secs(2);
const SHORT_WAIT: Duration = Duration::from_secs(30);
const OVERDUE: Duration = Duration::from_secs(600);

fn stamp(version: u64) -> Stamp {
    // Size and times do not change with every write: any one field must do.
    Stamp { dev: 1, ino: 7, size: version / 3, mtime_ns: 0, ctime_ns: i128::from(version) }
}

fn look(files: &[(&str, u64)]) -> Look {
    Look::Seen(files.iter().map(|(name, v)| (PathBuf::from(name), stamp(*v).into())).collect())
}

fn at(seconds: u64) -> LookTime {
    LookTime { began: Duration::from_secs(seconds), ended: Duration::from_secs(seconds) }
}

fn settling() -> Settling {
    Settling::new(QUIET, SHORT_WAIT, OVERDUE)
}

fn names(settled: &[Settled]) -> Vec<&str> {
    settled.iter().filter_map(|s| s.path.to_str()).collect()
}

#[test]
fn a_growing_file_waits_until_it_is_quiet() {
    let mut settling = settling();
    for second in 0..100 {
        assert!(settling.observe(look(&[("a", second)]), at(second)).is_empty());
    }
    assert!(settling.observe(look(&[("a", 99)]), at(100)).is_empty());
    assert_eq!(names(&settling.observe(look(&[("a", 99)]), at(101))), ["a"]);
}

#[test]
fn a_file_that_left_and_came_back_starts_again() {
    let mut settling = settling();
    settling.observe(look(&[("a", 1)]), at(0));
    settling.observe(look(&[]), at(1));
    assert!(settling.observe(look(&[("a", 1)]), at(2)).is_empty());
    assert_eq!(names(&settling.observe(look(&[("a", 1)]), at(4))), ["a"]);
}

#[test]
fn time_out_of_reach_is_not_quiet_time() {
    let mut settling = settling();
    settling.observe(look(&[("a", 1)]), at(0));
    settling.observe(Look::OutOfReach, at(10));
    assert!(settling.observe(look(&[("a", 1)]), at(20)).is_empty());
    assert_eq!(names(&settling.observe(look(&[("a", 1)]), at(22))), ["a"]);
}

#[test]
fn a_slow_look_does_not_count_as_quiet_time() {
    let mut settling = settling();
    let slow = |began, ended| LookTime {
        began: Duration::from_secs(began),
        ended: Duration::from_secs(ended),
    };
    settling.observe(look(&[("a", 1)]), slow(0, 5));
    assert!(settling.observe(look(&[("a", 1)]), slow(5, 10)).is_empty());
    assert_eq!(names(&settling.observe(look(&[("a", 1)]), slow(10, 15))), ["a"]);
}

#[test]
fn a_taken_file_is_offered_again_only_when_it_has_changed_even_after_an_outage() {
    let mut settling = settling();
    settling.observe(look(&[("a", 1)]), at(0));
    let offered = settling.observe(look(&[("a", 1)]), at(2));
    settling.taken(&offered[0]);
    settling.observe(Look::OutOfReach, at(3));
    assert!(settling.observe(look(&[("a", 1)]), at(100)).is_empty());
    assert_eq!(settling.next_due(), None);
    settling.observe(look(&[("a", 2)]), at(101));
    assert_eq!(names(&settling.observe(look(&[("a", 2)]), at(103))), ["a"]);
}

#[test]
fn a_file_cut_short_is_awaited_and_then_taken_as_it_is() {
    let mut settling = settling();
    settling.observe(look(&[("a", 1)]), at(0));
    let offered = settling.observe(look(&[("a", 1)]), at(2));
    assert!(!offered[0].awaited);
    settling.cut_short(&offered[0]);
    assert!(settling.observe(look(&[("a", 1)]), at(29)).is_empty());
    assert_eq!(settling.next_due(), Some(SHORT_WAIT));
    let offered = settling.observe(look(&[("a", 1)]), at(30));
    assert!(offered[0].awaited);
}

#[test]
fn a_last_line_end_is_awaited_for_three_quiet_times_only() {
    let mut settling = settling();
    settling.observe(look(&[("a", 1)]), at(0));
    let offered = settling.observe(look(&[("a", 1)]), at(2));
    settling.lacks_line_end(&offered[0]);
    assert!(settling.observe(look(&[("a", 1)]), at(5)).is_empty());
    assert_eq!(settling.next_due(), Some(Duration::from_secs(6)));
    let offered = settling.observe(look(&[("a", 1)]), at(6));
    assert!(offered[0].awaited);
}

#[test]
fn a_file_cut_short_that_grows_is_offered_once_it_is_quiet_again() {
    let mut settling = settling();
    settling.observe(look(&[("a", 1)]), at(0));
    let offered = settling.observe(look(&[("a", 1)]), at(2));
    settling.cut_short(&offered[0]);
    settling.observe(look(&[("a", 2)]), at(10));
    let offered = settling.observe(look(&[("a", 2)]), at(12));
    assert_eq!((names(&offered), offered[0].awaited), (vec!["a"], false));
}

#[test]
fn a_file_that_changed_under_the_copy_starts_its_quiet_time_again() {
    let mut settling = settling();
    settling.observe(look(&[("a", 1)]), at(0));
    let offered = settling.observe(look(&[("a", 1)]), at(2));
    settling.changed(&offered[0], Duration::from_secs(3));
    assert!(settling.observe(look(&[("a", 1)]), at(4)).is_empty());
    assert_eq!(names(&settling.observe(look(&[("a", 1)]), at(5))), ["a"]);
}

#[test]
fn a_failed_attempt_is_repeated_without_limit() {
    let mut settling = settling();
    settling.observe(look(&[("a", 1)]), at(0));
    let mut now = 2;
    for _ in 0..50 {
        let offered = settling.observe(look(&[("a", 1)]), at(now));
        assert_eq!(names(&offered), ["a"]);
        settling.failed(&offered[0], Duration::from_secs(now), 0.99);
        assert!(settling.observe(look(&[("a", 1)]), at(now)).is_empty());
        now += backoff::CEILING.as_secs();
    }
}

fn group(scan: u64, companion: Option<u64>, done: Option<u64>) -> Group {
    let companion = companion.map(|version| Companion {
        path: "a.ord".into(),
        stamp: stamp(version),
        name_ending: "ord".into(),
    });
    Group {
        companions: companion.into_iter().collect(),
        done: done.map_or(Done::Missing, |version| Done::There(stamp(version))),
        ..Group::from(stamp(scan))
    }
}

fn look_at(group: Group) -> Look {
    Look::Seen(BTreeMap::from([("a".into(), group)]))
}

#[test]
fn a_scan_waits_for_what_is_written_beside_it() {
    let mut settling = settling();
    settling.observe(look_at(group(1, None, Some(1))), at(0));
    for second in 1..50 {
        let growing = group(1, Some(second), Some(1));
        assert!(settling.observe(look_at(growing), at(second)).is_empty(), "{second}");
    }
    let offered = settling.observe(look_at(group(1, Some(49), Some(1))), at(51));
    assert_eq!(offered[0].group.companions, group(1, Some(49), None).companions);
    settling.taken(&offered[0]);
    for (second, companion) in [(52, Some(50)), (53, None), (60, Some(51)), (90, Some(51))] {
        let late = group(1, companion, Some(1));
        assert!(settling.observe(look_at(late), at(second)).is_empty(), "it came too late");
    }
}

#[test]
fn a_scan_is_taken_only_while_its_done_file_is_there_and_quiet() {
    let mut settling = settling();
    settling.observe(look_at(group(1, None, None)), at(0));
    assert!(settling.observe(look_at(group(1, None, None)), at(100)).is_empty());
    assert_eq!(settling.next_due(), None);
    assert!(settling.observe(look_at(group(1, None, Some(1))), at(101)).is_empty());
    assert!(settling.observe(look_at(group(1, None, None)), at(103)).is_empty());
    assert!(settling.observe(look_at(group(1, None, Some(2))), at(104)).is_empty());
    let offered = settling.observe(look_at(group(1, None, Some(2))), at(106));
    assert_eq!(names(&offered), ["a"]);
}

fn waits(settling: &Settling, seconds: u64) -> Vec<(String, bool)> {
    let waiting = settling.waiting(Duration::from_secs(seconds));
    waiting.map(|(_, waiting)| (waiting.wait.words(Language::En), waiting.overdue)).collect()
}

#[test]
fn what_a_file_waits_for_is_said_in_words() {
    let mut settling = settling();
    let mut says = |group: Group, second: u64, words: &str, overdue: bool| {
        let offered = settling.observe(look_at(group), at(second));
        assert_eq!(waits(&settling, second), [(words.to_owned(), overdue)]);
        offered.iter().for_each(|offered| settling.cut_short(offered));
        settling.newly_overdue(Duration::from_secs(second))
    };
    says(group(1, None, None), 0, "has been unchanged for 0.0 s of 2.0 s", false);
    says(group(2, None, None), 1, "is still being written", false);
    let beside = "waits for a file beside it that is still being written";
    says(group(2, Some(1), None), 2, beside, false);
    says(group(2, Some(1), None), 9, "waits for its done file", false);
    assert_eq!(says(group(2, Some(1), None), 600, "waits for its done file", true), 1);
    assert_eq!(says(group(2, Some(1), None), 601, "waits for its done file", true), 0, "once");
    assert_eq!(says(group(3, None, Some(1)), 602, "is still being written", true), 0);
    says(group(3, None, Some(1)), 604, "has settled and waits for its turn", false);
    let rest = "is incomplete; waits 26 s more for the rest";
    says(group(3, None, Some(1)), 606, rest, true);
    says(group(3, None, Some(1)), 632, "has settled and waits for its turn", false);
}

#[test]
fn a_file_that_fails_says_so_and_one_that_is_taken_waits_for_nothing() {
    let mut settling = settling();
    settling.observe(look(&[("a", 1)]), at(0));
    let offered = settling.observe(look(&[("a", 1)]), at(2));
    settling.failed(&offered[0], Duration::from_secs(2), 0.99);
    let (said, _) = waits(&settling, 2).remove(0);
    assert!(said.starts_with("could not be taken in (tried once); next attempt in"), "{said}");
    settling.observe(Look::OutOfReach, at(3));
    assert_eq!(waits(&settling, 1000)[0].0, "was seen before its folder became unreachable");
    settling.taken(&offered[0]);
    assert_eq!(waits(&settling, 1000), []);
}

/// One event at the folder; the number is which file.
#[derive(Debug, Clone)]
enum Event {
    Write(usize),
    WriteBeside(usize),
    RemoveBeside(usize),
    Done(usize),
    Remove(usize),
    Look,
    OutOfReach,
    Wait(u64),
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        3 => (0..3usize).prop_map(Event::Write),
        1 => (0..3usize).prop_map(Event::WriteBeside),
        1 => (0..3usize).prop_map(Event::RemoveBeside),
        2 => (0..3usize).prop_map(Event::Done),
        1 => (0..3usize).prop_map(Event::Remove),
        4 => Just(Event::Look),
        1 => Just(Event::OutOfReach),
        4 => (1..1500u64).prop_map(Event::Wait),
    ]
}

/// A file as its writer knows it: a version that is never used twice, and when it was written.
type Version = (u64, Duration);

/// A scan and what belongs to it.
#[derive(Clone, Copy)]
struct Written {
    scan: Version,
    beside: Option<Version>,
    done: Option<Version>,
}

impl Written {
    fn group(self) -> Group {
        let version = |(version, _): Version| version;
        group(version(self.scan), self.beside.map(version), self.done.map(version))
    }

    fn changed(self) -> Duration {
        let others = [self.beside, self.done].into_iter().flatten();
        others.map(|(_, at)| at).fold(self.scan.1, Duration::max)
    }
}

/// A folder of three scans.
#[derive(Default)]
struct Folder {
    files: [Option<Written>; 3],
    version: u64,
    taken: BTreeMap<u64, u32>,
}

impl Folder {
    fn write(&mut self, event: &Event, now: Duration) {
        self.version += 1;
        let version = (self.version, now);
        match *event {
            Event::Write(file) => {
                let written = Written { scan: version, beside: None, done: None };
                self.files[file].get_or_insert(written).scan = version;
            }
            Event::WriteBeside(file) => self.change(file, |file| file.beside = Some(version)),
            Event::RemoveBeside(file) => self.change(file, |file| file.beside = None),
            Event::Done(file) => self.change(file, |file| file.done = Some(version)),
            Event::Remove(file) => self.files[file] = None,
            Event::Look | Event::OutOfReach | Event::Wait(_) => {}
        }
    }

    fn change(&mut self, file: usize, change: impl FnOnce(&mut Written)) {
        if let Some(file) = &mut self.files[file] {
            change(file);
        }
    }

    fn look(&self) -> Look {
        let present = self.files.iter().enumerate();
        let present = present.filter_map(|(name, file)| Some((name, (*file)?)));
        Look::Seen(present.map(|(n, file)| (PathBuf::from(n.to_string()), file.group())).collect())
    }

    /// Looks, and takes all that is offered; fails where anything of it is younger than the quiet
    /// time or not done.
    fn look_and_take(&mut self, settling: &mut Settling, now: Duration) {
        for settled in settling.observe(self.look(), LookTime { began: now, ended: now }) {
            let version = settled.group.stamp.ctime_ns as u64;
            let file = self.files.iter().flatten().find(|file| file.scan.0 == version);
            let file = *file.expect("only files that are there are offered");
            let age = now - file.changed();
            assert!(age >= QUIET, "offered {age:?} after its change");
            assert!(file.done.is_some(), "offered undone");
            assert_eq!(settled.group.companions, file.group().companions);
            *self.taken.entry(version).or_default() += 1;
            settling.taken(&settled);
        }
    }
}

proptest! {
    #[test]
    fn no_group_is_taken_young_or_undone_and_each_that_stops_changing_is_taken_once(
        events in prop::collection::vec(event(), 0..200),
    ) {
        let mut folder = Folder::default();
        let mut settling = settling();
        let mut now = Duration::ZERO;
        for event in events {
            match event {
                Event::Look => folder.look_and_take(&mut settling, now),
                Event::OutOfReach => {
                    let when = LookTime { began: now, ended: now };
                    prop_assert!(settling.observe(Look::OutOfReach, when).is_empty());
                }
                Event::Wait(ms) => now += Duration::from_millis(ms),
                event => folder.write(&event, now),
            }
        }
        folder.look_and_take(&mut settling, now);
        now += QUIET;
        folder.look_and_take(&mut settling, now);
        let untaken: Vec<&Path> = settling.waiting(now).map(|(path, _)| path).collect();
        for (name, file) in folder.files.iter().enumerate() {
            let Some(file) = file else { continue };
            let name = name.to_string();
            let awaits_done = file.done.is_none() && untaken.contains(&Path::new(&name));
            let taken = folder.taken.get(&file.scan.0).copied();
            prop_assert!(taken == Some(1) || taken.is_none() && awaits_done, "{name}: {taken:?}");
        }
        prop_assert!(folder.taken.values().all(|times| *times == 1));
    }
}
