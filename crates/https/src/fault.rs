//! Why a request got no answer.

use std::io::{self, ErrorKind};
use std::time::Duration;

use gaiter_flow::cause::Cause;
use rustls::CertificateError;

use super::endpoint::EndpointFault;
use super::secret::SecretFault;
use super::tls::TlsFault;

/// The beginning of `std`'s message for a name that was not found; it has no kind of error.
const NAME_NOT_FOUND: &str = "failed to lookup address information";

/// Why a request got no answer. Whether the server has carried it out is then not known. None contains the
/// address that was asked for, which may hold a patient's id.
#[derive(Debug, thiserror::Error)]
pub enum HttpFault {
    /// The address cannot be asked.
    #[error(transparent)]
    Address(#[from] EndpointFault),
    /// A password, token or key cannot be read.
    #[error(transparent)]
    Secret(#[from] SecretFault),
    /// The certificates cannot be used.
    #[error(transparent)]
    Certificates(#[from] TlsFault),
    /// The network has no address for the host.
    #[error("the network does not know {host}")]
    UnknownHost { host: String },
    /// The host cannot be reached.
    #[error("{host} cannot be reached: {source}")]
    Connect { host: String, source: io::Error },
    /// The proxy does not let the connection through.
    #[error("the proxy does not let the connection through: {0}")]
    Proxy(String),
    /// The server cannot be trusted, or does not trust the station.
    #[error("no safe connection with {host}: {source}")]
    Tls { host: String, source: io::Error },
    /// The connection ended before the answer did.
    #[error("the connection with {host} broke: {source}")]
    Broken { host: String, source: io::Error },
    /// What was received is no HTTP.
    #[error("{host} does not answer by HTTP: {why}")]
    NotHttp { host: String, why: String },
    /// The answer is longer than any that is expected.
    #[error("the answer has more than {most} bytes")]
    TooLong {
        /// The most that is read, bytes.
        most: usize,
    },
    /// The answer points elsewhere.
    #[error("the answer points to another address, which is not followed")]
    Redirect,
    /// The exchange took too long.
    #[error("no whole answer within {} s", limit.as_secs_f64())]
    TimedOut { limit: Duration },
}

impl HttpFault {
    /// Why, for people.
    pub fn cause(&self) -> Cause {
        match self {
            HttpFault::Address(fault) => Cause::verbatim(fault),
            HttpFault::Secret(fault) => Cause::known("server-secret", [("why", fault.to_string())]),
            HttpFault::Certificates(fault) => {
                Cause::known("server-certificates", [("why", fault.to_string())])
            }
            HttpFault::UnknownHost { host } => {
                Cause::known("server-unknown-host", [("host", host.clone())])
            }
            HttpFault::Connect { host, source } => {
                Cause::of_system(source).after(format_args!("{host} cannot be reached"))
            }
            HttpFault::Proxy(why) => Cause::known("server-proxy", [("why", why.clone())]),
            HttpFault::Tls { host, source } => not_trusted(host, source),
            HttpFault::Broken { source, .. } if source.kind() == ErrorKind::UnexpectedEof => {
                Cause::known("server-cut-short", [])
            }
            HttpFault::Broken { host, source } => {
                Cause::of_system(source).after(format_args!("the connection with {host} broke"))
            }
            HttpFault::NotHttp { host, why } => {
                Cause::known("server-no-http", [("host", host.clone()), ("why", why.clone())])
            }
            HttpFault::TooLong { most } => {
                Cause::known("server-too-long", [("bytes", most.to_string())])
            }
            HttpFault::Redirect => Cause::known("server-redirect", []),
            HttpFault::TimedOut { limit } => {
                Cause::known("server-too-slow", [("limit_s", limit.as_secs_f64().to_string())])
            }
        }
    }

    /// The fault of an error of the client, for a host that had this much time.
    pub(super) fn from_client_error(
        error: ureq::Error,
        host: String,
        limit: Duration,
    ) -> HttpFault {
        match error {
            ureq::Error::Io(source) => HttpFault::of_io(source, host),
            ureq::Error::Rustls(error) => HttpFault::Tls { host, source: io::Error::other(error) },
            ureq::Error::HostNotFound | ureq::Error::Timeout(ureq::Timeout::Resolve) => {
                HttpFault::UnknownHost { host }
            }
            ureq::Error::Timeout(ureq::Timeout::Connect) => {
                HttpFault::Connect { host, source: ErrorKind::TimedOut.into() }
            }
            ureq::Error::Timeout(_) => HttpFault::TimedOut { limit },
            ureq::Error::BodyExceedsLimit(most) => {
                HttpFault::TooLong { most: usize::try_from(most).unwrap_or(usize::MAX) }
            }
            ureq::Error::LargeResponseHeader(_, most) => HttpFault::TooLong { most },
            ureq::Error::ConnectProxyFailed(why) => HttpFault::Proxy(why),
            // It contains the whole address.
            ureq::Error::BadUri(_) => HttpFault::Address(EndpointFault::Address),
            other => HttpFault::NotHttp { host, why: other.to_string() },
        }
    }

    fn of_io(source: io::Error, host: String) -> HttpFault {
        if source.get_ref().is_some_and(|inner| inner.is::<rustls::Error>()) {
            return HttpFault::Tls { host, source };
        }
        match source.kind() {
            ErrorKind::UnexpectedEof
            | ErrorKind::ConnectionReset
            | ErrorKind::ConnectionAborted
            | ErrorKind::BrokenPipe => HttpFault::Broken { host, source },
            _ if source.to_string().starts_with(NAME_NOT_FOUND) => HttpFault::UnknownHost { host },
            _ => HttpFault::Connect { host, source },
        }
    }
}

/// Why a connection is not safe. What is most often wrong with a certificate has words of its own.
fn not_trusted(host: &str, source: &io::Error) -> Cause {
    let host = ("host", host.to_owned());
    let error = source.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>());
    match error {
        Some(rustls::Error::InvalidCertificate(CertificateError::UnknownIssuer)) => {
            Cause::known("certificate-of-unknown-authority", [host])
        }
        Some(rustls::Error::InvalidCertificate(
            CertificateError::Expired | CertificateError::ExpiredContext { .. },
        )) => Cause::known("certificate-expired", [host]),
        Some(rustls::Error::InvalidCertificate(
            CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. },
        )) => Cause::known("certificate-of-other-host", [host]),
        _ => Cause::known("server-not-safe", [host, ("why", source.to_string())]),
    }
}
