//! The operator's page: what the station is, live, and what a person can decide there.
//!
//! ```text
//! journal, board, booth ─ snapshot ─▶ feed ─▶ /state, /stream ─▶ page.js
//! record folders, previews ─ summaries ──┘
//! page.js ─▶ /ask ─ guard, token ─▶ control::answer
//! ```
//!
//! One task takes the snapshot for everybody, and only while somebody looks. A slow
//! reader of a stream delays no other.

mod ask;
mod assets;
mod feed;
mod files;
mod guard;
mod snapshot;
mod stream;
mod summaries;
mod token;

use std::net::SocketAddr;
use std::sync::{Arc, OnceLock};

use axum::Router;
use axum::extract::{RawQuery, State};
use axum::http::HeaderMap;
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use tokio::sync::Semaphore;
use tracing::warn;

use self::feed::{Feed, Texts};
use self::summaries::Summaries;
use self::token::Token;
use super::http::SharedLook;
use crate::config::Config;
use crate::station::assembly::Station;
use crate::station::error::chain;
use crate::station::stop::Stop;
pub use feed::worker;
pub use files::FILES;

/// So many streams are served at a time at each endpoint; later readers poll.
const MOST_STREAMS: usize = 8;

/// So many files of records are read at a time: a share that does not answer holds up no more.
const MOST_READERS: usize = 4;

/// The query by which the kiosk asks.
const KIOSK: &str = "kiosk";

/// What the page needs of a station besides its parts.
#[derive(Debug)]
pub struct Desk {
    feed: Feed,
    summaries: Summaries,
    token: OnceLock<Token>,
    local: OnceLock<SocketAddr>,
    readers: Arc<Semaphore>,
}

impl Default for Desk {
    fn default() -> Desk {
        Desk {
            feed: Feed::default(),
            summaries: Summaries::default(),
            token: OnceLock::new(),
            local: OnceLock::new(),
            readers: Arc::new(Semaphore::new(MOST_READERS)),
        }
    }
}

impl Desk {
    /// The link that opens the page with its token; none where no page is served.
    pub fn link(&self) -> Option<String> {
        let (token, local) = (self.token.get()?, self.local.get()?);
        Some(format!("http://{local}/#token={}", token.word()))
    }

    /// Something has changed that a person waits for.
    pub fn refresh(&self) {
        self.feed.refresh();
    }

    /// Takes the token from the state folder, made where there is none, or made anew. Blocks, on the
    /// local disk. Without one the page is for reading only.
    fn take_token(&self, config: &Config, is_new: bool) {
        let state_dir = &config.station.state_dir;
        match if is_new { Token::renew(state_dir) } else { Token::take(state_dir) } {
            Ok(token) => _ = self.token.set(token),
            Err(error) => warn!(event = "page-token-failed", error = chain(&error)),
        }
    }
}

/// Through which endpoint somebody comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Way {
    /// From this machine: reads, and decides with the token.
    Local,
    /// From the local network: reads.
    Network,
}

impl Way {
    /// Its word in the log.
    pub fn word(self) -> &'static str {
        match self {
            Way::Local => "local",
            Way::Network => "network",
        }
    }
}

/// A listener, and what those find who come through it.
#[derive(Debug)]
pub struct HttpEndpoint {
    station: Arc<Station>,
    way: Way,
    address: SocketAddr,
    streams: Arc<Semaphore>,
    state: Arc<SharedLook<Option<Texts>>>,
    stop: Stop,
}

impl HttpEndpoint {
    /// A endpoint at this address. Where another program had the address, browsers may have sent it
    /// the token, so a new one holds from now on. Blocks, on the local disk.
    pub fn open(
        station: &Arc<Station>,
        way: Way,
        address: SocketAddr,
        was_lost: bool,
        stop: Stop,
    ) -> Arc<HttpEndpoint> {
        if way == Way::Local {
            station.page.take_token(&station.config, was_lost);
            _ = station.page.local.set(address);
        }
        let streams = Arc::new(Semaphore::new(MOST_STREAMS));
        let state = Arc::default();
        Arc::new(HttpEndpoint { station: Arc::clone(station), way, address, streams, state, stop })
    }

    /// Whose endpoint it is.
    pub fn station(&self) -> &Arc<Station> {
        &self.station
    }

    /// Whether a reader holds the station's token.
    fn is_operator(&self, headers: &HeaderMap) -> bool {
        let token = self.station.page.token.get().filter(|_| self.way == Way::Local);
        token.is_some_and(|token| token.is_shown_in(headers) || token.is_read_with(headers))
    }

    /// Whether a reader may know whose scans these are. The kiosk hangs where everybody sees it,
    /// also where an operator opened it.
    fn shows_ids(&self, headers: &HeaderMap, query: Option<&str>) -> bool {
        let is_kiosk = query == Some(KIOSK);
        self.station.config.page.ids.to(!is_kiosk && self.is_operator(headers))
    }
}

/// What is served at a endpoint; `others` are pages for monitors, which are for this machine only.
pub fn routes(endpoint: &Arc<HttpEndpoint>, others: Router) -> Router {
    let read = Router::new()
        .route("/state", get(state))
        .route("/stream", get(stream::stream))
        .route("/scan/{scan}/{file}", get(files::file))
        .merge(assets::routes(endpoint));
    let routes = match endpoint.way {
        Way::Local => {
            let act = Router::new().route("/ask", post(ask::ask)).route("/enter", post(ask::enter));
            read.merge(act).with_state(Arc::clone(endpoint)).merge(others)
        }
        Way::Network => read.with_state(Arc::clone(endpoint)),
    };
    routes.layer(from_fn_with_state(Arc::clone(endpoint), guard::guard))
}

/// The snapshot of this moment.
async fn state(
    State(endpoint): State<Arc<HttpEndpoint>>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Response {
    let shows_ids = endpoint.shows_ids(&headers, query.as_deref());
    let station = Arc::clone(&endpoint.station);
    match endpoint.state.of(move || feed::texts(&station)).await.flatten() {
        Some(texts) => ([assets::JSON], texts.of(shows_ids)).into_response(),
        None => axum::http::StatusCode::SERVICE_UNAVAILABLE.into_response(),
    }
}
