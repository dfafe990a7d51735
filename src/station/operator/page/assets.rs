//! The page's own files, inside the binary, with the words of the station's language.

use std::sync::{Arc, OnceLock};

use axum::Router;
use axum::http::header::{CONTENT_TYPE, HeaderName};
use axum::response::Html;
use axum::routing::get;
use gaiter_language::Language;
use gaiter_record::report::viewer;
use gaiter_record::sha256;

use super::endpoint::HttpEndpoint;
use crate::station::operator::http::listeners::Way;

const PAGE: &str = include_str!("../web/page.html");
const KIOSK: &str = include_str!("../web/kiosk.html");
const STYLE: &str = include_str!("../web/page.css");
const SCRIPT: &str = concat!(
    include_str!("../web/decide.js"),
    include_str!("../web/amend.js"),
    include_str!("../web/search.js"),
    include_str!("../web/worklist.js"),
    include_str!("../web/page.js")
);
const ICON: &str = include_str!("../web/icon.svg");

/// The content type of scripts.
const JAVASCRIPT: &str = "text/javascript; charset=utf-8";

/// The content type of an answer for programs.
pub const JSON: (HeaderName, &str) = (CONTENT_TYPE, "application/json");

/// The page, the kiosk and what they load.
pub fn routes(endpoint: &HttpEndpoint) -> Router<Arc<HttpEndpoint>> {
    let language = endpoint.desk.core.config.language;
    let html = |template: &str| Html(fill(template, language, endpoint.way));
    let (page, kiosk) = (html(PAGE), html(KIOSK));
    let script = |text: &'static str| ([(CONTENT_TYPE, JAVASCRIPT)], text);
    // Without its words the view shows nothing, and the page shows everything else.
    let with_words = ([(CONTENT_TYPE, JAVASCRIPT)], viewer(language, &[]).unwrap_or_default());
    let style = ([(CONTENT_TYPE, "text/css; charset=utf-8")], STYLE);
    Router::new()
        .route("/", get(async move || page.clone()))
        .route("/kiosk", get(async move || kiosk.clone()))
        .route("/page.css", get(async move || style))
        .route("/icon.svg", get(async || ([(CONTENT_TYPE, "image/svg+xml")], ICON)))
        .route("/page.js", get(async move || script(SCRIPT)))
        .route("/viewer.js", get(async move || with_words.clone()))
}

/// The version of the page; a page that was loaded from another version reloads itself. It is computed once:
/// every snapshot has it.
pub fn version(language: Language) -> &'static str {
    static ALL: [OnceLock<String>; Language::ALL.len()] =
        [const { OnceLock::new() }; Language::ALL.len()];
    ALL[language as usize].get_or_init(|| {
        let (labels, viewer) = (labels(language), viewer(language, &[]).unwrap_or_default());
        let parts = [env!("CARGO_PKG_VERSION"), PAGE, KIOSK, STYLE, SCRIPT, &viewer, &labels];
        sha256(parts.join("\0").as_bytes()).chars().take(16).collect()
    })
}

/// The labels as an object for the script. `<` is escaped because it could end the enclosing element.
fn labels(language: Language) -> String {
    let pairs = language.table("page.label").map(|(key, text)| format!("{key:?}:{text:?}"));
    format!("{{{}}}", pairs.collect::<Vec<_>>().join(",")).replace('<', "\\u003c")
}

/// A page with its words: `{{page}}`, `{{language}}`, `{{way}}`, `{{labels}}`, and labels by key.
fn fill(template: &str, language: Language, way: Way) -> String {
    let mut parts = template.split("{{");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (key, rest) = part.split_once("}}").unwrap_or((part, ""));
        match key {
            "page" => text += version(language),
            "language" => text += language.tag(),
            "way" => text += way.word(),
            "labels" => text += &labels(language),
            key => text += language.word("page.label", key),
        }
        text += rest;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use gaiter_flow::page::files::FIRST;
    use gaiter_record::report::VIEWER;

    fn keys(template: &str) -> Vec<&str> {
        template.split("{{").skip(1).filter_map(|part| part.split("}}").next()).collect()
    }

    #[test]
    fn every_word_of_the_page_is_known_and_every_known_word_is_used() {
        let own = ["page", "language", "way", "labels"];
        let of_script = SCRIPT.split("label(\"").skip(1).filter_map(|part| part.split('"').next());
        let used: Vec<&str> = keys(PAGE).into_iter().chain(keys(KIOSK)).chain(of_script).collect();
        assert!(used.len() > 20, "{used:?}");
        for key in used.iter().filter(|key| !own.contains(key)) {
            let label = Language::En.find(&format!("page.label.{key}"));
            assert!(label.is_some(), "{key} has no words");
        }
        // The labels of decisions about a scan, and of its files, are found by their own names.
        let acts = ["assign", "give_up", "leave", "release", "retry", "unassign"];
        for (key, _) in Language::En.table("page.label") {
            let by_name = acts.contains(&key) || FIRST.contains(&key);
            let by_script = SCRIPT.contains(&format!("{key:?}"));
            assert!(by_name || by_script || used.contains(&key), "{key} is not used");
        }
    }

    #[test]
    fn a_page_is_filled_with_words_of_its_language() {
        for language in Language::ALL {
            for template in [PAGE, KIOSK] {
                let page = fill(template, language, Way::Local);
                assert!(!page.contains("{{"), "{page}");
                assert!(page.contains(version(language)));
            }
        }
        assert!(fill(PAGE, Language::De, Way::Local).contains("lang=\"de\""));
        assert_ne!(version(Language::En), version(Language::De));
    }

    #[test]
    fn labels_are_json_in_which_no_element_ends() {
        for language in Language::ALL {
            let labels = labels(language);
            let object: serde_json::Value = serde_json::from_str(&labels).unwrap();
            assert_eq!(object.as_object().unwrap().len(), language.table("page.label").count());
            assert!(!labels.contains('<'));
        }
    }

    #[test]
    fn the_page_is_small() {
        let sizes = [PAGE, KIOSK, STYLE, SCRIPT, VIEWER].map(str::len);
        assert!(sizes.iter().sum::<usize>() < 300_000, "{sizes:?}");
    }
}
