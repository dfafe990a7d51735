//! The station as the page shows it, at one moment.

use std::path::PathBuf;

use super::assets;
use crate::flow::ScanId;
use crate::flow::account::Whole;
use crate::flow::page::{self, Known, ScanShown, Shown};
use crate::station::assembly::Station;
use crate::station::delivery::preview::Preview;
use crate::station::journal::JournalError;
use crate::station::operator::overview::Overview;

/// How many of the last scans are shown: what fits a screen.
const LAST: u32 = 12;

/// How many scans that wait for a decision are shown. More of them are no matter of clicks.
const UNDECIDED: u32 = 20;

/// The store whose folders the page reads.
pub const STORE: &str = "folder";

/// Looks now. Blocks, on the local disk only: what records say comes from the summaries, and the second
/// value names the records that they should read.
pub fn take(station: &Station) -> (Shown, Vec<(String, PathBuf)>) {
    let overview = Overview::take(station);
    let who_is_next = station.who_is_next();
    let journal = station.custody.journal();
    let (mut records, of_list) = (Vec::new(), |ids: Result<Vec<ScanId>, JournalError>| {
        let wholes = ids.and_then(|ids| {
            let wholes = ids.iter().map(|id| journal.whole(id));
            wholes.filter_map(Result::transpose).collect::<Result<Vec<Whole>, _>>()
        });
        let wholes =
            wholes.inspect_err(|error| station.check_corruption(error)).unwrap_or_default();
        let shown: Vec<ScanShown> = wholes.iter().map(|whole| scan(station, whole)).collect();
        (wholes, shown)
    });
    let (held, undecided) = of_list(journal.undecided(UNDECIDED));
    let (last, scans) = of_list(journal.newest(LAST));
    for whole in held.iter().chain(&last) {
        records.extend(folder(station, whole).map(|folder| (whole.scan.clone(), folder)));
    }
    let waiting = overview
        .tally
        .as_ref()
        .map_or(0, |tally| tally.held + tally.scans.get("refused").copied().unwrap_or_default());
    let more = waiting.saturating_sub(undecided.len() as u64);
    let version = assets::version(station.config.language);
    let known = Known {
        page: &version,
        station: &station.config.station.id,
        facts: &overview.facts,
        complaints: &overview.complaints,
        booth: who_is_next.situation(),
        now: overview.now,
    };
    (page::shown(&known, undecided, more, scans, station.config.language), records)
}

fn scan(station: &Station, whole: &Whole) -> ScanShown {
    let told =
        folder(station, whole).and_then(|folder| station.page.summaries.of(&whole.scan, &folder));
    let mut told = told.unwrap_or_default();
    if let Some(Preview::Impossible(code)) = preview(station, whole) {
        told.unmeasured = Some(code);
    }
    page::scan_shown(whole, &told, station.config.language)
}

/// The folder of the record that may be opened from a scan, if there is one; of a held scan else that
/// of its preview.
pub fn folder(station: &Station, whole: &Whole) -> Option<PathBuf> {
    let record = page::record_folder(whole, STORE).map(PathBuf::from);
    record.or_else(|| match preview(station, whole) {
        Some(Preview::Made(folder)) => Some(folder),
        _ => None,
    })
}

/// What is known of the legs of a held scan.
fn preview(station: &Station, whole: &Whole) -> Option<Preview> {
    let scan = ScanId::parse(&whole.scan).ok().filter(|_| page::is_held(whole))?;
    station.previews.get(&scan)
}
