//! Contents that are gone before they were taken, and what only looks like it.

use super::departed::{seen, stamp_of};
use super::*;

fn body(of: u8, length: usize) -> Vec<u8> {
    (0..length).map(|at| of.wrapping_add((at % 251) as u8)).collect()
}

/// A look finds these files, by name, inode and content, each written in this second; where they are new
/// or have changed, they are read. Returns what is gone.
fn looked(settling: &mut Settling, second: u64, files: &[(&str, u64, &[u8], i128)]) -> Vec<Gone> {
    let stamps =
        files.iter().map(|(name, ino, bytes, at)| (*name, stamp_of(*ino, bytes.len(), *at)));
    let stamps: Vec<(&str, Stamp)> = stamps.collect();
    let is_scan = |name: &str| name.ends_with(".obj");
    let others = stamps.iter().filter(|(name, _)| !is_scan(name));
    let others = others.map(|(name, stamp)| (PathBuf::from(name), *stamp)).collect();
    settling.pass_over(others, at(second));
    let scans: Vec<(&str, Stamp)> =
        stamps.iter().copied().filter(|(name, _)| is_scan(name)).collect();
    let due = settling.observe(seen(&scans), at(second));
    let now = Duration::from_secs(second);
    for (path, stamp) in settling.unmarked() {
        let of = files.iter().find(|(name, ..)| Path::new(name) == path);
        let mark = of.map(|(_, _, bytes, _)| Fingerprint::whole(now, now, bytes));
        settling.marked(&path, stamp, mark);
    }
    settling.gone(!due.is_empty())
}

/// A station that has looked at an empty folder, and then saw one export.
fn one_seen(bytes: &[u8]) -> Settling {
    let mut settling = settling();
    assert_eq!(looked(&mut settling, 5, &[]), []);
    assert_eq!(looked(&mut settling, 10, &[("a.obj", 7, bytes, 9)]), []);
    settling
}

fn when(gone: &[Gone]) -> Vec<(&Path, Appeared)> {
    gone.iter().map(|content| (content.path.as_path(), content.appeared)).collect()
}

const FIRST: Appeared =
    Appeared { absent: Some(Duration::from_secs(5)), seen: Duration::from_secs(10) };

#[test]
fn a_deleted_content_is_gone_when_a_second_look_misses_it_or_another_is_to_be_taken() {
    let (first, second) = (body(1, 9_000), body(2, 9_000));
    let mut deleted = one_seen(&first);
    assert_eq!(looked(&mut deleted, 11, &[]), []);
    let gone = looked(&mut deleted, 12, &[]);
    assert_eq!(when(&gone), [(Path::new("a.obj"), FIRST)]);
    assert_eq!(looked(&mut deleted, 13, &[]), [], "it is reported once");

    let mut settling = one_seen(&first);
    let both = [("a.obj", 7, &first[..], 9), ("b.obj", 8, &second[..], 10)];
    assert_eq!(looked(&mut settling, 11, &both), []);
    let gone = looked(&mut settling, 14, &both[1..]);
    assert_eq!(when(&gone), [(Path::new("a.obj"), FIRST)]);
}

#[test]
fn a_content_that_is_written_over_in_place_cut_off_or_replaced_is_gone() {
    let (first, second) = (body(1, 9_000), body(2, 12_000));
    for (ino, bytes) in [(7, &second[..]), (8, &second[..]), (7, &second[..5_000])] {
        let mut settling = one_seen(&first);
        let files = [("a.obj", ino, bytes, 11)];
        let mut gone = looked(&mut settling, 11, &files);
        gone.extend(looked(&mut settling, 12, &files));
        assert_eq!(when(&gone), [(Path::new("a.obj"), FIRST)], "{ino}, {}", bytes.len());
        assert_eq!(looked(&mut settling, 20, &files), []);
    }
}

#[test]
fn a_content_that_is_cut_off_is_gone_only_if_another_follows() {
    let first = body(1, 9_000);
    let mut settling = one_seen(&first);
    assert_eq!(looked(&mut settling, 11, &[("a.obj", 7, &first[..0], 11)]), []);
    assert_eq!(looked(&mut settling, 12, &[("a.obj", 7, &first[..6_000], 12)]), []);
    assert_eq!(looked(&mut settling, 13, &[("a.obj", 7, &first[..], 13)]), []);
    // Nothing follows, and that is to be taken.
    let mut settling = one_seen(&first);
    assert_eq!(looked(&mut settling, 11, &[("a.obj", 7, &first[..0], 11)]), []);
    assert_eq!(looked(&mut settling, 14, &[("a.obj", 7, &first[..0], 11)]).len(), 1);
}

#[test]
fn a_small_part_that_leaves_is_gone_and_an_empty_file_is_not() {
    for (length, count) in [(0, 0), (1, 1), (3_000, 1)] {
        let mut settling = one_seen(&body(1, length));
        assert_eq!(looked(&mut settling, 11, &[]), []);
        assert_eq!(looked(&mut settling, 12, &[]).len(), count, "{length}");
    }
}

#[test]
fn what_is_renamed_moved_copied_or_grows_is_not_gone() {
    let (first, longer, part) = (body(1, 9_000), body(1, 12_000), body(1, 3_000));
    for files in [
        vec![("b.obj", 7, &first[..], 9)],
        vec![("a.bak", 7, &first[..], 9)],
        // Copied and deleted.
        vec![("b.obj", 8, &first[..], 11)],
        vec![("a.obj", 7, &longer[..], 11)],
    ] {
        let mut settling = one_seen(&first);
        for second in [11, 12, 20] {
            assert_eq!(looked(&mut settling, second, &files), [], "{}", files[0].0);
        }
    }
    // Nothing was read of it, and a look that a rename hid it from is not the last.
    let mut settling = one_seen(&part);
    assert_eq!(looked(&mut settling, 11, &[]), []);
    assert_eq!(looked(&mut settling, 12, &[("b.obj", 7, &part[..], 9)]), []);
}

#[test]
fn what_was_taken_or_whose_bytes_are_kept_and_what_is_out_of_reach_is_not_gone() {
    let (first, second) = (body(1, 9_000), body(2, 12_000));
    for is_taken in [true, false] {
        let mut settling = one_seen(&first);
        let files = [("a.obj", 7, &first[..], 9)];
        settling.pass_over(BTreeMap::new(), at(13));
        let due = settling.observe(seen(&[("a.obj", stamp_of(7, 9_000, 9))]), at(13));
        match is_taken {
            true => settling.taken(&due[0]),
            false => settling.kept(&due[0]),
        }
        assert_eq!(looked(&mut settling, 14, &files), []);
        assert_eq!(looked(&mut settling, 15, &[("a.obj", 7, &second[..], 15)]), []);
        assert_eq!(looked(&mut settling, 16, &[("a.obj", 7, &second[..], 15)]), []);
    }
    let mut settling = one_seen(&first);
    settling.observe(Look::OutOfReach, at(11));
    assert_eq!(settling.gone(false), []);
    assert_eq!(looked(&mut settling, 20, &[("a.obj", 7, &first[..], 9)]), []);
    // Mounted again.
    assert_eq!(looked(&mut settling, 21, &[("a.obj", 99, &first[..], 9)]), []);
}

#[test]
fn a_content_that_no_look_read_is_found_written_over_when_the_file_is_read() {
    let (first, second) = (body(1, 9_000), body(2, 12_000));
    let mut settling = one_seen(&first);
    for second_of in [11, 14] {
        settling.pass_over(BTreeMap::new(), at(second_of));
        let due = settling.observe(seen(&[("a.obj", stamp_of(7, 12_000, 11))]), at(second_of));
        if let [settled] = due.as_slice() {
            let gone = settling.overwritten_by(settled, &second);
            assert_eq!(gone.map(|content| content.appeared), Some(FIRST));
            assert_eq!(settling.overwritten_by(settled, &first), None);
            return;
        }
    }
    panic!("it did not settle");
}
