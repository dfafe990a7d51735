//! Servers that speak HTTP: how the station authenticates and asks, and what of that must get into no log.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gaiter_https::{EndpointFault, HttpFault, HttpsClient, Secret, secret};
use http::header::{ACCEPT, AUTHORIZATION, CACHE_CONTROL, CONTENT_TYPE, HeaderValue};
use http::{Method, Request, Response};

use super::server::{ServerFault, TokenFault};

/// Servers keep the result of a search, some for a minute: what was stored, or who was registered since, would be
/// missing.
const NO_CACHE: HeaderValue = HeaderValue::from_static("no-cache");

/// How the station authenticates. A certificate of its own is part of the connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum HttpAccess {
    /// It does not.
    Open,
    /// By user and password.
    Basic { user: String, password: Secret },
    /// By a token that does not change.
    Bearer { token: Secret },
}

impl HttpAccess {
    /// The secret that it needs.
    pub fn secret(&self) -> Option<&Secret> {
        match self {
            HttpAccess::Open => None,
            HttpAccess::Basic { password, .. } => Some(password),
            HttpAccess::Bearer { token } => Some(token),
        }
    }

    /// What the header `Authorization` holds; `None` if none is needed.
    pub(super) fn authorization(&self) -> Result<Option<HeaderValue>, ServerFault> {
        let read = |secret: &Secret| secret::read(secret).map_err(HttpFault::from);
        let text = match self {
            HttpAccess::Open => return Ok(None),
            HttpAccess::Basic { user, password } => {
                let both = format!("{user}:{}", read(password)?);
                format!("Basic {}", STANDARD.encode(both))
            }
            HttpAccess::Bearer { token } => format!("Bearer {}", read(token)?),
        };
        Ok(Some(header(&text)?))
    }
}

/// Asks a server, with a body of a media type or without. `shown` is what the header `Authorization` holds.
pub(super) fn asked(
    client: &HttpsClient,
    method: Method,
    address: &str,
    accept: &'static str,
    body: Option<(String, Vec<u8>)>,
    shown: Option<HeaderValue>,
) -> Result<Response<Vec<u8>>, ServerFault> {
    let mut request = Request::builder()
        .method(method)
        .uri(address)
        .header(ACCEPT, accept)
        .header(CACHE_CONTROL, NO_CACHE);
    if let Some(shown) = shown {
        request = request.header(AUTHORIZATION, shown);
    }
    let (media_type, body) = body.unzip();
    if let Some(media_type) = media_type {
        request = request.header(CONTENT_TYPE, media_type);
    }
    let request = request.body(body.unwrap_or_default());
    Ok(client.send(request.map_err(|_| HttpFault::from(EndpointFault::Address))?)?)
}

/// A text as the header. Its `Debug` hides the value.
pub(super) fn header(text: &str) -> Result<HeaderValue, TokenFault> {
    // A header may have other letters, but the client sends none.
    let text = Some(text).filter(|text| text.is_ascii()).ok_or(TokenFault::Characters)?;
    let mut value = HeaderValue::from_str(text).map_err(|_| TokenFault::Characters)?;
    value.set_sensitive(true);
    Ok(value)
}

/// The words of what was shown that must get into no log: a token, or a password and its encoded form.
pub(super) fn secret_words(shown: &HeaderValue) -> Vec<String> {
    let value = shown.to_str().ok().and_then(|text| text.split_once(' ')).map(|(_, value)| value);
    let Some(value) = value else { return Vec::new() };
    let made_of = STANDARD.decode(value).ok().and_then(|bytes| String::from_utf8(bytes).ok());
    let password = made_of.and_then(|text| text.split_once(':').map(|(_, word)| word.to_owned()));
    [Some(value.to_owned()), password].into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_is_in_no_debug_output_and_is_known_as_secret() {
        let bearer = header("Bearer abc123").unwrap();
        assert!(!format!("{bearer:?}").contains("abc123"));
        assert_eq!(secret_words(&bearer), ["abc123"]);
        let basic =
            header(&format!("Basic {}", STANDARD.encode("station:word:with colon"))).unwrap();
        let words = secret_words(&basic);
        assert_eq!(words, [STANDARD.encode("station:word:with colon").as_str(), "word:with colon"]);
        for text in ["Bearer a\nb", "Bearer a€b"] {
            assert_eq!(header(text), Err(TokenFault::Characters));
        }
    }
}
