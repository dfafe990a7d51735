//! Looks at real folders.

use std::os::unix::fs::symlink;
use std::os::unix::net::UnixListener;

use gaiter_language::Language;
use rustix::fs::{CWD, Mode, mkfifoat};

use crate::station::intake::scan_dir::*;

fn config() -> WatchConfig {
    WatchConfig { subfolders: false, done_file: None, marker: None }
}

fn looked(folder: &Path, config: &WatchConfig) -> Found {
    look(folder, config, &StepCounter::default()).unwrap()
}

fn changed_ns(path: &Path) -> i128 {
    stamp(&fs::metadata(path).unwrap()).ctime_ns
}

/// Writes a file after this time by the clock of stamps, which advances in steps.
fn write_after(path: &Path, ctime_ns: i128) {
    fs::write(path, "x").unwrap();
    while changed_ns(path) <= ctime_ns {
        fs::write(path, "x").unwrap();
    }
}

fn names(folder: &Path, found: &Found) -> Vec<String> {
    let inside = |path: &PathBuf| path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned();
    found.scans.keys().map(inside).collect()
}

#[test]
fn only_regular_files_that_could_be_scans_are_found_and_the_others_say_why_not() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    for name in ["a.obj", "B.OBJ", ".c.obj", "d.obj.part", "e.TMP", "notes.pdf", "a.ord"] {
        fs::write(at(name), name).unwrap();
    }
    fs::create_dir(at("folder.obj")).unwrap();
    symlink(at("a.obj"), at("link.obj")).unwrap();
    symlink("/nowhere", at("broken.obj")).unwrap();
    mkfifoat(CWD, at("pipe.obj"), Mode::RUSR).unwrap();
    let _socket = UnixListener::bind(at("socket.obj")).unwrap();
    fs::hard_link(at("a.obj"), at("hard.obj")).unwrap();
    let found = looked(dir.path(), &config());
    assert_eq!(names(dir.path(), &found), ["B.OBJ", "a.obj", "hard.obj"]);
    assert_eq!(found.scans[&at("a.obj")].companions[0].path, at("a.ord"));
    assert_eq!(found.scans[&at("a.obj")].stamp, found.scans[&at("hard.obj")].stamp);
    let ignored =
        |name: &str| found.ignored.get(&at(name)).map_or("", |of| of.why.words(Language::En));
    for (name, why) in [
        ("folder.obj", "is a folder"),
        ("link.obj", "is a link"),
        ("broken.obj", "is a link"),
        ("pipe.obj", "is a pipe"),
        ("socket.obj", "is a socket"),
        ("notes.pdf", "does not have the ending of a scan"),
    ] {
        assert!(ignored(name).starts_with(why), "{name}: {}", ignored(name));
    }
    assert_eq!((found.passed_over.values().sum::<usize>(), found.ignored.len()), (6, 6));
    assert_eq!(found.passed_over[&PassedOver::Link], 2);
}

#[test]
fn a_missing_folder_is_no_empty_folder() {
    assert!(look(Path::new("/nowhere/at/all"), &config(), &StepCounter::default()).is_err());
}

#[test]
fn sub_folders_are_looked_through_by_choice_to_a_depth_and_never_through_links() {
    let dir = tempfile::tempdir().unwrap();
    let deepest = dir.path().join("1/2/3/4");
    fs::create_dir_all(deepest.join("5")).unwrap();
    fs::create_dir(dir.path().join(".hidden")).unwrap();
    let outside = tempfile::tempdir().unwrap();
    symlink(outside.path(), dir.path().join("link")).unwrap();
    symlink(dir.path(), dir.path().join("1/loop")).unwrap();
    let places = ["a.obj", "1/b.obj", "1/2/3/4/c.obj", "1/2/3/4/5/d.obj", ".hidden/e.obj"];
    for path in
        places.map(|name| dir.path().join(name)).iter().chain([&outside.path().join("f.obj")])
    {
        fs::write(path, "x").unwrap();
    }
    assert_eq!(names(dir.path(), &looked(dir.path(), &config())), ["a.obj"]);
    let found = looked(dir.path(), &WatchConfig { subfolders: true, ..config() });
    assert_eq!(names(dir.path(), &found), ["1/2/3/4/c.obj", "1/b.obj", "a.obj"]);
    assert_eq!(found.ignored[&deepest.join("5")].why, PassedOver::TooDeep);
    assert_eq!(found.ignored[&dir.path().join("link")].why, PassedOver::Link);
}

#[test]
fn a_look_tells_through_which_folders_it_went_and_when_they_came_to_their_places() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    fs::create_dir_all(at("1/2")).unwrap();
    assert!(looked(dir.path(), &config()).folders.below.is_empty());
    let config = WatchConfig { subfolders: true, ..config() };
    let before = looked(dir.path(), &config).folders;
    assert_eq!(before.export, folder_id(dir.path()).unwrap());
    assert_eq!(before.below.keys().collect::<Vec<_>>(), [&at("1"), &at("1/2")]);
    write_after(&at("clock"), before.below[&at("1")].ctime_ns);
    fs::rename(at("1"), at("new")).unwrap();
    let after = looked(dir.path(), &config).folders;
    let (old, new) = (before.below[&at("1")], after.below[&at("new")]);
    assert_eq!((old.ino, old.mtime_ns), (new.ino, new.mtime_ns));
    assert!(old.ctime_ns < new.ctime_ns);
    assert_eq!(before.below[&at("1/2")], after.below[&at("new/2")]);
}

#[test]
fn a_scan_s_done_file_is_found_and_counts_as_nothing_else() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    for name in ["a.obj", "a.obj.done", "b.obj", "c.obj"] {
        fs::write(at(name), name).unwrap();
    }
    fs::create_dir(at("c.obj.done")).unwrap();
    let config = WatchConfig { done_file: DoneFile::new("{name}.done"), ..config() };
    let found = looked(dir.path(), &config);
    assert!(matches!(found.scans[&at("a.obj")].done, Done::There(_)));
    assert_eq!(found.scans[&at("b.obj")].done, Done::Missing);
    assert_eq!(found.scans[&at("c.obj")].done, Done::Missing, "a folder says nothing");
    assert_eq!(found.ignored.keys().collect::<Vec<_>>(), [&at("c.obj.done")]);
}

#[test]
fn a_look_tells_whether_the_marker_is_missing() {
    let dir = tempfile::tempdir().unwrap();
    assert!(!looked(dir.path(), &config()).mount.lacks_marker);
    let config = WatchConfig { marker: Some(".here".into()), ..config() };
    assert!(looked(dir.path(), &config).mount.lacks_marker);
    fs::write(dir.path().join(".here"), "").unwrap();
    assert!(!looked(dir.path(), &config).mount.lacks_marker);
}

#[test]
fn of_many_files_that_are_no_scans_those_that_changed_last_are_followed() {
    let dir = tempfile::tempdir().unwrap();
    let old = fs::FileTimes::new().set_modified(std::time::UNIX_EPOCH);
    for n in 0..2 * UNRELATED_MAX {
        let file = fs::File::create(dir.path().join(format!("{n}.jpg"))).unwrap();
        file.set_times(old).unwrap();
    }
    // Before that, the newest is not known.
    let ctime_ns = |n| changed_ns(&dir.path().join(format!("{n}.jpg")));
    write_after(&dir.path().join("now.tmp"), (0..2 * UNRELATED_MAX).map(ctime_ns).max().unwrap());
    let found = looked(dir.path(), &config());
    assert_eq!(found.unrelated.len(), UNRELATED_MAX);
    assert!(found.unrelated.contains_key(&dir.path().join("now.tmp")));
}
