//! What records and previews say of their scans, read in the background: a store that does
//! not answer makes measures late, and never the page.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::task::spawn_blocking;

use super::files::FILES;
use crate::flow::page::Told;
use crate::record::{Language, Record, RecordSummary};
use crate::station::assembly::Station;
use crate::store::revision;

/// What was read is read anew after this time: a report may have been made since.
const FRESH: Duration = Duration::from_secs(60);

/// A record that could not be read is tried again after this time.
const AGAIN: Duration = Duration::from_secs(5);

/// The longest `record.json` that is read, bytes; one with shapes has under one million.
const RECORD_MOST: u64 = 16_000_000;

/// What was read, by scan.
#[derive(Debug, Default)]
pub struct Summaries(Mutex<Inner>);

#[derive(Debug, Default)]
struct Inner {
    known: BTreeMap<String, Known>,
    /// A thread reads, or hangs on the store.
    is_reading: bool,
    /// Grows with every change.
    edition: u64,
}

#[derive(Debug)]
struct Known {
    folder: PathBuf,
    told: Told,
    at: Duration,
}

impl Summaries {
    /// What is known of a scan's record in this folder.
    pub fn of(&self, scan: &str, folder: &Path) -> Option<Told> {
        let inner = self.inner();
        let known = inner.known.get(scan).filter(|known| known.folder == folder);
        known.map(|known| known.told.clone())
    }

    /// Grows whenever something else is known.
    pub fn edition(&self) -> u64 {
        self.inner().edition
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Forgets all records but these; those among them that must be read, if nobody reads yet.
    fn due(&self, records: Vec<(String, PathBuf)>, now: Duration) -> Vec<(String, PathBuf)> {
        let mut inner = self.inner();
        inner.known.retain(|scan, _| records.iter().any(|(wanted, _)| wanted == scan));
        if inner.is_reading {
            return Vec::new();
        }
        let is_due = |(scan, folder): &(String, PathBuf)| {
            inner.known.get(scan).is_none_or(|known| {
                let lasts = if known.told.measures.is_some() { FRESH } else { AGAIN };
                known.folder != *folder || now.saturating_sub(known.at) > lasts
            })
        };
        let due: Vec<(String, PathBuf)> = records.into_iter().filter(is_due).collect();
        inner.is_reading = !due.is_empty();
        due
    }

    fn note(&self, scan: String, folder: PathBuf, told: Told, now: Duration) {
        let mut inner = self.inner();
        let before = inner.known.get(&scan).map(|known| &known.told);
        if before != Some(&told) {
            inner.edition += 1;
        }
        inner.known.insert(scan, Known { folder, told, at: now });
    }
}

/// Reads in the background what is not known of these records.
pub fn read(station: &Arc<Station>, records: Vec<(String, PathBuf)>) {
    let due = station.page.summaries.due(records, station.now());
    if due.is_empty() {
        return;
    }
    let station = Arc::clone(station);
    spawn_blocking(move || {
        for (scan, folder) in due {
            let told = told(&revision::latest(&folder), station.config.language);
            station.page.summaries.note(scan, folder, told, station.now());
        }
        station.page.summaries.inner().is_reading = false;
        station.page.feed.refresh();
    });
}

fn told(folder: &Path, language: Language) -> Told {
    let is_there = |name: &&str| folder.join(name).is_file();
    let record = record(&folder.join("record.json"));
    Told {
        measures: record.map(|record| RecordSummary::of(&record, language)),
        files: FILES.iter().map(|file| file.name).filter(is_there).collect(),
        unmeasured: None,
    }
}

fn record(path: &Path) -> Option<Record> {
    let mut bytes = Vec::new();
    File::open(path).ok()?.take(RECORD_MOST).read_to_end(&mut bytes).ok()?;
    serde_json::from_slice(&bytes).ok()
}
