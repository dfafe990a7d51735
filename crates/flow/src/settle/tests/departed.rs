//! Files that a look did not find although they were there, stamps without fractions, and sleep.

use super::*;

/// The part that was there at the first look, and the whole.
fn contents() -> (Vec<u8>, Vec<u8>) {
    let whole: Vec<u8> = (0..30_000).map(|at| (at % 251) as u8).collect();
    (whole[..9_000].to_vec(), whole)
}

pub(super) fn stamp_of(ino: u64, size: usize, second: i128) -> Stamp {
    let ns = second * 1_000_000_000 + 1;
    Stamp { dev: 1, ino, size: size as u64, mtime_ns: ns, ctime_ns: ns }
}

pub(super) fn seen(files: &[(&str, Stamp)]) -> Look {
    Look::Seen(files.iter().map(|(name, stamp)| (PathBuf::from(name), (*stamp).into())).collect())
}

/// A temporary file is seen in second 10, hidden by its rename from the look of second 20, and seen as a
/// scan in second 30. Returns when its content began. `is_read` is whether part of it was read in
/// between.
fn renamed_in_a_look(is_read: bool) -> Appeared {
    let (part, whole) = contents();
    let mut settling = settling();
    settling.pass_over(BTreeMap::new(), at(5));
    settling.observe(seen(&[]), at(5));
    let temporary = stamp_of(7, part.len(), 9);
    settling.pass_over(BTreeMap::from([(PathBuf::from("x.tmp"), temporary)]), at(10));
    settling.observe(seen(&[]), at(10));
    let mark = Fingerprint::whole(Duration::from_secs(10), Duration::from_secs(10), &part);
    settling.marked(Path::new("x.tmp"), temporary, is_read.then_some(mark));
    settling.pass_over(BTreeMap::new(), at(20));
    settling.observe(seen(&[]), at(20));
    let scan = stamp_of(7, whole.len(), 29);
    for second in [30, 40] {
        settling.pass_over(BTreeMap::new(), at(second));
        let settled = settling.observe(seen(&[("a.obj", scan)]), at(second));
        if let [settled] = settled.as_slice() {
            return settling.began(settled, &whole);
        }
    }
    panic!("it did not settle");
}

#[test]
fn a_content_that_a_rename_hid_from_a_look_is_no_younger_for_it() {
    let began = renamed_in_a_look(true);
    assert_eq!((began.absent, began.seen), (Some(Duration::from_secs(5)), Duration::from_secs(10)));
}

#[test]
fn nor_is_one_of_which_nothing_was_read() {
    let began = renamed_in_a_look(false);
    assert_eq!(began.absent, Some(Duration::from_secs(5)));
}

#[test]
fn another_content_under_the_number_of_a_file_that_has_gone_is_as_young_as_it_is() {
    let (part, _) = contents();
    let other: Vec<u8> = (0..30_000).map(|at| (at % 241) as u8).collect();
    let mut settling = settling();
    settling.observe(seen(&[]), at(5));
    let gone = stamp_of(7, part.len(), 9);
    settling.observe(seen(&[("a.obj", gone)]), at(10));
    let mark = Fingerprint::whole(Duration::from_secs(10), Duration::from_secs(10), &part);
    settling.marked(Path::new("a.obj"), gone, Some(mark));
    settling.observe(seen(&[]), at(20));
    let scan = stamp_of(7, other.len(), 29);
    settling.observe(seen(&[("b.obj", scan)]), at(30));
    let settled = settling.observe(seen(&[("b.obj", scan)]), at(40));
    let began = settling.began(&settled[0], &other);
    let (absent, seen) = (Some(Duration::from_secs(20)), Duration::from_secs(30));
    assert_eq!(began, Appeared { absent, seen });
}

#[test]
fn what_has_departed_is_forgotten_after_a_while() {
    let mut settling = settling();
    settling.observe(seen(&[("a.obj", stamp_of(7, 9, 1))]), at(10));
    settling.observe(seen(&[]), at(20));
    assert_eq!(settling.departed.len(), 1);
    settling.observe(seen(&[]), at(621));
    assert!(settling.departed.is_empty());
}

#[test]
fn where_stamps_have_whole_seconds_a_file_is_quiet_for_two_of_them() {
    let short = Duration::from_millis(100);
    let whole = Stamp { mtime_ns: 4_000_000_000, ctime_ns: 4_000_000_000, ..stamp_of(7, 9, 4) };
    for (stamp, grain) in [(stamp_of(7, 9, 4), 0), (whole, 2)] {
        let mut settling = Settling::new(short, SHORT_WAIT, OVERDUE);
        settling.observe(seen(&[("a.obj", stamp)]), at(10));
        let due = settling.next_due().unwrap();
        assert_eq!(due, Duration::from_secs(10) + short.max(Duration::from_secs(grain)));
    }
}

#[test]
fn the_time_in_which_the_machine_slept_is_no_quiet_time() {
    let mut settling = settling();
    settling.observe(look(&[("a", 1)]), at(0));
    settling.note_gap();
    assert!(settling.observe(look(&[("a", 1)]), at(100)).is_empty());
    assert_eq!(names(&settling.observe(look(&[("a", 1)]), at(102))), ["a"]);
}
