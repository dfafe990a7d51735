//! `report.html`: one file that works offline, for the screen in both themes and for A4 paper.

mod markup;
mod parts;

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gaiter_language::{Language, Piece, pieces};
use sha2::{Digest, Sha256};

use self::markup::element;
use super::document::{Block, Document};
use super::{Head, Paper};
use crate::picture::svg;
use crate::shown::escaped;

/// The style sheet of the page.
const STYLE: &str = include_str!("report.css");

/// What works on the page once it is loaded: its buttons, the age of the scan, the view.
const BEGIN: &str = include_str!("begin.js");

/// Makes the page of a report. The same report gives the same bytes.
///
/// # Errors
/// If a figure of a view cannot be written as JSON.
pub fn page(of: &Document, paper: Paper) -> Result<String, serde_json::Error> {
    let head = &of.head;
    let style = format!("{STYLE}{}{}", svg::dark_rules(), printed_margins(head, paper));
    let view = of.blocks.iter().find_map(|block| match block {
        Block::View(view) => Some(view),
        _ => None,
    });
    let (record, viewer) = match view {
        None => (String::new(), String::new()),
        Some(view) => {
            // `<` in the JSON's strings could end the script element, and it occurs nowhere else in JSON.
            let json = serde_json::to_string(&view.record)?.replace('<', "\\u003c");
            let record =
                format!("<script type=\"application/json\" id=\"record\">{json}</script>\n");
            (record, viewer(head.language, &view.words)?)
        }
    };
    let script = format!("{viewer}\n{BEGIN}");
    Ok(format!(
        "<!doctype html>\n<html lang=\"{}\">\n<head>\n{}<style>{style}</style>\n</head>\n<body>\n{}{}\
         {record}<script>{script}</script>\n</body>\n</html>\n",
        head.language.tag(),
        self::head(head, &policy(&style, &script)),
        parts::header(head, of.paper.as_ref()),
        element("main", "", &body(of)),
    ))
}

/// The blocks of a report. The content before its turn is the first page on paper.
fn body(of: &Document) -> String {
    let language = of.head.language;
    let appended = of.appendix.iter().flat_map(|of| &of.blocks);
    let all = of.blocks.iter().chain(appended).enumerate();
    let all: Vec<String> = all.map(|(index, of)| block(index, of, language)).collect();
    let (blocks, appended) = all.split_at(of.blocks.len());
    let turn = of.blocks.iter().position(|block| matches!(block, Block::Turn)).unwrap_or(0);
    let (first, others) = blocks.split_at(turn);
    let first = match first {
        [] => String::new(),
        first => parts::tools(language) + &element("div", " class=\"first-page\"", &first.concat()),
    };
    let appendix = of.appendix.as_ref().map(|of| parts::appendix(&of.title, &appended.concat()));
    first + &others.concat() + &appendix.unwrap_or_default()
}

/// A part of a report, with its place among all of them.
fn block(index: usize, of: &Block, language: Language) -> String {
    let id = format!("part-{index}");
    match of {
        Block::Verdict(sentences) => parts::verdict(sentences),
        Block::Sheet(sheet) => parts::sheet(&id, sheet),
        Block::Notes { notes, summary } => parts::notes(&id, notes, summary, language),
        Block::Section(section) => parts::entries(&id, section),
        Block::Facts(facts) => parts::facts(&id, facts),
        Block::Table(table) => parts::table(&id, table),
        Block::Picture { title, figure, caption, .. } => {
            parts::picture(&id, title, figure, caption)
        }
        Block::View(view) => parts::view(&id, view, language),
        Block::Turn => String::new(),
    }
}

/// The rules for paper: its format, and the patient and the number on every page.
fn printed_margins(head: &Head, paper: Paper) -> String {
    let number = head.language.text("report.page_number");
    let number: String = pieces(number)
        .map(|piece| match piece {
            Piece::Words(words) => css_string(words),
            Piece::Place { name: "page", .. } => " counter(page) ".to_owned(),
            Piece::Place { .. } => " counter(pages) ".to_owned(),
        })
        .collect();
    format!(
        "@page {{ size: {}; @top-left {{ content: {}; }} @top-right {{ content: {}; }} \
         @bottom-left {{ content: {}; }} @bottom-right {{ content: {number}; }} }}\n",
        paper.name(),
        css_string(&head.patient),
        css_string(&head.taken),
        css_string(&head.title),
    )
}

/// A text as a string of a style sheet. What is not a letter or digit is escaped: it could end the string
/// or the style element.
fn css_string(text: &str) -> String {
    let escaped = |of: char| match of {
        of if of.is_alphanumeric() => of.to_string(),
        of => format!("\\{:x} ", u32::from(of)),
    };
    format!("\"{}\"", text.chars().map(escaped).collect::<String>())
}

fn head(head: &Head, policy: &str) -> String {
    format!(
        "<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta name=\"referrer\" content=\"no-referrer\">\n\
         <title>{}</title>\n",
        escaped(&format!("{} – {}", head.title, head.patient))
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

// The 3D view of a record's legs: own WebGL code without libraries or network access. Its parts form one script,
// which has the words of a language before it.

/// The script without words. `gaiterViewer.mount(element, record, {patient})` shows the legs of a
/// `record.json` in an element; `patient` is the id as the page shows it, if it does.
pub const VIEWER: &str = concat!(
    include_str!("viewer/1_constants.js"),
    include_str!("viewer/2_reading.js"),
    include_str!("viewer/3_geometry.js"),
    include_str!("viewer/4_tape.js"),
    include_str!("viewer/5_camera.js"),
    include_str!("viewer/6_gpu.js"),
    include_str!("viewer/7_labels.js"),
    include_str!("viewer/8_inputs.js"),
    include_str!("viewer/9_page.js"),
);

/// The script with the words of a language, some of which are replaced by others.
///
/// # Errors
/// If the words cannot be written as JSON.
pub fn viewer(
    language: Language,
    others: &[(&'static str, String)],
) -> Result<String, serde_json::Error> {
    let mut words: BTreeMap<&str, &str> = language.table("viewer").collect();
    words.insert("point", language.decimal_sign());
    words.insert("tag", language.tag());
    words.extend(others.iter().map(|(key, text)| (*key, text.as_str())));
    // `<` could end the script's element.
    let words = serde_json::to_string(&words)?.replace('<', "\\u003c");
    Ok(format!("globalThis.gaiterViewerWords = {words};\n{VIEWER}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_text_ends_its_string_in_a_style_sheet_or_the_style_sheet() {
        assert_eq!(css_string("4711"), "\"4711\"");
        assert_eq!(css_string("P 47"), "\"P\\20 47\"");
        for hostile in ["\"; } * { display: none", "</style><script>", "\\", "a\nb", "\u{202e}4711"]
        {
            let string = css_string(hostile);
            let inside = &string[1..string.len() - 1];
            let is_safe = |of: char| of.is_alphanumeric() || of == '\\' || of == ' ';
            assert!(inside.chars().all(is_safe), "{inside}");
        }
    }
}
