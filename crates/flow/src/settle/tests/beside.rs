//! What lies beside an export when it is taken: a second content counts, and another file of the same scan
//! does not.

use super::departed::{seen, stamp_of};
use super::*;

/// The content of scan 1 or 2, of 30 000 bytes.
fn scan(number: usize) -> Vec<u8> {
    (0..30_000).map(|at| (at % (250 + number)) as u8).collect()
}

/// A look finds these files (name, state, content) and reads part of each that changed.
fn looked(settling: &mut Settling, files: &[(&str, Stamp, &[u8])], second: u64) -> Vec<Settled> {
    let there: Vec<(&str, Stamp)> = files.iter().map(|(name, stamp, _)| (*name, *stamp)).collect();
    let due = settling.observe(seen(&there), at(second));
    for (path, stamp) in settling.unmarked() {
        let (_, _, content) = files.iter().find(|(name, ..)| Path::new(name) == path).unwrap();
        let now = at(second).ended;
        let mark = (!content.is_empty()).then(|| Fingerprint::whole(now, now, content));
        settling.marked(&path, stamp, mark);
    }
    due
}

/// How many contents lie beside `a.obj`, which is whole in second 10 and due in second 13, if this file is
/// first found in that second.
fn beside((name, ino): (&str, u64), content: &[u8], first_s: u64) -> usize {
    let mut settling = settling();
    let own = scan(1);
    let a = ("a.obj", stamp_of(1, own.len(), 9), own.as_slice());
    let other = (name, stamp_of(ino, content.len(), 9), content);
    looked(&mut settling, &[], 5);
    let mut due = Vec::new();
    for second in [10, 11, 13] {
        let files = if second < first_s { vec![a] } else { vec![a, other] };
        due = looked(&mut settling, &files, second);
    }
    let own_settled = due.iter().find(|settled| settled.path == Path::new("a.obj")).unwrap();
    settling.others(own_settled, &own).len()
}

#[test]
fn another_content_that_was_there_when_an_export_was_whole_lies_beside_it() {
    assert_eq!(beside(("b.obj", 2), &scan(2), 10), 1);
    assert_eq!(beside(("b.obj", 2), &scan(2), 11), 0, "it begins afterwards");
    for format in ["a.stl", "a.ply"] {
        assert_eq!(beside((format, 2), &scan(2), 10), 0, "{format} is another format of it");
    }
    assert_eq!(beside(("b.obj", 1), &scan(1), 10), 0, "a link");
    assert_eq!(beside(("b.obj", 2), &scan(1), 10), 0, "a copy");
    assert_eq!(beside(("b.obj", 2), &scan(1)[..9_000], 10), 0, "an earlier part");
    assert_eq!(beside(("b.obj", 2), &[], 10), 0, "nothing yet");
}

#[test]
fn so_does_one_that_was_written_over_a_file_that_was_taken() {
    let mut settling = settling();
    let (own, old, new) = (scan(1), scan(2), scan(3));
    let old = ("b.obj", stamp_of(2, old.len(), 1), old.as_slice());
    looked(&mut settling, &[old], 5);
    let due = looked(&mut settling, &[old], 8);
    settling.taken(&due[0]);
    let files = [
        ("a.obj", stamp_of(1, own.len(), 19), own.as_slice()),
        ("b.obj", stamp_of(2, new.len(), 19), new.as_slice()),
    ];
    looked(&mut settling, &files, 20);
    let due = looked(&mut settling, &files, 23);
    let a = due.iter().find(|settled| settled.path == Path::new("a.obj")).unwrap();
    let others = settling.others(a, &own);
    assert_eq!(others.len(), 1);
    assert!(others[0].seen >= Duration::from_secs(20), "its content began then: {others:?}");
}

#[test]
fn a_file_that_is_no_scan_may_become_one_only_while_it_changes() {
    let mut settling = settling();
    let note = BTreeMap::from([(PathBuf::from("note.log"), stamp_of(7, 100, 9))]);
    let mut beside = |second: u64| {
        settling.pass_over(note.clone(), at(second));
        settling.observe(seen(&[]), at(second));
        settling.sights().beside.len()
    };
    let end = 10 + SHORT_WAIT.as_secs();
    assert_eq!([10, end - 1, end + 1].map(&mut beside), [1, 1, 0]);
}
