//! The board on which workers note what they know, for others to read.

use std::collections::BTreeSet;
use std::sync::Mutex;

use gaiter_flow::Facts;
use gaiter_flow::complaint::ComplaintFigures;
use gaiter_flow::facts::Alarm;
use jiff::Timestamp;

use super::runtime::locked;

/// The current facts of a station.
#[derive(Debug)]
pub struct Board(Mutex<Facts>);

impl Board {
    /// A board that shows these facts.
    pub fn new(facts: Facts) -> Board {
        Board(Mutex::new(facts))
    }

    /// Changes the facts or reads some of them. `change` must be short, because everyone else waits.
    pub fn note<T>(&self, change: impl FnOnce(&mut Facts) -> T) -> T {
        change(&mut locked(&self.0))
    }

    /// Raises an alarm. One that is raised already keeps its time and gets these figures. Returns whether it is new.
    pub fn raise(&self, code: &'static str, figures: ComplaintFigures) -> bool {
        self.note(|facts| {
            let known = facts.alarms.get(code).map(|known| known.since);
            let since = known.unwrap_or_else(Timestamp::now);
            facts.alarms.insert(code, Alarm { figures, since }).is_none()
        })
    }

    /// Ends an alarm. Returns whether it was raised.
    pub fn clear(&self, code: &str) -> bool {
        self.note(|facts| facts.alarms.remove(code).is_some())
    }

    /// The stores that wait until somebody fetches what they have.
    pub fn unfetched(&self) -> BTreeSet<&'static str> {
        self.note(|facts| facts.unfetched())
    }

    /// The current facts.
    pub fn facts(&self) -> Facts {
        self.note(|facts| facts.clone())
    }
}
