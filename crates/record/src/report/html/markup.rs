//! Elements of a page.

use crate::report::held::held;
use crate::report::{Reliability, ReportFigure};
use crate::shown::escaped;

/// An element with attributes, ` name="value"` each, around existing markup.
pub(super) fn element(name: &str, attributes: &str, inside: &str) -> String {
    format!("<{name}{attributes}>{inside}</{name}>\n")
}

/// An element around text, which is escaped.
pub(super) fn words(name: &str, attributes: &str, words: &str) -> String {
    format!("<{name}{attributes}>{}</{name}>", escaped(words))
}

/// An element around running text, whose figures stay on one line with their units.
pub(super) fn held_words(name: &str, attributes: &str, text: &str) -> String {
    words(name, attributes, &held(text))
}

/// Text from outside, isolated so that it does not change the direction of the text around it.
pub(super) fn foreign(text: &str) -> String {
    words("bdi", "", text)
}

/// A section of the page with its heading.
pub(super) fn section(id: &str, title: &str, inside: &str) -> String {
    let heading = words("h2", &format!(" id=\"{id}\""), title);
    element("section", &format!(" aria-labelledby=\"{id}\""), &format!("{heading}\n{inside}"))
}

/// A table that may be wider than the page. It scrolls on its own, also by keyboard.
pub(super) fn wide(named_by: &str, table: &str) -> String {
    let attributes =
        format!(" class=\"wide\" role=\"group\" tabindex=\"0\" aria-labelledby=\"{named_by}\"");
    element("div", &attributes, table)
}

/// A figure in a cell with these attributes besides its class.
pub(super) fn figure(figure: &ReportFigure, attributes: &str) -> String {
    let (class, before, behind) = match figure.mark {
        Reliability::Sure => ("", "", ""),
        Reliability::Doubtful => (" class=\"doubtful\"", "", "<span class=\"mark\"> ?</span>"),
        Reliability::Estimated => (" class=\"estimated\"", "~", ""),
        Reliability::ByHand => {
            (" class=\"set-by-hand\"", "", "<span class=\"mark\">&nbsp;*</span>")
        }
        Reliability::Missing => (" class=\"missing\"", "", ""),
        Reliability::Real => (" class=\"real\"", "", ""),
    };
    let value = escaped(&figure.value);
    let margin = figure
        .margin
        .as_ref()
        .map(|margin| format!(" <span class=\"margin\">±&nbsp;{}</span>", escaped(margin)));
    let margin = margin.unwrap_or_default();
    format!(
        "<td{attributes}{class}><span class=\"value\">{before}{value}</span>{margin}{behind}</td>"
    )
}
