//! Floods and oddities in the export folder: more files than the kernel has events for, names and
//! things no scanner writes, files without end. Every file is accounted for and none keeps the
//! scans among them from their records.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::os::unix::net::UnixListener;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use rig::invariants::PutKind;
use rig::{Booth, Daemon, names, sha256};
use rustix::fs::{CWD, FileType, Mode};
use rustix::process::{Pid, Signal, kill_process};
use support::coarse_body;

/// What the kernel keeps of events that nobody has read yet; more overflow.
const QUEUE: &str = "/proc/sys/fs/inotify/max_queued_events";

/// Files of the flood; the kernel keeps 16 384 events where nobody changed that.
const FLOOD: usize = 20_000;

/// The station's process reads no event while this is done: the kernel's queue overflows.
fn while_asleep(daemon: &Daemon, work: impl FnOnce()) {
    let pid = Pid::from_raw(i32::try_from(daemon.id()).unwrap()).unwrap();
    kill_process(pid, Signal::STOP).unwrap();
    work();
    kill_process(pid, Signal::CONT).unwrap();
}

/// Exports `count` files at once: every 1000th a scan, every tenth garbage of its own, the others
/// a few kinds of garbage again and again. Gives the scans and the different kinds of garbage.
fn flood(booth: &Booth, count: usize) -> (Vec<Vec<u8>>, BTreeSet<Vec<u8>>) {
    let (mut scans, mut garbage) = (Vec::new(), BTreeSet::new());
    for n in 0..count {
        let bytes = match n {
            n if n % 1000 == 500 => coarse_body(n),
            n if n % 10 == 0 => format!("garbage {n}\n").into_bytes(),
            n => format!("garbage of the kind {}\n", n % 7).into_bytes(),
        };
        booth.export(&format!("4711_{n:05}.obj"), &bytes);
        match n % 1000 == 500 {
            true => scans.push(bytes),
            false => drop(garbage.insert(bytes)),
        }
    }
    (scans, garbage)
}

fn count_of(count: usize) -> i64 {
    i64::try_from(count).unwrap()
}

/// Every file was sighted once, every scan has its record, all garbage lies in quarantine.
fn all_is_accounted_for(
    booth: &Booth,
    daemon: Daemon,
    count: usize,
    scans: &[Vec<u8>],
    garbage: &BTreeSet<Vec<u8>>,
) {
    booth.wait_long_for_journal("SELECT count(*) FROM sightings", count_of(count));
    let refused = "SELECT count(*) FROM scans WHERE state = 'refused'";
    booth.wait_long_for_journal(refused, count_of(garbage.len()));
    booth.wait_for_records(scans.len());
    booth.asks();
    assert_eq!(daemon.stop().code(), Some(0));
    let expected: Vec<(&str, &[u8])> = scans.iter().map(|scan| ("4711", scan.as_slice())).collect();
    booth.assert_settled(&expected);
    assert_eq!(names(&booth.path("state/quarantine")).len(), garbage.len());
    for bytes in garbage.iter().take(20) {
        booth.reason(bytes);
    }
    assert_eq!(names(&booth.path("export")).len(), count, "the source is untouched");
}

#[test]
#[ignore = "takes minutes, run by .ci/run"]
fn twenty_thousand_files_at_once_are_all_accounted_for() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    let mut flooded = None;
    while_asleep(&daemon, || flooded = Some(flood(&booth, FLOOD)));
    let (scans, garbage) = flooded.unwrap();
    all_is_accounted_for(&booth, daemon, FLOOD, &scans, &garbage);
}

/// The kernel's limit lowered for watches that are made while this lives.
pub struct ShortQueue(String);

impl ShortQueue {
    pub fn new(events: u32) -> Option<ShortQueue> {
        let before = fs::read_to_string(QUEUE).ok()?;
        if fs::write(QUEUE, events.to_string()).is_err() {
            println!("the kernel's limit of events may not be changed here");
            return None;
        }
        Some(ShortQueue(before))
    }
}

impl Drop for ShortQueue {
    fn drop(&mut self) {
        let _ = fs::write(QUEUE, &self.0);
    }
}

#[test]
#[ignore = "needs root to lower the kernel's limit of events, run by .ci/run"]
fn a_queue_of_16_events_loses_no_file() {
    let booth = Booth::new();
    let short = ShortQueue::new(16).unwrap();
    let daemon = booth.start_ready();
    drop(short);
    let mut flooded = None;
    while_asleep(&daemon, || flooded = Some(flood(&booth, 600)));
    let (scans, garbage) = flooded.unwrap();
    all_is_accounted_for(&booth, daemon, 600, &scans, &garbage);
}

/// The store holds these records and no other, and nothing waits. For folders with things in them
/// that the checker of the invariants cannot name or read.
#[track_caller]
fn holds_exactly<'a>(booth: &Booth, expected: impl IntoIterator<Item = (&'a str, &'a [u8])>) {
    let expected = expected.into_iter().map(|(patient, bytes)| (patient.to_owned(), sha256(bytes)));
    let mut expected: Vec<(String, String)> = expected.collect();
    expected.sort();
    assert_eq!(booth.records(), expected, "log:\n{}", booth.log());
    assert_eq!(booth.journal("SELECT count(*) FROM deliveries WHERE state = 'pending'"), Some(0));
    assert_eq!(names(&booth.path("state/spool")), [""; 0]);
}

/// Names no scanner gives, every one legal on Linux; and whose scan each says it is.
fn odd_names() -> Vec<(&'static str, Vec<u8>)> {
    let long = |head: &str| [head.as_bytes(), &vec![b'x'; 255 - head.len() - 4], b".obj"].concat();
    let odd: [(&str, &[u8]); 16] = [
        ("4711", b"4711_\xff\xfe\x80.obj"),
        ("_unassigned", b"\xc3\x28\xa0.obj"),
        ("4711", b"4711_two\nlines\r.obj"),
        ("4711", "4711_\u{202e}jbo.naps\u{202c}.obj".as_bytes()),
        ("_unassigned", b"--config=x.obj"),
        ("_unassigned", b"-.obj"),
        ("4711", b"4711_%s%n%d{}$(reboot)`id`.obj"),
        ("4711", b"4711_\x1b[2J\x1b]0;owned\x07\x00.obj".split(|b| *b == 0).next().unwrap()),
        ("4711", b"4711_ ' \" \\ * ? | <> ; &.obj"),
        ("_unassigned", b"CON.obj"),
        ("_unassigned", b" .obj"),
        ("_unassigned", "Mu\u{308}ller.obj".as_bytes()),
        ("_unassigned", "M\u{fc}ller.obj".as_bytes()),
        ("_unassigned", b"..obj.obj"),
        ("4711", b"4711_.OBJ"),
        ("_unassigned", "\u{1f9e6}.obj".as_bytes()),
    ];
    let mut all: Vec<(&str, Vec<u8>)> = odd.iter().map(|(id, name)| (*id, name.to_vec())).collect();
    all.extend([("4711", long("4711_")), ("_unassigned", long("\u{e4}"))]);
    all
}

#[test]
fn odd_names_are_taken_like_any_other_and_never_reach_the_log() {
    let booth = Booth::new();
    let daemon = booth.start();
    let mut expected = Vec::new();
    for (n, (patient, name)) in odd_names().into_iter().enumerate() {
        let path = booth.path("export").join(OsStr::from_bytes(&name));
        let hidden = name.starts_with(b".");
        let ends = name.to_ascii_lowercase().ends_with(b".obj");
        fs::write(path, coarse_body(n)).unwrap();
        if ends && !hidden {
            expected.push((patient, coarse_body(n)));
        }
    }
    assert!(expected.len() >= 15, "{}", expected.len());
    booth.wait_for_records(expected.len());
    assert_eq!(daemon.stop().code(), Some(0));
    holds_exactly(&booth, expected.iter().map(|(patient, bytes)| (*patient, bytes.as_slice())));
    let log = booth.log();
    let strange = log.chars().find(|c| c.is_control() && *c != '\n' || !c.is_ascii());
    assert_eq!(strange, None, "{log:?}");
    for word in ["reboot", "owned", "CON", "ller", "xxxx", ".obj"] {
        assert!(!log.contains(word), "{word} in {log}");
    }
}

#[test]
fn what_is_no_file_is_left_alone_and_delays_nothing() {
    let booth = Booth::new();
    let at = |name: &str| booth.path("export").join(name);
    let secret = booth.path("secret.obj");
    fs::write(&secret, coarse_body(98)).unwrap();
    rustix::fs::mkfifoat(CWD, at("4711_1.obj"), Mode::RUSR | Mode::WUSR).unwrap();
    let _socket = UnixListener::bind(at("4711_2.obj")).unwrap();
    fs::create_dir(at("4711_3.obj")).unwrap();
    fs::write(at("4711_3.obj/4711_inside.obj"), coarse_body(97)).unwrap();
    symlink(&secret, at("4711_4.obj")).unwrap();
    symlink("/dev/zero", at("4711_5.obj")).unwrap();
    symlink(at("4711_6.obj"), at("4711_6.obj")).unwrap();
    let zero = rustix::fs::makedev(1, 5);
    let mode = Mode::RUSR;
    if rustix::fs::mknodat(CWD, at("4711_7.obj"), FileType::CharacterDevice, mode, zero).is_err() {
        println!("SKIPPED in part: a device needs root");
    }
    let daemon = booth.start();
    booth.export("4711_8.obj", &coarse_body(8));
    booth.wait_for_records(1);
    booth.export("4711_9.obj", &coarse_body(9));
    booth.wait_for_records(2);
    assert_eq!(daemon.stop().code(), Some(0));
    holds_exactly(
        &booth,
        [("4711", coarse_body(8).as_slice()), ("4711", coarse_body(9).as_slice())],
    );
    assert_eq!(names(&booth.path("state/quarantine")), [""; 0]);
}

/// Swaps a file for a link and back as fast as it goes, until it is told to stop; a file stays.
fn swap(path: &Path, file: &Path, link: &Path, stop: &AtomicBool) {
    let spare = path.with_extension("spare");
    while !stop.load(Ordering::Relaxed) {
        fs::rename(path, &spare).unwrap();
        fs::rename(link, path).unwrap();
        fs::rename(path, link).unwrap();
        fs::rename(&spare, path).unwrap();
        thread::yield_now();
    }
    assert!(file.exists());
}

#[test]
fn a_link_put_in_a_file_s_place_between_look_and_read_is_never_followed() {
    let booth = Booth::new();
    let (secret, link) = (booth.path("secret.obj"), booth.path("link"));
    fs::write(&secret, coarse_body(98)).unwrap();
    symlink(&secret, &link).unwrap();
    booth.export("4711_a.obj", &coarse_body(1));
    let path: PathBuf = booth.path("export/4711_a.obj");
    let stop = AtomicBool::new(false);
    let daemon = booth.start();
    thread::scope(|scope| {
        scope.spawn(|| swap(&path, &secret, &link, &stop));
        for n in 2..=6 {
            booth.export(&format!("4711_{n}.obj"), &coarse_body(n));
            let delivered = || booth.records().iter().any(|r| r.1 == sha256(&coarse_body(n)));
            booth.wait_for("a scan beside the swapping", delivered);
        }
        stop.store(true, Ordering::Relaxed);
    });
    booth.has_put("4711_a.obj", &coarse_body(1), PutKind::Whole);
    booth.wait_for_records(6);
    assert_eq!(daemon.stop().code(), Some(0));
    let scans: Vec<Vec<u8>> = (1..=6).map(coarse_body).collect();
    let expected: Vec<(&str, &[u8])> = scans.iter().map(|scan| ("4711", scan.as_slice())).collect();
    booth.assert_settled(&expected);
}

#[test]
fn files_without_end_are_refused_and_the_scans_beside_them_get_their_records() {
    let booth = Booth::new();
    booth.reconfigure(|text| text.replace("max_scan = \"20MB\"", "max_scan = \"300MB\""));
    let sparse = |name: &str, size: u64| {
        File::create(booth.path("export").join(name)).unwrap().set_len(size).unwrap();
    };
    sparse("4711_1_fifty-gigabytes.obj", 50_000_000_000);
    booth.has_put("4711_1_fifty-gigabytes.obj", &[], PutKind::Huge);
    sparse("4711_2_zeros.obj", 100_000_000);
    booth.has_put("4711_2_zeros.obj", &vec![0; 100_000_000], PutKind::Whole);
    booth.export("4711_3_one-line.obj", &vec![b'v'; 200_000_000]);
    let mut line = b"v".to_vec();
    line.extend(std::iter::repeat_n(*b" 1", 10_000_000).flatten());
    booth.export("4711_4_one-vertex.obj", &line);
    let daemon = booth.start();
    for n in 5..=7 {
        booth.export(&format!("4711_{n}.obj"), &coarse_body(n));
    }
    booth.wait_for_records(3);
    booth.wait_for("four refusals", || names(&booth.path("state/quarantine")).len() == 4);
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'spooled'", 0);
    assert_eq!(daemon.stop().code(), Some(0));
    let scans: Vec<Vec<u8>> = (5..=7).map(coarse_body).collect();
    let expected: Vec<(&str, &[u8])> = scans.iter().map(|scan| ("4711", scan.as_slice())).collect();
    booth.assert_settled(&expected);
}
