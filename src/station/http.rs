//! Metrics and health over HTTP, on an address of this machine or a socket that the service manager
//! has opened for us. As with the control socket, whoever hangs on it holds up only his like.

use std::io;
use std::net::SocketAddr;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use axum::Router;
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use listenfd::ListenFd;
use rustix::io::{FdFlags, fcntl_setfd};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::{sleep, timeout};
use tracing::{info, warn};

use super::assembly::Station;
use super::metrics;
use super::overview::Overview;
use super::stop::Stop;

/// So many connections are served at a time; further ones wait in the kernel.
const MOST_CLIENTS: usize = 16;

/// A request's head has come by then, or never will.
const HEAD_TIME: Duration = Duration::from_secs(5);

/// A connection carries one request, and is over by then.
const CONNECTION_TIME: Duration = Duration::from_secs(30);

/// The pause before the address is tried again where it cannot be had.
const RETRY: Duration = Duration::from_secs(10);

/// Serves where the service manager or else the configuration says, until it is asked to stop.
///
/// # Errors
/// None; the type is that of all workers.
pub async fn worker(station: Arc<Station>, mut stop: Stop) -> Result<(), JoinError> {
    let mut said = false;
    while !stop.is_requested() {
        let listened = match given() {
            Ok(None) => match station.config.status.listen {
                Some(address) => TcpListener::bind(address).await.map(Some),
                None => Ok(None),
            },
            given => given,
        };
        match listened {
            Ok(Some(listener)) => {
                info!(event = "http-listening", port = port(&listener));
                serve(&station, &listener, &mut stop).await;
            }
            Ok(None) => stop.requested().await,
            Err(error) => {
                if !std::mem::replace(&mut said, true) {
                    warn!(event = "http-unavailable", %error);
                }
                tokio::select! {
                    () = stop.requested() => {}
                    () = sleep(RETRY) => {}
                }
            }
        }
    }
    Ok(())
}

/// The socket that the service manager has passed to this process. It is kept: a reload begins
/// anew with workers, not with the process.
static PASSED: OnceLock<Option<std::net::TcpListener>> = OnceLock::new();

/// That socket, if there is one.
fn given() -> io::Result<Option<TcpListener>> {
    let take = || ListenFd::from_env().take_tcp_listener(0).ok().flatten();
    let Some(listener) = PASSED.get_or_init(take) else { return Ok(None) };
    // Children that measure have no business with it.
    fcntl_setfd(listener, FdFlags::CLOEXEC)?;
    if !listener.local_addr()?.ip().is_loopback() {
        let message = "the socket unit listens on an address that other machines can reach";
        return Err(io::Error::new(io::ErrorKind::AddrNotAvailable, message));
    }
    listener.set_nonblocking(true)?;
    TcpListener::from_std(listener.try_clone()?).map(Some)
}

fn port(listener: &TcpListener) -> Option<u16> {
    listener.local_addr().ok().as_ref().map(SocketAddr::port)
}

async fn serve(station: &Arc<Station>, listener: &TcpListener, stop: &mut Stop) {
    let clients = Arc::new(Semaphore::new(MOST_CLIENTS));
    let pages = Router::new()
        .route("/metrics", get(metrics))
        .route("/healthz", get(healthz))
        .with_state(Arc::clone(station));
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
        let pages = TowerToHyperService::new(pages.clone());
        tokio::spawn(async move {
            let _permit = permit;
            let mut http = http1::Builder::new();
            http.keep_alive(false).timer(TokioTimer::new()).header_read_timeout(HEAD_TIME);
            // A client that goes away or says nothing has its answer already.
            let _ =
                timeout(CONNECTION_TIME, http.serve_connection(TokioIo::new(stream), pages)).await;
        });
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
