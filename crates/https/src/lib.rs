//! An HTTPS client whose calls block.
//!
#![doc = include_str!("../README.md")]

mod bucket;
mod endpoint;
mod fault;
pub mod secret;
mod signature;
#[cfg(test)]
mod tests;
pub mod tls;
mod validity;

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use http::{Request, Response};
use ureq::{Agent, ProxyProtocol};

pub use bucket::{Bucket, BucketFault, BucketPlace, Listed, Page, PutNew};
pub use endpoint::{Endpoint, EndpointFault, Proxy, Secret, TlsFiles, is_this_machine};
pub use fault::HttpFault;
pub use secret::SecretFault;
pub use signature::escaped;

/// The longest answer, bytes, unless said otherwise: a capability statement has one or two million.
const ANSWER_MOST: u64 = 16 << 20;

/// The longest head of an answer, bytes.
const HEAD_MOST: usize = 64 << 10;

/// The longest search for the address of a name.
const LOOKUP_MOST: Duration = Duration::from_secs(5);

/// The longest way to a connection, with proxy and TLS.
const CONNECT_MOST: Duration = Duration::from_secs(10);

/// A connection that was idle for so long is not used again: servers close theirs after 5 s and more.
const IDLE_MOST: Duration = Duration::from_secs(2);

/// So long connections are made with the same certificates; then their files are read again.
const KEPT_MOST: Duration = Duration::from_secs(60);

/// What the station calls itself.
const STATION: &str = concat!("gaiter/", env!("CARGO_PKG_VERSION"));

/// Sends requests to servers.
#[derive(Debug)]
pub struct HttpsClient {
    tls: TlsFiles,
    proxy: Option<Proxy>,
    /// For a whole exchange, from the search for the address to the last byte of the answer.
    limit: Duration,
    /// The longest answer, bytes.
    answer_most: u64,
    kept: Mutex<Option<Kept>>,
}

/// What keeps connections.
#[derive(Debug)]
struct Kept {
    agent: Agent,
    is_encrypted: bool,
    since: Instant,
}

impl HttpsClient {
    /// A client that trusts by `tls`; `limit` is for a whole exchange.
    pub fn new(tls: TlsFiles, proxy: Option<Proxy>, limit: Duration) -> HttpsClient {
        HttpsClient { tls, proxy, limit, answer_most: ANSWER_MOST, kept: Mutex::default() }
    }

    /// It, but with answers of up to this many bytes.
    #[must_use]
    pub fn with_answers_up_to(self, answer_most: u64) -> HttpsClient {
        HttpsClient { answer_most, ..self }
    }

    /// Sends a request, whose body may be empty, and reads the answer to its end, whatever its status is.
    ///
    /// # Errors
    /// See [`HttpFault`]; whether the server has carried the request out is then not known.
    pub fn send(&self, request: Request<Vec<u8>>) -> Result<Response<Vec<u8>>, HttpFault> {
        let endpoint = Endpoint::from_uri(request.uri())?;
        let agent = self.agent(endpoint.is_encrypted)?;
        let answer = exchange(&agent, request, self.answer_most)
            .map_err(|error| {
                HttpFault::from_client_error(error, self.way_to(&endpoint), self.limit)
            })
            .inspect_err(|_| *self.kept() = None)?;
        match answer.status().is_redirection() {
            true => Err(HttpFault::Redirect),
            false => Ok(answer),
        }
    }

    fn kept(&self) -> MutexGuard<'_, Option<Kept>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn agent(&self, is_encrypted: bool) -> Result<Agent, HttpFault> {
        let mut kept = self.kept();
        let fitting = kept
            .as_ref()
            .filter(|of| of.is_encrypted == is_encrypted && of.since.elapsed() < KEPT_MOST);
        if let Some(fitting) = fitting {
            return Ok(fitting.agent.clone());
        }
        let agent = self.new_agent(is_encrypted)?;
        *kept = Some(Kept { agent: agent.clone(), is_encrypted, since: Instant::now() });
        Ok(agent)
    }

    /// What is not encrypted stays on this machine and needs no certificates; no proxy gets it.
    fn new_agent(&self, is_encrypted: bool) -> Result<Agent, HttpFault> {
        let proxy = match &self.proxy {
            Some(proxy) if is_encrypted => Some(of_client(proxy)?),
            _ => None,
        };
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            // Set in any case: the client takes one from the environment otherwise.
            .proxy(proxy)
            .user_agent(STATION)
            .max_response_header_size(HEAD_MOST)
            .max_idle_connections(1)
            .max_idle_age(IDLE_MOST)
            .timeout_global(Some(self.limit))
            .timeout_resolve(Some(LOOKUP_MOST))
            .timeout_connect(Some(CONNECT_MOST));
        let config = match is_encrypted {
            true => config.tls_config(tls::of_client(&self.tls)?),
            false => config,
        };
        Ok(config.build().new_agent())
    }

    /// The host, and the proxy on the way to it.
    fn way_to(&self, endpoint: &Endpoint) -> String {
        let host = endpoint.authority();
        match &self.proxy {
            Some(proxy) if endpoint.is_encrypted => {
                format!("{host} (proxy {})", proxy.endpoint.authority())
            }
            _ => host,
        }
    }
}

fn exchange(
    agent: &Agent,
    request: Request<Vec<u8>>,
    answer_most: u64,
) -> Result<Response<Vec<u8>>, ureq::Error> {
    let answer = match request.body().is_empty() {
        true => agent.run(request.map(drop))?,
        false => agent.run(request)?,
    };
    let (head, mut body) = answer.into_parts();
    let body = body.with_config().limit(answer_most).read_to_vec()?;
    Ok(Response::from_parts(head, body))
}

fn of_client(proxy: &Proxy) -> Result<ureq::Proxy, HttpFault> {
    let Endpoint { host, port, .. } = &proxy.endpoint;
    let mut made = ureq::Proxy::builder(ProxyProtocol::Http).host(host).port(*port);
    if let Some((user, password)) = &proxy.user {
        made = made.username(user).password(&secret::read(password)?);
    }
    made.build().map_err(|_| HttpFault::Address(EndpointFault::Address))
}
