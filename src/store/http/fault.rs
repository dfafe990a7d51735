//! Why a request got no answer.

use std::io;
use std::time::Duration;

use super::tls::TlsFault;
use crate::flow::server::EndpointFault;
use crate::store::secret::SecretFault;

/// Why a request got no answer. Whether the server has carried it out is then not known.
#[derive(Debug, thiserror::Error)]
pub enum HttpFault {
    /// The address cannot be asked.
    #[error(transparent)]
    Address(#[from] EndpointFault),
    /// The password of the proxy cannot be read.
    #[error(transparent)]
    Secret(#[from] SecretFault),
    /// The host cannot be reached.
    #[error("{host} cannot be reached: {source}")]
    Connect {
        /// The host, or the proxy.
        host: String,
        /// The underlying error.
        source: io::Error,
    },
    /// The proxy does not let the connection through.
    #[error("the proxy answers: {0}")]
    Proxy(String),
    /// The server cannot be trusted, or does not trust the station.
    #[error("no safe connection with {host}: {source}")]
    Tls {
        /// The host.
        host: String,
        /// The underlying error.
        source: io::Error,
    },
    /// The certificates cannot be used.
    #[error(transparent)]
    Certificates(#[from] TlsFault),
    /// What was sent or received is no HTTP, or ended too early.
    #[error("the connection failed: {0}")]
    Http(#[from] hyper::Error),
    /// The answer is longer than any that is expected.
    #[error("the answer has more than {most} bytes")]
    TooLong {
        /// The most that is read, bytes.
        most: usize,
    },
    /// The answer points elsewhere.
    #[error("the answer is a redirect, which is not followed")]
    Redirect,
    /// The exchange took too long.
    #[error("no whole answer within {} s", limit.as_secs())]
    TimedOut {
        /// The limit.
        limit: Duration,
    },
    /// The machine has no resources for it.
    #[error("the request could not be begun: {0}")]
    Runtime(#[source] io::Error),
}
