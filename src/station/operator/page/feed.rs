//! The snapshot for everybody who looks: one task takes it, when something has changed, and none
//! while nobody looks.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{Notify, watch};
use tokio::task::spawn_blocking;
use tokio::time::sleep;

use super::{snapshot, summaries};
use crate::flow::Facts;
use crate::station::assembly::Station;
use crate::station::booth::BoothState;
use crate::station::stop::Stop;

/// How often it is looked whether something has changed; a person sees no shorter delay.
const PACE: Duration = Duration::from_millis(400);

/// A snapshot is taken anew after this time even if nothing has: some faults grow with time alone.
const ANEW: Duration = Duration::from_secs(5);

/// A snapshot as text, for those who may know whose scans these are, and for all others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Texts {
    with_ids: Arc<str>,
    without_ids: Arc<str>,
}

impl Texts {
    /// The text for a reader.
    pub fn of(&self, shows_ids: bool) -> String {
        if shows_ids { self.with_ids.to_string() } else { self.without_ids.to_string() }
    }
}

/// The last snapshot, none while nobody looks, and those who wait for the next.
#[derive(Debug)]
pub struct Feed {
    texts: watch::Sender<Option<Texts>>,
    somebody: Notify,
    refresh: Notify,
}

impl Default for Feed {
    fn default() -> Feed {
        Feed { texts: watch::Sender::new(None), somebody: Notify::new(), refresh: Notify::new() }
    }
}

impl Feed {
    /// The snapshots from now on.
    pub fn subscribe(&self) -> watch::Receiver<Option<Texts>> {
        let texts = self.texts.subscribe();
        self.somebody.notify_one();
        texts
    }

    /// Something has changed that a person waits for.
    pub fn refresh(&self) {
        self.refresh.notify_one();
    }
}

/// What a snapshot hangs on, cheap to ask.
#[derive(PartialEq)]
struct Ground {
    journal: u64,
    summaries: u64,
    previews: u64,
    facts: Facts,
    booth: BoothState,
}

impl Ground {
    /// Blocks for as long as somebody writes to the journal.
    fn of(station: &Station) -> Ground {
        Ground {
            journal: station.custody.journal().changes(),
            summaries: station.page.summaries.edition(),
            previews: station.previews.edition(),
            facts: station.board.facts(),
            booth: station.booth.state(station.now()),
        }
    }
}

/// The snapshot of this moment; none where it could not be taken. Blocks, on the local disk only.
pub fn texts(station: &Arc<Station>) -> Option<Texts> {
    let (shown, records) = snapshot::take(station);
    summaries::read(station, records);
    let with_ids = serde_json::to_string(&shown).ok()?;
    let without_ids = serde_json::to_string(&shown.without_ids()).ok()?;
    Some(Texts { with_ids: with_ids.into(), without_ids: without_ids.into() })
}

async fn now(station: &Arc<Station>) -> Option<Texts> {
    let looked = Arc::clone(station);
    spawn_blocking(move || texts(&looked)).await.ok()?
}

/// Takes snapshots while somebody looks, until it is asked to stop.
pub async fn worker(station: &Arc<Station>, mut stop: Stop) {
    let feed = &station.page.feed;
    let mut signal = station.booth.signal();
    let (mut ground, mut taken) = (None, Duration::ZERO);
    while !stop.is_requested() {
        if feed.texts.receiver_count() == 0 {
            // The next reader is not to see an old one.
            feed.texts.send_replace(None);
            ground = None;
            tokio::select! {
                () = stop.requested() => return,
                () = feed.somebody.notified() => continue,
            }
        }
        let looked = Arc::clone(station);
        let found = spawn_blocking(move || Ground::of(&looked)).await.ok();
        if found != ground || station.now() - taken >= ANEW {
            (ground, taken) = (found, station.now());
            if let Some(texts) = now(station).await {
                feed.texts.send_if_modified(|last| {
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
            () = feed.refresh.notified() => {}
        }
    }
}
