//! The board on which workers note what they know, for those who ask.

use std::sync::{Mutex, PoisonError};

use crate::flow::Facts;

/// The present facts of a station.
#[derive(Debug)]
pub struct Board(Mutex<Facts>);

impl Board {
    /// A board that shows these facts.
    pub fn new(facts: Facts) -> Board {
        Board(Mutex::new(facts))
    }

    /// Changes the facts; short, for everybody else waits.
    pub fn note(&self, change: impl FnOnce(&mut Facts)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// The facts as they are now.
    pub fn facts(&self) -> Facts {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
