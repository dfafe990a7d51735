//! Takes the snapshot for all readers: when something has changed, and never without readers.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use gaiter_flow::Facts;
use tokio::task::spawn_blocking;
use tokio::time::sleep;

use super::desk::{Desk, Texts};
use super::{snapshot, summaries};
use crate::station::booth::BoothState;
use crate::station::runtime::Stop;

/// How often to check for changes; people do not notice a shorter delay.
const PACE: Duration = Duration::from_millis(400);

/// A snapshot is taken again after this time even without a change: some faults grow with time alone.
const ANEW: Duration = Duration::from_secs(5);

/// What a snapshot depends on, apart from summaries and previews, which tell of their changes; cheap to read.
#[derive(PartialEq)]
struct Ground {
    journal: Option<i64>,
    facts: Facts,
    booth: BoothState,
}

impl Ground {
    /// Blocks, on the local disk only.
    fn new(desk: &Desk) -> Ground {
        let core = &desk.core;
        Ground {
            journal: core.custody.journal().edition(),
            facts: core.board.facts(),
            booth: desk.booth.state(),
        }
    }
}

/// The current snapshot; `None` if it could not be taken. Blocks, on the local disk only.
pub fn texts(desk: &Arc<Desk>) -> Option<Texts> {
    let (shown, records) = snapshot::take(desk);
    read_summaries(desk, records);
    let with_ids = serde_json::to_string(&shown).ok()?;
    let without_ids = serde_json::to_string(&shown.without_ids()).ok()?;
    Some(Texts { with_ids: with_ids.into(), without_ids: without_ids.into() })
}

/// Reads in the background what is not known about these records.
fn read_summaries(desk: &Arc<Desk>, records: Vec<(String, PathBuf)>) {
    let due = desk.summaries.due(records, desk.core.now());
    if due.is_empty() {
        return;
    }
    let desk = Arc::clone(desk);
    spawn_blocking(move || {
        let config = &desk.core.config;
        for (scan, folder) in due {
            let details = summaries::read(&folder, config.language, &config.garment);
            desk.summaries.note(scan, folder, details, desk.core.now());
        }
        desk.summaries.all_read();
        desk.refresh.notify_one();
    });
}

/// Takes snapshots while there are readers, until asked to stop.
pub async fn worker(desk: &Arc<Desk>, mut stop: Stop) {
    let mut signal = desk.booth.signal();
    let (mut ground, mut taken) = (None, Duration::ZERO);
    while !stop.is_requested() {
        if desk.texts.receiver_count() == 0 {
            // The next reader must not see an old one.
            desk.texts.send_replace(None);
            ground = None;
            tokio::select! {
                () = stop.requested() => return,
                () = desk.refresh.notified() => continue,
            }
        }
        let looked = Arc::clone(desk);
        let found = spawn_blocking(move || Ground::new(&looked)).await.ok();
        let now = desk.core.now();
        if found != ground || now - taken >= ANEW {
            (ground, taken) = (found, now);
            let looked = Arc::clone(desk);
            if let Some(texts) = spawn_blocking(move || texts(&looked)).await.ok().flatten() {
                desk.texts.send_if_modified(|last| {
                    let is_new = last.as_ref() != Some(&texts);
                    *last = Some(texts);
                    is_new
                });
            }
        }
        tokio::select! {
            () = stop.requested() => return,
            () = sleep(PACE) => {}
            _ = signal.changed() => {}
            () = desk.refresh.notified() => ground = None,
            () = desk.previews.changed() => ground = None,
        }
    }
}
