//! Questions over all scans: as the role that reads, as Parquet, and of the stations.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};

use gaiter_record::archive::{Document, Heartbeat, StationId};
use jiff::{SignedDuration, Timestamp};
use serde_json::Value;

use crate::place::{Place, crop, whole};
use crate::servers::python;

/// An archive with the role that reads, two scans of two months, and one that cannot be measured.
fn archive() -> Place {
    let place = Place::new();
    let role = "do $$ begin create role gaiter_reader; exception when others then null; end $$";
    place.client().batch_execute(role).unwrap();
    place.renew(2);
    let mut few = whole().crop();
    few.points.truncate(3);
    few.triangles = vec![[0, 1, 2]];
    place.announce(&(few.to_ply(), crop(0).1));
    place.verb(&["index", "--once"]);
    place.verb(&["work", "--until-empty"]);
    let moved = "\
        update announcement set first_seen = '2026-10-31 23:59:59Z', patient = sha256('somebody')
        where scan = (select scan from result where outcome = 'measured' order by 1 limit 1)";
    assert_eq!(place.client().execute(moved, &[]).unwrap(), 1);
    place
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn a_question_changes_nothing_and_reads_nothing_but_the_views() {
    let place = archive();
    let said = |args: &[&str]| String::from_utf8(place.verb(args).stdout).unwrap();
    let csv =
        said(&["query", "select outcome, count(*) from scan_result group by 1 order by 2 -- all;"]);
    assert!(csv.starts_with("outcome,count\n") && csv.ends_with("measured,2\n"), "{csv}");
    let calves = "select count(*) from level where level = 'C'";
    let calves: i64 = place.client().query_one(calves, &[]).unwrap().get(0);
    assert!(calves > 0);
    for (question, legs) in
        [("calf-by-stature", calves), ("repeatability", 0), ("phantom-drift", 0)]
    {
        let rows: Vec<Value> = serde_json::from_str(&said(&["query", "--json", question])).unwrap();
        let counted: i64 = rows.iter().filter_map(|row| row["legs"].as_i64()).sum();
        assert_eq!(counted, legs, "{question}: {rows:?}");
    }
    for (refused, why) in [
        ("select * from result", "permission denied"),
        ("delete from visit returning 1", "permission denied"),
        ("select pg_read_file('/etc/hostname')", "permission denied"),
    ] {
        let output = place.tried(&["query", refused]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && said.contains(why), "{refused}: {said}");
    }
}

#[test]
#[ignore = "needs PostgreSQL, moto and pyarrow, run by .ci/run"]
fn an_export_says_what_the_database_says_and_forgets_what_it_forgot() {
    let place = archive();
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("parquet");
    let export = || drop(place.verb(&["export", target.to_str().unwrap()]));
    export();
    let rows = exported(&target);
    assert_eq!(rows, indexed(&place));
    let months = |rows: &[Vec<Value>]| -> BTreeSet<String> {
        rows.iter().map(|row| row[13].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(months(&rows).len(), 2);
    // Somebody is removed, and with him all of a month.
    place
        .client()
        .batch_execute(
            "delete from scan where scan in (select scan from visit where patient is not null)",
        )
        .unwrap();
    export();
    let rows = exported(&target);
    assert_eq!(rows, indexed(&place));
    assert_eq!(months(&rows), ["1970-01".to_owned()].into());
}

/// The rows of an export, as pyarrow reads them.
fn exported(folder: &Path) -> Vec<Vec<Value>> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/archive/parquet.py");
    let output = Command::new(python()).arg(script).arg(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    sorted(String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned))
}

/// The same rows, as the database has them.
fn indexed(place: &Place) -> Vec<Vec<Value>> {
    let statement = "\
        select json_build_array(station, encode(scan, 'hex'), extract(epoch from first_seen)::bigint,
            encode(patient, 'hex'), method, outcome, stature_mm::float8, crotch_height_mm::float8, side, level,
            height_mm::float8, girth_mm::float8, girth_sd_mm::float8,
            to_char(first_seen at time zone 'UTC', 'YYYY-MM'))::text
        from visit_level";
    let rows = place.client().query(statement, &[]).unwrap();
    sorted(rows.iter().map(|row| row.get(0)))
}

fn sorted(lines: impl Iterator<Item = String>) -> Vec<Vec<Value>> {
    let row = |line: String| {
        let mut row: Vec<Value> = serde_json::from_str(&line).unwrap();
        // 1700 is 1700.0.
        for cell in &mut row {
            if let Some(number) = cell.as_f64() {
                *cell = number.into();
            }
        }
        row
    };
    let mut rows: Vec<_> = lines.map(row).collect();
    rows.sort_by_key(|row| row.iter().map(Value::to_string).collect::<Vec<_>>());
    rows
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn the_status_tells_refusals_and_drift_by_what_the_station_said_before() {
    let place = Place::new();
    place.renew(0);
    let now = Timestamp::now();
    for (days_ago, scans, refused, phantom_bias_mm) in
        [(2, 100, 10, 0.25), (1, 150, 11, 0.75), (0, 160, 15, 1.0)]
    {
        let beat = Heartbeat {
            schema: Heartbeat::SCHEMA.to_owned(),
            station: StationId::parse("booth-1").unwrap(),
            at: now - SignedDuration::from_hours(24 * days_ago),
            gaiter: "0.1.0".to_owned(),
            is_ready: true,
            scans: [("delivered".to_owned(), scans - refused), ("refused".to_owned(), refused)]
                .into(),
            oldest_undelivered: None,
            phantom_bias_mm: Some(phantom_bias_mm),
        };
        place.bucket.put(&beat.key().to_string(), beat.json().unwrap()).unwrap();
        place.verb(&["index", "--once"]);
    }
    let output = place.verb(&["status", "--json"]);
    let status: Value = serde_json::from_slice(&output.stdout).unwrap();
    let station = &status["stations"][0];
    // Between the day before and today: 10 scans, 4 of them refused; on the day before 1 of 50.
    assert_eq!(station["scans_today"], 10);
    assert_eq!(station["refused_today"], 4);
    assert_eq!(station["refused_share"], 0.02);
    assert_eq!(station["phantom_drift_mm"], 0.5);
    let page = served(&place, "/");
    assert!(page.contains("4 of 10 refused today (usually 2.0 %)"), "{page}");
    assert!(page.contains("phantom +1.0 mm (drift +0.5)"), "{page}");
    let metrics = served(&place, "/metrics");
    assert!(
        metrics.contains("gaiter_archive_station_refused_today{station=\"booth-1\"} 4.0"),
        "{metrics}"
    );
}

/// What is served at a path.
fn served(place: &Place, path: &str) -> String {
    let mut command = place.command(&["status", "--listen", "127.0.0.1:0"]);
    let mut server = command.stderr(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(server.stderr.as_mut().unwrap()).read_line(&mut line).unwrap();
    let address = line.trim().rsplit("http://").next().unwrap();
    let mut stream = TcpStream::connect(address).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    server.kill().unwrap();
    server.wait().unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    answer
}
