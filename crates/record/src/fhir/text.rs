//! The narrative of a resource: what a reader without a program for its fields sees.

use serde_json::{Value, json};

/// A title and lines, generated from the resource's own fields.
pub(super) fn narrative(title: &str, lines: &[String]) -> Value {
    let mut html = format!("<p>{}</p>", escaped(title));
    if !lines.is_empty() {
        let items: String =
            lines.iter().map(|line| format!("<li>{}</li>", escaped(line))).collect();
        html += &format!("<ul>{items}</ul>");
    }
    let div = format!("<div xmlns=\"http://www.w3.org/1999/xhtml\">{html}</div>");
    json!({ "status": "generated", "div": div })
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
