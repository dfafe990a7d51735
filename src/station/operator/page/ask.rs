//! What an operator decides on the page, for clients that show the token from this endpoint's own page;
//! and what a verb of the command line asks at the control socket. The same answers carry it out.

use std::sync::Arc;

use axum::body::{Bytes, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use gaiter_flow::page::of_fault;
use gaiter_language::Language;
use serde::Serialize;
use tokio::task::spawn_blocking;

use super::endpoint::HttpEndpoint;
use super::{assets, guard};
use crate::station::operator::control::answer;
use crate::station::operator::control::protocol::{
    self, ControlAnswer, ControlFault, ControlFaultKind,
};

/// The longest decision, bytes; an id fits many times over.
const MOST: usize = 16 * 1024;

/// The reply to a decision.
#[derive(Serialize)]
struct Reply {
    /// Stable code; `None` if it was carried out.
    code: Option<String>,
    /// A sentence for the operator.
    sentence: String,
}

/// Carries out a decision.
pub async fn ask(State(endpoint): State<Arc<HttpEndpoint>>, request: Request) -> Response {
    if let Some(refused) = refusal(&endpoint, request.headers()) {
        return refused;
    }
    let Ok(body) = to_bytes(request.into_body(), MOST).await else {
        return refused(StatusCode::PAYLOAD_TOO_LARGE, "too-large", "this is too long");
    };
    let asked = serde_json::from_slice::<protocol::Request>(&body).ok();
    let Some((asked, verb)) = asked.and_then(|asked| verb(&asked).map(|verb| (asked, verb))) else {
        return refused(StatusCode::BAD_REQUEST, "malformed", "this is not a decision");
    };
    let language = endpoint.desk.core.config.language;
    let answered = spawn_blocking(move || {
        let answered = answer(&endpoint.desk, &asked);
        endpoint.desk.refresh.notify_one();
        answered
    });
    match answered.await {
        Ok(answered) => reply(answered, verb, language),
        Err(_) => refused(StatusCode::INTERNAL_SERVER_ERROR, "panic", "the answer was interrupted"),
    }
}

/// Answers a verb. Only the station's user and root get here.
pub async fn answer_verb(State(endpoint): State<Arc<HttpEndpoint>>, body: Bytes) -> Response {
    let answered =
        spawn_blocking(move || match serde_json::from_slice::<protocol::Request>(&body) {
            Ok(request) => answer(&endpoint.desk, &request),
            Err(error) => {
                let message = format!("the request cannot be read: {error}");
                ControlAnswer::Fault(ControlFault::new(
                    ControlFaultKind::Request,
                    "request-malformed",
                    message,
                ))
            }
        });
    match answered.await {
        Ok(answer) => json(&answer),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

/// Gives a reader who shows the token the cookie for reading.
pub async fn enter(State(endpoint): State<Arc<HttpEndpoint>>, headers: HeaderMap) -> Response {
    let token = endpoint.desk.token();
    match (refusal(&endpoint, &headers), token) {
        (None, Some(token)) => {
            let reply = Reply { code: None, sentence: String::new() };
            ([(header::SET_COOKIE, token.cookie())], json(&reply)).into_response()
        }
        (Some(refused), _) => refused,
        (None, None) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

/// Why a request must not decide anything, or read what only an operator may read.
pub(super) fn refusal(endpoint: &HttpEndpoint, headers: &HeaderMap) -> Option<Response> {
    if !guard::is_own(headers) {
        let why = "only the station's own page can decide";
        return Some(refused(StatusCode::FORBIDDEN, "origin", why));
    }
    let token = endpoint.desk.token();
    if !token.is_some_and(|token| token.is_shown_in(headers)) {
        let why = endpoint.desk.core.config.language.text("page.link_expired");
        return Some(refused(StatusCode::UNAUTHORIZED, "token", why));
    }
    let kind = headers.get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    let kind = kind.and_then(|kind| kind.split(';').next()).map(str::trim);
    (kind != Some("application/json"))
        .then(|| refused(StatusCode::UNSUPPORTED_MEDIA_TYPE, "media-type", "a decision is JSON"))
}

/// The verb of a decision that the page may ask for; `None` for everything else.
fn verb(request: &protocol::Request) -> Option<&'static str> {
    use protocol::Request;
    match request {
        Request::Retry { .. } => Some("retry"),
        Request::Release { .. } => Some("release"),
        Request::Assign { .. } => Some("assign"),
        Request::Unassign { .. } => Some("unassign"),
        Request::GiveUp { .. } => Some("give_up"),
        Request::Amend { .. } => Some("amend"),
        Request::NameAffected { .. } => Some("name_affected"),
        Request::NameNext { .. } | Request::NameListed { .. } => Some("name_next"),
        Request::CallOff => Some("call_off"),
        Request::Pause => Some("pause"),
        Request::Resume => Some("resume"),
        // What concerns all of a person needs the machine's user, not only the page's link.
        _ => None,
    }
}

fn reply(answered: ControlAnswer, verb: &str, language: Language) -> Response {
    match answered {
        ControlAnswer::Fault(fault) => {
            let status = match fault.kind {
                ControlFaultKind::Request => StatusCode::CONFLICT,
                ControlFaultKind::Unknown => StatusCode::NOT_FOUND,
                ControlFaultKind::Failed => StatusCode::SERVICE_UNAVAILABLE,
            };
            let of_code = || of_fault(&fault.code, language).unwrap_or(&fault.message);
            let sentence = fault.on_page.as_deref().unwrap_or_else(of_code);
            refused(status, &fault.code, sentence)
        }
        _ => {
            let sentence = language.word("page.done", verb).to_owned();
            json(&Reply { code: None, sentence })
        }
    }
}

fn refused(status: StatusCode, code: &str, sentence: &str) -> Response {
    let reply = Reply { code: Some(code.to_owned()), sentence: sentence.to_owned() };
    (status, json(&reply)).into_response()
}

pub(super) fn json(reply: &impl Serialize) -> Response {
    match serde_json::to_string(reply) {
        Ok(text) => ([assets::JSON], text).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}
