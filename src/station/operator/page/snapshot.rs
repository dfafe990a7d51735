//! The station as the page shows it, at one moment.

use std::path::PathBuf;

use gaiter_flow::account::{Search, Whole};
use gaiter_flow::page::{self, ScanDetails, ScanShown, Shown, Situation, StationView};
use gaiter_flow::{Disposition, ScanId, Task};
use gaiter_record::SheetLine;
use jiff::{SignedDuration, Timestamp};

use super::desk::Desk;
use super::{assets, summaries};
use crate::station::delivery::preview::Preview;
use crate::station::journal::JournalError;
use crate::station::overview::Overview;
use crate::store::FolderStore;

/// How many of the last scans are shown: what fits a screen.
const LAST: u32 = 12;

/// How many scans that wait for a decision are shown. More than that cannot be handled by clicks.
const UNDECIDED: u32 = 20;

/// How long measures that a record lacks are asked for: then the patient is gone, and the record lists what it
/// lacks.
const COMPLETED_WITHIN: SignedDuration = SignedDuration::from_hours(24);

/// Takes a snapshot. Blocks, on the local disk only: details of records come from the summaries. The second
/// value names the records that the summaries should read, by the key of their row.
pub fn take(desk: &Desk) -> (Shown, Vec<(String, PathBuf)>) {
    let overview = Overview::take(&desk.core);
    desk.booth.who_is_next(|booth| whole_page(desk, &overview, booth))
}

fn whole_page(
    desk: &Desk,
    overview: &Overview,
    booth: Situation<'_>,
) -> (Shown, Vec<(String, PathBuf)>) {
    let core = &desk.core;
    let language = core.config.language;
    let journal = core.custody.journal();
    let measured_since = overview.now.saturating_sub(COMPLETED_WITHIN);
    let measured_since = measured_since.unwrap_or(Timestamp::MIN);
    let waiting = rows(desk, journal.open_tasks(UNDECIDED, measured_since));
    let newest = rows(desk, journal.newest(LAST + UNDECIDED));
    let mut records = Vec::new();
    let mut show = |row: &Whole| {
        records.extend(folder(desk, row).map(|folder| (row_name(row), folder)));
        scan(desk, row)
    };
    // A scan is in one list only: what waits for a decision is above.
    let needs = |row: &Whole| match row.task() {
        Task::Decide => true,
        Task::Complete => row.summary.first_seen >= measured_since,
        Task::Nothing => false,
    };
    let undecided: Vec<ScanShown> =
        waiting.iter().filter(|row| needs(row)).map(&mut show).collect();
    let decided = newest.iter().filter(|row| !needs(row));
    let scans = decided.take(LAST as usize).map(&mut show).collect();
    let count = core.read(journal.count_open_tasks(measured_since));
    let more = count.unwrap_or_default().saturating_sub(undecided.len() as u64);
    let version = assets::version(language);
    let known = StationView {
        page: version,
        station: &core.config.station.id,
        facts: &overview.facts,
        complaints: &overview.complaints,
        booth,
        now: overview.now,
    };
    (page::assemble(&known, undecided, more, scans, language), records)
}

/// The rows of these scans.
fn rows(desk: &Desk, ids: Result<Vec<ScanId>, JournalError>) -> Vec<Whole> {
    let journal = desk.core.custody.journal();
    let wholes = ids.and_then(|ids| {
        let wholes = ids.iter().map(|id| journal.whole(id));
        wholes.filter_map(Result::transpose).collect::<Result<Vec<Whole>, _>>()
    });
    let wholes = desk.core.read(wholes).unwrap_or_default();
    wholes.into_iter().flat_map(page::rows::rows).collect()
}

/// Identifies the row of a scan.
fn row_name(row: &Whole) -> String {
    format!("{}{}", row.scan, page::row_key(row).unwrap_or_default())
}

fn scan(desk: &Desk, row: &Whole) -> ScanShown {
    let details = folder(desk, row).and_then(|folder| desk.summaries.of(&row_name(row), &folder));
    scan_row(desk, row, details.unwrap_or_default())
}

/// The row of a scan with the details of its record.
fn scan_row(desk: &Desk, row: &Whole, mut details: ScanDetails) -> ScanShown {
    if let Some(Preview::Impossible(code)) = preview(desk, row) {
        details.unmeasured = Some(code);
    }
    let unfetched = desk.core.board.unfetched();
    details.is_to_be_fetched = row.disposition() == Disposition::Spooled
        && row.has_record()
        && !row.is_in_work(&unfetched);
    page::scan_shown(row, &details, desk.core.config.language)
}

/// The scans that a search finds, without details of their records, and whether there are more. Blocks, on
/// the local disk only.
pub fn found(desk: &Desk, search: &Search) -> (Vec<ScanShown>, bool) {
    let ids = desk.core.custody.journal().search(search);
    let has_more = ids.as_ref().is_ok_and(|ids| ids.len() > search.limit as usize);
    let ids = ids.map(|ids| ids.into_iter().take(search.limit as usize).collect());
    let details = ScanDetails::default;
    (rows(desk, ids).iter().map(|row| scan_row(desk, row, details())).collect(), has_more)
}

/// The rows of one scan with the details of their records. Blocks as long as the store does.
pub fn one(desk: &Desk, scan: &ScanId) -> Vec<ScanShown> {
    let config = &desk.core.config;
    let details = |row: &Whole| {
        let folder = folder(desk, row)?;
        Some(summaries::read(&folder, config.language, &config.garment))
    };
    let rows = rows(desk, Ok(vec![scan.clone()]));
    rows.iter().map(|row| scan_row(desk, row, details(row).unwrap_or_default())).collect()
}

/// Every measure of the record of a scan's row with this key. Blocks as long as the store does.
pub fn sheet(desk: &Desk, scan: &ScanId, key: Option<&str>) -> Vec<SheetLine> {
    let folder = row(desk, scan, key).and_then(|row| folder(desk, &row));
    let config = &desk.core.config;
    let sheet = |folder: PathBuf| summaries::sheet(&folder, config.language, &config.garment);
    folder.map(sheet).unwrap_or_default()
}

/// The row of a scan with this key; without a key, its only row.
pub fn row(desk: &Desk, scan: &ScanId, key: Option<&str>) -> Option<Whole> {
    let mut rows = rows(desk, Ok(vec![scan.clone()]));
    match key {
        Some(key) => rows.into_iter().find(|row| page::row_key(row).as_deref() == Some(key)),
        None if rows.len() == 1 => rows.pop(),
        // A held scan's preview, or an unassigned record, belongs to no patient who has a record.
        None => rows.into_iter().find(|row| page::row_key(row).is_none()),
    }
}

/// The folder of the record that can be opened from a row, if any; otherwise the preview of a held
/// scan.
pub fn folder(desk: &Desk, row: &Whole) -> Option<PathBuf> {
    let record = page::record_folder(row, FolderStore::FIRST).map(PathBuf::from);
    record.or_else(|| match preview(desk, row) {
        Some(Preview::Made(folder)) => Some(folder),
        _ => None,
    })
}

/// What is known about the legs of a held scan.
fn preview(desk: &Desk, row: &Whole) -> Option<Preview> {
    let scan = ScanId::parse(&row.scan).filter(|_| row.disposition() == Disposition::Held)?;
    desk.previews.get(&scan)
}
