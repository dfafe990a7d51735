//! Why a store that is a server does not take a record now.

use gaiter_flow::cause::Cause;

use gaiter_https::{EndpointFault, HttpFault};
use gaiter_record::archive::WordFault;

/// Why a server does not take a record now. It may later, so it is asked again.
///
/// A server's message is reported in one line, without the patient's id and the station's credentials.
#[derive(Debug, thiserror::Error)]
pub enum ServerFault {
    /// It gave no answer, or could not be asked.
    #[error(transparent)]
    Http(#[from] HttpFault),
    /// The key of the site is none.
    #[error("the secret for the server cannot be read: {0}")]
    SiteKey(WordFault),
    /// It lets the station in no more, or not for this.
    #[error("the server does not let the station do this ({status}): {why}")]
    Forbidden {
        status: u16,
        /// The server's message.
        why: String,
    },
    /// It is busy, or has a fault of its own.
    #[error("the server cannot do it now ({status}): {why}")]
    Busy {
        status: u16,
        /// The server's message.
        why: String,
    },
    /// There is no token to be let in with.
    #[error("no access token: {0}")]
    NoToken(#[from] TokenFault),
    /// The answer is none that its protocol has.
    #[error("the server's answer cannot be used: {0}")]
    Answer(String),
    /// A server that is asked over associations does not do it now.
    #[cfg(feature = "dicom")]
    #[error("the DICOM server cannot do it now: {0}")]
    Dimse(gaiter_dicom::dimse::DimseFault),
    /// It does not show what it was sent, or has confirmed: it may yet.
    #[error("the server does not show what it was sent; it may yet")]
    NotShown,
    /// A receiver of messages does not take one now.
    #[error("the receiver cannot take the message now: {0}")]
    Later(String),
}

/// Why there is no access token.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TokenFault {
    /// The server names no place of tokens.
    #[error(
        "the server does not say where tokens are given (.well-known/smart-configuration); \
         store.fhir.token_address can"
    )]
    NoPlace,
    /// The place of tokens cannot be asked.
    #[error("the place where tokens are given cannot be asked: {0}")]
    Place(EndpointFault),
    /// The answer has no token.
    #[error("the answer holds none")]
    NotThere,
    /// The place of tokens gives none.
    #[error("the server answers {status}: {why}")]
    Refused {
        status: u16,
        /// The server's message.
        why: String,
    },
    /// The station's key is none that can sign.
    #[error("the key is no private key of P-384 or RSA (2048 bits or more) as PKCS#8 (PEM)")]
    Key,
    /// The machine cannot sign.
    #[error("the statement of the station cannot be signed")]
    NotSigned,
    /// Password or token hold what no header can have.
    #[error("password or token hold characters that cannot be sent")]
    Characters,
}

impl ServerFault {
    /// Whether a working server may answer so for one record, such as one that is locked there.
    pub fn is_of_a_record(&self) -> bool {
        match self {
            ServerFault::Later(_) | ServerFault::Answer(_) | ServerFault::NotShown => true,
            ServerFault::Http(fault) => matches!(fault, HttpFault::TooLong { .. }),
            ServerFault::Busy { status, .. } => matches!(status, 409 | 412 | 423),
            #[cfg(feature = "dicom")]
            ServerFault::Dimse(fault) => fault.is_of_an_answer(),
            ServerFault::SiteKey(_) | ServerFault::Forbidden { .. } | ServerFault::NoToken(_) => {
                false
            }
        }
    }

    /// Why, for people.
    pub fn cause(&self) -> Cause {
        let figures =
            |status: u16, why: &str| [("status", status.to_string()), ("why", why.to_owned())];
        match self {
            ServerFault::Http(fault) => fault.cause(),
            ServerFault::SiteKey(fault) => {
                Cause::known("server-secret", [("why", fault.to_string())])
            }
            ServerFault::Forbidden { status, why } => {
                Cause::known("server-forbids", figures(*status, why))
            }
            ServerFault::Busy { status, why } => Cause::known("server-busy", figures(*status, why)),
            ServerFault::NoToken(fault) => {
                Cause::known("server-no-token", [("why", fault.to_string())])
            }
            ServerFault::Answer(why) => Cause::known("server-answer", [("why", why.clone())]),
            #[cfg(feature = "dicom")]
            ServerFault::Dimse(fault) => Cause::known("server-dimse", [("why", fault.to_string())]),
            // A take-back waits for it, and no store is out of reach by it.
            ServerFault::NotShown => Cause::verbatim(self),
            ServerFault::Later(why) => Cause::known("receiver-later", [("why", why.clone())]),
        }
    }
}

#[cfg(test)]
mod tests {
    use gaiter_language::Language;

    use super::*;

    #[test]
    fn a_fault_of_a_server_is_told_in_each_language() {
        let busy = ServerFault::Busy { status: 503, why: "restarting".to_owned() };
        let cause = busy.cause();
        assert_eq!(cause.to_string(), busy.to_string());
        assert_eq!(
            cause.in_words(Language::De),
            "der Server kann es zurzeit nicht ausführen (503): restarting"
        );
        for fault in [
            ServerFault::Forbidden { status: 403, why: "scope".to_owned() },
            ServerFault::NoToken(TokenFault::NotThere),
            ServerFault::SiteKey(WordFault::SiteKey),
            ServerFault::Answer("no bundle".to_owned()),
            ServerFault::Later("AE: full".to_owned()),
            #[cfg(feature = "dicom")]
            ServerFault::Dimse(gaiter_dicom::dimse::DimseFault::Aborted),
            ServerFault::Http(HttpFault::Redirect),
        ] {
            let cause = fault.cause();
            assert_eq!(cause.to_string(), fault.to_string());
            assert_ne!(cause.in_words(Language::De), cause.to_string(), "{fault:?}");
        }
    }
}
