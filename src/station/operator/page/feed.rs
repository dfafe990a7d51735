//! The last snapshot, for all readers.

use std::sync::Arc;

use tokio::sync::{Notify, watch};

/// A snapshot as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Texts {
    /// For readers who may know whose scans these are.
    pub with_ids: Arc<str>,
    /// For all other readers.
    pub without_ids: Arc<str>,
}

impl Texts {
    /// The text for a reader.
    pub fn of(&self, shows_ids: bool) -> String {
        if shows_ids { self.with_ids.to_string() } else { self.without_ids.to_string() }
    }
}

/// The last snapshot, `None` without readers, and the signals for the next.
#[derive(Debug)]
pub struct Feed {
    texts: watch::Sender<Option<Texts>>,
    first_reader: Notify,
    refresh: Notify,
}

impl Default for Feed {
    fn default() -> Feed {
        Feed {
            texts: watch::Sender::new(None),
            first_reader: Notify::new(),
            refresh: Notify::new(),
        }
    }
}

impl Feed {
    /// Subscribes to the snapshots from now on.
    pub fn subscribe(&self) -> watch::Receiver<Option<Texts>> {
        let texts = self.texts.subscribe();
        self.first_reader.notify_one();
        texts
    }

    /// Notes that something has changed that an operator waits for.
    pub fn refresh(&self) {
        self.refresh.notify_one();
    }

    /// Whether there are readers.
    pub fn has_readers(&self) -> bool {
        self.texts.receiver_count() > 0
    }

    /// Forgets the last snapshot, so that the next reader does not see an old one.
    pub fn forget(&self) {
        self.texts.send_replace(None);
    }

    /// Returns when a reader subscribes.
    pub async fn first_reader(&self) {
        self.first_reader.notified().await;
    }

    /// Returns when something has changed that an operator waits for.
    pub async fn refreshed(&self) {
        self.refresh.notified().await;
    }

    /// Sends a snapshot to all readers if it differs from the last.
    pub fn publish(&self, texts: Texts) {
        self.texts.send_if_modified(|last| {
            let is_new = last.as_ref() != Some(&texts);
            *last = Some(texts);
            is_new
        });
    }
}
