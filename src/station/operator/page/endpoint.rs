//! One endpoint of the page, and what its clients may do.

use std::net::SocketAddr;
use std::sync::Arc;

use axum::http::{HeaderMap, StatusCode};
use gaiter_flow::ScanId;
use tokio::sync::Semaphore;
use tokio::task::spawn_blocking;

use super::desk::{Desk, Texts};
use crate::station::operator::http::listeners::Way;
use crate::station::operator::http::shared_look::SharedLook;
use crate::station::overview::Overview;
use crate::station::runtime::Stop;

/// The number of streams served at once at each endpoint; later readers poll.
const MOST_STREAMS: usize = 8;

/// The query that the kiosk sends.
const KIOSK: &str = "kiosk";

/// A listener, and what it serves to its clients.
#[derive(Debug)]
pub struct HttpEndpoint {
    /// The desk behind it.
    pub desk: Arc<Desk>,
    pub(in crate::station::operator) way: Way,
    /// `None` at the control socket.
    pub(super) address: Option<SocketAddr>,
    pub(super) streams: Arc<Semaphore>,
    pub(super) state: SharedLook<Option<Texts>>,
    /// What the requests of monitors share.
    pub(in crate::station::operator) overview: SharedLook<Arc<Overview>>,
    pub(super) stop: Stop,
}

impl HttpEndpoint {
    /// Opens an endpoint. If another program had its address, browsers may have sent it the token, so the
    /// token is renewed. Blocks, on the local disk.
    pub fn open(
        desk: &Arc<Desk>,
        way: Way,
        address: Option<SocketAddr>,
        was_lost: bool,
        stop: Stop,
    ) -> Arc<HttpEndpoint> {
        if let (Way::Local, Some(address)) = (way, address) {
            desk.is_served_at(address, was_lost);
        }
        let streams = Arc::new(Semaphore::new(MOST_STREAMS));
        let (state, overview) = (SharedLook::default(), SharedLook::default());
        let desk = Arc::clone(desk);
        Arc::new(HttpEndpoint { desk, way, address, streams, state, overview, stop })
    }

    /// Whether a reader holds the station's token, or is let in by the control socket.
    fn is_operator(&self, headers: &HeaderMap) -> bool {
        let token = self.desk.token().filter(|_| self.way == Way::Local);
        self.way == Way::Control
            || token.is_some_and(|it| it.is_shown_in(headers) || it.is_read_with(headers))
    }

    /// Whether a reader may know whose scans these are. A kiosk does not count as an operator, even if
    /// an operator opened it, because everyone can see it.
    pub(super) fn shows_ids(&self, headers: &HeaderMap, query: Option<&str>) -> bool {
        let is_kiosk = query == Some(KIOSK);
        self.desk.core.config.page.ids.to(!is_kiosk && self.is_operator(headers))
    }

    /// Reads something of the scan with this id, on a thread that may block, for a reader who may see whose scan it
    /// is; else the status of the answer.
    pub(super) async fn of_scan<T: Send + 'static>(
        &self,
        scan: &str,
        headers: &HeaderMap,
        read: impl FnOnce(&Desk, &ScanId) -> T + Send + 'static,
    ) -> Result<T, StatusCode> {
        let scan = ScanId::parse(scan).ok_or(StatusCode::NOT_FOUND)?;
        if !self.shows_ids(headers, None) {
            return Err(StatusCode::FORBIDDEN);
        }
        let desk = Arc::clone(&self.desk);
        // A store that does not answer holds a few readers and no more.
        let reader = Arc::clone(&desk.readers).try_acquire_owned();
        let reader = reader.map_err(|_| StatusCode::SERVICE_UNAVAILABLE)?;
        let read = spawn_blocking(move || {
            let _reader = reader;
            read(&desk, &scan)
        });
        read.await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)
    }
}
