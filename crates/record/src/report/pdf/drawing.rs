//! Draws pictures in the PDF as lines and letters.

use pdf_writer::Content;

use super::sheet::{Pen, SIZE, short};
use super::wrap::Type;
use crate::picture::font::writable;
use crate::picture::{Ink, Mark, Picture, Stroke};

/// Draws a picture with its upper left corner at this place, pt. `scale` is in pt per px.
pub(super) fn draw(pen: &mut Pen<'_>, picture: &Picture, [left, top]: [f64; 2], scale: f64) {
    pen.content.save_state();
    // The transform lets the picture's px with y down be used as they are.
    let scale = scale as f32;
    pen.content.transform([scale, 0.0, 0.0, -scale, short(left), short(SIZE[1] - top)]);
    for mark in &picture.marks {
        draw_mark(pen, mark);
    }
    pen.content.restore_state();
}

fn draw_mark(pen: &mut Pen<'_>, mark: &Mark) {
    match mark {
        Mark::Lines { lines, is_closed, fill, stroke } => {
            path(pen.content, lines, *is_closed);
            paint(pen, *fill, *stroke);
        }
        Mark::Dots { at, radius, fill: Some(ink), stroke: None } => {
            // A line of length zero with round ends is a dot.
            pen.stroke(*ink);
            pen.content.set_line_width(short(2.0 * radius)).set_dash_pattern([], 0.0);
            let dots: Vec<[[f64; 2]; 2]> = at.iter().map(|dot| [*dot; 2]).collect();
            path(pen.content, &dots, false);
            pen.content.stroke();
        }
        Mark::Dots { at, radius, fill, stroke } => {
            // One by one, so that overlapping dots cover each other.
            for dot in at {
                circle(pen.content, *dot, *radius);
                paint(pen, *fill, *stroke);
            }
        }
        Mark::Words { at: [x, y], anchor, size, is_bold, ink, words } => {
            let letters = Type { size: *size, is_bold: *is_bold };
            let words = writable(words);
            let left = x - anchor.share() * letters.width(&words);
            // Letters are upright although y goes down.
            pen.show(&words, letters, *ink, [1.0, 0.0, 0.0, -1.0, short(left), short(*y)]);
        }
    }
}

/// Lines through their points, to a tenth of px.
fn path<L: AsRef<[[f64; 2]]>>(content: &mut Content, lines: &[L], is_closed: bool) {
    for line in lines.iter().map(L::as_ref) {
        for (index, [x, y]) in line.iter().map(|point| point.map(tenth)).enumerate() {
            if index == 0 {
                content.move_to(x, y)
            } else {
                content.line_to(x, y)
            };
        }
        if is_closed && !line.is_empty() {
            content.close_path();
        }
    }
}

/// A circle of four cubic curves. The usual 0.5523 of the radius is off by at most 0.03 %.
fn circle(content: &mut Content, [x, y]: [f64; 2], radius: f64) {
    let arm = 0.5523 * radius;
    let at = |right: f64, down: f64| [x + right, y + down].map(short);
    let [from_x, from_y] = at(radius, 0.0);
    content.move_to(from_x, from_y);
    for [a, b, c] in [
        [at(radius, arm), at(arm, radius), at(0.0, radius)],
        [at(-arm, radius), at(-radius, arm), at(-radius, 0.0)],
        [at(-radius, -arm), at(-arm, -radius), at(0.0, -radius)],
        [at(arm, -radius), at(radius, -arm), at(radius, 0.0)],
    ] {
        content.cubic_to(a[0], a[1], b[0], b[1], c[0], c[1]);
    }
    content.close_path();
}

fn paint(pen: &mut Pen<'_>, fill: Option<Ink>, stroke: Option<Stroke>) {
    if let Some(ink) = fill {
        pen.fill(ink);
    }
    if let Some(Stroke { ink, width, dash }) = stroke {
        pen.stroke(ink);
        let dash = dash.map(|dash| [short(dash); 2]);
        pen.content.set_line_width(short(width)).set_dash_pattern(dash.into_iter().flatten(), 0.0);
    }
    match (fill, stroke) {
        (Some(_), Some(_)) => pen.content.fill_even_odd_and_stroke(),
        (Some(_), None) => pen.content.fill_even_odd(),
        (None, Some(_)) => pen.content.stroke(),
        (None, None) => pen.content.end_path(),
    };
}

/// A number of px to a tenth, as in the SVG drawings.
fn tenth(px: f64) -> f32 {
    ((px * 10.0).round() / 10.0) as f32
}
