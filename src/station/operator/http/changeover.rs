//! Answers while the station changes over to its next generation of workers, or ends: nobody waits for a
//! journal that is being checked.

use std::sync::Arc;

use axum::Router;
use axum::extract::State;
use axum::http::{StatusCode, Uri, header};
use axum::response::{Html, IntoResponse, Response};
use gaiter_language::Language;
use tokio::net::TcpListener;

use super::accept;
use super::connections::Connections;
use crate::station::runtime::stop::Stop;

/// What monitors are told.
const CHANGES_OVER: &str = "station-changes-over";

/// Where a browser finds the page.
const PAGE: &str = "/";

/// How long a browser waits before it asks for the page again, seconds.
const AGAIN_S: &str = "1";

/// Answers until the next generation does.
pub(super) async fn serve(listener: Arc<TcpListener>, language: Language, mut stop: Stop) {
    let answers = Router::new().fallback(answer).with_state(language);
    accept(&listener, &answers, &Arc::new(Connections::default()), &mut stop).await;
}

/// 503 in any case. A browser that wanted the page shows why, and asks again.
async fn answer(State(language): State<Language>, uri: Uri) -> Response {
    let headers = [
        (header::RETRY_AFTER, AGAIN_S),
        (header::CACHE_CONTROL, "no-store"),
        (header::CONTENT_SECURITY_POLICY, "default-src 'none'"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ];
    let answer = if uri.path() == PAGE {
        let (tag, text) = (language.tag(), language.text("page.changes_over"));
        let html = format!(
            "<!doctype html><html lang=\"{tag}\"><meta charset=\"utf-8\">\
             <title>gaiter</title><p>{text}</p></html>\n"
        );
        ([(header::REFRESH, AGAIN_S)], Html(html)).into_response()
    } else {
        format!("{CHANGES_OVER}\n").into_response()
    };
    (StatusCode::SERVICE_UNAVAILABLE, headers, answer).into_response()
}
