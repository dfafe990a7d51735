//! The station at one moment, from board, journal and disk.

use std::collections::BTreeMap;
use std::time::Duration;

use gaiter_flow::Facts;
use gaiter_flow::account::Seen;
use gaiter_flow::complaint::Complaint;
use gaiter_flow::health::{Backlog, complaints};
use gaiter_https::tls;
use jiff::Timestamp;

use crate::station::core::Core;
use crate::station::custody::state_folders;
use crate::station::journal::Tally;
use crate::store::RecordStore;

/// What is known at one moment.
#[derive(Debug, Clone)]
pub struct Overview {
    /// What the workers know.
    pub facts: Facts,
    /// What the journal holds; `None` if it cannot be read.
    pub tally: Option<Tally>,
    /// Room on the disk of the state folder; `None` if unknown.
    pub disk: Option<Disk>,
    /// Why the station is not ready, and what a person should know.
    pub complaints: Vec<Complaint>,
    /// How long the station has been running.
    pub running: Duration,
    pub now: Timestamp,
}

/// The room on a disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Disk {
    /// Free for the station, bytes.
    pub free: u64,
    /// Its size, bytes.
    pub size: u64,
}

impl Overview {
    /// Takes an overview now. Removed state folders are created again first, because the answer counts
    /// from then on. Blocks, on the local disk only.
    pub fn take(core: &Core) -> Overview {
        state_folders::look_after(&core.custody, &core.board);
        let (facts, now) = (core.board.facts(), Timestamp::now());
        let tally = core.read(core.custody.journal().tally());
        let disk = rustix::fs::statvfs(&core.config.station.state_dir).ok().map(|found| Disk {
            free: found.f_bavail.saturating_mul(found.f_frsize),
            size: found.f_blocks.saturating_mul(found.f_frsize),
        });
        let running = core.clock.running();
        let mut overview = Overview { facts, tally, disk, complaints: Vec::new(), running, now };
        overview.complaints = match &overview.tally {
            None => vec![Complaint::journal()],
            Some(tally) => {
                let backlog = Backlog {
                    pending: overview.pending(),
                    oldest: overview.oldest().map(|seen| seen.first_seen),
                    revisions_refused: tally.revisions_refused,
                    moved: tally.moved.clone(),
                    certificates: certificates(core),
                };
                complaints(&overview.facts, &backlog, core.config.status.overdue, now)
            }
        };
        overview
    }

    /// What keeps the station from being ready.
    pub fn faults(&self) -> impl Iterator<Item = &Complaint> {
        self.complaints.iter().filter(|complaint| complaint.is_fault())
    }

    /// Whether scans become records.
    pub fn is_ready(&self) -> bool {
        self.faults().next().is_none()
    }

    /// The scan that has waited longest for its record in a store other than those that wait to be fetched from.
    pub fn oldest(&self) -> Option<&Seen> {
        let unfetched = self.facts.unfetched();
        let waiting = self.tally.as_ref()?.oldest.iter();
        let awaited = waiting.filter(|(store, _)| !unfetched.contains(store.as_str()));
        awaited.map(|(_, seen)| seen).min_by_key(|seen| seen.first_seen)
    }

    /// How many records are to be delivered; zero if the journal cannot be read.
    pub fn pending(&self) -> u64 {
        let deliveries = self.tally.iter().flat_map(|tally| &tally.deliveries);
        let pending = deliveries.filter(|((_, state), _)| state == "pending");
        pending.map(|(_, count)| count).sum()
    }
}

/// Until when the certificates hold that the station shows to servers. One that cannot be read is a fault of its store.
fn certificates(core: &Core) -> BTreeMap<String, Timestamp> {
    let of = |store: &dyn RecordStore| {
        let until = tls::holds_until(store.own_certificate()?).ok()??;
        Some((store.name().to_owned(), until))
    };
    core.stores.iter().filter_map(of).collect()
}
