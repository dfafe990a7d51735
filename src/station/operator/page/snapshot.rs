//! The station as the page shows it, at one moment.

use std::path::PathBuf;

use super::assets;
use super::desk::Desk;
use crate::flow::ScanId;
use crate::flow::account::Whole;
use crate::flow::page::{self, Known, ScanShown, Shown};
use crate::station::delivery::preview::Preview;
use crate::station::journal::JournalError;
use crate::station::overview::Overview;

/// How many of the last scans are shown: what fits a screen.
const LAST: u32 = 12;

/// How many scans that wait for a decision are shown. More than that cannot be handled by clicks.
const UNDECIDED: u32 = 20;

/// The store whose folders the page reads.
pub const STORE: &str = "folder";

/// Takes a snapshot. Blocks, on the local disk only: what records say comes from the summaries. The
/// second value names the records that the summaries should read.
pub fn take(desk: &Desk) -> (Shown, Vec<(String, PathBuf)>) {
    let core = &desk.core;
    let overview = Overview::take(core);
    let who_is_next = desk.booth.who_is_next();
    let journal = core.custody.journal();
    let (mut records, of_list) = (Vec::new(), |ids: Result<Vec<ScanId>, JournalError>| {
        let wholes = ids.and_then(|ids| {
            let wholes = ids.iter().map(|id| journal.whole(id));
            wholes.filter_map(Result::transpose).collect::<Result<Vec<Whole>, _>>()
        });
        let wholes = wholes.inspect_err(|error| core.check_corruption(error)).unwrap_or_default();
        let shown: Vec<ScanShown> = wholes.iter().map(|whole| scan(desk, whole)).collect();
        (wholes, shown)
    });
    let (held, undecided) = of_list(journal.undecided(UNDECIDED));
    let (last, scans) = of_list(journal.newest(LAST));
    for whole in held.iter().chain(&last) {
        records.extend(folder(desk, whole).map(|folder| (whole.scan.clone(), folder)));
    }
    let waiting = overview
        .tally
        .as_ref()
        .map_or(0, |tally| tally.held + tally.scans.get("refused").copied().unwrap_or_default());
    let more = waiting.saturating_sub(undecided.len() as u64);
    let version = assets::version(desk.core.config.language);
    let known = Known {
        page: &version,
        station: &core.config.station.id,
        facts: &overview.facts,
        complaints: &overview.complaints,
        booth: who_is_next.situation(),
        now: overview.now,
    };
    (page::shown(&known, undecided, more, scans, desk.core.config.language), records)
}

fn scan(desk: &Desk, whole: &Whole) -> ScanShown {
    let told = folder(desk, whole).and_then(|folder| desk.summaries.of(&whole.scan, &folder));
    let mut told = told.unwrap_or_default();
    if let Some(Preview::Impossible(code)) = preview(desk, whole) {
        told.unmeasured = Some(code);
    }
    page::scan_shown(whole, &told, desk.core.config.language)
}

/// The folder of the record that can be opened from a scan, if any; otherwise the preview of a held
/// scan.
pub fn folder(desk: &Desk, whole: &Whole) -> Option<PathBuf> {
    let record = page::record_folder(whole, STORE).map(PathBuf::from);
    record.or_else(|| match preview(desk, whole) {
        Some(Preview::Made(folder)) => Some(folder),
        _ => None,
    })
}

/// What is known about the legs of a held scan.
fn preview(desk: &Desk, whole: &Whole) -> Option<Preview> {
    let scan = ScanId::parse(&whole.scan).ok().filter(|_| page::is_held(whole))?;
    desk.previews.get(&scan)
}
