//! Tells the archive each minute how the station is. It has a connection of its own, and waits for nothing else as nothing
//! waits for it: what cannot be told now is told the next minute.

use std::error::Error;
use std::sync::Arc;
use std::time::Duration;

use gaiter_https::Bucket;
use gaiter_record::archive::{self, Document, StationId};
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;
use tracing::{info, warn};

use super::core::Core;
use super::overview::Overview;
use super::runtime::{Heartbeat, Stop, chain, random_unit};
use crate::store::ArchiveStore;
use crate::store::archive::ArchivePlace;

/// How often the archive is told.
const EVERY: Duration = Duration::from_secs(60);

/// By up to this share of it sooner: stations that started together, or whose archive was away, do not stay together.
const JITTER_SHARE: f64 = 0.2;

/// Tells the archive how the station is until asked to stop.
///
/// # Errors
/// If a look at the station, or the telling, panicked.
pub async fn worker(
    core: Arc<Core>,
    archive: ArchivePlace,
    beat: Heartbeat,
    mut stop: Stop,
) -> Result<(), JoinError> {
    let bucket = Arc::new(archive.bucket());
    let mut is_told = true;
    while !stop.is_requested() {
        let (core, station) = (Arc::clone(&core), archive.station.clone());
        let taken = spawn_blocking(move || told(&Overview::take(&core), station));
        let heartbeat = beat.during(taken).await?;
        let bucket = Arc::clone(&bucket);
        let sent = spawn_blocking(move || send(&bucket, &heartbeat));
        tokio::select! {
            // A stop does not wait for a server.
            () = stop.requested() => break,
            sent = beat.during(sent) => note(&sent?, &mut is_told),
        }
        let pause = EVERY.mul_f64(1.0 - JITTER_SHARE * random_unit());
        tokio::select! {
            () = stop.requested() => break,
            () = beat.during(sleep(pause)) => {}
        }
    }
    Ok(())
}

/// What the archive is told of a station.
fn told(overview: &Overview, station: StationId) -> archive::Heartbeat {
    let tally = overview.tally.as_ref();
    let scans = tally.into_iter().flat_map(|tally| &tally.dispositions);
    let oldest = tally.and_then(|tally| tally.oldest.get(ArchiveStore::NAME));
    let last_check = overview.facts.phantom.as_ref().and_then(|phantom| phantom.checks.last());
    archive::Heartbeat {
        schema: archive::Heartbeat::SCHEMA.to_owned(),
        station,
        at: overview.now,
        gaiter: env!("CARGO_PKG_VERSION").to_owned(),
        is_ready: overview.is_ready(),
        scans: scans.map(|(is, count)| ((*is).to_owned(), *count)).collect(),
        oldest_undelivered: oldest.map(|seen| seen.first_seen),
        phantom_bias_mm: last_check.and_then(|check| check.bias_mm),
    }
}

/// Nothing, or why the archive was not told.
type Sent = Result<(), Box<dyn Error + Send + Sync>>;

fn send(bucket: &Bucket, heartbeat: &archive::Heartbeat) -> Sent {
    Ok(bucket.put(&heartbeat.key().to_string(), heartbeat.json()?)?)
}

/// Logs where an outage begins and where it ends.
fn note(sent: &Sent, is_told: &mut bool) {
    match sent {
        Ok(()) if !*is_told => info!(event = "heartbeat-sent-again"),
        Err(fault) if *is_told => warn!(event = "heartbeat-not-sent", error = chain(&**fault)),
        Ok(()) | Err(_) => {}
    }
    *is_told = sent.is_ok();
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use gaiter_flow::Facts;
    use gaiter_flow::account::Seen;
    use gaiter_flow::facts::PhantomFacts;
    use gaiter_flow::lifecycle::ScanState;
    use gaiter_record::phantom::{CheckResult, LastCheck};
    use jiff::Timestamp;

    use super::*;
    use crate::station::journal::Tally;

    fn at(second: i64) -> Timestamp {
        Timestamp::from_second(1_800_000_000 + second).unwrap()
    }

    fn seen(second: i64) -> Seen {
        Seen { scan: "12345678".to_owned(), first_seen: at(second), state: ScanState::Spooled }
    }

    #[test]
    fn the_archive_is_told_what_waits_for_it_and_how_far_the_phantom_was_off() {
        let mut facts = Facts::new(at(0), 1);
        let check = LastCheck {
            at: at(5),
            result: CheckResult::Beyond,
            bias_mm: Some(1.5),
            worst_mm: Some(2.5),
            tolerance_mm: 2.0,
        };
        facts.phantom = Some(PhantomFacts { every: EVERY, checks: vec![check] });
        let tally = Tally {
            dispositions: BTreeMap::from([("stored", 7), ("refused", 2)]),
            oldest: BTreeMap::from([("archive".to_owned(), seen(9)), ("fhir".to_owned(), seen(1))]),
            ..Tally::default()
        };
        let (tally, disk, running, now) = (Some(tally), None, Duration::ZERO, at(60));
        let overview = Overview { facts, tally, disk, complaints: Vec::new(), running, now };
        let heartbeat = told(&overview, StationId::parse("house-booth-1").unwrap());
        assert_eq!(heartbeat.oldest_undelivered, Some(at(9)));
        assert_eq!(heartbeat.phantom_bias_mm, Some(1.5));
        assert_eq!(heartbeat.scans["refused"], 2);
        assert!(heartbeat.is_ready);
        assert_eq!(heartbeat.key().to_string(), "fleet/house-booth-1.json");
    }
}
