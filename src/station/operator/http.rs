//! The station over HTTP: the operator's page, metrics and health at an address of this machine or on a
//! socket that the service manager has opened; the page, read-only, at another address; and all of it for the
//! verbs of the command line at the control socket. No client blocks the others, and a request that arrives
//! while a disk hangs gets an answer that reports it.

pub mod listeners;
pub mod serve;
pub mod shared_look;

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use gaiter_flow::cause::Cause;
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;
use tracing::{info, warn};

use self::listeners::{Listeners, Opened, Way};
use self::serve::{Answers, HEALTH, METRICS, PATIENCE};
use super::metrics;
use super::page::desk::Desk;
use super::page::endpoint::HttpEndpoint;
use super::page::{self, publish};
use crate::station::overview::Overview;
use crate::station::runtime::Stop;

/// The pause before an endpoint is tried again after a failure.
const RETRY: Duration = Duration::from_secs(10);

/// Answers at the endpoints until asked to stop.
///
/// # Errors
/// None; all workers have this type.
pub async fn worker(
    desk: Arc<Desk>,
    listeners: Arc<Listeners>,
    stop: Stop,
) -> Result<(), JoinError> {
    let keep = |way| keep(&desk, &listeners, way, stop.clone());
    tokio::join!(
        keep(Way::Local),
        keep(Way::Network),
        keep(Way::Control),
        publish::worker(&desk, stop.clone())
    );
    Ok(())
}

/// Answers at one endpoint.
async fn keep(desk: &Arc<Desk>, listeners: &Listeners, way: Way, mut stop: Stop) {
    let core = &desk.core;
    let mut was_unavailable = false;
    while !stop.is_requested() {
        match listeners.open(&core.config, way).await {
            Ok(Some(Opened { address, answers })) => {
                let (desk, asked) = (Arc::clone(desk), stop.clone());
                let endpoint = spawn_blocking(move || {
                    HttpEndpoint::open(&desk, way, address, was_unavailable, asked)
                });
                // It does not panic.
                let Ok(endpoint) = endpoint.await else { return };
                core.board.note(|facts| drop(facts.endpoints.remove(way.word())));
                let patience = if way == Way::Control { PATIENCE } else { Duration::ZERO };
                let language = core.config.language;
                answers.send_replace(Answers::new(routes(&endpoint), language, patience));
                if let Some(address) = address {
                    info!(event = "http-listening", way = way.word(), port = address.port());
                }
                stop.requested().await;
                serve::end(&answers).await;
            }
            Ok(None) => {
                core.board.note(|facts| drop(facts.endpoints.remove(way.word())));
                stop.requested().await;
            }
            Err(error) => {
                if !std::mem::replace(&mut was_unavailable, true) {
                    warn!(event = "http-unavailable", way = way.word(), %error);
                }
                // The facts about it concern the page's address.
                if way != Way::Control {
                    let why = Cause::of_system(&error);
                    core.board.note(|facts| drop(facts.endpoints.insert(way.word(), why)));
                }
                tokio::select! {
                    () = stop.requested() => {}
                    () = sleep(RETRY) => {}
                }
            }
        }
    }
}

fn routes(endpoint: &Arc<HttpEndpoint>) -> Router {
    let monitors = Router::new().route(METRICS, get(metrics)).route(HEALTH, get(healthz));
    page::routes(endpoint, monitors.with_state(Arc::clone(endpoint)))
}

/// An overview; `None` if the disk of the state folder does not answer.
async fn overview(endpoint: &HttpEndpoint) -> Option<Arc<Overview>> {
    let core = Arc::clone(&endpoint.desk.core);
    endpoint.overview.of(move || Arc::new(Overview::take(&core))).await
}

/// The code of a station that cannot report its state in time.
const NO_ANSWER: &str = "state-disk-stalled";

async fn metrics(State(endpoint): State<Arc<HttpEndpoint>>) -> Response {
    let Some(overview) = overview(&endpoint).await else { return no_answer() };
    match metrics::text(&overview) {
        Ok(text) => ([(header::CONTENT_TYPE, metrics::CONTENT_TYPE)], text).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

/// 200 and "ready", or 503 and the codes of what is wrong, one per line.
async fn healthz(State(endpoint): State<Arc<HttpEndpoint>>) -> Response {
    match overview(&endpoint).await {
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
