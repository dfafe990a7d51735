//! The looks of a mark in SVG: inks, pens, numbers and text.

use std::fmt::Write;

use crate::picture::{Ink, Stroke, Theme};

/// What an ink can be used for: the attribute, and the beginning of its classes.
#[derive(Clone, Copy)]
pub(super) struct Use {
    attribute: &'static str,
    class: &'static str,
}

pub(super) const FILL: Use = Use { attribute: "fill", class: "f-" };
const STROKE: Use = Use { attribute: "stroke", class: "s-" };

/// The fill and the stroke of a mark.
pub(super) fn push_looks(svg: &mut String, fill: Option<Ink>, stroke: Option<Stroke>) {
    svg.push_str(if fill.is_none() { " fill=\"none\"" } else { "" });
    let pen = stroke.map(|stroke| (STROKE, stroke.ink));
    let inks: Vec<(Use, Ink)> = fill.map(|ink| (FILL, ink)).into_iter().chain(pen).collect();
    push_painted(svg, &inks);
    if let Some(Stroke { width, dash, .. }) = stroke {
        push_px(svg, "stroke-width", width);
        if let Some(dash) = dash {
            push_px(svg, "stroke-dasharray", dash);
        }
    }
}

/// The light colours of inks, and the classes that let a style sheet change them.
pub(super) fn push_painted(svg: &mut String, inks: &[(Use, Ink)]) {
    let class = |(what, ink): &(Use, Ink)| Some(format!("{}{}", what.class, ink.name()?));
    let classes: Vec<String> = inks.iter().filter_map(class).collect();
    if !classes.is_empty() {
        svg.extend([" class=\"", &classes.join(" "), "\""]);
    }
    for (what, ink) in inks {
        let [r, g, b] = ink.colour(Theme::Light);
        // Writing to memory never fails.
        let _ = write!(svg, " {}=\"#{r:02x}{g:02x}{b:02x}\"", what.attribute);
    }
}

/// An attribute with a number of px.
pub(super) fn push_px(svg: &mut String, name: &str, px: f64) {
    svg.extend([" ", name, "=\""]);
    push_number(svg, px);
    svg.push('"');
}

/// A number of px to a hundredth, without trailing zeros.
pub(super) fn push_number(svg: &mut String, px: f64) {
    let from = svg.len();
    // Writing to memory never fails.
    let _ = write!(svg, "{px:.2}");
    let kept = svg[from..].trim_end_matches('0').trim_end_matches('.').len();
    svg.truncate(from + kept);
    if &svg[from..] == "-0" {
        svg.replace_range(from.., "0");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_digit_that_says_nothing() {
        let number = |px: f64| {
            let mut text = String::from("0");
            push_number(&mut text, px);
            text[1..].to_owned()
        };
        let written = [0.0, -0.0, -0.004, 0.005, 10.0, 100.5, 12.345, -7.1].map(number);
        assert_eq!(written, ["0", "0", "0", "0.01", "10", "100.5", "12.35", "-7.1"]);
    }
}
