//! Metrics, health and the operator's page over HTTP, on an address of this machine or on a socket that
//! the service manager has opened; and a read-only page on another address. No client holds up the
//! others: a connection that waits for its own client makes room, monitors have their own places, and a
//! request that arrives while a disk hangs gets an answer that says so.

mod changeover;
pub mod connections;
pub mod listeners;
pub mod shared_look;

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::{StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Router};
use gaiter_flow::cause::Cause;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::{sleep, timeout};
use tracing::{info, warn};

use self::connections::{Connection, Connections};
use self::listeners::{Listeners, Way};
use self::shared_look::SharedLook;
use super::metrics;
use super::page::desk::Desk;
use super::page::endpoint::HttpEndpoint;
use super::page::{self, publish};
use crate::station::core::Core;
use crate::station::overview::Overview;
use crate::station::runtime::stop::Stop;

/// The number of requests answered at once; further ones wait.
const MOST_SERVED: usize = 16;

/// The number of monitor requests answered at once, in addition to the others.
const MOST_MONITORS: usize = 4;

/// How long the head of a request may take to arrive.
const HEAD_TIME: Duration = Duration::from_secs(5);

/// How long a connection may last; it carries one request.
const CONNECTION_TIME: Duration = Duration::from_secs(30);

/// The longest head of a request, bytes; hyper's default would keep 400 kB for each connection.
const HEAD_MOST: usize = 64 * 1024;

/// The pause before the address is tried again after a failure.
const RETRY: Duration = Duration::from_secs(10);

/// The pause if no connection can be accepted, for example for lack of file descriptors.
const SHORT_OF_FILES: Duration = Duration::from_millis(200);

/// How long a closing endpoint waits for the requests of clients that have connected.
const SAY_IT: Duration = Duration::from_millis(200);

/// The paths that monitors request.
const METRICS: &str = "/metrics";
const HEALTH: &str = "/healthz";

/// Serves the endpoints at the addresses of the service manager, or else of the configuration, until
/// asked to stop.
///
/// # Errors
/// None; all workers have this type.
pub async fn worker(
    desk: Arc<Desk>,
    listeners: Arc<Listeners>,
    stop: Stop,
) -> Result<(), JoinError> {
    let local = keep(&desk, &listeners, Way::Local, stop.clone());
    let network = keep(&desk, &listeners, Way::Network, stop.clone());
    tokio::join!(local, network, publish::worker(&desk, stop.clone()));
    Ok(())
}

/// Keeps one endpoint open.
async fn keep(desk: &Arc<Desk>, listeners: &Listeners, way: Way, mut stop: Stop) {
    let core = &desk.core;
    let mut was_unavailable = false;
    while !stop.is_requested() {
        match listeners.take(&core.config, way).await {
            Ok(Some((listener, address))) => {
                let (desk, asked) = (Arc::clone(desk), stop.clone());
                let endpoint = spawn_blocking(move || {
                    HttpEndpoint::open(&desk, way, address, was_unavailable, asked)
                });
                // It does not panic.
                let Ok(endpoint) = endpoint.await else { return };
                listeners.end_changeover(way).await;
                info!(event = "http-listening", way = way.word(), port = address.port());
                core.board.note(|facts| drop(facts.endpoints.remove(way.word())));
                serve(&endpoint, Arc::new(listener), listeners, &mut stop).await;
            }
            Ok(None) => {
                core.board.note(|facts| drop(facts.endpoints.remove(way.word())));
                stop.requested().await;
            }
            Err(error) => {
                listeners.end_changeover(way).await;
                if !std::mem::replace(&mut was_unavailable, true) {
                    warn!(event = "http-unavailable", way = way.word(), %error);
                }
                let why = Cause::of_system(&error);
                core.board.note(|facts| drop(facts.endpoints.insert(way.word(), why)));
                tokio::select! {
                    () = stop.requested() => {}
                    () = sleep(RETRY) => {}
                }
            }
        }
    }
}

/// Serves until a stop is requested. Requests in progress are still answered afterwards, later ones by
/// [`changeover`].
async fn serve(
    endpoint: &Arc<HttpEndpoint>,
    listener: Arc<TcpListener>,
    listeners: &Listeners,
    stop: &mut Stop,
) {
    let core = Arc::clone(&endpoint.desk.core);
    let monitors = Monitors { core, overview: Arc::default() };
    let monitors =
        Router::new().route(METRICS, get(metrics)).route(HEALTH, get(healthz)).with_state(monitors);
    let places = Places {
        others: Arc::new(Semaphore::new(MOST_SERVED)),
        monitors: Arc::new(Semaphore::new(MOST_MONITORS)),
    };
    let pages = page::routes(endpoint, monitors).layer(from_fn_with_state(places, attended));
    let connections = Arc::new(Connections::default());
    accept(&listener, &pages, &connections, stop).await;
    let language = endpoint.desk.core.config.language;
    listeners.begin_changeover(endpoint.way, |next| changeover::serve(listener, language, next));
    // Clients that have just connected send their requests at once.
    sleep(SAY_IT).await;
    connections.close_idle();
    // Decisions in progress must be complete before another generation begins.
    let _ = timeout(HEAD_TIME, connections.all_are_served()).await;
}

/// Accepts connections until a stop is requested.
async fn accept(
    listener: &TcpListener,
    pages: &Router,
    connections: &Arc<Connections>,
    stop: &mut Stop,
) {
    loop {
        let accepted = tokio::select! {
            () = stop.requested() => return,
            accepted = listener.accept() => accepted,
        };
        let Ok((stream, peer)) = accepted else {
            // A hot loop would not free any file descriptors.
            connections.close_idle();
            sleep(SHORT_OF_FILES).await;
            continue;
        };
        if let Some(connection) = connections.admit(peer.ip()) {
            tokio::spawn(attend(stream, pages.clone(), connection, stop.clone()));
        }
    }
}

/// Serves one connection to its end.
async fn attend(stream: TcpStream, pages: Router, connection: Arc<Connection>, stop: Stop) {
    let pages = TowerToHyperService::new(pages.layer(Extension(Arc::clone(&connection))));
    let mut http = http1::Builder::new();
    http.keep_alive(false).timer(TokioTimer::new()).header_read_timeout(HEAD_TIME);
    http.max_buf_size(HEAD_MOST);
    tokio::select! {
        // A client that disconnects or sends nothing needs no answer.
        _ = http.serve_connection(TokioIo::new(stream), pages) => {}
        () = connection.must_close() => {}
        () = over(&connection, stop) => {}
    }
}

/// Returns when a connection has lasted long enough; a stream lasts as long as the station.
async fn over(connection: &Connection, mut stop: Stop) {
    sleep(CONNECTION_TIME).await;
    if connection.is_stream() {
        stop.requested().await;
        // It ends by itself, unless its client reads nothing.
        sleep(HEAD_TIME).await;
    }
}

/// How many requests are answered at once. Monitors do not wait for other requests.
#[derive(Debug, Clone)]
struct Places {
    others: Arc<Semaphore>,
    monitors: Arc<Semaphore>,
}

/// Answers a complete request when there is a place.
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

/// What the requests of monitors share.
#[derive(Debug, Clone)]
struct Monitors {
    core: Arc<Core>,
    overview: Arc<SharedLook<Arc<Overview>>>,
}

impl Monitors {
    /// An overview; `None` if the disk of the state folder does not answer.
    async fn overview(&self) -> Option<Arc<Overview>> {
        let core = Arc::clone(&self.core);
        self.overview.of(move || Arc::new(Overview::take(&core))).await
    }
}

/// The code of a station that cannot report its state in time.
const NO_ANSWER: &str = "state-disk-stalled";

async fn metrics(State(monitors): State<Monitors>) -> Response {
    let Some(overview) = monitors.overview().await else { return no_answer() };
    match metrics::text(&overview) {
        Ok(text) => ([(header::CONTENT_TYPE, metrics::CONTENT_TYPE)], text).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

/// 200 and "ready", or 503 and the codes of what is wrong, one per line.
async fn healthz(State(monitors): State<Monitors>) -> Response {
    match monitors.overview().await {
        Some(overview) if overview.is_ready() => "ready\n".into_response(),
        Some(overview) => {
            let codes = overview.faults().map(|complaint| format!("{}\n", complaint.code));
            (StatusCode::SERVICE_UNAVAILABLE, codes.collect::<String>()).into_response()
        }
        None => no_answer(),
    }
}

fn no_answer() -> Response {
    (StatusCode::SERVICE_UNAVAILABLE, format!("{NO_ANSWER}\n")).into_response()
}
