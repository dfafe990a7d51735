//! Metrics, health and the operator's page over HTTP, on an address of this machine or a socket that
//! the service manager has opened for us, and the page for reading on another. No client
//! holds up the others: a connection that waits for its own client makes room, monitors have places of
//! their own, and a request that comes while a disk stands still is told so.

mod connections;
mod listeners;
mod shared_look;

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::{StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::{sleep, timeout};
use tracing::{info, warn};

pub use self::connections::Connection;
use self::connections::Connections;
pub use self::listeners::Listeners;
pub use self::shared_look::SharedLook;
use super::metrics;
use super::overview::Overview;
use super::page::{self, HttpEndpoint, Way};
use crate::station::assembly::Station;
use crate::station::stop::Stop;

/// So many requests are answered at a time; further ones wait.
const MOST_SERVED: usize = 16;

/// So many of those that monitors make, beside the others.
const MOST_MONITORS: usize = 4;

/// A request's head has come by then, or never will.
const HEAD_TIME: Duration = Duration::from_secs(5);

/// A connection carries one request, and is over by then.
const CONNECTION_TIME: Duration = Duration::from_secs(30);

/// The longest head of a request, bytes: hyper would keep 400 kB for each connection.
const HEAD_MOST: usize = 64 * 1024;

/// The pause before the address is tried again where it cannot be had.
const RETRY: Duration = Duration::from_secs(10);

/// The pause where no connection can be taken in, for want of file descriptors say.
const SHORT_OF_FILES: Duration = Duration::from_millis(200);

/// How long those are waited for who have connected when the endpoint closes.
const SAY_IT: Duration = Duration::from_millis(200);

/// What monitors ask for.
const METRICS: &str = "/metrics";
const HEALTH: &str = "/healthz";

/// Serves the endpoints where the service manager or else the configuration says, until it is asked to
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

/// Keeps one endpoint open.
async fn keep(station: &Arc<Station>, way: Way, mut stop: Stop) {
    let mut was_unavailable = false;
    while !stop.is_requested() {
        match station.lasting.listeners.take(&station.config, way) {
            Ok(Some((listener, address))) => {
                info!(event = "http-listening", way = way.word(), port = address.port());
                station.board.note(|facts| drop(facts.endpoints.remove(way.word())));
                let (station, asked) = (Arc::clone(station), stop.clone());
                let endpoint = spawn_blocking(move || {
                    HttpEndpoint::open(&station, way, address, was_unavailable, asked)
                });
                // It does not panic.
                let Ok(endpoint) = endpoint.await else { return };
                serve(&endpoint, &listener, &mut stop).await;
            }
            Ok(None) => {
                station.board.note(|facts| drop(facts.endpoints.remove(way.word())));
                stop.requested().await;
            }
            Err(error) => {
                if !std::mem::replace(&mut was_unavailable, true) {
                    warn!(event = "http-unavailable", way = way.word(), %error);
                }
                station
                    .board
                    .note(|facts| drop(facts.endpoints.insert(way.word(), error.to_string())));
                tokio::select! {
                    () = stop.requested() => {}
                    () = sleep(RETRY) => {}
                }
            }
        }
    }
}

/// Serves until a stop is asked for. Answers in hand are given after it.
async fn serve(endpoint: &Arc<HttpEndpoint>, listener: &TcpListener, stop: &mut Stop) {
    let station = Arc::clone(endpoint.station());
    let monitors = Monitors { station, overview: Arc::default() };
    let monitors =
        Router::new().route(METRICS, get(metrics)).route(HEALTH, get(healthz)).with_state(monitors);
    let places = Places {
        others: Arc::new(Semaphore::new(MOST_SERVED)),
        monitors: Arc::new(Semaphore::new(MOST_MONITORS)),
    };
    let pages = page::routes(endpoint, monitors).layer(from_fn_with_state(places, attended));
    let connections = Arc::new(Connections::default());
    loop {
        let accepted = tokio::select! {
            () = stop.requested() => break,
            accepted = listener.accept() => accepted,
        };
        let Ok((stream, peer)) = accepted else {
            // A hot loop would free none.
            connections.close_idle();
            sleep(SHORT_OF_FILES).await;
            continue;
        };
        if let Some(connection) = connections.admit(peer.ip()) {
            tokio::spawn(attend(stream, pages.clone(), connection, stop.clone()));
        }
    }
    // Who came last says what he wants at once.
    sleep(SAY_IT).await;
    connections.close_idle();
    // What is decided must be decided before another generation begins.
    let _ = timeout(HEAD_TIME, connections.all_are_served()).await;
}

/// Carries one connection to its end.
async fn attend(stream: TcpStream, pages: Router, connection: Arc<Connection>, stop: Stop) {
    let pages = TowerToHyperService::new(pages.layer(Extension(Arc::clone(&connection))));
    let mut http = http1::Builder::new();
    http.keep_alive(false).timer(TokioTimer::new()).header_read_timeout(HEAD_TIME);
    http.max_buf_size(HEAD_MOST);
    tokio::select! {
        // A client that goes away or says nothing has its answer already.
        _ = http.serve_connection(TokioIo::new(stream), pages) => {}
        () = connection.must_close() => {}
        () = over(&connection, stop) => {}
    }
}

/// Ends when a connection has lasted long enough: a stream lasts as long as the station.
async fn over(connection: &Connection, mut stop: Stop) {
    sleep(CONNECTION_TIME).await;
    if connection.is_stream() {
        stop.requested().await;
        // It ends by itself, unless its reader takes nothing.
        sleep(HEAD_TIME).await;
    }
}

/// How many requests are answered at a time. Those of monitors wait for no others.
#[derive(Debug, Clone)]
struct Places {
    others: Arc<Semaphore>,
    monitors: Arc<Semaphore>,
}

/// Answers a request that has come whole, when there is a place.
async fn attended(
    State(places): State<Places>,
    Extension(connection): Extension<Arc<Connection>>,
    request: Request,
    next: Next,
) -> Response {
    let of_monitor = [METRICS, HEALTH].contains(&request.uri().path());
    connection.is_served();
    let place = if of_monitor { places.monitors } else { places.others }.acquire_owned().await;
    let response = next.run(request).await;
    drop(place);
    connection.is_answered();
    response
}

/// What monitors ask.
#[derive(Debug, Clone)]
struct Monitors {
    station: Arc<Station>,
    overview: Arc<SharedLook<Arc<Overview>>>,
}

impl Monitors {
    /// An overview; none where the disk of the state folder does not answer.
    async fn overview(&self) -> Option<Arc<Overview>> {
        let station = Arc::clone(&self.station);
        self.overview.of(move || Arc::new(Overview::take(&station))).await
    }
}

/// The code of a station that does not come to tell how it is.
const NO_ANSWER: &str = "state-disk-stalled";

async fn metrics(State(monitors): State<Monitors>) -> Response {
    let Some(overview) = monitors.overview().await else { return no_answer() };
    match metrics::text(&overview) {
        Ok(text) => ([(header::CONTENT_TYPE, metrics::CONTENT_TYPE)], text).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

/// 200 and "ready", or 503 and the codes of what is wrong, one a line.
async fn healthz(State(monitors): State<Monitors>) -> Response {
    match monitors.overview().await {
        Some(overview) if overview.complaints.is_empty() => "ready\n".into_response(),
        Some(overview) => {
            let codes = overview.complaints.iter().map(|complaint| format!("{}\n", complaint.code));
            (StatusCode::SERVICE_UNAVAILABLE, codes.collect::<String>()).into_response()
        }
        None => no_answer(),
    }
}

fn no_answer() -> Response {
    (StatusCode::SERVICE_UNAVAILABLE, format!("{NO_ANSWER}\n")).into_response()
}
