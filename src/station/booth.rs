//! The station's side of the booth: takes what the ports hear, and tells them what the light shows.

use tokio::sync::watch;
use tracing::info;

use crate::flow::booth::{Heard, Signal};

/// Where ports tell what they hear and read what the light shows.
#[derive(Debug)]
pub struct Booth {
    signal: watch::Sender<Signal>,
}

impl Booth {
    /// A booth whose light shows that the station is ready.
    pub fn new() -> Booth {
        Booth { signal: watch::Sender::new(Signal::Ready) }
    }

    /// Takes what a port has heard. Blocks for a write to the journal.
    pub fn hear(&self, heard: &Heard) {
        match heard {
            Heard::Press(_) => info!(event = "pressed"),
            Heard::Named { .. } => info!(event = "patient-named"),
        }
    }

    /// What the light shows, now and whenever it changes.
    pub fn signal(&self) -> watch::Receiver<Signal> {
        self.signal.subscribe()
    }
}
