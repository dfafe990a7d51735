//! What is brought in from elsewhere, in every way, and what only looks like it.

use super::*;

/// A body as its export; two begin differently.
fn body(of: u8) -> Vec<u8> {
    (0..30_000).map(|at| of.wrapping_add((at % 251) as u8)).collect()
}

/// A file with so much of a body, and the seconds in which its content and anything of it changed last.
fn file(ino: u64, size: usize, written: i128, changed: i128) -> Stamp {
    let ns = |second: i128| second * 1_000_000_000 + 1;
    Stamp { dev: 1, ino, size: size as u64, mtime_ns: ns(written), ctime_ns: ns(changed) }
}

/// What is there.
#[derive(Default)]
struct There<'a> {
    /// Which folder the path leads to.
    export: u64,
    /// The folders in it, and the second in which each changed last.
    below: &'a [(&'a str, u64, i128)],
    files: &'a [(&'a str, Stamp)],
}

impl There<'_> {
    /// Looks in this second, and reads what is to be read: parts of this body.
    fn looked(&self, settling: &mut Settling, body: &[u8], second: u64) -> Vec<Settled> {
        let folder = |(path, ino, changed): &(&str, u64, i128)| {
            (PathBuf::from(path), file(*ino, 0, *changed, *changed))
        };
        let below = self.below.iter().map(folder).collect();
        settling.found_in(Folders { export: (1, self.export), below });
        settling.pass_over(BTreeMap::new(), at(second));
        let files = self.files.iter();
        let files = files.map(|(path, stamp)| (PathBuf::from(path), Group::from(*stamp)));
        let due = settling.observe(Look::Seen(files.collect()), at(second));
        for (path, stamp) in settling.unmarked() {
            let part = &body[..stamp.size as usize];
            let mark = Fingerprint::whole(at(second).began, at(second).ended, part);
            settling.marked(&path, stamp, Some(mark));
        }
        due
    }
}

/// The files alone.
fn files<'a>(files: &'a [(&'a str, Stamp)]) -> There<'a> {
    There { files, ..There::default() }
}

/// When the only file that is due was absent, seconds.
#[track_caller]
fn absent(settling: &Settling, due: &[Settled], body: &[u8]) -> Option<u64> {
    assert_eq!(due.len(), 1);
    settling.began(&due[0], body).absent.map(|absent| absent.as_secs())
}

#[test]
fn what_gets_the_time_of_its_source_last_is_as_old_as_that() {
    for parts in [&[9_000, 30_000][..], &[0, 9_000, 30_000], &[30_000], &[]] {
        let (mut settling, body) = (settling(), body(1));
        files(&[]).looked(&mut settling, &body, 1005);
        for (n, part) in (0..).zip(parts) {
            let now = 1010 + n;
            let growing = file(7, *part, now, now);
            files(&[("a.obj", growing)]).looked(&mut settling, &body, now as u64);
        }
        let copied = [("a.obj", file(7, 30_000, 100, 1014))];
        files(&copied).looked(&mut settling, &body, 1014);
        let due = files(&copied).looked(&mut settling, &body, 1016);
        assert_eq!(absent(&settling, &due, &body), Some(100), "{parts:?}");
    }
}

#[test]
fn so_is_what_is_copied_in_place_over_an_older_name_smaller_or_larger() {
    for size in [9_000, 20_000, 30_000] {
        let (mut settling, [there, copied]) = (settling(), [body(1), body(2)]);
        let old = [("a.obj", file(7, 20_000, 900, 900))];
        files(&old).looked(&mut settling, &there, 1005);
        let due = files(&old).looked(&mut settling, &there, 1008);
        let read = Duration::from_secs(1008);
        settling.read(&due[0], &Fingerprint::whole(read, read, &there[..20_000]));
        settling.taken(&due[0]);
        files(&[("a.obj", file(7, size, 1010, 1010))]).looked(&mut settling, &copied, 1010);
        let copy = [("a.obj", file(7, size, 100, 1011))];
        files(&copy).looked(&mut settling, &copied, 1011);
        let due = files(&copy).looked(&mut settling, &copied, 1014);
        assert_eq!(absent(&settling, &due, &copied[..size]), Some(100), "{size}");
    }
}

#[test]
fn a_time_that_is_set_to_now_makes_an_old_content_no_younger_nor_does_a_copy_of_it() {
    let (mut settling, body) = (settling(), body(1));
    files(&[]).looked(&mut settling, &body, 1005);
    files(&[("a.obj", file(7, 30_000, 100, 1010))]).looked(&mut settling, &body, 1010);
    let touched = ("a.obj", file(7, 30_000, 1011, 1011));
    files(&[touched]).looked(&mut settling, &body, 1011);
    let both = [touched, ("b.obj", file(8, 30_000, 1012, 1012))];
    files(&both).looked(&mut settling, &body, 1012);
    let due = files(&both).looked(&mut settling, &body, 1015);
    assert_eq!(due.len(), 2);
    for settled in due {
        assert_eq!(absent(&settling, &[settled], &body), Some(100));
    }
}

#[test]
fn what_is_moved_in_with_a_folder_is_as_old_as_it_was_there() {
    let (mut settling, body) = (settling(), body(1));
    files(&[]).looked(&mut settling, &body, 1005);
    let moved_in = There {
        below: &[("d", 50, 1010), ("d/e", 51, 90)],
        files: &[("d/e/a.obj", file(7, 30_000, 100, 100))],
        ..There::default()
    };
    moved_in.looked(&mut settling, &body, 1010);
    let due = moved_in.looked(&mut settling, &body, 1013);
    assert_eq!(absent(&settling, &due, &body), Some(100));
}

#[test]
fn the_folder_of_a_day_and_a_temporary_name_make_nothing_old() {
    let (mut settling, body) = (settling(), body(1));
    There { below: &[("d", 50, 970)], ..There::default() }.looked(&mut settling, &body, 980);
    let there = There {
        below: &[("d", 50, 1000)],
        files: &[("d/a.obj", file(7, 30_000, 990, 995))],
        ..There::default()
    };
    there.looked(&mut settling, &body, 1000);
    let due = there.looked(&mut settling, &body, 1003);
    assert_eq!(absent(&settling, &due, &body), Some(980));
}

#[test]
fn where_another_export_folder_took_the_place_of_one_nothing_new_is_known_to_have_been_absent() {
    let before = There { export: 1, below: &[("d", 50, 10), ("e", 60, 10)], ..There::default() };
    // A sub-folder that the exporter makes again is no other one.
    for (export, d, is_known) in [(1, 50, true), (2, 50, false), (1, 51, true)] {
        let (mut settling, body) = (settling(), body(1));
        before.looked(&mut settling, &body, 1005);
        let below = [("d", d, 10), ("e", 60, 10)];
        let first = ("d/f/a.obj", file(7, 30_000, 1009, 1009));
        There { export, below: &below, files: &[first] }.looked(&mut settling, &body, 1010);
        let files = [first, ("d/f/b.obj", file(8, 30_000, 1011, 1011))];
        let there = There { export, below: &below, files: &files };
        there.looked(&mut settling, &body, 1011);
        let due = there.looked(&mut settling, &body, 1014);
        assert_eq!(due.len(), 2);
        let first = due.iter().find(|settled| settled.group.stamp.ino == 7).unwrap();
        assert_eq!(first.writing.appeared().absent.is_some(), is_known, "{export} {d}");
        let second = due.iter().find(|settled| settled.group.stamp.ino == 8).unwrap();
        assert_eq!(second.writing.appeared().absent, Some(Duration::from_secs(1010)));
    }
}

#[test]
fn a_mode_a_link_and_another_name_make_no_file_younger_or_older() {
    let (mut settling, body) = (settling(), body(1));
    files(&[]).looked(&mut settling, &body, 1005);
    files(&[("a.obj", file(7, 30_000, 1009, 1009))]).looked(&mut settling, &body, 1010);
    files(&[("a.obj", file(7, 30_000, 1009, 2000))]).looked(&mut settling, &body, 2000);
    let linked = file(7, 30_000, 1009, 2001);
    files(&[("a.obj", linked), ("b.obj", linked)]).looked(&mut settling, &body, 2001);
    let renamed = [("c.obj", file(7, 30_000, 1009, 2002))];
    files(&renamed).looked(&mut settling, &body, 2002);
    let due = files(&renamed).looked(&mut settling, &body, 2005);
    assert_eq!(absent(&settling, &due, &body), Some(1005));
}
