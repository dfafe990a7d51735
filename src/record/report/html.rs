//! `report.html`: one file that needs no network, for the screen in both themes and for A4 paper.

mod markup;
mod parts;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

use self::markup::{element, escaped};
use super::{Content, VIEWER};
use crate::record::picture::figures::Figure;
use crate::record::picture::svg;
use crate::record::{Language, Record};

/// How the page looks.
const STYLE: &str = include_str!("report.css");

/// Begins the view when the page is read; the record stands in the page.
const BEGIN: &str = include_str!("begin.js");

/// The page of a record in a language, with its figures in that language. The same record gives the
/// same bytes.
///
/// # Errors
/// Where a figure of the record cannot be written as JSON.
pub fn page(
    record: &Record,
    language: Language,
    figures: &[Figure],
) -> Result<String, serde_json::Error> {
    let content = Content::of(record, language);
    // `<` within the JSON's strings could end the script's element; nothing else may hold it.
    let json = serde_json::to_string(record)?.replace('<', "\\u003c");
    let style = format!("{STYLE}{}", svg::dark_rules());
    let script = format!("{VIEWER}\n{BEGIN}");
    Ok(format!(
        "<!doctype html>\n<html lang=\"{}\">\n<head>\n{}<style>{style}</style>\n</head>\n<body>\n{}\
         <script type=\"application/json\" id=\"record\">{json}</script>\n\
         <script>{script}</script>\n</body>\n</html>\n",
        language.tag(),
        head(&content, &policy(&style, &script)),
        body(&content, figures),
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

/// Nothing is fetched, and nothing runs or paints but what was written here.
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
        parts::key_figures(content),
        parts::levels(content),
        parts::notes(content),
        parts::pictures(content, figures),
        parts::view(content),
        parts::tables(content),
        parts::entries("surfaces", &content.surfaces),
        parts::entries("legend", &content.legend),
        parts::landmarks(content),
        parts::facts(content),
    ];
    format!("{}{}", parts::header(content), element("main", "", &parts.concat()))
}
