//! What the answers of an archive of images mean.

use gaiter_dicom::{NotStored, web};
use gaiter_record::shown::in_a_line;
use http::{Response, StatusCode};

use crate::store::server::ServerFault;
use crate::store::{Rejection, StoreFault};

/// What a search has found, which may be nothing, or that the answer lists nothing of the kind.
pub(super) fn found<T: Default>(
    answer: &Response<Vec<u8>>,
    secret: Option<&[&str]>,
    read: impl Fn(&[u8]) -> Option<T>,
    kind: &str,
) -> Result<T, StoreFault> {
    if answer.status() == StatusCode::NO_CONTENT {
        return Ok(T::default());
    }
    if !answer.status().is_success() {
        return Err(refusal(answer, secret));
    }
    read(answer.body())
        .ok_or_else(|| ServerFault::Answer(format!("it does not list {kind}")).into())
}

/// An object that the archive did not store.
#[derive(Debug)]
pub(super) struct Failed {
    /// The status of its answer.
    pub status: u16,
    pub why: NotStored,
}

/// Whether the object of a request was stored, as far as the answer tells. Without the words that must get into no log,
/// nothing that it says is repeated.
pub(super) fn stored(
    answer: &Response<Vec<u8>>,
    secret: Option<&[&str]>,
) -> Result<Option<Failed>, StoreFault> {
    let status = answer.status();
    // With a conflict the body tells why the object was not stored.
    if !status.is_success() && status != StatusCode::CONFLICT {
        return Err(refusal(answer, secret));
    }
    match web::stored(answer.body()) {
        Some(Err(why)) => Ok(Some(Failed { status: status.as_u16(), why })),
        Some(Ok(())) => Ok(None),
        None if status.is_success() => Ok(None),
        None => Err(refusal(answer, secret)),
    }
}

/// What it means that some of so many objects were not stored: if one never will be, a person must decide.
pub(super) fn judged(failed: &[Failed], count: usize) -> Result<(), StoreFault> {
    let lasting = failed.iter().find(|of| !of.why.is_passing());
    let Some(of) = lasting.or(failed.first()) else { return Ok(()) };
    let Failed { status, why: NotStored { reason } } = *of;
    let why = format!("{} of {count} objects were not stored, reason {reason:04X}", failed.len());
    match lasting {
        Some(_) => Err(StoreFault::Permanent(Rejection::ServerRefused { status, why })),
        None => Err(ServerFault::Busy { status, why }.into()),
    }
}

/// The fault of an answer that is none of success.
fn refusal(answer: &Response<Vec<u8>>, secret: Option<&[&str]>) -> StoreFault {
    let text = String::from_utf8_lossy(answer.body());
    let why = match (text.trim(), secret) {
        ("", _) => "it does not say why".to_owned(),
        (_, None) => "what it says may name the patient".to_owned(),
        (text, Some(secret)) => in_a_line(text, secret),
    };
    StoreFault::of_status(answer.status().as_u16(), why)
}
