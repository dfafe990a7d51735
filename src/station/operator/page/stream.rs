//! The snapshots as server-sent events: at once and at every change, with a beat in between that shows a
//! browser that the station is alive. A stream ends with the station or with its reader.

use std::io;
use std::sync::Arc;
use std::time::Duration;

use axum::body::Body;
use axum::extract::{RawQuery, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use hyper::body::Bytes;
use tokio::sync::mpsc;
use tokio::time::sleep;

use super::Pieces;
use super::endpoint::HttpEndpoint;
use crate::station::operator::http::serve::EVENTS;

/// How often a beat is sent: a browser that gets nothing for two beats asks by itself.
const BEAT: Duration = Duration::from_secs(1);

/// How soon a browser reconnects after its stream has ended, ms.
const RETRY_MS: u32 = 1000;

/// A stream, or 503 if there are too many: then the page polls `/state`.
pub async fn stream(
    State(endpoint): State<Arc<HttpEndpoint>>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Response {
    let Ok(place) = Arc::clone(&endpoint.streams).try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many readers\n").into_response();
    };
    let shows_ids = endpoint.shows_ids(&headers, query.as_deref());
    let (sender, events) = mpsc::channel(1);
    tokio::spawn(async move {
        let _place = place;
        send_all(&endpoint, shows_ids, &sender).await;
    });
    let kind = [(header::CONTENT_TYPE, EVENTS)];
    (kind, Body::new(Pieces(events))).into_response()
}

/// Sends snapshots to a reader until it disconnects or the station stops.
async fn send_all(
    endpoint: &HttpEndpoint,
    shows_ids: bool,
    sender: &mpsc::Sender<io::Result<Bytes>>,
) {
    let mut snapshots = endpoint.desk.texts.subscribe();
    endpoint.desk.refresh.notify_one();
    let mut stop = endpoint.stop.clone();
    let mut last = None;
    if sender.send(Ok(format!("retry: {RETRY_MS}\n\n").into())).await.is_err() {
        return;
    }
    loop {
        let text = snapshots.borrow_and_update().as_ref().map(|texts| texts.of(shows_ids));
        if text.is_some() && text != last {
            let message = format!("data: {}\n\n", text.as_deref().unwrap_or_default());
            last = text;
            tokio::select! {
                () = stop.requested() => return,
                sent = sender.send(Ok(message.into())) => if sent.is_err() { return },
            }
        }
        tokio::select! {
            () = stop.requested() => return,
            () = sender.closed() => return,
            changed = snapshots.changed() => if changed.is_err() { return },
            () = sleep(BEAT) => {
                // If this fails, the reader still has the last event to read.
                let _ = sender.try_send(Ok(Bytes::from_static(b"event: beat\ndata:\n\n")));
            }
        }
    }
}
