//! How the station shows a server that it may.

use std::sync::PoisonError;
use std::time::{Duration, Instant};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use hyper::header::{AUTHORIZATION, HeaderName, HeaderValue};

use super::{FhirStore, smart};
use crate::flow::server::fhir::{Access, SmartAccess};
use crate::store::http::HttpClient;
use crate::store::secret;
use crate::store::server::ServerFault;

/// A token is renewed so long before its end.
const BEFORE_END: Duration = Duration::from_secs(30);

/// A token with its end.
#[derive(Debug, Clone)]
pub(super) struct Token {
    pub value: String,
    pub until: Instant,
}

impl FhirStore {
    /// The header that shows that the station may; `None` if none is needed.
    pub(super) fn authorization(
        &self,
        client: &HttpClient,
    ) -> Result<Option<(HeaderName, HeaderValue)>, ServerFault> {
        let text = match &self.server.access {
            Access::Open => return Ok(None),
            Access::Basic { user, password } => {
                format!("Basic {}", STANDARD.encode(format!("{user}:{}", secret::read(password)?)))
            }
            Access::Bearer { token } => format!("Bearer {}", secret::read(token)?),
            Access::Smart(smart) => format!("Bearer {}", self.token(client, smart)?),
        };
        let mut value = HeaderValue::from_str(&text)
            .map_err(|_| ServerFault::NoToken("it has signs that no header can have".to_owned()))?;
        value.set_sensitive(true);
        Ok(Some((AUTHORIZATION, value)))
    }

    fn token(&self, client: &HttpClient, smart: &SmartAccess) -> Result<String, ServerFault> {
        let mut token = self.token.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        if let Some(known) = token.as_ref().filter(|known| known.until > now + BEFORE_END) {
            return Ok(known.value.clone());
        }
        let (value, lasts) = smart::token(client, smart, &self.server.base)?;
        *token = Some(Token { value: value.clone(), until: now + lasts });
        Ok(value)
    }

    /// Forgets the token that the server did not take. Returns whether another can be had.
    pub(super) fn forget_token(&self) -> bool {
        let mut token = self.token.lock().unwrap_or_else(PoisonError::into_inner);
        *token = None;
        matches!(self.server.access, Access::Smart(_))
    }
}
