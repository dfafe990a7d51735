//! Names and birth dates of a worklist stand on the page of somebody with the token, and in what an archive of images
//! gets that is to have them, and nowhere else: in nothing that the station tells, logs at whatever level, or writes.
//! They are gone with the day and with the run.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use rig::images::ImageArchive;
use rig::process::{family, public_words};
use rig::web::{HttpAnswer, Site};
use rig::worklist::{Manner, Planned, WorklistServer};
use rig::{Booth, Daemon, Setting, sha256};
use serde_json::{Value, json};
use support::coarse_body;
use support::stow::SentObject;

/// What the page of somebody with the token shows of the first entry.
const SHOWN: [&str; 2] = ["Quastenflosser, Hanna", "1947-03-11"];

/// What may stand nowhere else: names, and birth dates as DICOM, ISO 8601 and people write them.
const PLANTED: [&str; 9] = [
    "quastenflosser",
    "hammerhai",
    "ammenhai",
    "19470311",
    "1947-03-11",
    "11.03.1947",
    "19310423",
    "1931-04-23",
    "23.04.1931",
];

const FIRST: Planned = Planned {
    patient: "4711",
    name: "Quastenflosser^Hanna",
    born: "19470311",
    study: "1.2.276.4711",
    accession_number: "A4711",
};

const SECOND: Planned = Planned {
    patient: "4712",
    name: "Hammerhai^Karl",
    born: "19310423",
    study: "1.2.276.4712",
    accession_number: "A4712",
};

/// Entries that name no patient, with names where a server should have none: as an id, as a study, and of an
/// id that two people have.
const LEFT_OUT: [Planned; 4] = [
    Planned { patient: "Ammenhai", accession_number: "A1", ..FIRST },
    Planned { patient: "4713", study: "Ammenhai", ..SECOND },
    Planned { patient: "4714", study: "1.2.276.1", accession_number: "A2", ..FIRST },
    Planned { patient: "4714", study: "1.2.276.2", accession_number: "A3", ..SECOND },
];

/// How many objects an archive of images has of a record: the figures and the report.
const OBJECTS: usize = 2;

/// So long before its midnight a station is started that takes a scan before it, seconds. On a machine on which that is
/// too short, the next.
const UNTIL_MIDNIGHT_S: [u64; 3] = [20, 60, 180];

/// A day, seconds.
const DAY_S: u64 = 24 * 3600;

/// A booth whose page is open to this machine and to the network, and whose archive of images gets names.
fn booth(server: &WorklistServer, archive: &ImageArchive) -> Booth {
    let booth = Booth::set(&Setting { files: "[]", ..Setting::default() });
    let servers = server.section() + &archive.section();
    booth.reconfigure(|config| {
        format!(
            "{config}[status]\nlisten = \"127.0.0.1:0\"\n[page]\nnetwork = \"0.0.0.0:0\"\n{servers}"
        )
    });
    booth
}

/// A station whose log has this level, so many seconds before its midnight.
fn start(booth: &Booth, level: &str, until_midnight_s: u64) -> Daemon {
    let mut command = booth.command();
    command.env("RUST_LOG", level).env("TZ", zone_before_midnight(until_midnight_s));
    Daemon::start(command)
}

/// The time zone, as POSIX writes it, in which the next midnight is so many seconds away.
fn zone_before_midnight(seconds: u64) -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs();
    let ahead = (2 * DAY_S - seconds - now % DAY_S) % DAY_S;
    // What is east of Greenwich has a minus.
    let (sign, by) = if ahead <= DAY_S / 2 { ('-', ahead) } else { ('+', DAY_S - ahead) };
    format!("BOOTH{sign}{:02}:{:02}:{:02}", by / 3600, by / 60 % 60, by % 60)
}

/// What the worklist answers to the page of somebody with the token, as one that was just opened asks.
fn listed(site: &Site) -> HttpAnswer {
    site.post("/worklist", "{\"anew\":true}", &site.operator())
}

fn are_shown(site: &Site) -> bool {
    let answer = listed(site);
    SHOWN.iter().all(|planted| answer.body.contains(planted))
}

/// Taps the entry of a patient.
fn tap(site: &Site, patient: &str) {
    let answer: Value = serde_json::from_str(&listed(site).body).unwrap();
    let entries = answer["entries"].as_array().unwrap();
    let entry = entries.iter().find(|entry| entry["patient"] == patient).unwrap();
    let tapped = json!({ "ask": "name_listed", "entry": entry["key"], "replace": true });
    let answer = site.post("/ask", &tapped.to_string(), &site.operator());
    assert_eq!(answer.status, 200, "{}", answer.body);
    assert_clean("the answer to a tap", &answer.bytes);
}

/// The scan that is exported.
fn scan() -> String {
    sha256(&coarse_body(0))[..12].to_owned()
}

/// Takes a scan of the first patient, who is tapped, as far as the archive of images, which refuses it.
fn take_scan(booth: &Booth, site: &Site, archive: &ImageArchive) {
    tap(site, FIRST.patient);
    booth.wait_for_look();
    booth.export("x.obj", &coarse_body(0));
    booth.wait_for_records(1);
    booth.wait_for("a refusal", || !archive.refused().is_empty());
}

/// What the archive of images has once it keeps what it refused.
fn delivered(booth: &Booth, archive: &ImageArchive) -> Vec<SentObject> {
    archive.keeps();
    booth.gaiter(&["retry", &scan()]);
    booth.wait_for("the objects", || archive.kept().len() == OBJECTS);
    archive.kept()
}

/// Fails unless objects say who the first patient is, and nothing of others.
#[track_caller]
fn assert_name_the_first(objects: &[SentObject]) {
    for SentObject { name, text, .. } in objects {
        assert_eq!(name, FIRST.name);
        assert!(text.contains(FIRST.born));
        let others = text.replace(FIRST.name, "").replace(FIRST.born, "");
        assert_clean("an object", others.as_bytes());
    }
}

#[track_caller]
fn assert_clean(what: &str, text: &[u8]) {
    let text = String::from_utf8_lossy(text).to_lowercase();
    for planted in PLANTED {
        let Some(at) = text.find(planted) else { continue };
        let line = text[..at].lines().count().max(1);
        panic!("{planted} is in {what}: {}", text.lines().nth(line - 1).unwrap_or_default());
    }
}

/// Every file below a folder, by name and content.
fn assert_clean_files(folder: &Path) {
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let name = path.display().to_string();
        assert_clean("a name", name.as_bytes());
        if path.is_dir() {
            assert_clean_files(&path);
        } else if path.is_file() {
            // A file of a journal that is in use may be gone by now.
            assert_clean(&name, &fs::read(&path).unwrap_or_default());
        }
    }
}

/// Everything that is told of a running station, to whomever.
fn assert_tells_nobody(booth: &Booth, daemon: &Daemon) {
    let scan = &scan();
    let (local, network) = (Site::open(booth, "local"), Site::open(booth, "network"));
    let pages = ["/", "/kiosk", "/state", "/state?kiosk", "/page.js", "/healthz", "/metrics"];
    for (site, way) in [(&local, "local"), (&network, "network")] {
        // The snapshots have none, not even for somebody with the token.
        for headers in [Vec::new(), local.operator()] {
            for page in pages {
                assert_clean(&format!("{way}{page}"), &site.get(page, &headers).bytes);
            }
            for stream in ["/stream", "/stream?kiosk"] {
                let told = site.stream_of(stream, &headers).next().unwrap();
                assert_clean(&format!("{way}{stream}"), told.to_string().as_bytes());
            }
        }
    }
    let others =
        [local.post("/worklist", "{}", &[]), network.post("/worklist", "{}", &network.operator())];
    for answer in others {
        assert_ne!(answer.status, 200);
        assert_clean("an answer to somebody without the token", &answer.bytes);
    }
    let verbs: [&[&str]; 8] = [
        &["status"],
        &["status", "--json"],
        &["scans"],
        &["scans", "--json"],
        &["show", scan],
        &["show", scan, "--json"],
        &["patient", "show"],
        &["check"],
    ];
    for verb in verbs {
        let told = booth.gaiter(verb);
        assert_clean(&format!("{verb:?}"), &[told.stdout, told.stderr].concat());
    }
    for pid in family(daemon.id()) {
        assert_clean("a process", &public_words(pid));
    }
}

/// Everything that a station has written: its log, and all of its folders.
fn assert_has_written_nobody(booth: &Booth) {
    assert_clean_files(&booth.path(""));
}

/// A day with everything that can happen to a worklist: entries that name nobody, a tap, a server that refuses with a
/// name in its remark, one that is away, and an entry that goes. The archive of images refuses with names, too, before
/// it keeps them.
fn a_day(booth: &Booth, daemon: &Daemon, server: &WorklistServer, archive: &ImageArchive) {
    let site = Site::open(booth, "local");
    booth.wait_for("the list", || are_shown(&site));
    take_scan(booth, &site, archive);
    for (outage, manner) in [(1, Manner::Refuses("Ammenhai^Fritz 19310423")), (2, Manner::IsAway)] {
        server.is(manner);
        booth.wait_for("an outage", || listed(&site).status == 200 && outages(booth) == outage);
        assert!(are_shown(&site), "the last answer holds");
        assert_tells_nobody(booth, daemon);
        server.is(Manner::Answers);
        let answers = || booth.log().matches("event=\"worklist-in-reach\"").count();
        booth.wait_for("its end", || listed(&site).status == 200 && answers() == outage + 1);
    }
    let objects = delivered(booth, archive);
    assert_name_the_first(&[archive.refused(), objects].concat());
    tap(&site, SECOND.patient);
    assert_tells_nobody(booth, daemon);
    server.has(&[FIRST, LEFT_OUT[0]]);
    booth.wait_for("one entry less", || !listed(&site).body.contains("Hammerhai"));
    assert!(are_shown(&site), "whoever has the token still sees the other");
}

/// How often the log says that the server is away.
fn outages(booth: &Booth) -> usize {
    booth.log().matches("event=\"worklist-out-of-reach\"").count()
}

/// What may be known of a day at a station whose log has this level.
fn nobody_is_named_but_on_the_page(level: &str) {
    let server = WorklistServer::new(&[&[FIRST, SECOND][..], &LEFT_OUT].concat());
    let archive = ImageArchive::that_refuses();
    let booth = booth(&server, &archive);
    let daemon = start(&booth, level, DAY_S / 2);
    a_day(&booth, &daemon, &server, &archive);
    assert_has_written_nobody(&booth);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_has_written_nobody(&booth);
    // Of the request the record knows what a hospital needs.
    let folder =
        fs::read_dir(booth.path("records/4711")).unwrap().map(|entry| entry.unwrap().path());
    let record = folder.map(|path| path.join("record.json")).find(|path| path.exists()).unwrap();
    let record: Value = serde_json::from_slice(&fs::read(record).unwrap()).unwrap();
    let request = &record["patient"]["sources"][0]["request"];
    assert_eq!(
        *request,
        json!({ "study_instance_uid": "1.2.276.4711", "accession_number": "A4711" })
    );
    // The next run knows nothing of them while the server is away.
    server.is(Manner::IsAway);
    let before = outages(&booth);
    let daemon = start(&booth, level, DAY_S / 2);
    booth.wait_for("another outage", || outages(&booth) > before);
    let site = Site::open(&booth, "local");
    assert_eq!(listed(&site).body, "{\"entries\":null}");
    assert_tells_nobody(&booth, &daemon);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_has_written_nobody(&booth);
}

#[test]
fn names_of_a_worklist_stand_on_the_page_of_who_has_the_token_and_in_an_archive_and_nowhere_else() {
    nobody_is_named_but_on_the_page("info");
}

#[test]
fn names_of_a_worklist_are_in_no_log_at_the_finest_level() {
    nobody_is_named_but_on_the_page("trace");
}

/// Whether the names are gone at midnight from a station that had them before, on its page and in what it sent. On a
/// machine that is too slow for that, they are not seen in time.
fn are_seen_and_gone_at_midnight(seconds: u64) -> bool {
    let server = WorklistServer::new(&[FIRST, SECOND]);
    let archive = ImageArchive::that_refuses();
    let booth = booth(&server, &archive);
    let before = SystemTime::now();
    let daemon = start(&booth, "info", seconds);
    let site = Site::open(&booth, "local");
    booth.wait_for("the list", || are_shown(&site));
    take_scan(&booth, &site, &archive);
    server.is(Manner::IsAway);
    // The zone counts whole seconds.
    let is_over = || before.elapsed().unwrap() >= Duration::from_secs(seconds - 1);
    if is_over() {
        return false;
    }
    assert_name_the_first(&archive.refused());
    booth.wait_for("the end of the day", || !are_shown(&site));
    assert!(is_over());
    assert_eq!(listed(&site).body, "{\"entries\":null}");
    booth.wait_for("a status of the new day", || booth.status()["worklist"]["entries"] == 0);
    // What waited for the archive answers the request, and names nobody any more.
    for SentObject { name, text, .. } in delivered(&booth, &archive) {
        assert_eq!(name, "");
        assert!(text.contains(FIRST.accession_number));
        assert_clean("an object of the day after", text.as_bytes());
    }
    assert_tells_nobody(&booth, &daemon);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_has_written_nobody(&booth);
    true
}

#[test]
fn names_of_a_worklist_are_gone_at_midnight_although_its_server_and_an_archive_are_away() {
    let is_seen = UNTIL_MIDNIGHT_S.into_iter().any(are_seen_and_gone_at_midnight);
    assert!(is_seen, "no scan was sent within {UNTIL_MIDNIGHT_S:?} s of a start");
}
