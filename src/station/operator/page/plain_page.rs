//! A page of one sentence, where there is no other answer.

use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use gaiter_language::Language;

/// The sentence of this key with the way back to the operator's page.
pub fn plain_page(status: StatusCode, key: &'static str, language: Language) -> Response {
    let (tag, text) = (language.tag(), |key| language.text(key));
    let (said, back) = (text(key), text("page.plain.back"));
    let page = format!(
        "<!doctype html>\n<html lang=\"{tag}\">\n<head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><title>{said}</title>\
         <link rel=\"stylesheet\" href=\"/page.css\"></head>\n\
         <body><main><h1>{said}</h1><p><a href=\"/\">{back}</a></p></main></body>\n</html>\n"
    );
    (status, [(header::CONTENT_TYPE, "text/html; charset=utf-8")], page).into_response()
}
