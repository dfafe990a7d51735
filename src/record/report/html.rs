//! `report.html`: one file that works offline, for the screen in both themes and for A4 paper.

mod markup;
mod parts;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

use self::markup::{element, escaped};
use super::{Content, VIEWER};
use crate::record::Record;
use crate::record::picture::figures::Figure;
use crate::record::picture::svg;

/// The style sheet of the page.
const STYLE: &str = include_str!("report.css");

/// Starts the view when the page is loaded. The record is embedded in the page.
const BEGIN: &str = include_str!("begin.js");

/// Makes the page of a record with its content and with figures in the same language. The same record gives
/// the same bytes.
///
/// # Errors
/// If a figure of the record cannot be written as JSON.
pub fn page(
    record: &Record,
    content: &Content,
    figures: &[Figure],
) -> Result<String, serde_json::Error> {
    // `<` in the JSON's strings could end the script element, and it occurs nowhere else in JSON.
    let json = serde_json::to_string(record)?.replace('<', "\\u003c");
    let style = format!("{STYLE}{}", svg::dark_rules());
    let script = format!("{VIEWER}\n{BEGIN}");
    Ok(format!(
        "<!doctype html>\n<html lang=\"{}\">\n<head>\n{}<style>{style}</style>\n</head>\n<body>\n{}\
         <script type=\"application/json\" id=\"record\">{json}</script>\n\
         <script>{script}</script>\n</body>\n</html>\n",
        content.language.tag(),
        head(content, &policy(&style, &script)),
        body(content, figures),
    ))
}

fn head(content: &Content, policy: &str) -> String {
    format!(
        "<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta name=\"referrer\" content=\"no-referrer\">\n\
         <title>{}</title>\n",
        escaped(&format!("{} – {}", content.title, content.patient))
    )
}

/// The policy: nothing is fetched, and only the embedded script and style are allowed.
fn policy(style: &str, script: &str) -> String {
    let hash = |text: &str| STANDARD.encode(Sha256::digest(text.as_bytes()));
    format!(
        "default-src 'none'; style-src 'sha256-{}'; script-src 'sha256-{}'; base-uri 'none'; \
         form-action 'none'",
        hash(style),
        hash(script)
    )
}

fn body(content: &Content, figures: &[Figure]) -> String {
    let parts = [
        parts::verdict(content),
        parts::levels(content, figures),
        parts::view(content),
        parts::notes(content),
        parts::tables(content),
        parts::pictures(content, figures),
        parts::entries("surfaces", &content.surfaces),
        parts::entries("legend", &content.legend),
        parts::landmarks(content),
        parts::facts(content),
    ];
    format!("{}{}", parts::header(content), element("main", "", &parts.concat()))
}
