//! Journal errors that may or may not mean damage. They trigger a check. An intact journal that refuses
//! a statement is not given up: the cause is a bug in gaiter or a change made by another program.

use std::sync::{Mutex, PoisonError};

use tokio::sync::Notify;

/// The last such error, until the journal is checked.
#[derive(Debug, Default)]
pub struct Suspicion {
    last: Mutex<Option<String>>,
    news: Notify,
}

impl Suspicion {
    /// Reports such an error.
    pub fn tell(&self, error: String) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
        self.news.notify_one();
    }

    /// Completes when an error has been reported since the last check.
    pub async fn told(&self) {
        self.news.notified().await;
    }

    /// Takes the last error.
    pub fn taken(&self) -> Option<String> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}
