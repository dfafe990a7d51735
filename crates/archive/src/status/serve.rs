//! The page and the metrics over HTTP, for those who look after the stations. Nothing can be changed there.

use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::Router;
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use tokio::net::TcpListener;
use tokio::runtime;
use tokio::task::spawn_blocking;

use super::{Status, metrics};
use crate::config::ArchiveConfig;
use crate::fault::{ArchiveFault, chain};
use crate::note;

/// So long an answer is the last one: however many ask, the database is asked no more often.
const FRESH: Duration = Duration::from_secs(10);

/// What a browser may do with the page.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'";

/// What all requests share.
struct Desk {
    config: ArchiveConfig,
    last: Mutex<Option<(Instant, Arc<Status>)>>,
}

/// Answers at this address until it is stopped.
///
/// # Errors
/// If nothing can be opened there.
pub fn serve(config: &ArchiveConfig, address: SocketAddr) -> Result<(), ArchiveFault> {
    let desk = Arc::new(Desk { config: config.clone(), last: Mutex::default() });
    let routes =
        Router::new().route("/", get(page)).route("/metrics", get(metrics)).with_state(desk);
    // Two threads ask the database: one that waits for it, and one that waits for the first.
    let runtime =
        runtime::Builder::new_current_thread().enable_all().max_blocking_threads(2).build()?;
    runtime.block_on(async {
        let listener = TcpListener::bind(address).await?;
        note(format_args!("status: http://{}", listener.local_addr()?));
        axum::serve(listener, routes).await
    })?;
    Ok(())
}

impl Desk {
    fn status(&self) -> Result<Arc<Status>, ArchiveFault> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((at, status)) = &*last
            && at.elapsed() < FRESH
        {
            return Ok(Arc::clone(status));
        }
        let status = Arc::new(Status::read(&self.config)?);
        *last = Some((Instant::now(), Arc::clone(&status)));
        Ok(status)
    }
}

async fn page(State(desk): State<Arc<Desk>>) -> Response {
    answer(desk, |status| {
        ([(header::CONTENT_SECURITY_POLICY, POLICY)], Html(status.page())).into_response()
    })
    .await
}

async fn metrics(State(desk): State<Arc<Desk>>) -> Response {
    answer(desk, |status| match status.metrics() {
        Ok(text) => ([(header::CONTENT_TYPE, metrics::CONTENT_TYPE)], text).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    })
    .await
}

/// An answer that is made of the state; another if the database does not tell.
async fn answer(desk: Arc<Desk>, make: fn(&Status) -> Response) -> Response {
    match spawn_blocking(move || desk.status().map_err(|fault| chain(&fault))).await {
        Ok(Ok(status)) => make(&status),
        Ok(Err(why)) => {
            // This is for the log: a page need not say where the database is.
            note(format_args!("status: {why}"));
            (StatusCode::SERVICE_UNAVAILABLE, "the database does not answer\n").into_response()
        }
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}
