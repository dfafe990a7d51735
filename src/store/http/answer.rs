//! The answer of a server.

use http_body_util::BodyExt;
use hyper::Response;
use hyper::body::Incoming;
use hyper::header::{HeaderMap, HeaderName};

use super::fault::HttpFault;

/// An answer, read to its end.
#[derive(Debug, Clone)]
pub struct HttpAnswer {
    /// Its status, such as 201.
    pub status: u16,
    /// Its headers.
    pub headers: HeaderMap,
    /// Its body.
    pub body: Vec<u8>,
}

impl HttpAnswer {
    /// A header as text; `None` if it is missing or not ASCII.
    pub fn header(&self, name: &HeaderName) -> Option<&str> {
        self.headers.get(name)?.to_str().ok()
    }

    /// Whether it did what was asked.
    pub fn is_success(&self) -> bool {
        (200..300).contains(&self.status)
    }
}

/// Reads an answer to its end, up to this many bytes.
pub(super) async fn read(answer: Response<Incoming>, most: usize) -> Result<HttpAnswer, HttpFault> {
    let (head, mut incoming) = answer.into_parts();
    if head.status.is_redirection() {
        return Err(HttpFault::Redirect);
    }
    let mut body = Vec::new();
    while let Some(frame) = incoming.frame().await {
        let frame = frame?;
        let Some(data) = frame.data_ref() else { continue };
        if body.len() + data.len() > most {
            return Err(HttpFault::TooLong { most });
        }
        body.extend_from_slice(data);
    }
    Ok(HttpAnswer { status: head.status.as_u16(), headers: head.headers, body })
}
