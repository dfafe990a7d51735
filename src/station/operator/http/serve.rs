//! Serves the connections of a listener, each with one request. A connection that waits only for its own
//! client makes room for later ones, so that a client that keeps connections open holds up no other. Between
//! two generations of workers requests get a notice, or wait.
//!
//! Not by `axum::serve`: it sets no time for the head of a request and no limit of connections, and layers
//! begin only when the head has arrived.

use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::Router;
use axum::http::{Request, StatusCode, Uri, header};
use axum::response::{Html, IntoResponse, Response};
use axum::serve::Listener;
use gaiter_language::Language;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::sync::{Semaphore, watch};
use tokio::task::AbortHandle;
use tokio::time::{sleep, timeout};

/// The paths that monitors request. They share one look at the station, and wait for no other request.
pub const METRICS: &str = "/metrics";
/// See [`METRICS`].
pub const HEALTH: &str = "/healthz";

/// The content type of an answer that lasts as long as the station.
pub const EVENTS: &str = "text/event-stream";

/// The largest number of connections at a listener. Each takes some 20 kB.
const MOST: usize = 256;

/// The number of requests answered at once; further ones wait.
const MOST_ANSWERED: u32 = 16;

/// How long the head of a request may take to arrive.
const HEAD_TIME: Duration = Duration::from_secs(5);

/// How long an answer may take.
const ANSWER_TIME: Duration = Duration::from_secs(25);

/// How long a connection may last; it carries one request. A stream lasts as long as its generation.
const CONNECTION_TIME: Duration = Duration::from_secs(30);

/// How long a request waits for a station that starts, and a verb for one that reloads. A reload takes
/// less, because it does not rebuild the journal.
pub const PATIENCE: Duration = Duration::from_secs(5);

/// How long the end of a generation waits for the answers in progress.
const LAST_ANSWERS: Duration = Duration::from_secs(5);

/// The longest head of a request, bytes; hyper's default would keep 400 kB for each connection.
const HEAD_MOST: usize = 64 * 1024;

/// The answer to monitors between two generations.
const CHANGES_OVER: &str = "station-changes-over";

/// Where a browser finds the page.
const PAGE: &str = "/";

/// How long a browser waits before it asks for the page again, seconds.
const AGAIN_S: &str = "1";

/// Who answers at an endpoint: a generation of the station's workers, or nobody between two of them.
#[derive(Debug, Clone)]
pub struct Answers {
    routes: Option<Router>,
    places: Arc<Semaphore>,
    language: Language,
    patience: Duration,
}

impl Answers {
    /// Nobody answers yet.
    pub fn none(language: Language) -> Answers {
        let places = Arc::new(Semaphore::new(MOST_ANSWERED as usize));
        Answers { routes: None, places, language, patience: PATIENCE }
    }

    /// A generation answers with these routes. After its end, a request waits this long for the next.
    pub fn new(routes: Router, language: Language, patience: Duration) -> Answers {
        Answers { routes: Some(routes), patience, ..Answers::none(language) }
    }
}

/// Ends the answers of a generation. On return the decisions in progress are complete, unless a disk
/// hangs.
pub async fn end(answers: &watch::Sender<Answers>) {
    answers.send_modify(|answers| answers.routes = None);
    let places = Arc::clone(&answers.borrow().places);
    let all = timeout(LAST_ANSWERS, places.acquire_many(MOST_ANSWERED)).await;
    places.close();
    drop(all);
}

/// A connection that is open.
struct Connection {
    task: AbortHandle,
    waits_for_client: Arc<AtomicBool>,
}

/// Accepts connections until it is aborted.
pub async fn accept<L: Listener>(mut listener: L, answers: watch::Receiver<Answers>) {
    // In the order of arrival.
    let mut open: Vec<Connection> = Vec::new();
    loop {
        let (stream, _) = listener.accept().await;
        open.retain(|connection| !connection.task.is_finished());
        if open.len() >= MOST {
            let waits = |it: &Connection| it.waits_for_client.load(Ordering::Relaxed);
            let Some(oldest) = open.iter().position(waits) else { continue };
            open.remove(oldest).task.abort();
        }
        let waits_for_client = Arc::new(AtomicBool::new(true));
        let served = attend(stream, answers.clone(), Arc::clone(&waits_for_client));
        open.push(Connection { task: tokio::spawn(served).abort_handle(), waits_for_client });
    }
}

/// Serves one connection to its end.
async fn attend(
    stream: impl AsyncRead + AsyncWrite + Unpin,
    answers: watch::Receiver<Answers>,
    waits_for_client: Arc<AtomicBool>,
) {
    let (of_generation, waits) = (answers.clone(), Arc::clone(&waits_for_client));
    let service = service_fn(move |request: Request<Incoming>| {
        let (answers, waits) = (answers.clone(), Arc::clone(&waits));
        async move {
            waits.store(false, Ordering::Relaxed);
            let answer = answer(answers, request).await;
            let kind = answer.headers().get(header::CONTENT_TYPE);
            waits.store(kind.is_none_or(|kind| kind != EVENTS), Ordering::Relaxed);
            Ok::<Response, Infallible>(answer)
        }
    });
    let mut http = http1::Builder::new();
    http.keep_alive(false).timer(TokioTimer::new()).header_read_timeout(HEAD_TIME);
    http.max_buf_size(HEAD_MOST);
    tokio::select! {
        // A client that disconnects or sends nothing needs no answer.
        _ = http.serve_connection(TokioIo::new(stream), service) => {}
        () = over(&waits_for_client, of_generation) => {}
    }
}

/// Returns when a connection has lasted long enough.
async fn over(waits_for_client: &AtomicBool, mut answers: watch::Receiver<Answers>) {
    answers.mark_unchanged();
    sleep(CONNECTION_TIME).await;
    if !waits_for_client.load(Ordering::Relaxed) {
        let _ = answers.changed().await;
        // A stream ends by itself, unless its client reads nothing.
        sleep(HEAD_TIME).await;
    }
}

/// Answers a complete request when there is a place. What it asks for is carried out to its end, and
/// keeps the place, even if the client disconnects: impatient clients cannot pile up work.
async fn answer(mut answers: watch::Receiver<Answers>, request: Request<Incoming>) -> Response {
    loop {
        let patience = answers.borrow().patience;
        let _ = timeout(patience, answers.wait_for(|answers| answers.routes.is_some())).await;
        let Answers { routes, places, language, .. } = answers.borrow().clone();
        let Some(routes) = routes else { return changes_over(request.uri(), language) };
        let place = if [METRICS, HEALTH].contains(&request.uri().path()) {
            None
        } else {
            match places.acquire_owned().await {
                Ok(place) => Some(place),
                // Its generation has just ended.
                Err(_) => continue,
            }
        };
        let answered = tokio::spawn(async move {
            let answer = TowerToHyperService::new(routes).call(request).await;
            drop(place);
            answer
        });
        return match timeout(ANSWER_TIME, answered).await {
            Ok(Ok(Ok(answer))) => answer,
            Ok(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
            // A disk hangs.
            Err(_) => StatusCode::SERVICE_UNAVAILABLE.into_response(),
        };
    }
}

/// 503 in any case. A browser that wanted the page shows why, and asks again.
fn changes_over(uri: &Uri, language: Language) -> Response {
    let headers = [
        (header::RETRY_AFTER, AGAIN_S),
        (header::CACHE_CONTROL, "no-store"),
        (header::CONTENT_SECURITY_POLICY, "default-src 'none'"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ];
    let answer = if uri.path() == PAGE {
        let (tag, text) = (language.tag(), language.text("page.changes_over"));
        let html = format!(
            "<!doctype html><html lang=\"{tag}\"><meta charset=\"utf-8\">\
             <title>gaiter</title><p>{text}</p></html>\n"
        );
        ([(header::REFRESH, AGAIN_S)], Html(html)).into_response()
    } else {
        format!("{CHANGES_OVER}\n").into_response()
    };
    (StatusCode::SERVICE_UNAVAILABLE, headers, answer).into_response()
}

#[cfg(test)]
mod tests {
    use std::net::SocketAddr;

    use axum::routing::get;
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    use tokio::net::{TcpListener, TcpStream};
    use tokio::sync::Notify;

    use super::*;

    /// Signals that a request has arrived, and lets it be answered.
    #[derive(Clone, Default)]
    struct Gate {
        arrived: Arc<Notify>,
        open: Arc<Notify>,
    }

    impl Gate {
        fn answers(&self, patience: Duration) -> Answers {
            let gate = self.clone();
            let handler = move || {
                let gate = gate.clone();
                async move {
                    gate.arrived.notify_one();
                    gate.open.notified().await;
                    "done"
                }
            };
            Answers::new(Router::new().route("/", get(handler)), Language::En, patience)
        }
    }

    /// An endpoint where requests are answered once the gate is open.
    async fn endpoint(gate: &Gate, patience: Duration) -> (watch::Sender<Answers>, SocketAddr) {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let (answers, asked) = watch::channel(gate.answers(patience));
        tokio::spawn(accept(listener, asked));
        (answers, address)
    }

    async fn ask(address: SocketAddr) -> String {
        let mut stream = TcpStream::connect(address).await.unwrap();
        stream.write_all(b"GET / HTTP/1.1\r\nHost: station\r\n\r\n").await.unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).await.unwrap();
        answer
    }

    #[tokio::test]
    async fn where_all_places_are_taken_the_oldest_closes_that_waits_for_its_client() {
        let gate = Gate::default();
        let (_answers, address) = endpoint(&gate, Duration::ZERO).await;
        let served = tokio::spawn(ask(address));
        gate.arrived.notified().await;
        let mut idle = Vec::new();
        for _ in 0..MOST {
            idle.push(TcpStream::connect(address).await.unwrap());
        }
        // By itself it closes later.
        let closed = timeout(HEAD_TIME / 2, idle[0].read(&mut [0])).await;
        assert_eq!(closed.unwrap().unwrap(), 0, "it makes room");
        gate.open.notify_one();
        assert!(served.await.unwrap().starts_with("HTTP/1.1 200 "));
    }

    #[tokio::test]
    async fn a_generation_ends_when_its_answers_are_complete_and_later_requests_are_told_so() {
        let gate = Gate::default();
        let (answers, address) = endpoint(&gate, Duration::ZERO).await;
        let mut seen = answers.subscribe();
        let first = tokio::spawn(ask(address));
        gate.arrived.notified().await;
        let ended = tokio::spawn(async move { end(&answers).await });
        seen.wait_for(|answers| answers.routes.is_none()).await.unwrap();
        assert!(ask(address).await.starts_with("HTTP/1.1 503 "));
        assert!(!ended.is_finished(), "a decision is in progress");
        gate.open.notify_one();
        assert!(first.await.unwrap().ends_with("done"));
        ended.await.unwrap();
    }

    #[tokio::test]
    async fn a_verb_waits_for_the_next_generation() {
        let gate = Gate::default();
        let (answers, address) = endpoint(&gate, Duration::from_secs(60)).await;
        end(&answers).await;
        let verb = tokio::spawn(ask(address));
        answers.send_replace(gate.answers(Duration::ZERO));
        gate.open.notify_one();
        assert!(verb.await.unwrap().ends_with("done"));
    }
}
