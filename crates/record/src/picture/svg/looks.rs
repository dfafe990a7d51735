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
    match (fill, stroke) {
        (Some(fill), Some(Stroke { ink, .. })) => push_twice_painted(svg, fill, ink),
        (Some(fill), None) => push_painted(svg, FILL, fill),
        (None, Some(Stroke { ink, .. })) => {
            svg.push_str(" fill=\"none\"");
            push_painted(svg, STROKE, ink);
        }
        (None, None) => svg.push_str(" fill=\"none\""),
    }
    if let Some(Stroke { width, dash, .. }) = stroke {
        push_px(svg, "stroke-width", width);
        if let Some(dash) = dash {
            push_px(svg, "stroke-dasharray", dash);
        }
    }
}

/// The light colour of an ink, and the class that lets a style sheet change it.
pub(super) fn push_painted(svg: &mut String, what: Use, ink: Ink) {
    if let Some(name) = ink.name() {
        svg.extend([" class=\"", what.class, name, "\""]);
    }
    push_colour(svg, what, ink);
}

fn push_twice_painted(svg: &mut String, fill: Ink, stroke: Ink) {
    svg.push_str(" class=\"");
    if let Some(name) = fill.name() {
        svg.extend([FILL.class, name]);
    }
    if let Some(name) = stroke.name() {
        let gap = if fill.name().is_some() { " " } else { "" };
        svg.extend([gap, STROKE.class, name]);
    }
    svg.push('"');
    push_colour(svg, FILL, fill);
    push_colour(svg, STROKE, stroke);
}

fn push_colour(svg: &mut String, what: Use, ink: Ink) {
    let [r, g, b] = ink.colour(Theme::Light);
    // Writing to memory never fails.
    let _ = write!(svg, " {}=\"#{r:02x}{g:02x}{b:02x}\"", what.attribute);
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
