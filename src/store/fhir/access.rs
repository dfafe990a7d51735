//! How the station shows a server that it may.

use std::sync::{MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use http::header::HeaderValue;

use super::server::{FhirAccess, SmartAccess};
use super::{FhirStore, smart};
use crate::store::server::ServerFault;
use crate::store::web::header;

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
        match &self.server.access {
            FhirAccess::Http(access) => access.authorization(),
            FhirAccess::Smart(smart) => self.token(smart).map(Some),
        }
    }

    fn token(&self, smart: &SmartAccess) -> Result<HeaderValue, ServerFault> {
        let mut kept = self.kept_token();
        let now = Instant::now();
        if let Some(token) = kept.as_ref().filter(|token| token.holds(now)) {
            return Ok(token.shown.clone());
        }
        let (value, lasts) = smart::token(&self.client, smart, &self.server.base)?;
        let shown = header(&format!("Bearer {value}"))?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_renewed_before_its_end_and_a_short_one_at_half_its_time() {
        let given = Instant::now();
        for (lasts_s, renewed_s) in [(300, 270), (60, 30), (40, 20), (1, 0), (0, 0)] {
            let token = header("Bearer x").unwrap();
            let token = Token::new(token, given, Duration::from_secs(lasts_s));
            let at = |s: u64| given + Duration::from_secs(s);
            assert!(!token.holds(at(renewed_s) + Duration::from_millis(500)), "{lasts_s}");
            assert!(renewed_s == 0 || token.holds(at(renewed_s) - Duration::from_millis(1)));
            assert!(!token.holds(at(lasts_s)), "{lasts_s}");
        }
    }

    #[test]
    fn a_token_is_in_no_debug_output() {
        let shown = header("Bearer abc123").unwrap();
        let token = Token::new(shown, Instant::now(), BEFORE_END);
        assert!(!format!("{token:?}").contains("abc123"));
    }
}
