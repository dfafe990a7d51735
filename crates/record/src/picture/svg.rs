//! Pictures as SVG: as a file of its own, or embedded in a page that knows the names of the inks.

mod looks;

use std::fmt::Write;

use self::looks::{FILL, push_looks, push_number, push_painted, push_px};
use super::{Anchor, Ink, Mark, Picture, Stroke, Theme};
use crate::shown::escaped;

/// The font families and the ends of lines, as attributes.
const LOOKS: &str = " font-family=\"system-ui, 'Segoe UI', Roboto, 'Noto Sans', sans-serif\" \
     stroke-linejoin=\"round\" stroke-linecap=\"round\"";

/// A file of its own with these marks, in the reader's theme. Programs that do not support style sheets
/// show the light theme.
pub(crate) fn file(title: &str, size: [f64; 2], marks: &str) -> String {
    let [width, height] = size;
    let mut first = format!("<style>{}</style>\n<rect", dark_rules());
    push_px(&mut first, "width", width);
    push_px(&mut first, "height", height);
    push_painted(&mut first, &[(FILL, Ink::Paper)]);
    first.push_str("/>\n");
    let view_box = [0.0, 0.0, width, height];
    element(" role=\"img\"", view_box, &[&title_element(title), &first, marks])
}

/// For embedding in a page whose style sheet has [`dark_rules`]. A picture with cuts is there twice: whole
/// (class `whole`), and in parts (class `parts`) that show the same marks, for narrow screens. The style
/// sheet shows one of the two. `name` must be unique in the page.
pub(crate) fn embedded(name: &str, picture: &Picture, marks: &str) -> String {
    let Picture { title, size: [width, height], cuts, .. } = picture;
    let titled = title_element(title);
    let whole_box = [0.0, 0.0, *width, *height];
    if cuts.is_empty() {
        return element(" role=\"img\"", whole_box, &[&titled, marks]);
    }
    let group = format!("<g id=\"marks-{name}\">\n");
    let attributes = " class=\"whole\" role=\"img\"";
    let mut page = element(attributes, whole_box, &[&titled, &group, marks, "</g>"]);
    let again = format!("<use href=\"#marks-{name}\"/>");
    let ends = [&[0.0], cuts.as_slice(), &[*width]].concat();
    page.push_str("<div class=\"parts\">\n");
    for (index, end) in ends.windows(2).enumerate() {
        let part_box = [end[0], 0.0, end[1] - end[0], *height];
        // The first part stands for all.
        page.push_str(&match index {
            0 => element(" role=\"img\"", part_box, &[&titled, &again]),
            _ => element(" aria-hidden=\"true\"", part_box, &[&again]),
        });
    }
    page + "</div>\n"
}

/// A style sheet that gives pictures the dark theme for readers who prefer it.
pub(crate) fn dark_rules() -> String {
    let rule = |(ink, name): (Ink, &str)| {
        let [r, g, b] = ink.colour(Theme::Dark);
        let colour = format!("#{r:02x}{g:02x}{b:02x}");
        format!(".f-{name}{{fill:{colour}}}.s-{name}{{stroke:{colour}}}")
    };
    let rules: String = Ink::NAMED.into_iter().map(rule).collect();
    format!("@media screen and (prefers-color-scheme:dark){{{rules}}}")
}

fn title_element(title: &str) -> String {
    format!("<title>{}</title>\n", escaped(title))
}

/// An `svg` element with these attributes, its box of left, top, width and height, and what is inside.
fn element(attributes: &str, view_box: [f64; 4], inside: &[&str]) -> String {
    let mut svg = String::from("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"");
    for (index, px) in view_box.into_iter().enumerate() {
        svg.push_str(if index == 0 { "" } else { " " });
        push_number(&mut svg, px);
    }
    svg.extend(["\"", attributes, LOOKS, ">"]);
    svg.extend(inside.iter().copied());
    svg.push_str("</svg>\n");
    svg
}

/// The marks of a picture, one per line.
pub fn marks(picture: &Picture) -> String {
    let mut svg = String::new();
    for mark in &picture.marks {
        push_mark(&mut svg, mark);
        svg.push('\n');
    }
    svg
}

fn push_mark(svg: &mut String, mark: &Mark) {
    match mark {
        Mark::Lines { lines, is_closed, fill, stroke } => {
            svg.push_str("<path d=\"");
            for line in lines.iter().filter(|line| !line.is_empty()) {
                push_path(svg, line);
                svg.push_str(if *is_closed { "Z" } else { "" });
            }
            let is_ruled = *is_closed && lines.len() > 1;
            svg.push_str(if is_ruled { "\" fill-rule=\"evenodd\"" } else { "\"" });
            push_looks(svg, *fill, *stroke);
            svg.push_str("/>");
        }
        Mark::Dots { at, radius, fill, stroke: None } => {
            // A line of length zero with round ends is a dot and takes few bytes.
            svg.push_str("<path d=\"");
            for dot in at {
                push_path(svg, &[*dot]);
                svg.push_str("h0");
            }
            svg.push('"');
            let stroke = Stroke { ink: fill.unwrap_or(Ink::Text), width: 2.0 * radius, dash: None };
            push_looks(svg, None, Some(stroke));
            svg.push_str("/>");
        }
        Mark::Dots { at, radius, fill, stroke } => {
            svg.push_str("<g");
            push_looks(svg, *fill, *stroke);
            svg.push('>');
            at.iter().for_each(|dot| push_circle(svg, *dot, *radius));
            svg.push_str("</g>");
        }
        Mark::Words { at: [x, y], anchor, size, is_bold, ink, words } => {
            svg.push_str("<text");
            push_px(svg, "x", *x);
            push_px(svg, "y", *y);
            push_px(svg, "font-size", *size);
            push_painted(svg, &[(FILL, *ink)]);
            svg.push_str(match anchor {
                Anchor::Start => "",
                Anchor::Middle => " text-anchor=\"middle\"",
                Anchor::End => " text-anchor=\"end\"",
            });
            svg.push_str(if *is_bold { " font-weight=\"600\">" } else { ">" });
            svg.push_str(&escaped(words));
            svg.push_str("</text>");
        }
    }
}

fn push_circle(svg: &mut String, [x, y]: [f64; 2], radius: f64) {
    svg.push_str("<circle");
    push_px(svg, "cx", x);
    push_px(svg, "cy", y);
    push_px(svg, "r", radius);
    svg.push_str("/>");
}

/// A path through points, written as the steps between them in whole tenths of px. Integers are
/// formatted many times as fast as fractions.
fn push_path(path: &mut String, points: &[[f64; 2]]) {
    let tenths = |at: &[f64; 2]| at.map(|of| (of * 10.0).round() as i64);
    let mut last = [0, 0];
    for (index, point) in points.iter().map(tenths).enumerate() {
        let [x, y] = if index == 0 { point } else { [point[0] - last[0], point[1] - last[1]] };
        path.push(if index == 0 { 'M' } else { 'l' });
        push_tenths(path, x);
        if y >= 0 {
            path.push(' ');
        }
        push_tenths(path, y);
        last = point;
    }
}

/// Appends a number of tenths as a decimal, without a decimal point if it is whole.
fn push_tenths(path: &mut String, tenths: i64) {
    let (whole, rest) = (tenths.unsigned_abs() / 10, tenths.unsigned_abs() % 10);
    path.push_str(if tenths < 0 { "-" } else { "" });
    // Writing to memory never fails.
    let _ = write!(path, "{whole}");
    if rest != 0 {
        let _ = write!(path, ".{rest}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [f64; 2] = [10.0, 20.0];

    fn picture(marks: Vec<Mark>) -> Picture {
        Picture { title: String::new(), size: SIZE, cuts: Vec::new(), marks }
    }

    #[test]
    fn a_line_is_told_by_its_ways_and_rounding_does_not_add_up() {
        let step = |index: u32| [f64::from(index) * 0.16, 0.04];
        let line: Vec<[f64; 2]> = (0..101).map(step).collect();
        let path = |line: &[[f64; 2]]| {
            let mut text = String::new();
            push_path(&mut text, line);
            text
        };
        let text = path(&line);
        let numbers: Vec<f64> = text
            .split(['M', 'l'])
            .filter(|part| !part.is_empty())
            .map(|part| part.split(' ').next().unwrap().parse::<f64>().unwrap())
            .collect();
        assert!((numbers.iter().sum::<f64>() - 16.0).abs() < 1e-9, "{text}");
        assert_eq!(path(&[[1.0, -2.0], [0.0, 3.5]]), "M1-2l-1 5.5");
        assert_eq!(path(&[[-0.04, -0.7], [30.4, -1.0]]), "M0-0.7l30.4-0.3");
    }

    #[test]
    fn words_from_outside_stay_words() {
        let words = Mark::Words {
            at: [0.0, 0.0],
            anchor: Anchor::End,
            size: 9.0,
            is_bold: false,
            ink: Ink::Text,
            words: "</text><script>&\"".to_owned(),
        };
        let svg = file("a < b", SIZE, &marks(&picture(vec![words])));
        assert!(svg.contains("&lt;/text&gt;&lt;script&gt;&amp;&quot;</text>"), "{svg}");
        assert!(svg.contains("<title>a &lt; b</title>"), "{svg}");
    }

    #[test]
    fn a_file_knows_both_themes_and_a_page_brings_its_own() {
        let dots =
            Mark::Dots { at: vec![[1.0, 2.0]], radius: 1.5, fill: Some(Ink::Left), stroke: None };
        let marks = marks(&picture(vec![dots]));
        assert!(file("a", SIZE, &marks).contains("prefers-color-scheme:dark"));
        let embedded = embedded("a", &picture(Vec::new()), &marks);
        assert!(
            !embedded.contains("<style") && embedded.contains("class=\"s-left\""),
            "{embedded}"
        );
    }
    #[test]
    fn a_picture_with_cuts_stands_in_a_page_whole_and_in_parts_that_cover_it() {
        let cut = Picture { cuts: vec![4.0], ..picture(Vec::new()) };
        let page = embedded("a", &cut, "<path/>");
        assert_eq!(page.matches("<path/>").count(), 1, "{page}");
        assert_eq!(page.matches("<use href=\"#marks-a\"/>").count(), 2, "{page}");
        for view_box in ["0 0 10 20", "0 0 4 20", "4 0 6 20"] {
            assert!(page.contains(&format!("viewBox=\"{view_box}\"")), "{page}");
        }
    }
}
