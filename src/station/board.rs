//! The board on which workers note what they know, for others to read.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use gaiter_flow::Facts;

/// The current facts of a station.
#[derive(Debug)]
pub struct Board(Mutex<Facts>);

impl Board {
    /// A board that shows these facts.
    pub fn new(facts: Facts) -> Board {
        Board(Mutex::new(facts))
    }

    /// Changes the facts. `change` must be short, because everyone else waits.
    pub fn note(&self, change: impl FnOnce(&mut Facts)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// The stores that wait until somebody fetches what they have.
    pub fn unfetched(&self) -> BTreeSet<&'static str> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).unfetched()
    }

    /// Whether one of these ports is not listened to, and will not be in a moment.
    pub fn is_any_port_at_fault(&self, ports: &BTreeSet<&'static str>) -> bool {
        let facts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        ports.iter().filter_map(|port| facts.triggers.get(port)).any(|port| port.state.is_fault())
    }

    /// The current facts.
    pub fn facts(&self) -> Facts {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
