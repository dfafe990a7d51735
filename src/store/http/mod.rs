//! A small HTTPS client for the stores that are servers: one request a connection, HTTP/1.1, verification always
//! on, no redirects, and a limit for time and length of every answer.
//!
//! The calls block. Each has a runtime of its own for as long as it lasts, so that a delivery, `gaiter check` and a
//! test use it in the same way.

mod answer;
mod connect;
mod fault;
pub mod tls;

use std::time::Duration;

use http_body_util::Full;
use hyper::body::Bytes;
use hyper::client::conn::http1;
use hyper::header::{CONNECTION, HOST, HeaderMap, HeaderName, HeaderValue, USER_AGENT};
use hyper::{Method, Request, Uri};
use hyper_util::rt::TokioIo;
use tokio::runtime::{Builder, Runtime};
use tokio::time::timeout;

use crate::flow::server::{Endpoint, EndpointFault, Proxy, TlsFiles};
pub use answer::HttpAnswer;
pub(in crate::store) use connect::stream;
pub use fault::HttpFault;

/// The longest answer, bytes: a capability statement has one or two million.
const ANSWER_MOST: usize = 16 << 20;

/// What the station calls itself.
const AGENT: &str = concat!("gaiter/", env!("CARGO_PKG_VERSION"));

/// Sends requests to a server.
#[derive(Debug, Clone)]
pub struct HttpClient {
    tls: TlsFiles,
    proxy: Option<Proxy>,
    /// For a whole exchange, from the search for the address to the last byte of the answer.
    limit: Duration,
}

/// A request.
#[derive(Debug)]
pub struct HttpRequest {
    /// Its method.
    pub method: Method,
    /// The whole address.
    pub uri: Uri,
    /// Headers besides those that every request has.
    pub headers: Vec<(HeaderName, HeaderValue)>,
    /// The body; may be empty.
    pub body: Vec<u8>,
}

impl HttpClient {
    /// A client that trusts as `tls` says.
    pub fn new(tls: TlsFiles, proxy: Option<Proxy>, limit: Duration) -> HttpClient {
        HttpClient { tls, proxy, limit }
    }

    /// Sends a request and reads the answer, whatever its status is.
    ///
    /// # Errors
    /// See [`HttpFault`]; whether the server has carried the request out is then not known.
    pub fn send(&self, request: HttpRequest) -> Result<HttpAnswer, HttpFault> {
        blocking(self.limit, self.exchange(request))
    }

    async fn exchange(&self, request: HttpRequest) -> Result<HttpAnswer, HttpFault> {
        let endpoint = Endpoint::of(&request.uri)?;
        let opened = stream(&endpoint, self.proxy.as_ref(), &self.tls).await?;
        let (mut sender, connection) = http1::handshake(TokioIo::new(opened)).await?;
        // It ends with the runtime.
        let connection = tokio::spawn(connection);
        let answer = sender.send_request(written(request, &endpoint)?).await?;
        let answer = answer::read(answer, ANSWER_MOST).await;
        drop(sender);
        connection.abort();
        answer
    }
}

/// Runs one exchange to its end or to the limit, on a runtime of its own.
pub(in crate::store) fn blocking<T>(
    limit: Duration,
    exchange: impl Future<Output = Result<T, HttpFault>>,
) -> Result<T, HttpFault> {
    let runtime: Runtime =
        Builder::new_current_thread().enable_all().build().map_err(HttpFault::Runtime)?;
    let done = runtime.block_on(async { timeout(limit, exchange).await });
    // A search for an address that hangs in the system's resolver is left behind.
    runtime.shutdown_background();
    done.unwrap_or(Err(HttpFault::TimedOut { limit }))
}

fn written(request: HttpRequest, endpoint: &Endpoint) -> Result<Request<Full<Bytes>>, HttpFault> {
    let HttpRequest { method, uri, headers, body } = request;
    let path = uri.path_and_query().map_or("/", |path| path.as_str());
    let mut fields = HeaderMap::new();
    let host = HeaderValue::from_str(&endpoint.authority());
    fields.insert(HOST, host.map_err(|_| EndpointFault::Address)?);
    fields.insert(USER_AGENT, HeaderValue::from_static(AGENT));
    fields.insert(CONNECTION, HeaderValue::from_static("close"));
    fields.extend(headers);
    let mut request = Request::new(Full::new(Bytes::from(body)));
    *request.method_mut() = method;
    *request.uri_mut() = path.parse().map_err(|_| EndpointFault::Address)?;
    *request.headers_mut() = fields;
    Ok(request)
}
