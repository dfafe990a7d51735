//! Metrics, health and the operator's page over HTTP, on an address of this machine or a socket that
//! the service manager has opened for us, and the page for reading on another. As with the control
//! socket, whoever hangs on it holds up only his like.

use std::io;
use std::net::SocketAddr;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use listenfd::ListenFd;
use rustix::io::{FdFlags, fcntl_setfd};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;
use tracing::{info, warn};

use super::assembly::Station;
use super::metrics;
use super::overview::Overview;
use super::page::{self, Connection, Door, Way};
use super::stop::Stop;
use crate::config::Config;

/// So many connections are served at a time; further ones wait in the kernel.
const MOST_CLIENTS: usize = 16;

/// A request's head has come by then, or never will.
const HEAD_TIME: Duration = Duration::from_secs(5);

/// A connection carries one request, and is over by then.
const CONNECTION_TIME: Duration = Duration::from_secs(30);

/// The pause before the address is tried again where it cannot be had.
const RETRY: Duration = Duration::from_secs(10);

/// Serves the doors where the service manager or else the configuration says, until it is asked to
/// stop.
///
/// # Errors
/// None; the type is that of all workers.
pub async fn worker(station: Arc<Station>, stop: Stop) -> Result<(), JoinError> {
    let local = keep(&station, Way::Local, stop.clone());
    let network = keep(&station, Way::Network, stop.clone());
    tokio::join!(local, network, page::worker(&station, stop.clone()));
    Ok(())
}

/// Keeps one door open.
async fn keep(station: &Arc<Station>, way: Way, mut stop: Stop) {
    let mut said = false;
    while !stop.is_requested() {
        match listen(&station.config, way).await {
            Ok(Some((listener, address))) => {
                info!(event = "http-listening", way = way.word(), port = address.port());
                let (station, asked) = (Arc::clone(station), stop.clone());
                let door = spawn_blocking(move || Door::open(&station, way, address, asked)).await;
                // It does not panic.
                let Ok(door) = door else { return };
                serve(&door, &listener, &mut stop).await;
            }
            Ok(None) => stop.requested().await,
            Err(error) => {
                if !std::mem::replace(&mut said, true) {
                    warn!(event = "http-unavailable", way = way.word(), %error);
                }
                tokio::select! {
                    () = stop.requested() => {}
                    () = sleep(RETRY) => {}
                }
            }
        }
    }
}

/// A door's listener and its address; none where nobody wants it.
async fn listen(config: &Config, way: Way) -> io::Result<Option<(TcpListener, SocketAddr)>> {
    let wanted = match way {
        Way::Local => config.status.listen,
        Way::Network => config.page.network,
    };
    let listener = match (given(config, way)?, wanted) {
        (Some(given), _) => given,
        (None, Some(address)) => TcpListener::bind(address).await?,
        (None, None) => return Ok(None),
    };
    let address = listener.local_addr()?;
    Ok(Some((listener, address)))
}

/// The sockets that the service manager has passed to this process. They are kept: a reload begins
/// anew with workers, not with the process.
static PASSED: OnceLock<Vec<std::net::TcpListener>> = OnceLock::new();

/// The one of these sockets that is this door's, if there is one. An address that other machines can
/// reach must be that of the configuration, where somebody has thought about it.
fn given(config: &Config, way: Way) -> io::Result<Option<TcpListener>> {
    let passed = PASSED.get_or_init(|| {
        let mut passed = ListenFd::from_env();
        (0..passed.len()).filter_map(|at| passed.take_tcp_listener(at).ok().flatten()).collect()
    });
    for listener in passed {
        // Children that measure have no business with it.
        fcntl_setfd(listener, FdFlags::CLOEXEC)?;
        let address = listener.local_addr()?;
        let its_way = match address.ip().is_loopback() {
            true => Way::Local,
            false if config.page.network == Some(address) => Way::Network,
            false => {
                let message = "the socket unit listens on an address that other machines can reach, \
                               and page.network is another";
                return Err(io::Error::new(io::ErrorKind::AddrNotAvailable, message));
            }
        };
        if its_way == way {
            listener.set_nonblocking(true)?;
            return TcpListener::from_std(listener.try_clone()?).map(Some);
        }
    }
    Ok(None)
}

async fn serve(door: &Arc<Door>, listener: &TcpListener, stop: &mut Stop) {
    let clients = Arc::new(Semaphore::new(MOST_CLIENTS));
    let monitors = Router::new()
        .route("/metrics", get(metrics))
        .route("/healthz", get(healthz))
        .with_state(Arc::clone(door.station()));
    let pages = page::routes(door, monitors);
    loop {
        let accepted = tokio::select! {
            () = stop.requested() => return,
            accepted = next(&clients, listener) => accepted,
        };
        let Ok((stream, permit)) = accepted else {
            // No file descriptors are left; a hot loop would not free any.
            sleep(HEAD_TIME).await;
            continue;
        };
        let connection = Connection::new(permit);
        let pages = pages.clone().layer(Extension(connection.clone()));
        let pages = TowerToHyperService::new(pages);
        let stop = stop.clone();
        tokio::spawn(async move {
            let mut http = http1::Builder::new();
            http.keep_alive(false).timer(TokioTimer::new()).header_read_timeout(HEAD_TIME);
            tokio::select! {
                // A client that goes away or says nothing has its answer already.
                _ = http.serve_connection(TokioIo::new(stream), pages) => {}
                () = over(connection, stop) => {}
            }
        });
    }
}

/// Ends when a connection has lasted long enough: a stream lasts as long as the station.
async fn over(connection: Connection, mut stop: Stop) {
    sleep(CONNECTION_TIME).await;
    if connection.is_stream() {
        stop.requested().await;
        // It ends by itself, unless its reader takes nothing.
        sleep(HEAD_TIME).await;
    }
}

async fn next(
    clients: &Arc<Semaphore>,
    listener: &TcpListener,
) -> io::Result<(TcpStream, OwnedSemaphorePermit)> {
    let permit = Arc::clone(clients).acquire_owned().await.map_err(io::Error::other)?;
    Ok((listener.accept().await?.0, permit))
}

/// An overview taken on a thread that may block.
async fn overview(station: Arc<Station>) -> Result<Overview, StatusCode> {
    let taken = spawn_blocking(move || Overview::take(&station)).await;
    taken.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)
}

async fn metrics(State(station): State<Arc<Station>>) -> Response {
    let text = overview(station).await.and_then(|overview| {
        metrics::text(&overview).map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)
    });
    match text {
        Ok(text) => ([(header::CONTENT_TYPE, metrics::CONTENT_TYPE)], text).into_response(),
        Err(status) => status.into_response(),
    }
}

/// 200 and "ready", or 503 and the codes of what is wrong, one a line.
async fn healthz(State(station): State<Arc<Station>>) -> Response {
    match overview(station).await {
        Ok(overview) if overview.complaints.is_empty() => "ready\n".into_response(),
        Ok(overview) => {
            let codes = overview.complaints.iter().map(|complaint| format!("{}\n", complaint.code));
            (StatusCode::SERVICE_UNAVAILABLE, codes.collect::<String>()).into_response()
        }
        Err(status) => status.into_response(),
    }
}
