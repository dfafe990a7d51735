//! The snapshots as server-sent events: at once, whenever they change, and a beat in between by which
//! a browser knows that the station lives. A stream ends with the station, or with its reader.

use std::convert::Infallible;
use std::pin::Pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::Extension;
use axum::body::Body;
use axum::extract::{RawQuery, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use hyper::body::{Bytes, Frame};
use tokio::sync::{OwnedSemaphorePermit, mpsc};
use tokio::time::sleep;

use super::Door;

/// How often a beat goes out: a browser that has heard nothing for three beats looks for another way.
const BEAT: Duration = Duration::from_secs(10);

/// How soon a browser whose stream has ended comes again, ms.
const RETRY_MS: u32 = 1000;

/// A connection, as the page knows it: one that becomes a stream does not end by time, and gives its
/// place among the short ones to others.
#[derive(Debug, Clone)]
pub struct Connection {
    is_stream: Arc<AtomicBool>,
    permit: Arc<Mutex<Option<OwnedSemaphorePermit>>>,
}

impl Connection {
    /// A short one, with its place.
    pub fn new(permit: OwnedSemaphorePermit) -> Connection {
        let permit = Arc::new(Mutex::new(Some(permit)));
        Connection { is_stream: Arc::default(), permit }
    }

    /// Whether it has become a stream.
    pub fn is_stream(&self) -> bool {
        self.is_stream.load(Ordering::Relaxed)
    }

    fn becomes_stream(&self) {
        self.is_stream.store(true, Ordering::Relaxed);
        drop(self.permit.lock().unwrap_or_else(PoisonError::into_inner).take());
    }
}

/// A stream, or 503 where there are too many: the page asks for `/state` again and again then.
pub async fn stream(
    State(door): State<Arc<Door>>,
    Extension(connection): Extension<Connection>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Response {
    let Ok(place) = Arc::clone(&door.streams).try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many look already\n").into_response();
    };
    connection.becomes_stream();
    let shows_ids = door.shows_ids(&headers, query.as_deref());
    let (sender, events) = mpsc::channel(1);
    tokio::spawn(async move {
        let _place = place;
        tell(&door, shows_ids, &sender).await;
    });
    let kind = [(header::CONTENT_TYPE, "text/event-stream")];
    (kind, Body::new(Events(events))).into_response()
}

/// Tells a reader until he goes away or the station stops.
async fn tell(door: &Door, shows_ids: bool, sender: &mpsc::Sender<String>) {
    let mut snapshots = door.station.page.feed.subscribe();
    let mut stop = door.stop.clone();
    let mut last = None;
    if sender.send(format!("retry: {RETRY_MS}\n\n")).await.is_err() {
        return;
    }
    loop {
        let text = snapshots.borrow_and_update().as_ref().map(|texts| texts.of(shows_ids));
        if text.is_some() && text != last {
            let event = format!("data: {}\n\n", text.as_deref().unwrap_or_default());
            last = text;
            tokio::select! {
                () = stop.requested() => return,
                sent = sender.send(event) => if sent.is_err() { return },
            }
        }
        tokio::select! {
            () = stop.requested() => return,
            () = sender.closed() => return,
            changed = snapshots.changed() => if changed.is_err() { return },
            () = sleep(BEAT) => {
                // A reader who takes nothing has his last event still before him.
                let _ = sender.try_send("event: beat\ndata:\n\n".to_owned());
            }
        }
    }
}

/// The events of one stream as the body of an answer.
struct Events(mpsc::Receiver<String>);

impl hyper::body::Body for Events {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        let event = self.0.poll_recv(context);
        event.map(|event| event.map(|event| Ok(Frame::data(Bytes::from(event)))))
    }
}
