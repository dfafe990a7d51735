//! How the station shows a server that it may.

use std::sync::{MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gaiter_https::secret;
use http::header::HeaderValue;

use super::server::{FhirAccess, SmartAccess};
use super::{FhirStore, smart};
use crate::store::server::{ServerFault, TokenFault};

/// A token is renewed so long before its end, or when half of its time is over.
const BEFORE_END: Duration = Duration::from_secs(30);

/// A token as it is shown.
#[derive(Debug, Clone)]
pub(super) struct Token {
    /// Its `Debug` hides the value.
    shown: HeaderValue,
    renewed_at: Instant,
}

impl Token {
    /// A token that was given at this time and holds for so long.
    fn new(shown: HeaderValue, given: Instant, lasts: Duration) -> Token {
        Token { shown, renewed_at: given + (lasts - BEFORE_END.min(lasts / 2)) }
    }

    fn holds(&self, now: Instant) -> bool {
        now < self.renewed_at
    }
}

impl FhirStore {
    /// What the header `Authorization` holds; `None` if none is needed.
    pub(super) fn authorization(&self) -> Result<Option<HeaderValue>, ServerFault> {
        let text = match &self.server.access {
            FhirAccess::Open => return Ok(None),
            FhirAccess::Basic { user, password } => {
                format!("Basic {}", STANDARD.encode(format!("{user}:{}", secret::read(password)?)))
            }
            FhirAccess::Bearer { token } => format!("Bearer {}", secret::read(token)?),
            FhirAccess::Smart(smart) => return self.token(smart).map(Some),
        };
        Ok(Some(header_value(&text)?))
    }

    fn token(&self, smart: &SmartAccess) -> Result<HeaderValue, ServerFault> {
        let mut kept = self.kept_token();
        let now = Instant::now();
        if let Some(token) = kept.as_ref().filter(|token| token.holds(now)) {
            return Ok(token.shown.clone());
        }
        let (value, lasts) = smart::token(&self.client, smart, &self.server.base)?;
        let shown = header_value(&format!("Bearer {value}"))?;
        *kept = Some(Token::new(shown.clone(), now, lasts));
        Ok(shown)
    }

    /// Forgets the token that the server did not take. Returns whether another can be had.
    pub(super) fn forget_token(&self) -> bool {
        *self.kept_token() = None;
        matches!(self.server.access, FhirAccess::Smart(_))
    }

    fn kept_token(&self) -> MutexGuard<'_, Option<Token>> {
        self.token.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn header_value(text: &str) -> Result<HeaderValue, TokenFault> {
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
    fn a_token_is_renewed_before_its_end_and_a_short_one_at_half_its_time() {
        let given = Instant::now();
        for (lasts_s, renewed_s) in [(300, 270), (60, 30), (40, 20), (1, 0), (0, 0)] {
            let token = header_value("Bearer x").unwrap();
            let token = Token::new(token, given, Duration::from_secs(lasts_s));
            let at = |s: u64| given + Duration::from_secs(s);
            assert!(!token.holds(at(renewed_s) + Duration::from_millis(500)), "{lasts_s}");
            assert!(renewed_s == 0 || token.holds(at(renewed_s) - Duration::from_millis(1)));
            assert!(!token.holds(at(lasts_s)), "{lasts_s}");
        }
    }

    #[test]
    fn what_is_shown_is_in_no_debug_output_and_is_known_as_secret() {
        let token = Token::new(header_value("Bearer abc123").unwrap(), Instant::now(), BEFORE_END);
        assert!(!format!("{token:?}").contains("abc123"));
        assert_eq!(secret_words(&token.shown), ["abc123"]);
        let basic =
            header_value(&format!("Basic {}", STANDARD.encode("station:word:with colon"))).unwrap();
        let words = secret_words(&basic);
        assert_eq!(words, [STANDARD.encode("station:word:with colon").as_str(), "word:with colon"]);
        for text in ["Bearer a\nb", "Bearer a€b"] {
            assert_eq!(header_value(text), Err(TokenFault::Characters));
        }
    }
}
