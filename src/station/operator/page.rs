//! The operator's page: the live state of the station, and what an operator can decide there.
//!
//! ```text
//! journal, board, booth ─ snapshot ─▶ publish ─▶ /state, /stream ─▶ page.js
//! record folders, previews ─ summaries ──┘
//! page.js ─▶ /ask ─ guard, token ─▶ control::answer ◀─ /ask ◀─ verbs, by the control socket
//! page.js ─▶ /worklist ─ guard, token ─▶ booth
//! page.js ─▶ /scan/ID/visits.html ─▶ visits: the patient's records, compared
//! ```
//!
//! One task takes the snapshot for all readers, and only while there are readers. A slow reader of a
//! stream delays no other.

mod ask;
mod assets;
pub mod desk;
pub mod endpoint;
mod files;
mod guard;
pub mod publish;
mod search;
mod snapshot;
mod stream;
mod summaries;
mod token;
mod visits;
mod worklist;

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use axum::Router;
use axum::extract::{RawQuery, State};
use axum::http::{HeaderMap, StatusCode};
use axum::middleware::from_fn_with_state;
use axum::response::{Html, IntoResponse, Response};
use axum::routing::{get, post};
use gaiter_language::Language;
use hyper::body::{Bytes, Frame};
use tokio::sync::mpsc;

use self::endpoint::HttpEndpoint;
use super::http::listeners::Way;

/// The routes of an endpoint; `others` are pages for monitors, on this machine only.
pub fn routes(endpoint: &Arc<HttpEndpoint>, others: Router) -> Router {
    let read = Router::new()
        .route("/state", get(state))
        .route("/stream", get(stream::stream))
        .route("/scans", get(search::scans))
        .route("/scan/{scan}", get(search::one))
        .route("/scan/{scan}/measures", get(search::measures))
        .route("/scan/{scan}/visits.html", get(visits::visits))
        .route("/scan/{scan}/visits.pdf", get(visits::visits))
        .route("/scan/{scan}/{file}", get(files::file))
        .merge(assets::routes(endpoint));
    let routes = match endpoint.way {
        Way::Local => {
            let act = Router::new()
                .route("/ask", post(ask::ask))
                .route("/enter", post(ask::enter))
                .route("/worklist", post(worklist::worklist));
            read.merge(act).with_state(Arc::clone(endpoint)).merge(others)
        }
        Way::Network => read.with_state(Arc::clone(endpoint)),
        Way::Control => {
            let verb = read.route("/ask", post(ask::answer_verb));
            verb.with_state(Arc::clone(endpoint)).merge(others)
        }
    };
    let language = endpoint.desk.core.config.language;
    let none = async move || plain_page(StatusCode::NOT_FOUND, "page.plain.no_page", language);
    routes.fallback(none).layer(from_fn_with_state(Arc::clone(endpoint), guard::guard))
}

/// The current snapshot.
async fn state(
    State(endpoint): State<Arc<HttpEndpoint>>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Response {
    let shows_ids = endpoint.shows_ids(&headers, query.as_deref());
    let desk = Arc::clone(&endpoint.desk);
    match endpoint.state.of(move || publish::texts(&desk)).await.flatten() {
        Some(texts) => ([assets::JSON], texts.of(shows_ids)).into_response(),
        None => StatusCode::SERVICE_UNAVAILABLE.into_response(),
    }
}

/// A page of one sentence, where there is no other answer: that of this key, with the way back to the
/// operator's page.
fn plain_page(status: StatusCode, key: &'static str, language: Language) -> Response {
    let (tag, text) = (language.tag(), |key| language.text(key));
    let (message, back) = (text(key), text("page.plain.back"));
    let page = format!(
        "<!doctype html>\n<html lang=\"{tag}\">\n<head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><title>{message}</title>\
         <link rel=\"stylesheet\" href=\"/page.css\"></head>\n\
         <body><main><h1>{message}</h1><p><a href=\"/\">{back}</a></p></main></body>\n</html>\n"
    );
    (status, Html(page)).into_response()
}

/// The pieces of an answer that is made while it is sent. One that cannot be made breaks the connection, so
/// that no reader takes half an answer for a whole one.
struct Pieces(mpsc::Receiver<io::Result<Bytes>>);

impl hyper::body::Body for Pieces {
    type Data = Bytes;
    type Error = io::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, io::Error>>> {
        let piece = self.0.poll_recv(context);
        piece.map(|piece| piece.map(|piece| piece.map(Frame::data)))
    }
}
