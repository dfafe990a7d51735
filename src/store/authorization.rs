//! What the header `Authorization` shows a server, and what of it must get into no log.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gaiter_https::{Secret, secret};
use http::header::HeaderValue;

use super::server::{ServerFault, TokenFault};

/// A user with a password.
pub(super) fn basic(user: &str, password: &Secret) -> Result<HeaderValue, ServerFault> {
    let both = format!("{user}:{}", secret::read(password)?);
    Ok(header(&format!("Basic {}", STANDARD.encode(both)))?)
}

/// A token that does not change.
pub(super) fn bearer(token: &Secret) -> Result<HeaderValue, ServerFault> {
    Ok(header(&format!("Bearer {}", secret::read(token)?))?)
}

/// A text as the header. Its `Debug` hides the value.
pub(super) fn header(text: &str) -> Result<HeaderValue, TokenFault> {
    // A header may have other letters, but the client sends none.
    let text = Some(text).filter(|text| text.is_ascii()).ok_or(TokenFault::Characters)?;
    let mut value = HeaderValue::from_str(text).map_err(|_| TokenFault::Characters)?;
    value.set_sensitive(true);
    Ok(value)
}

/// The words of what was shown that must get into no log: a token, or a password and what it was made to.
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
