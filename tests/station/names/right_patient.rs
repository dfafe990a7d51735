//! No scan lies under a wrong name, however files, presses, names, refusals and a failing journal cross
//! each other: the real program, with a button on a pseudo-terminal where one is in it.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::time::{Duration, SystemTime};

use rig::booth::{At, Room};
use rig::{Daemon, sha256};
use support::coarse_body;

/// The patient's folder in the store holds exactly these scans.
#[track_caller]
fn assert_has(room: &Room, patient: &str, scans: &[&[u8]]) {
    let mut expected: Vec<String> = scans.iter().map(|scan| sha256(scan)).collect();
    expected.sort();
    let records = room.booth.records();
    let mut found: Vec<String> =
        records.into_iter().filter(|(id, _)| id == patient).map(|(_, scan)| scan).collect();
    found.sort();
    assert_eq!(found, expected, "{patient}; log:\n{}", room.booth.log());
}

#[test]
fn a_name_that_is_used_again_before_its_first_export_was_taken_gives_no_body_to_the_first_patient()
{
    let mut room = Room::with_button("");
    room.set_short_wait("60s");
    let station = room.start();
    let (first, second) = (coarse_body(1), coarse_body(2));
    room.name("1002");
    room.press();
    // It breaks off, and its rest is awaited.
    room.write("scan.obj", &first[..first.len() / 2]);
    room.wait_until_waiting("scan.obj", "more for the rest");
    room.name("1003");
    room.press();
    room.write("scan.obj", &second);
    room.wait_for_taken(&second);
    assert_has(&room, "1002", &[]);
    // Both captures are open: a person decides.
    let held = room.held();
    assert!(held.iter().all(|code| code == "capture-ambiguous"), "{held:?}");
    assert!(station.stop().success());
}

#[test]
fn a_name_that_is_used_again_while_the_station_is_paused_gives_no_body_to_the_first_patient() {
    let mut room = Room::with_button("");
    let station = room.start();
    let (first, second) = (coarse_body(1), coarse_body(2));
    room.name("1002");
    room.press();
    room.said(&["pause"]);
    room.write("scan.obj", &first);
    room.wait_for_look();
    room.name("1003");
    room.press();
    room.write("scan.obj", &second);
    room.wait_for_look();
    room.said(&["resume"]);
    room.wait_for_taken(&second);
    assert_has(&room, "1002", &[]);
    assert!(station.stop().success());
}

#[test]
fn a_refused_half_that_is_finished_after_the_next_press_is_not_the_next_patients() {
    let mut room = Room::with_button("");
    let station = room.start();
    let (first, second) = (coarse_body(1), coarse_body(2));
    room.name("1002");
    room.press();
    room.write("scan.obj", &first[..first.len() / 2]);
    room.wait_for_refusals(1);
    room.name("1003");
    room.press();
    let mut file = File::options().append(true).open(room.export("scan.obj")).unwrap();
    file.write_all(&first[first.len() / 2..]).unwrap();
    drop(file);
    room.wait_for_taken(&first);
    room.write("other.obj", &second);
    room.wait_for_taken(&second);
    room.wait_until_at_rest();
    for record in room.booth.records() {
        let owner = if record.1 == sha256(&first) { "1002" } else { "1003" };
        assert_eq!(record.0, owner);
    }
    assert!(station.stop().success());
}

#[test]
fn a_refused_half_that_is_renamed_or_exported_again_whole_is_not_the_next_patients() {
    for renamed in [true, false] {
        let mut room = Room::with_button("");
        let station = room.start();
        let first = coarse_body(1);
        room.name("1002");
        room.press();
        room.write("scan.obj", &first[..first.len() / 2]);
        room.wait_for_refusals(1);
        room.name("1003");
        room.press();
        match renamed {
            true => fs::rename(room.export("scan.obj"), room.export("again.obj")).unwrap(),
            false => room.write("again.obj", &first),
        }
        let taken = if renamed { &first[..first.len() / 2] } else { &first };
        room.wait_for_taken(taken);
        room.wait_for_look();
        assert_has(&room, "1003", &[]);
        if renamed {
            // The press of 1003 is not used up.
            let second = coarse_body(2);
            room.write("second.obj", &second);
            room.wait_for_taken(&second);
            room.wait_until_at_rest();
            assert_has(&room, "1002", &[]);
        }
        assert!(station.stop().success());
    }
}

#[test]
fn a_refused_export_leaves_its_press_to_the_one_that_is_made_again() {
    let mut room = Room::with_button("");
    let station = room.start();
    let first = coarse_body(1);
    room.name("1002");
    room.press();
    room.write("scan.obj", &first[..first.len() / 2]);
    room.wait_for_refusals(1);
    room.booth
        .wait_for("its press again", || room.booth.log().contains("event=\"capture-reopened\""));
    room.write("again.obj", &coarse_body(7));
    room.booth.wait_for_records(1);
    assert_has(&room, "1002", &[&coarse_body(7)]);
    assert!(station.stop().success());
}

#[test]
fn a_changed_mode_a_link_and_a_new_name_of_an_old_export_use_up_no_press() {
    let mut room = Room::with_button("");
    let station = room.start();
    let (old, new) = (coarse_body(1), coarse_body(2));
    room.write("old.obj", &old);
    room.booth.wait_for_records(1);
    room.name("1002");
    room.press();
    fs::set_permissions(room.export("old.obj"), fs::Permissions::from_mode(0o640)).unwrap();
    fs::hard_link(room.export("old.obj"), room.export("linked.obj")).unwrap();
    fs::rename(room.export("old.obj"), room.export("renamed.obj")).unwrap();
    // And exported again with another comment.
    let again = [old.as_slice(), b"# 22.11.2026 09:15\n"].concat();
    room.write("again.obj", &again);
    room.wait_for_known(3);
    room.write("new.obj", &new);
    room.booth.wait_for_records(2);
    assert_has(&room, "1002", &[&new]);
    assert_eq!(room.held(), [""; 0]);
    assert!(station.stop().success());
}

#[test]
fn bodies_with_the_same_faces_are_scans_of_their_own_and_one_written_otherwise_is_known() {
    let mut room = Room::with_button("");
    let station = room.start();
    let body = |n| String::from_utf8(coarse_body(n)).unwrap();
    let tabbed = |n| body(n).replace("\nv ", "\n\tv ");
    for (n, patient) in (1..).zip(["1002", "1003", "1004"]) {
        room.name(patient);
        room.press();
        room.write(&format!("{n}.obj"), tabbed(n).as_bytes());
        room.booth.wait_for_records(n);
        assert_has(&room, patient, &[tabbed(n).as_bytes()]);
    }
    room.name("1005");
    room.press();
    let again = body(1).replace("\nv ", "\nv   ").replace('\n', "\r\n") + "# 22.11.2026 09:15\r\n";
    room.write("again.obj", again.as_bytes());
    room.wait_for_known(1);
    room.booth.wait_for("the light", || room.status()["booth"]["light"] == "attention");
    let scan = &sha256(tabbed(1).as_bytes())[..8];
    room.wait_until_waiting("again.obj", &format!("the points and triangles of scan {scan}"));
    room.write("new.obj", body(4).as_bytes());
    room.booth.wait_for_records(4);
    assert_has(&room, "1005", &[body(4).as_bytes()]);
    assert_eq!(room.held(), [""; 0]);
    assert!(station.stop().success());
}

#[test]
fn a_second_format_of_a_scan_answers_no_press() {
    let mut room = Room::with_button("");
    let station = room.start();
    // Its triangles in STL, corner by corner.
    let stl = {
        let body = String::from_utf8(coarse_body(1)).unwrap();
        let numbers = |line: &str| -> Vec<f32> {
            let words = line.split_whitespace().map(|word| word.split('/').next().unwrap());
            words.map(|word| word.parse().unwrap()).collect()
        };
        let of = |key| body.lines().filter_map(move |line| line.strip_prefix(key)).map(numbers);
        let (points, faces): (Vec<_>, Vec<_>) = (of("v ").collect(), of("f ").collect());
        let mut stl = vec![b' '; 80];
        stl.extend(u32::try_from(faces.len()).unwrap().to_le_bytes());
        for face in faces {
            let corners = face.iter().flat_map(|corner| &points[*corner as usize - 1]);
            let numbers = [0.0; 3].iter().chain(corners).copied();
            stl.extend(numbers.flat_map(f32::to_le_bytes));
            stl.extend([0; 2]);
        }
        stl
    };
    room.name("1002");
    room.press();
    room.write("a.obj", &coarse_body(1));
    room.booth.wait_for_records(1);
    room.name("1003");
    room.press();
    room.write("a.stl", &stl);
    room.wait_for_taken(&stl);
    room.write("b.obj", &coarse_body(2));
    room.booth.wait_for_records(3);
    assert_has(&room, "1002", &[&coarse_body(1)]);
    assert_has(&room, "1003", &[&coarse_body(2)]);
    assert_eq!(room.held(), [""; 0]);
    assert!(station.stop().success());
}

/// Three patients, each ordered after the press; `until` waits for what becomes of each scan.
fn ordered_after_the_press(orders: &str, until: impl Fn(&Room, usize)) -> (Room, Daemon) {
    let mut room = Room::with_button(&At::orders(orders));
    let station = room.start();
    for n in 1..4 {
        room.press();
        room.order(&format!("100{n}"));
        room.write(&format!("{n}.obj"), &coarse_body(n));
        until(&room, n);
    }
    (room, station)
}

#[test]
fn orders_that_come_after_the_press_name_nobody_else() {
    let until = |room: &Room, n| room.wait_for_taken(&coarse_body(n));
    let (room, station) = ordered_after_the_press("before-press", until);
    room.wait_until_at_rest();
    assert_eq!(room.booth.records(), []);
    assert_eq!(room.held(), ["capture-ambiguous"; 3]);
    assert!(station.stop().success());
}

#[test]
fn where_the_practice_orders_after_the_press_each_order_is_the_open_presss() {
    let until = |room: &Room, n| room.booth.wait_for_records(n);
    let (room, station) = ordered_after_the_press("after-press", until);
    for n in 1..4 {
        assert_has(&room, &format!("100{n}"), &[&coarse_body(n)]);
    }
    assert!(station.stop().success());
}

#[test]
fn a_malformed_order_or_a_misread_card_disarms_the_name_that_waits() {
    let mut room = Room::with_button(&At::orders("before-press"));
    let station = room.start();
    room.order("1002");
    room.malformed_order();
    room.press();
    room.write("a.obj", &coarse_body(1));
    room.wait_for_taken(&coarse_body(1));
    assert_eq!(room.held(), ["name-unread"]);
    assert_eq!(room.booth.records(), []);
    assert!(station.stop().success());
}

#[test]
fn a_scan_whose_entry_fails_at_the_journal_answers_its_press_all_the_same() {
    for killed in [false, true] {
        let mut room = Room::with_button("");
        // The journal is locked for longer than the window.
        room.booth.reconfigure(|config| config.replace("late = \"0s\"", "late = \"20s\""));
        let station = room.start();
        let (first, second) = (coarse_body(1), coarse_body(2));
        room.name("1002");
        room.press();
        let lock = room.lock_journal();
        room.write("a.obj", &first);
        room.wait_for_spooled(&first);
        let failures = || room.booth.log().matches("intake-failed").count();
        let before = failures();
        let station = if killed {
            station.kill();
            drop(lock);
            room.start()
        } else {
            // The lock outlasts the time for which the station waits for it.
            room.booth.wait_for("its failure", || failures() > before);
            drop(lock);
            station
        };
        room.booth.wait_for_records(1);
        assert_has(&room, "1002", &[&first]);
        room.write("b.obj", &second);
        room.wait_for_taken(&second);
        room.wait_until_at_rest();
        assert_has(&room, "1002", &[&first]);
        assert!(station.stop().success());
    }
}

#[test]
fn a_name_that_the_journal_could_not_keep_names_nobody() {
    let mut room = Room::with_button("");
    let station = room.start();
    let lock = room.lock_journal();
    let (code, said) = room.try_name("1002");
    assert_eq!(code, Some(74), "{said}");
    drop(lock);
    assert!(room.said(&["patient", "show"]).contains("No patient is named"));
    room.press();
    room.write("a.obj", &coarse_body(1));
    room.booth.wait_for_records(1);
    assert_has(&room, "_unassigned", &[&coarse_body(1)]);
    assert!(station.stop().success());
}

#[test]
fn a_wrong_name_is_replaced_by_the_next_word_with_and_without_a_button() {
    for mut room in [Room::with_button(""), Room::without_button("")] {
        let station = room.start();
        room.name("111");
        room.name("222");
        room.press();
        room.write("a.obj", &coarse_body(1));
        room.booth.wait_for_records(1);
        assert_has(&room, "222", &[&coarse_body(1)]);
        assert!(station.stop().success());
    }
}

#[test]
fn a_temporary_name_keeps_the_history_of_what_is_written_under_it() {
    let mut room = Room::with_button("");
    let station = room.start();
    let (first, second) = (coarse_body(1), coarse_body(2));
    room.name("1002");
    room.press();
    room.write(".scan.obj.tmp", &first[..first.len() / 2]);
    room.wait_for_look();
    room.name("1003");
    room.press();
    let mut file = File::options().append(true).open(room.export(".scan.obj.tmp")).unwrap();
    file.write_all(&first[first.len() / 2..]).unwrap();
    fs::rename(room.export(".scan.obj.tmp"), room.export("scan.obj")).unwrap();
    room.booth.wait_for_records(1);
    assert_has(&room, "1002", &[&first]);
    // The second press was made before the first one's scan was there whole.
    room.write("second.obj", &second);
    room.wait_for_taken(&second);
    assert_eq!(room.held(), ["capture-ambiguous"]);
    assert!(station.stop().success());
}

#[test]
fn what_is_moved_in_from_elsewhere_with_an_older_content_is_held_and_so_is_what_comes_after_it() {
    let mut room = Room::with_button("");
    let station = room.start();
    let old = room.booth.path("old.obj");
    fs::write(&old, coarse_body(1)).unwrap();
    set_back(&old);
    room.name("1002");
    room.press();
    fs::rename(&old, room.export("scan.obj")).unwrap();
    room.wait_for_taken(&coarse_body(1));
    assert_eq!(room.held(), ["capture-unclear"]);
    room.write("real.obj", &coarse_body(2));
    room.wait_for_taken(&coarse_body(2));
    assert_eq!(room.held().len(), 2);
    assert_eq!(room.booth.records(), []);
    assert!(station.stop().success());
}

/// A file was last written an hour ago, as its time says.
fn set_back(file: &Path) {
    let an_hour_ago = SystemTime::now() - Duration::from_secs(3600);
    File::options().write(true).open(file).unwrap().set_modified(an_hour_ago).unwrap();
}

/// The only scan is held, and nobody's record holds it.
#[track_caller]
fn assert_unclear(room: &Room, scan: &[u8]) {
    room.wait_for_taken(scan);
    assert_eq!(room.held(), ["capture-unclear"], "{}", room.booth.log());
    assert_has(room, "1002", &[]);
}

#[test]
fn what_is_moved_in_with_its_folder_is_held_although_its_own_times_stay() {
    let mut room = Room::with_button("");
    let subfolders = "[scanner]\nsubfolders = true\n";
    room.booth.reconfigure(|config| config.replace("[scanner]\n", subfolders));
    let folder = room.booth.path("elsewhere");
    fs::create_dir(&folder).unwrap();
    // Until the station hears every press, more time passes than may lie between two times of a file.
    fs::write(folder.join("scan.obj"), coarse_body(1)).unwrap();
    let station = room.start();
    room.name("1002");
    room.press();
    fs::rename(&folder, room.export("day")).unwrap();
    assert_unclear(&room, &coarse_body(1));
    assert!(station.stop().success());
}

#[test]
fn what_lies_in_a_folder_that_takes_the_place_of_the_export_folder_is_held() {
    for by_link in [true, false] {
        let mut room = Room::with_button("");
        let [export, ours, other, link] =
            ["export", "ours", "other", "link"].map(|name| room.booth.path(name));
        fs::create_dir(&other).unwrap();
        fs::write(other.join("scan.obj"), coarse_body(1)).unwrap();
        if by_link {
            fs::rename(&export, &ours).unwrap();
            symlink(&ours, &export).unwrap();
            symlink(&other, &link).unwrap();
        }
        let station = room.start();
        room.name("1002");
        room.press();
        if by_link {
            fs::rename(&link, &export).unwrap();
        } else {
            fs::rename(&export, &ours).unwrap();
            fs::rename(&other, &export).unwrap();
        }
        assert_unclear(&room, &coarse_body(1));
        assert!(station.stop().success());
    }
}

/// Copies a scan as `cp -p` and others do, so slowly that looks come in between: the content first, in
/// place where there is a file, and the time of the source last.
fn copy_slowly(room: &Room, name: &str, scan: &[u8]) {
    room.said(&["pause"]);
    for part in [0, scan.len() / 2, scan.len()] {
        room.write(name, &scan[..part]);
        room.wait_for_look();
    }
    set_back(&room.export(name));
    room.wait_for_look();
    room.said(&["resume"]);
}

#[test]
fn what_is_copied_slowly_and_gets_the_time_of_its_source_last_is_held() {
    let mut room = Room::with_button("");
    let station = room.start();
    room.name("1002");
    room.press();
    copy_slowly(&room, "scan.obj", &coarse_body(1));
    assert_unclear(&room, &coarse_body(1));
    assert!(station.stop().success());
}

#[test]
fn so_is_what_is_copied_in_place_over_an_older_name_smaller_or_larger() {
    let larger = |body: Vec<u8>| [body, b"# a comment of the scanner\n".repeat(1000)].concat();
    for (there, copied) in
        [(larger(coarse_body(2)), coarse_body(1)), (coarse_body(2), larger(coarse_body(1)))]
    {
        let mut room = Room::with_button("");
        let station = room.start();
        room.write("scan.obj", &there);
        room.booth.wait_for_records(1);
        room.name("1002");
        room.press();
        copy_slowly(&room, "scan.obj", &copied);
        assert_unclear(&room, &copied);
        assert!(station.stop().success());
    }
}

#[test]
fn a_file_that_came_while_the_station_was_away_answers_no_press_since_its_last_look() {
    let mut room = Room::with_button("");
    let station = room.start();
    room.name("1002");
    room.press();
    station.kill();
    room.write("a.obj", &coarse_body(1));
    let station = room.start();
    room.wait_for_taken(&coarse_body(1));
    // Presses may have gone unheard meanwhile.
    assert_eq!(room.held().len(), 1);
    assert_eq!(room.booth.records(), []);
    assert!(station.stop().success());
}

#[test]
fn an_export_awaited_when_the_machine_starts_anew_is_not_the_next_patients() {
    let mut room = Room::without_button(&At::orders("before-press"));
    let station = room.start();
    room.order("1002");
    assert!(station.stop().success());
    room.begin_another_start_of_the_machine();
    let station = room.start();
    room.order("1003");
    room.wait_for_look();
    room.write("a.obj", &coarse_body(1));
    room.wait_for_taken(&coarse_body(1));
    assert_eq!(room.held(), ["capture-ambiguous"]);
    assert!(station.stop().success());
}

/// Her export is seen while the station is paused; what becomes of it then, and nobody's comes.
fn lost_while_paused(mut room: Room, lose: impl Fn(&Room)) {
    let station = room.start();
    room.name("1002");
    room.press();
    room.said(&["pause"]);
    room.write("scan.obj", &coarse_body(1));
    room.wait_until_waiting("scan.obj", "paused");
    room.wait_for_look();
    lose(&room);
    room.wait_for_look();
    room.said(&["resume"]);
    room.wait_for_taken(&coarse_body(2));
    assert_eq!(room.held(), ["capture-ambiguous"], "log:\n{}", room.booth.log());
    assert_has(&room, "1002", &[]);
    assert_eq!(room.booth.log().matches("event=\"export-gone\"").count(), 1);
    let status = room.status();
    assert_eq!(status["complaints"][0]["code"], "export-gone");
    assert_eq!(status["sources"][0]["gone"], 1);
    room.said(&["patient", "clear"]);
    assert_eq!(room.status()["ready"], true);
    assert!(station.stop().success());
}

#[test]
fn an_export_that_is_overwritten_while_the_station_is_paused_is_told_and_the_next_is_held() {
    for room in [Room::with_button(""), Room::without_button("")] {
        lost_while_paused(room, |room| room.write("scan.obj", &coarse_body(2)));
    }
}

#[test]
fn an_export_that_is_deleted_while_the_station_is_paused_is_told_and_the_next_is_held() {
    for room in [Room::with_button(""), Room::without_button("")] {
        lost_while_paused(room, |room| {
            fs::remove_file(room.export("scan.obj")).unwrap();
            room.wait_for_look();
            room.write("other.obj", &coarse_body(2));
        });
    }
}

#[test]
fn what_comes_and_is_not_read_while_an_export_is_awaited_raises_an_alarm() {
    let mut room = Room::without_button("");
    let before = room.export("before");
    fs::create_dir(&before).unwrap();
    let station = room.start();
    room.name("1002");
    assert_eq!(room.status()["ready"], true);
    fs::create_dir(room.export("day")).unwrap();
    room.write("day/scan.obj", &coarse_body(1));
    room.write("scan.obj.gz", b"packed");
    let alarm = |room: &Room| room.status()["alarms"]["export-passed-over"]["message"].clone();
    room.booth.wait_for("the alarm", || {
        alarm(&room).as_str().is_some_and(|said| said.ends_with(": sub-folders 1, packed files 1"))
    });
    assert_eq!(room.status()["sources"][0]["unread"]["sub_folder"], 2);
    room.wait_until_waiting("day/scan.obj", "is in a sub-folder, and scanner.subfolders is false");
    room.wait_until_waiting("scan.obj.gz", "is packed");
    room.said(&["patient", "clear"]);
    room.booth.wait_for("its end", || alarm(&room).is_null());
    assert!(station.stop().success());
}
