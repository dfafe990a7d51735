//! `report.html`: one file that works offline, for the screen in both themes and for A4 paper.

mod markup;
mod parts;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gaiter_language::{Piece, pieces};
use sha2::{Digest, Sha256};

use self::markup::{element, escaped};
use super::document::{Block, Document};
use super::head::Head;
use super::print::parted;
use super::viewer::viewer_with;
use super::{Content, Paper, viewer};
use crate::Record;
use crate::picture::figures::Figure;
use crate::picture::svg;

/// The style sheet of the page.
const STYLE: &str = include_str!("report.css");

/// Starts the view when the page is loaded. The record is embedded in the page.
const BEGIN: &str = include_str!("begin.js");

/// The same for a view that is not of a record's own page.
const BEGIN_VIEW: &str = "gaiterViewer.mount(document.getElementById(\"view-place\"), \
     JSON.parse(document.getElementById(\"record\").textContent), {});\n";

/// Makes the page of a record with its content and with figures in the same language. The same record gives
/// the same bytes.
///
/// # Errors
/// If a figure of the record cannot be written as JSON.
pub fn page(
    record: &Record,
    content: &Content,
    figures: &[Figure],
    paper: Paper,
) -> Result<String, serde_json::Error> {
    // `<` in the JSON's strings could end the script element, and it occurs nowhere else in JSON.
    let json = serde_json::to_string(record)?.replace('<', "\\u003c");
    let style =
        format!("{STYLE}{}{}", svg::dark_rules(), printed_margins(&Head::of(content), paper));
    let script = format!("{}\n{BEGIN}", viewer(content.language)?);
    Ok(format!(
        "<!doctype html>\n<html lang=\"{}\">\n<head>\n{}<style>{style}</style>\n</head>\n<body>\n{}\
         <script type=\"application/json\" id=\"record\">{json}</script>\n\
         <script>{script}</script>\n</body>\n</html>\n",
        content.language.tag(),
        head(&Head::of(content), &policy(&style, &script)),
        body(content, figures),
    ))
}

/// Makes the page of a report of blocks. The same report gives the same bytes.
///
/// # Errors
/// If a figure of a view cannot be written as JSON.
pub fn document_page(of: &Document, paper: Paper) -> Result<String, serde_json::Error> {
    let language = of.head.language;
    let style = format!("{STYLE}{}{}", svg::dark_rules(), printed_margins(&of.head, paper));
    let view = of.blocks.iter().find_map(|block| match block {
        Block::View(view) => Some(view),
        _ => None,
    });
    let (json, script) = match view {
        None => (String::new(), String::new()),
        Some(view) => {
            let json = serde_json::to_string(&view.record)?.replace('<', "\\u003c");
            let script = format!("{}\n{BEGIN_VIEW}", viewer_with(language, &view.words)?);
            (json, script)
        }
    };
    let scripts = match view {
        None => String::new(),
        Some(_) => format!(
            "<script type=\"application/json\" id=\"record\">{json}</script>\n\
             <script>{script}</script>\n"
        ),
    };
    let blocks: Vec<String> = of.blocks.iter().enumerate().map(block).collect();
    let turn = of.blocks.iter().position(|block| matches!(block, Block::Turn)).unwrap_or(0);
    let (first, others) = blocks.split_at(turn);
    let first = match first {
        [] => String::new(),
        first => element("div", " class=\"first-page summary\"", &first.concat()),
    };
    Ok(format!(
        "<!doctype html>\n<html lang=\"{}\">\n<head>\n{}<style>{style}</style>\n</head>\n<body>\n{}{}\
         {scripts}</body>\n</html>\n",
        language.tag(),
        head(&of.head, &policy(&style, &script)),
        parts::document_header(&of.head, of.paper.as_ref()),
        element("main", "", &(first + &others.concat())),
    ))
}

/// A part of a report, with its place among all of them.
fn block((index, of): (usize, &Block)) -> String {
    let id = format!("part-{index}");
    match of {
        Block::Verdict(said) => parts::verdict_of(said),
        Block::Section(section) => parts::entries(&id, section),
        Block::Table(table) => parts::whole_table(&id, table),
        Block::Picture { title, figure, caption } => parts::titled(&id, title, figure, caption),
        Block::View(view) => parts::view_of(&view.title, &view.text),
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

fn body(content: &Content, figures: &[Figure]) -> String {
    let (pictures, appendix) = parted(figures);
    let parts = [
        parts::tools(content),
        element(
            "div",
            " class=\"first-page\"",
            &(parts::verdict(content) + &parts::levels(content, figures)),
        ),
        parts::sizes(content),
        parts::view(content),
        parts::notes(content),
        parts::pictures(content, &pictures),
        parts::tables(content),
        parts::entries("legend", &content.legend),
        parts::facts(content),
        parts::appendix(content, &appendix),
    ];
    format!("{}{}", parts::header(content), element("main", "", &parts.concat()))
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
