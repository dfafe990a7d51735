//! Settling: single claims, then any interleaving of writes, looks and outages.

use proptest::prelude::*;

use super::*;

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

/// One event at the folder; the number is which file.
#[derive(Debug, Clone)]
enum Event {
    Write(usize),
    Remove(usize),
    Look,
    OutOfReach,
    Wait(u64),
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        3 => (0..3usize).prop_map(Event::Write),
        1 => (0..3usize).prop_map(Event::Remove),
        4 => Just(Event::Look),
        1 => Just(Event::OutOfReach),
        4 => (1..1500u64).prop_map(Event::Wait),
    ]
}

/// A folder of three files as its writer knows it: version and time of the last change, or gone.
#[derive(Default)]
struct Folder {
    files: [Option<(u64, Duration)>; 3],
    version: u64,
    offers: BTreeMap<u64, u32>,
}

impl Folder {
    fn look(&self) -> Look {
        let present = self.files.iter().enumerate();
        let present = present.filter_map(|(name, file)| Some((name, (*file)?.0)));
        Look::Seen(present.map(|(n, v)| (PathBuf::from(n.to_string()), stamp(v).into())).collect())
    }

    /// Looks, and takes all that is offered; fails where a file is younger than the quiet time.
    fn look_and_take(&mut self, settling: &mut Settling, now: Duration) {
        for settled in settling.observe(self.look(), LookTime { began: now, ended: now }) {
            let version = settled.stamp.ctime_ns as u64;
            let file = self.files.iter().flatten().find(|(v, _)| *v == version);
            let (_, changed) = file.expect("only files that are there are offered");
            assert!(now - *changed >= QUIET, "offered {:?} after its change", now - *changed);
            *self.offers.entry(version).or_default() += 1;
            settling.taken(&settled);
        }
    }
}

proptest! {
    #[test]
    fn no_file_is_taken_young_and_each_that_stops_changing_is_taken_once(
        events in prop::collection::vec(event(), 0..200),
    ) {
        let mut folder = Folder::default();
        let mut settling = settling();
        let mut now = Duration::ZERO;
        for event in events {
            match event {
                Event::Write(file) => {
                    folder.version += 1;
                    folder.files[file] = Some((folder.version, now));
                }
                Event::Remove(file) => folder.files[file] = None,
                Event::Look => folder.look_and_take(&mut settling, now),
                Event::OutOfReach => {
                    let when = LookTime { began: now, ended: now };
                    prop_assert!(settling.observe(Look::OutOfReach, when).is_empty());
                }
                Event::Wait(ms) => now += Duration::from_millis(ms),
            }
        }
        folder.look_and_take(&mut settling, now);
        now += QUIET;
        folder.look_and_take(&mut settling, now);
        for (version, _) in folder.files.iter().flatten() {
            prop_assert_eq!(folder.offers.get(version), Some(&1), "version {}", version);
        }
        prop_assert!(folder.offers.values().all(|n| *n == 1));
    }
}
