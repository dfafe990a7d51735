//! What the archive holds, what to do, how the stations are: in the terminal, and as a page and metrics.

mod metrics;
mod page;
pub mod serve;

use std::fmt::Write;

use serde::{Deserialize, Serialize};

use crate::config::ArchiveConfig;
use crate::database::{self, ATTEMPTS_MOST, rows};
use crate::fault::ArchiveFault;

/// How many dead letters are shown; all are in the view `dead_letter`.
const LETTERS_MOST: i64 = 20;

/// A station that is silent for longer is not well, seconds: its heart beats every minute.
const SILENT_MOST_S: i64 = 600;

/// The state of an archive.
#[derive(Debug, Serialize)]
struct Status {
    scans: i64,
    methods: Vec<MethodRow>,
    workers: Vec<WorkerRow>,
    dead_letters: Vec<LetterRow>,
    stations: Vec<StationRow>,
}

#[derive(Debug, Serialize, Deserialize)]
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
#[derive(Debug, Serialize, Deserialize)]
struct WorkerRow {
    worker: String,
    claimed: i64,
}

/// A scan that could not be measured.
#[derive(Debug, Serialize, Deserialize)]
struct LetterRow {
    scan: String,
    method: String,
    reason: String,
}

#[derive(Debug, Serialize, Deserialize)]
struct StationRow {
    station: String,
    /// How long ago it was heard, seconds; none if it has only announced.
    silent_s: Option<i64>,
    gaiter: Option<String>,
    is_ready: Option<bool>,
    /// How long the scan waits that waits longest for the archive, seconds.
    oldest_undelivered_s: Option<i64>,
    scans_today: Option<i64>,
    refused_today: Option<i64>,
    /// Its share of refusals on the 30 days before.
    refused_share: Option<f64>,
    phantom_bias_mm: Option<f64>,
    /// The bias, less its mean on the 30 days before.
    phantom_drift_mm: Option<f64>,
    /// How many scans of it are in the archive.
    scans: i64,
}

/// The state of the archive, for people or for programs.
///
/// # Errors
/// If the database does not tell.
pub fn status(config: &ArchiveConfig, json: bool) -> Result<String, ArchiveFault> {
    let status = Status::read(config)?;
    if json { Ok(serde_json::to_string_pretty(&status)?) } else { Ok(status.text()) }
}

impl Status {
    /// All of one moment; nothing is written.
    fn read(config: &ArchiveConfig) -> Result<Status, ArchiveFault> {
        let mut client = database::connect(&config.database)?;
        let mut moment = database::moment(&mut client)?;
        let scans = moment.query_one("select count(*) from scan", &[])?.get(0);
        let methods = "\
            select m.method, m.is_current, coalesce(r.results, 0) as results, coalesce(r.refused, 0) as refused,
                coalesce(j.waiting, 0) as waiting, coalesce(j.claimed, 0) as claimed, coalesce(j.dead, 0) as dead
            from method m
            left join (select method, count(*) results, count(*) filter (where outcome <> 'measured') refused
                from result group by method) r using (method)
            left join (select method,
                count(*) filter (where due <= now() and attempts < $1) waiting,
                count(*) filter (where due > now()) claimed,
                count(*) filter (where due <= now() and attempts >= $1) dead
                from job group by method) j using (method)
            order by m.number";
        let workers = "\
            select worker, count(*) as claimed from job where due > now() and worker is not null
            group by worker order by worker";
        let letters = "\
            select encode(scan, 'hex') as scan, method, reason from dead_letter order by scan limit $1";
        let stations = "\
            select station, extract(epoch from now() - heard)::bigint as silent_s, gaiter, is_ready,
                extract(epoch from now() - oldest_undelivered)::bigint as oldest_undelivered_s,
                scans_today, refused_today, refused_share,
                phantom_bias_mm::float8 as phantom_bias_mm, phantom_drift_mm, archived as scans
            from station_status order by station";
        Ok(Status {
            scans,
            methods: rows(&mut moment, methods, &[&ATTEMPTS_MOST])?,
            workers: rows(&mut moment, workers, &[])?,
            dead_letters: rows(&mut moment, letters, &[&LETTERS_MOST])?,
            stations: rows(&mut moment, stations, &[])?,
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
            let _ = writeln!(text, "station {}: {}", of.station, of.cells().join(", "));
        }
        text.truncate(text.trim_end().len());
        text
    }
}

impl StationRow {
    /// Whether it is ready and was heard of lately.
    fn is_well(&self) -> bool {
        self.is_ready == Some(true) && self.silent_s.is_some_and(|s| s <= SILENT_MOST_S)
    }

    /// What is told of it: last heard, version, what waits, refusals, phantom, scans.
    fn cells(&self) -> [String; 6] {
        let ready = if self.is_ready == Some(false) { ", not ready" } else { "" };
        let heard =
            self.silent_s.map_or("never heard".to_owned(), |s| format!("heard {} ago", lasting(s)));
        let waits = self.oldest_undelivered_s;
        let share = self
            .refused_share
            .map_or(String::new(), |of| format!(" (usually {:.1} %)", 100.0 * of));
        let refused = self.refused_today.zip(self.scans_today);
        let drift = self.phantom_drift_mm.map_or(String::new(), |mm| format!(" (drift {mm:+.1})"));
        let bias = self.phantom_bias_mm;
        [
            format!("{heard}{ready}"),
            self.gaiter.clone().unwrap_or_else(|| "unknown version".to_owned()),
            waits.map_or("nothing waits".to_owned(), |s| format!("waits for {}", lasting(s))),
            refused.map_or("no scans counted today".to_owned(), |(refused, scans)| {
                format!("{refused} of {scans} refused today{share}")
            }),
            bias.map_or("no phantom".to_owned(), |mm| format!("phantom {mm:+.1} mm{drift}")),
            format!("{} scans", self.scans),
        ]
    }
}

/// A time in the largest unit of which it has two.
fn lasting(seconds: i64) -> String {
    let units = [(86_400, "d"), (3600, "h"), (60, "min")];
    let unit = units.into_iter().find(|(length, _)| seconds >= 2 * length);
    unit.map_or(format!("{seconds} s"), |(length, unit)| format!("{} {unit}", seconds / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A station that told more than a page should show.
    fn status() -> Status {
        let station = StationRow {
            station: "booth-1".to_owned(),
            silent_s: Some(7200),
            gaiter: Some("<script>".to_owned()),
            is_ready: Some(true),
            oldest_undelivered_s: None,
            scans_today: Some(20),
            refused_today: Some(3),
            refused_share: Some(0.02),
            phantom_bias_mm: Some(0.74),
            phantom_drift_mm: Some(-0.26),
            scans: 4711,
        };
        let letter = LetterRow {
            scan: "ab".repeat(32),
            method: "0.1.0+1a2b3c4d".to_owned(),
            reason: "a & b".to_owned(),
        };
        let stations = vec![station];
        Status {
            scans: 4711,
            methods: vec![],
            workers: vec![],
            dead_letters: vec![letter],
            stations,
        }
    }

    #[test]
    fn a_station_is_a_line() {
        let text = status().text();
        let line = "station booth-1: heard 2 h ago, <script>, nothing waits, 3 of 20 refused today \
                    (usually 2.0 %), phantom +0.7 mm (drift -0.3), 4711 scans";
        assert_eq!(text.lines().last(), Some(line));
    }

    #[test]
    fn the_page_says_the_same_and_runs_nothing_that_a_station_wrote() {
        let page = status().page();
        assert!(
            page.contains("<tr class=\"fault\"><td>booth-1</td><td>heard 2 h ago</td>"),
            "{page}"
        );
        assert!(page.contains("&lt;script&gt;") && !page.contains("<script"), "{page}");
        assert!(page.contains("a &amp; b"), "{page}");
    }

    #[test]
    fn metrics_are_of_each_station() {
        let text = status().metrics().unwrap();
        for line in [
            "gaiter_archive_scans 4711.0",
            "gaiter_archive_station_silent_seconds{station=\"booth-1\"} 7200.0",
            "gaiter_archive_station_refused_today{station=\"booth-1\"} 3.0",
            "gaiter_archive_station_phantom_drift_millimetres{station=\"booth-1\"} -0.26",
            "# EOF",
        ] {
            assert!(text.lines().any(|found| found == line), "no {line} in\n{text}");
        }
        let unknown = "gaiter_archive_station_oldest_undelivered_seconds{";
        assert!(!text.contains(unknown), "{text}");
    }
}
