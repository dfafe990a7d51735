//! Errors of the journal that leave open whether it is damaged: it is checked then. A sound journal that
//! refuses a statement is no reason to give it up; that is a defect of gaiter, or somebody else's doing.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use jiff::Timestamp;
use tokio::sync::Notify;
use tracing::{error, warn};

use crate::flow::facts::Alarm;
use crate::station::assembly::Station;
use crate::station::error::chain;

/// How soon after a check another is made: it reads the whole journal.
pub const PAUSE: Duration = Duration::from_secs(60);

/// The alarm of a sound journal that refuses what the station asks of it.
const REFUSES: &str = "journal-refuses";

/// The last of these errors, until the journal is checked.
#[derive(Debug, Default)]
pub struct Suspicion {
    last: Mutex<Option<String>>,
    news: Notify,
}

impl Suspicion {
    /// There was such an error.
    pub fn tell(&self, error: String) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
        self.news.notify_one();
    }

    /// Ends when there has been one since the last check.
    pub async fn told(&self) {
        self.news.notified().await;
    }

    fn taken(&self) -> Option<String> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Checks the journal after such an error. Blocks.
pub fn look_into(station: &Station) {
    let Some(why) = station.suspicion.taken() else { return };
    match station.custody.journal().check() {
        Ok(()) => {
            error!(event = "journal-refuses", error = why);
            let message = format!("the journal is sound and refuses a statement: {why}");
            let alarm = Alarm { message, since: Timestamp::now() };
            station.board.note(|facts| _ = facts.alarms.entry(REFUSES).or_insert(alarm));
        }
        Err(fault) => {
            warn!(event = "journal-failed", error = chain(&fault));
            if fault.is_ruin() {
                station.ruin.notify_one();
            }
        }
    }
}
