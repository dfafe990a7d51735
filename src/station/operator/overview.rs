//! The station at one moment, put together from board, journal and disk.

use std::time::Duration;

use jiff::Timestamp;

use crate::flow::Facts;
use crate::flow::health::{Backlog, Complaint, complaints};
use crate::station::assembly::Station;
use crate::station::custody::state_folders;
use crate::station::journal::Tally;

/// What is known at one moment.
#[derive(Debug, Clone)]
pub struct Overview {
    /// What the workers know.
    pub facts: Facts,
    /// What the journal holds; none where it cannot be read.
    pub tally: Option<Tally>,
    /// Room on the disk of the state folder; none where it cannot be told.
    pub disk: Option<Disk>,
    /// What keeps the station from being ready.
    pub complaints: Vec<Complaint>,
    /// How long the station has been running.
    pub running: Duration,
    /// The moment.
    pub now: Timestamp,
}

/// A disk's room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Disk {
    /// Free for the station, bytes.
    pub free: u64,
    /// Its size, bytes.
    pub size: u64,
}

impl Overview {
    /// Looks now. Folders of the state that somebody removed are made anew first, for what is told counts
    /// from then on. Blocks, on the local disk only.
    pub fn take(station: &Station) -> Overview {
        state_folders::look_after(station);
        let (facts, now) = (station.board.facts(), Timestamp::now());
        let tally = station.custody.journal().tally();
        let tally = tally.inspect_err(|error| station.check_corruption(error)).ok();
        let found = match &tally {
            None => vec![Complaint::journal()],
            Some(tally) => {
                let oldest = tally.oldest.as_ref().map(|seen| seen.first_seen);
                let backlog = Backlog { pending: pending(tally), oldest };
                complaints(&facts, &backlog, station.config.status.overdue, now)
            }
        };
        let disk = rustix::fs::statvfs(&station.config.station.state_dir).ok().map(|found| Disk {
            free: found.f_bavail.saturating_mul(found.f_frsize),
            size: found.f_blocks.saturating_mul(found.f_frsize),
        });
        let running = station.running();
        Overview { facts, tally, disk, complaints: found, running, now }
    }

    /// How many records are to be delivered; zero where the journal cannot say.
    pub fn pending(&self) -> u64 {
        self.tally.as_ref().map_or(0, pending)
    }
}

/// Deliveries to be made.
fn pending(tally: &Tally) -> u64 {
    let pending = tally.deliveries.iter().filter(|((_, state), _)| state == "pending");
    pending.map(|(_, count)| count).sum()
}
