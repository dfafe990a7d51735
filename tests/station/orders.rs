//! Orders of practice software on the running station: which file names a patient, and which does not.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs::{self, File, FileTimes, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use gaiter_record::gdt::{Charset, message};
use rig::{Booth, Daemon, PATIENCE};
use rusqlite::{Connection, TransactionBehavior};
use serde_json::Value;

/// A booth beside a practice that puts its orders into a folder; `after` says what becomes of them.
fn practice(after: &str) -> Booth {
    let booth = Booth::new();
    fs::create_dir(booth.path("orders")).unwrap();
    let orders = booth.path("orders");
    booth.reconfigure(|text| {
        format!(
            "{text}[patient.orders]\npath = \"{}\"\nquiet = \"100ms\"\n\
             after = \"{after}\"\n",
            orders.display()
        )
    });
    booth
}

fn order(id: &str) -> Vec<u8> {
    let fields = [(9206, "3"), (3000, id), (8402, "ALLG00")];
    message(6302, Charset::Cp1252, &fields.map(|(field, text)| (field, text.to_owned()))).unwrap()
}

/// Puts an order into its folder in one step: of a slow writer the station would hear half.
fn put(booth: &Booth, name: &str, bytes: &[u8]) -> PathBuf {
    put_at(booth, name, bytes, SystemTime::now())
}

/// The same with this time of its last change.
fn put_at(booth: &Booth, name: &str, bytes: &[u8], time: SystemTime) -> PathBuf {
    let (new, path) = (booth.path("new-order"), booth.path("orders").join(name));
    fs::write(&new, bytes).unwrap();
    set_time(&new, time);
    fs::rename(new, &path).unwrap();
    path
}

fn events(booth: &Booth, event: &str) -> usize {
    booth.log().matches(&format!("event=\"{event}\"")).count()
}

/// How often this patient was named without a question, as the journal's history has it.
fn named(booth: &Booth, id: &str) -> i64 {
    let query = format!(
        "SELECT count(*) FROM history WHERE event = 'named' AND detail LIKE '%\"{id}\"%'
         AND detail NOT LIKE '%question%'"
    );
    booth.journal(&query).unwrap_or(0)
}

/// How often it was a question whether this patient is next.
fn questions(booth: &Booth, id: &str) -> i64 {
    let query = format!(
        "SELECT count(*) FROM history WHERE event = 'named' AND detail LIKE '%\"{id}\"%'
         AND detail LIKE '%question%'"
    );
    booth.journal(&query).unwrap_or(0)
}

#[track_caller]
fn wait_until_named(booth: &Booth, id: &str, count: i64) {
    booth.wait_for(&format!("name {count} of {id}"), || named(booth, id) >= count);
    assert_eq!(named(booth, id), count, "{}", booth.log());
}

/// Orders for another patient, and waits until that is heard: whatever lay there before has been looked
/// at by then, for the older ones are dealt with first.
#[track_caller]
fn wait_for_another(booth: &Booth, id: &str) {
    put(booth, &format!("{id}.gdt"), &order(id));
    wait_until_named(booth, id, 1);
}

fn alarms(booth: &Booth) -> Value {
    let output = booth.gaiter(&["status", "--json"]);
    let status: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    status["alarms"].clone()
}

fn set_time(path: &Path, time: SystemTime) {
    let file = File::options().write(true).open(path).unwrap();
    file.set_times(FileTimes::new().set_modified(time)).unwrap();
}

fn names(booth: &Booth) -> Vec<String> {
    let entries = fs::read_dir(booth.path("orders")).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Starts the station and waits until it has heard the order of this patient.
#[track_caller]
fn start(booth: &Booth, id: &str) -> Daemon {
    let daemon = booth.start();
    wait_until_named(booth, id, 1);
    daemon
}

fn stop(daemon: Daemon) {
    assert_eq!(daemon.stop().code(), Some(0));
}

/// The journal, for what a test must do to it itself.
fn journal(booth: &Booth) -> Connection {
    let journal = Connection::open(booth.path("state/journal.db")).unwrap();
    journal.busy_timeout(PATIENCE).unwrap();
    journal
}

const KNOWN: &str = "SELECT count(*) FROM orders";

#[test]
fn mode_links_and_renaming_of_a_kept_order_name_nobody_again() {
    let booth = practice("keep");
    let kept = put(&booth, "a.gdt", &order("4711"));
    let daemon = start(&booth, "4711");
    fs::set_permissions(&kept, Permissions::from_mode(0o600)).unwrap();
    fs::hard_link(&kept, booth.path("backup")).unwrap();
    wait_for_another(&booth, "1");
    fs::hard_link(&kept, booth.path("orders/link.gdt")).unwrap();
    wait_for_another(&booth, "2");
    fs::rename(&kept, booth.path("orders/renamed.gdt")).unwrap();
    wait_for_another(&booth, "3");
    stop(daemon);
    // And while the station is off.
    for name in ["renamed.gdt", "link.gdt", "1.gdt"] {
        let path = booth.path("orders").join(name);
        fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
        fs::rename(&path, booth.path("away")).unwrap();
        fs::rename(booth.path("away"), &path).unwrap();
    }
    let daemon = booth.start();
    wait_for_another(&booth, "4");
    stop(daemon);
    for id in ["4711", "1", "2", "3", "4"] {
        assert_eq!(named(&booth, id), 1, "{id}");
    }
    assert_eq!(names(&booth), ["1.gdt", "2.gdt", "3.gdt", "4.gdt", "link.gdt", "renamed.gdt"]);
}

#[test]
fn the_same_words_at_another_time_are_a_question_until_the_next_good_order() {
    let booth = practice("keep");
    let kept = put(&booth, "a.gdt", &order("4711"));
    let daemon = start(&booth, "4711");
    let first = kept.symlink_metadata().unwrap().modified().unwrap();
    for (asked, time) in [(1, first + Duration::from_secs(1)), (2, first - Duration::from_secs(9))]
    {
        set_time(&kept, time);
        booth.wait_for("the question", || events(&booth, "order-repeated") == asked);
        booth.wait_for("the alarm", || alarms(&booth)["order-repeated"].is_object());
    }
    let said = alarms(&booth)["order-repeated"].to_string();
    assert!(said.contains("name the patient at the booth") && !said.contains("4711"), "{said}");
    // It is asked once.
    wait_for_another(&booth, "1");
    booth.wait_for("its end", || alarms(&booth)["order-repeated"].is_null());
    assert_eq!((events(&booth, "order-repeated"), named(&booth, "4711")), (2, 1));
    // Other words under the same name are an order.
    put(&booth, "a.gdt", &order("4712"));
    wait_until_named(&booth, "4712", 1);
    stop(daemon);
}

#[test]
fn an_order_that_was_gone_is_heard_again_with_the_same_words_and_time() {
    let booth = practice("keep");
    let kept = put(&booth, "a.gdt", &order("4711"));
    let time = kept.symlink_metadata().unwrap().modified().unwrap();
    let daemon = start(&booth, "4711");
    booth.wait_for_journal(KNOWN, 1);
    fs::remove_file(&kept).unwrap();
    booth.wait_for_journal(KNOWN, 0);
    put_at(&booth, "a.gdt", &order("4711"), time);
    wait_until_named(&booth, "4711", 2);
    stop(daemon);
    // Gone while the station was off, too.
    fs::remove_file(&kept).unwrap();
    let daemon = booth.start();
    booth.wait_for_journal(KNOWN, 0);
    put_at(&booth, "a.gdt", &order("4711"), time);
    wait_until_named(&booth, "4711", 3);
    stop(daemon);
}

#[test]
fn the_same_words_are_heard_again_after_each_deletion() {
    let booth = practice("delete");
    let daemon = booth.start();
    let time = SystemTime::now();
    for count in 1..=5 {
        put_at(&booth, "a.gdt", &order("4711"), time);
        wait_until_named(&booth, "4711", count);
        booth.wait_for("its deletion", || names(&booth).is_empty());
        booth.wait_for_journal(KNOWN, 0);
    }
    assert_eq!(events(&booth, "order-repeated"), 0);
    stop(daemon);
}

#[test]
fn the_bare_folder_of_a_share_makes_no_kept_order_new() {
    let booth = practice("keep");
    put(&booth, "a.gdt", &order("4711"));
    let daemon = start(&booth, "4711");
    let (orders, share) = (booth.path("orders"), booth.path("share"));
    fs::rename(&orders, &share).unwrap();
    booth.wait_for("its absence", || events(&booth, "orders-out-of-reach") == 1);
    fs::create_dir(&orders).unwrap();
    booth.wait_for("the bare folder", || events(&booth, "orders-in-reach") == 1);
    fs::remove_dir(&orders).unwrap();
    booth.wait_for("its absence", || events(&booth, "orders-out-of-reach") == 2);
    fs::rename(&share, &orders).unwrap();
    wait_for_another(&booth, "1");
    assert_eq!(named(&booth, "4711"), 1);
    stop(daemon);
}

#[test]
fn an_order_that_cannot_be_read_is_an_alarm_and_names_nobody() {
    let booth = practice("delete");
    let daemon = booth.start();
    let mut cut = order("4711");
    cut.truncate(cut.len() - 5);
    put(&booth, "a.gdt", &cut);
    booth.wait_for("the refusal", || events(&booth, "order-refused") == 1);
    booth.wait_for("the alarm", || alarms(&booth)["order-refused"].is_object());
    booth.wait_for("its removal", || names(&booth).is_empty());
    wait_for_another(&booth, "1");
    booth.wait_for("its end", || alarms(&booth)["order-refused"].is_null());
    assert_eq!((events(&booth, "order-refused"), named(&booth, "4711")), (1, 0));
    stop(daemon);
}

#[test]
fn an_order_that_cannot_be_noted_is_heard_once_when_the_journal_works_again() {
    let booth = practice("delete");
    let daemon = booth.start();
    booth.wait_for("the start", || events(&booth, "station-ready") == 1);
    let mut journal = journal(&booth);
    let lock = journal.transaction_with_behavior(TransactionBehavior::Immediate).unwrap();
    put(&booth, "a.gdt", &order("4711"));
    booth.wait_for("the failure", || events(&booth, "order-put-off") > 0);
    assert_eq!((events(&booth, "patient-named"), names(&booth)), (0, vec!["a.gdt".to_owned()]));
    drop(lock);
    // Whoever was named meanwhile was not heard, either: it is a question.
    booth.wait_for("the question", || questions(&booth, "4711") == 1);
    booth.wait_for("its removal", || names(&booth).is_empty());
    wait_for_another(&booth, "1");
    assert_eq!((named(&booth, "4711"), questions(&booth, "4711")), (0, 1));
    stop(daemon);
}

#[test]
fn what_a_crash_left_under_a_hidden_name_is_heard_unless_it_was() {
    let booth = practice("keep");
    let kept = put(&booth, "heard.gdt", &order("4711"));
    stop(start(&booth, "4711"));
    booth.reconfigure(|text| text.replace("after = \"keep\"", "after = \"delete\""));
    let taken = |name: &str| booth.path("orders").join(format!(".{name}.gaiter-taken"));
    // The last run ended between renaming and deleting: an order that was heard, one that had come in
    // its place, and one whose name is not free any more.
    fs::rename(&kept, taken("heard.gdt")).unwrap();
    fs::write(taken("came.gdt"), order("4712")).unwrap();
    fs::write(taken("both.gdt"), order("4713")).unwrap();
    put(&booth, "both.gdt", &order("4714"));
    let daemon = booth.start();
    booth.wait_for("their removal", || names(&booth).is_empty());
    wait_for_another(&booth, "1");
    booth.wait_for_journal(KNOWN, 0);
    stop(daemon);
    for id in ["4711", "4712", "4713", "4714"] {
        assert_eq!(named(&booth, id), 1, "{id}");
    }
}
