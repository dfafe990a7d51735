//! Details of scans from records and previews, read in the background: a store that does not answer delays
//! the measures, but never the page.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use gaiter_flow::page::ScanDetails;
use gaiter_flow::page::files::in_order;
use gaiter_language::Language;
use gaiter_record::{self as record, Record, RecordSummary, SheetLine};
use gaiter_sizes::Garment;

use crate::station::runtime::locked;
use crate::store::{revision, sums};

/// A summary is read again after this time: a report may have been made since.
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
    known: BTreeMap<String, CachedSummary>,
    /// A thread is reading, or hangs on the store.
    is_reading: bool,
}

#[derive(Debug)]
struct CachedSummary {
    folder: PathBuf,
    details: ScanDetails,
    at: Duration,
    /// The record was amended since.
    is_old: bool,
}

impl Summaries {
    /// What is known about a scan's record in this folder.
    pub fn of(&self, scan: &str, folder: &Path) -> Option<ScanDetails> {
        let inner = locked(&self.0);
        let known = inner.known.get(scan).filter(|known| known.folder == folder);
        known.map(|known| known.details.clone())
    }

    /// Has every record read again: a person has just amended one.
    pub fn read_again(&self) {
        let mut inner = locked(&self.0);
        inner.known.values_mut().for_each(|known| known.is_old = true);
    }

    /// Forgets all other records. Returns those to be read, or none while a thread is reading.
    pub fn due(&self, records: Vec<(String, PathBuf)>, now: Duration) -> Vec<(String, PathBuf)> {
        let mut inner = locked(&self.0);
        inner.known.retain(|scan, _| records.iter().any(|(wanted, _)| wanted == scan));
        if inner.is_reading {
            return Vec::new();
        }
        let is_due = |(scan, folder): &(String, PathBuf)| {
            inner.known.get(scan).is_none_or(|known| {
                let lasts = if known.details.measures.is_some() { FRESH } else { AGAIN };
                known.is_old || known.folder != *folder || now.saturating_sub(known.at) > lasts
            })
        };
        let due: Vec<(String, PathBuf)> = records.into_iter().filter(is_due).collect();
        inner.is_reading = !due.is_empty();
        due
    }

    /// Notes that the records that were due have been read.
    pub fn all_read(&self) {
        locked(&self.0).is_reading = false;
    }

    /// Notes the details of a scan's record in this folder, read at the time `now` of the station's clock.
    pub fn note(&self, scan: String, folder: PathBuf, details: ScanDetails, now: Duration) {
        let summary = CachedSummary { folder, details, at: now, is_old: false };
        locked(&self.0).known.insert(scan, summary);
    }
}

/// The details of the record in this folder, or of its latest revision. Blocks as long as the store does.
pub fn read(folder: &Path, language: Language, garment: &Garment) -> ScanDetails {
    let folder = revision::latest(folder);
    let record = record(&folder.join("record.json"));
    ScanDetails {
        measures: record.map(|record| RecordSummary::from_record(&record, language, garment)),
        files: names(&folder),
        ..ScanDetails::default()
    }
}

/// Every measure of the record in this folder, or of its latest revision; empty if it cannot be read. Blocks
/// as long as the store does.
pub fn sheet(folder: &Path, language: Language, garment: &Garment) -> Vec<SheetLine> {
    let record = record(&revision::latest(folder).join("record.json"));
    record.map(|record| record::sheet(&record, language, garment)).unwrap_or_default()
}

/// The names of the files of a record or preview, in the order in which the page shows them.
fn names(folder: &Path) -> Vec<String> {
    let listed = sums::listed(folder).unwrap_or_default();
    let sums = (!listed.is_empty()).then(|| sums::SUMS.to_owned());
    in_order(listed.into_iter().chain(sums).collect())
}

fn record(path: &Path) -> Option<Record> {
    let mut bytes = Vec::new();
    File::open(path).ok()?.take(RECORD_MOST).read_to_end(&mut bytes).ok()?;
    serde_json::from_slice(&bytes).ok()
}
