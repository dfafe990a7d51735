//! Refused orders lie where a person finds them, whole and with the reason.

use std::fs::{self, File, FileTimes};
use std::path::Path;
use std::time::SystemTime;

use gaiter_flow::Mask;

use crate::station::booth::orders::*;
use crate::station::share::stamped_file::stamp;

#[test]
fn a_refused_order_is_kept_once_with_its_bytes_and_reason() {
    let dir = tempfile::tempdir().unwrap();
    let order = b"01380006302\r\nM\xfcller\r\n";
    for _ in 0..2 {
        aside::keep(dir.path(), order, "order-line-malformed", "line 2 …").unwrap();
    }
    aside::keep(dir.path(), b"", "order-empty", "it is empty").unwrap();
    let folder = dir.path().join("orders-refused");
    let kept: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(kept.len(), 2, "{kept:?}");
    let whole = kept.iter().find(|place| fs::read(place.join("order.gdt")).unwrap() == order);
    let reason = fs::read_to_string(whole.unwrap().join("reason.json")).unwrap();
    let reason: serde_json::Value = serde_json::from_str(&reason).unwrap();
    assert_eq!(reason["code"], "order-line-malformed");
    assert_eq!(reason["schema"], "gaiter.order-refused/1");
}

#[test]
fn half_a_kept_order_does_not_hinder_the_next_attempt() {
    let dir = tempfile::tempdir().unwrap();
    aside::keep(dir.path(), b"x", "order-not-gdt", "").unwrap();
    let folder = dir.path().join("orders-refused");
    let place = fs::read_dir(&folder).unwrap().next().unwrap().unwrap().path();
    let staged = folder.join(format!(".{}", place.file_name().unwrap().to_str().unwrap()));
    fs::rename(&place, &staged).unwrap();
    fs::remove_file(staged.join("reason.json")).unwrap();
    aside::keep(dir.path(), b"x", "order-not-gdt", "").unwrap();
    assert!(place.join("reason.json").exists() && !staged.exists());
}

fn read(path: &Path) -> read::Read {
    let stamp = stamp(&path.symlink_metadata().unwrap());
    read::read(path, stamp, &StepCounter::default()).unwrap().unwrap()
}

fn remove(path: &Path, read: &read::Read, between: impl FnOnce()) {
    removal::remove_in_steps(path, read, &StepCounter::default(), between).unwrap();
}

/// A file written again at a time of its own, as another program does that makes it beside and renames.
fn put(path: &Path, text: &str, seconds: u64) {
    let new = path.with_extension("new");
    fs::write(&new, text).unwrap();
    let at = SystemTime::UNIX_EPOCH + Duration::from_secs(1_800_000_000 + seconds);
    File::options()
        .write(true)
        .open(&new)
        .unwrap()
        .set_times(FileTimes::new().set_modified(at))
        .unwrap();
    fs::rename(new, path).unwrap();
}

fn names(folder: &Path) -> Vec<String> {
    let mask = Mask::new("*.gdt").unwrap();
    let found = list_orders::look(folder, &mask, &StepCounter::default()).unwrap();
    let name = |path: &PathBuf| path.file_name().unwrap().to_str().unwrap().to_owned();
    found.orders.keys().map(name).collect()
}

#[test]
fn an_order_that_was_read_is_removed_whatever_was_done_to_its_mode_or_time() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.gdt");
    put(&path, "old", 0);
    let old = read(&path);
    let touched = FileTimes::new().set_modified(SystemTime::now());
    File::options().write(true).open(&path).unwrap().set_times(touched).unwrap();
    remove(&path, &old, || ());
    assert_eq!(names(dir.path()), [""; 0]);
    // Somebody else may remove it.
    remove(&path, &old, || ());
}

#[test]
fn what_came_in_the_place_of_an_order_that_was_read_is_not_removed() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.gdt");
    // With other words, and with the same ones.
    for new in ["newer", "old"] {
        put(&path, "old", 0);
        let old = read(&path);
        put(&path, new, 1);
        remove(&path, &old, || ());
        assert_eq!((fs::read_to_string(&path).unwrap(), names(dir.path()).len()), (new.into(), 1));
    }
}

#[test]
fn what_comes_while_an_order_is_removed_lies_there_after_it() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.gdt");
    put(&path, "old", 0);
    let old = read(&path);
    remove(&path, &old, || put(&path, "new", 1));
    assert_eq!((fs::read_to_string(&path).unwrap(), names(dir.path()).len()), ("new".into(), 1));
}

#[test]
fn of_two_that_come_while_an_order_is_removed_neither_is_lost() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.gdt");
    put(&path, "old", 0);
    let old = read(&path);
    put(&path, "second", 1);
    remove(&path, &old, || put(&path, "third", 2));
    assert_eq!(fs::read_to_string(&path).unwrap(), "third");
    let taken = removal::hidden(&path);
    assert_eq!(fs::read_to_string(&taken).unwrap(), "second");
    // The next look finds both, and the one that is hidden goes back once its name is free.
    assert_eq!(names(dir.path()), [".a.gdt.gaiter-taken", "a.gdt"]);
    assert_eq!(removal::original(&taken), Some(path.clone()));
    assert!(removal::put_back(&taken, &path).is_err(), "never over another");
    assert!(removal::remove_in_steps(&path, &old, &StepCounter::default(), || ()).is_err());
    fs::remove_file(&path).unwrap();
    removal::put_back(&taken, &path).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "second");
}

#[test]
fn only_names_that_the_mask_means_are_taken_up() {
    let dir = tempfile::tempdir().unwrap();
    for name in [".b.txt.gaiter-taken", "..gaiter-taken", ".gaiter-taken", ".a.gdt", "A.GDT"] {
        fs::write(dir.path().join(name), name).unwrap();
    }
    assert_eq!(names(dir.path()), ["A.GDT"]);
}

#[test]
fn an_order_that_could_not_be_heard_is_remembered_with_what_was_known_until_it_is_or_is_gone() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.gdt");
    put(&path, "x", 0);
    let quiet = Duration::from_secs(1);
    let settling = Settling::new(quiet, quiet, quiet);
    let mut orders = Orders::new(settling);
    let look = || {
        let found =
            list_orders::look(dir.path(), &Mask::new("*.gdt").unwrap(), &StepCounter::default());
        Look::Seen(found.unwrap().orders)
    };
    let at = |seconds| {
        let at = Duration::from_secs(seconds);
        LookTime { began: at, ended: at }
    };
    assert_eq!(orders.due(look(), at(0)), []);
    let settled = orders.due(look(), at(1)).remove(0);
    let known = Some(read(&path).state);
    orders.taken(&settled, Ok(Taken::Unheard(known.clone())), at(1).ended);
    assert_eq!(orders.unapplied.get(&path), Some(&Before::Noted(known)));
    let again = orders.due(look(), at(900)).remove(0);
    orders.taken(&again, Ok(Taken::Unheard(None)), at(900).ended);
    assert_eq!(orders.unapplied.get(&path), Some(&Before::Noted(None)));
    orders.taken(&again, Ok(Taken::Done), at(900).ended);
    assert_eq!((orders.unapplied.len(), orders.due(look(), at(9000)).len()), (0, 0));
    orders.taken(&again, Ok(Taken::Unheard(None)), at(9000).ended);
    orders.unapplied.clear();
    let fault = TakeFault::Io { what: "reading an order", source: io::Error::other("locked") };
    orders.taken(&again, Err(fault), at(9000).ended);
    assert_eq!(orders.unapplied.get(&path), Some(&Before::Unnoted), "it is late when it is read");
    fs::remove_file(&path).unwrap();
    orders.due(look(), at(9001));
    assert_eq!(orders.unapplied.len(), 0);
}

#[test]
fn an_order_was_absent_at_the_last_look_before_it_came_until_another_comes_in_its_place() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.gdt");
    let quiet = Duration::from_secs(2);
    let mut orders = Orders::new(Settling::new(quiet, quiet, quiet));
    let look = |orders: &mut Orders, seconds: u64| {
        let found =
            list_orders::look(dir.path(), &Mask::new("*.gdt").unwrap(), &StepCounter::default());
        let at = Duration::from_secs(seconds);
        orders.due(Look::Seen(found.unwrap().orders), LookTime { began: at, ended: at })
    };
    let second = |seconds| Some(Duration::from_secs(seconds));
    put(&path, "there before the first look", 0);
    look(&mut orders, 1);
    assert_eq!(orders.absent(&path), None);
    fs::remove_file(&path).unwrap();
    look(&mut orders, 2);
    put(&path, "half", 1);
    look(&mut orders, 3);
    put(&path, "whole", 2);
    // A folder out of reach was not seen to be empty.
    let away = LookTime { began: Duration::from_secs(4), ended: Duration::from_secs(4) };
    assert_eq!(orders.due(Look::OutOfReach, away), []);
    look(&mut orders, 5);
    assert_eq!(orders.absent(&path), second(2), "it grew, and may name somebody since it came");
    let settled = look(&mut orders, 8).remove(0);
    orders.taken(&settled, Ok(Taken::Done), Duration::from_secs(8));
    look(&mut orders, 9);
    assert_eq!(orders.absent(&path), second(2), "it is kept");
    put(&path, "for somebody else", 3);
    look(&mut orders, 10);
    assert_eq!(orders.absent(&path), second(9));
}
