//! What the archive holds, what is to be done, how the stations are.

use std::fmt::Write;

use postgres::{Client, Row};
use serde::Serialize;

use crate::config::ArchiveConfig;
use crate::database::{self, ATTEMPTS_MOST};
use crate::fault::ArchiveFault;

/// How many dead letters are shown; all are in the view `dead_letter`.
const LETTERS_MOST: i64 = 20;

/// The state of an archive.
#[derive(Debug, Serialize)]
struct Status {
    scans: i64,
    methods: Vec<MethodRow>,
    workers: Vec<WorkerRow>,
    dead_letters: Vec<LetterRow>,
    stations: Vec<StationRow>,
}

/// A method.
#[derive(Debug, Serialize)]
struct MethodRow {
    method: String,
    is_current: bool,
    results: i64,
    refused: i64,
    waiting: i64,
    claimed: i64,
    dead: i64,
}

/// A worker that has claimed jobs.
#[derive(Debug, Serialize)]
struct WorkerRow {
    worker: String,
    claimed: i64,
}

/// A scan that could not be measured.
#[derive(Debug, Serialize)]
struct LetterRow {
    scan: String,
    method: String,
    reason: String,
}

/// A station.
#[derive(Debug, Serialize)]
struct StationRow {
    station: String,
    /// How long ago it was heard, seconds; none if it has only announced.
    silent_s: Option<i64>,
    gaiter: Option<String>,
    is_ready: Option<bool>,
    oldest_undelivered: Option<String>,
    phantom_bias_mm: Option<f64>,
    scans: i64,
}

/// The state of the archive, for people or for programs.
///
/// # Errors
/// If the database does not tell.
pub fn status(config: &ArchiveConfig, json: bool) -> Result<String, ArchiveFault> {
    let mut client = database::connect(&config.database)?;
    database::check_schema(&mut client)?;
    let status = Status::of(&mut client)?;
    if json { Ok(serde_json::to_string_pretty(&status)?) } else { Ok(status.text()) }
}

impl Status {
    fn of(client: &mut Client) -> Result<Status, ArchiveFault> {
        let scans = client.query_one("select count(*) from scan", &[])?.get(0);
        let methods = "\
            select m.method, m.is_current, coalesce(r.results, 0), coalesce(r.refused, 0),
                coalesce(j.waiting, 0), coalesce(j.claimed, 0), coalesce(j.dead, 0)
            from method m
            left join (select method, count(*) results, count(*) filter (where outcome <> 'measured') refused
                from result group by method) r using (method)
            left join (select method,
                count(*) filter (where due <= now() and attempts < $1) waiting,
                count(*) filter (where due > now()) claimed,
                count(*) filter (where due <= now() and attempts >= $1) dead
                from job group by method) j using (method)
            order by m.number";
        let workers = "select worker, count(*) from job where due > now() and worker is not null \
                       group by worker order by worker";
        let letters = "select scan, method, reason from dead_letter order by scan limit $1";
        let stations = "\
            select coalesce(s.station, a.station), extract(epoch from now() - s.heard)::bigint, s.gaiter, s.is_ready,
                to_char(s.oldest_undelivered at time zone 'UTC', 'YYYY-MM-DD\"T\"HH24:MI:SS\"Z\"'),
                s.phantom_bias_mm::float8, coalesce(a.scans, 0)
            from station s full join (select station, count(distinct scan) scans from announcement
                group by station) a on a.station = s.station
            order by 1";
        let rows = |rows: Vec<Row>| rows.into_iter();
        Ok(Status {
            scans,
            methods: rows(client.query(methods, &[&ATTEMPTS_MOST])?).map(MethodRow::of).collect(),
            workers: rows(client.query(workers, &[])?)
                .map(|row| WorkerRow { worker: row.get(0), claimed: row.get(1) })
                .collect(),
            dead_letters: rows(client.query(letters, &[&LETTERS_MOST])?)
                .map(|row| LetterRow { scan: row.get(0), method: row.get(1), reason: row.get(2) })
                .collect(),
            stations: rows(client.query(stations, &[])?).map(StationRow::of).collect(),
        })
    }

    fn text(&self) -> String {
        let mut text = format!("{} scans\n", self.scans);
        for of in &self.methods {
            let MethodRow { method, results, refused, waiting, claimed, dead, .. } = of;
            let current = if of.is_current { ", current" } else { "" };
            // Writing to a text cannot fail.
            let _ = writeln!(
                text,
                "method {method}{current}: {results} results ({refused} refused), {waiting} waiting, \
                 {claimed} claimed or put off, {dead} dead letters"
            );
        }
        for WorkerRow { worker, claimed } in &self.workers {
            let _ = writeln!(text, "worker {worker}: {claimed} claimed");
        }
        for LetterRow { scan, method, reason } in &self.dead_letters {
            let _ = writeln!(text, "dead letter {scan} {method}: {reason}");
        }
        for of in &self.stations {
            let heard =
                of.silent_s.map_or("never heard".to_owned(), |s| format!("heard {s} s ago"));
            let version = of.gaiter.as_deref().unwrap_or("unknown version");
            let ready = if of.is_ready == Some(false) { ", not ready" } else { "" };
            let waits = of.oldest_undelivered.as_ref();
            let waits = waits.map_or(String::new(), |since| format!(", delivers since {since}"));
            let bias =
                of.phantom_bias_mm.map_or(String::new(), |mm| format!(", phantom {mm:+.1} mm"));
            let _ = writeln!(
                text,
                "station {}: {heard}, {version}{ready}{waits}{bias}, {} scans",
                of.station, of.scans
            );
        }
        text.truncate(text.trim_end().len());
        text
    }
}

impl MethodRow {
    fn of(row: Row) -> MethodRow {
        MethodRow {
            method: row.get(0),
            is_current: row.get(1),
            results: row.get(2),
            refused: row.get(3),
            waiting: row.get(4),
            claimed: row.get(5),
            dead: row.get(6),
        }
    }
}

impl StationRow {
    fn of(row: Row) -> StationRow {
        StationRow {
            station: row.get(0),
            silent_s: row.get(1),
            gaiter: row.get(2),
            is_ready: row.get(3),
            oldest_undelivered: row.get(4),
            phantom_bias_mm: row.get(5),
            scans: row.get(6),
        }
    }
}
