//! What an operator can reach: the station's core, booth and previews, and what else the page needs.

use std::net::SocketAddr;
use std::sync::{Arc, OnceLock};

use tokio::sync::{Notify, Semaphore, watch};
use tracing::warn;

use super::summaries::Summaries;
use super::token::Token;
use crate::station::booth::Booth;
use crate::station::core::Core;
use crate::station::delivery::preview::Previews;
use crate::station::runtime::chain;

/// The number of record files read at once: a share that does not answer blocks no more threads.
const MOST_READERS: usize = 4;

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

/// The operator's desk.
#[derive(Debug)]
pub struct Desk {
    /// What all workers share.
    pub core: Arc<Core>,
    /// The button, the readers of ids and the light.
    pub booth: Arc<Booth>,
    /// The previews of held scans.
    pub previews: Arc<Previews>,
    /// The last snapshot, for all readers; `None` without readers.
    pub(super) texts: watch::Sender<Option<Texts>>,
    /// Notified when a reader subscribes, and when something has changed that an operator waits for.
    pub(super) refresh: Notify,
    pub(in crate::station::operator) summaries: Summaries,
    pub(super) readers: Arc<Semaphore>,
    /// Where the page is served, and the token needed to decide there.
    local: OnceLock<(SocketAddr, Token)>,
}

impl Desk {
    /// Creates a desk whose page is not served yet.
    pub fn new(core: Arc<Core>, booth: Arc<Booth>, previews: Arc<Previews>) -> Desk {
        Desk {
            core,
            booth,
            previews,
            texts: watch::Sender::new(None),
            refresh: Notify::new(),
            summaries: Summaries::default(),
            readers: Arc::new(Semaphore::new(MOST_READERS)),
            local: OnceLock::new(),
        }
    }

    /// The link that opens the page with its token; `None` if no page is served.
    pub fn link(&self) -> Option<String> {
        self.local.get().map(|(local, token)| format!("http://{local}/#token={}", token.word()))
    }

    /// The token needed to decide on the page; `None` if no page is served.
    pub(super) fn token(&self) -> Option<&Token> {
        self.local.get().map(|(_, token)| token)
    }

    /// Notes that the page is served at this address of the machine. Its token is read from the state
    /// folder, created if there is none, or renewed. Blocks, on the local disk. Without a token the
    /// page is read-only.
    pub(super) fn is_served_at(&self, address: SocketAddr, renews_token: bool) {
        let state_dir = &self.core.config.station.state_dir;
        match if renews_token { Token::renew(state_dir) } else { Token::take(state_dir) } {
            Ok(token) => _ = self.local.set((address, token)),
            Err(error) => warn!(event = "page-token-failed", error = chain(&error)),
        }
    }
}
