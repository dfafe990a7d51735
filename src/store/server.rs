//! What stores that are servers have in common: why one does not take a record now.

use super::http::HttpFault;
use super::secret::SecretFault;

/// Why a server does not take a record now. It may later, so it is asked again.
#[derive(Debug, thiserror::Error)]
pub enum ServerFault {
    /// It gave no answer.
    #[error(transparent)]
    Http(#[from] HttpFault),
    /// A secret cannot be read.
    #[error(transparent)]
    Secret(#[from] SecretFault),
    /// It lets the station in no more, or not for this.
    #[error("the server does not let the station do this ({status}): {why}")]
    Forbidden {
        /// The status of the answer.
        status: u16,
        /// What the server says.
        why: String,
    },
    /// It is busy, or has a fault of its own.
    #[error("the server cannot do it now ({status}): {why}")]
    Busy {
        /// The status of the answer.
        status: u16,
        /// What the server says.
        why: String,
    },
    /// There is no token to be let in with.
    #[error("no access token: {0}")]
    NoToken(String),
    /// The answer is none that its protocol has.
    #[error("the server's answer cannot be used: {0}")]
    Answer(String),
    /// A receiver of messages does not take one now.
    #[error("the receiver cannot take the message now: {0}")]
    Later(String),
}
