//! Pictures as SVG: as a file of its own, or embedded in a page that knows the names of the inks.

use std::fmt::Write;

use super::{Anchor, Ink, Mark, Picture, Stroke, Theme};

/// The font families of pictures.
const FONT: &str = "system-ui, 'Segoe UI', Roboto, 'Noto Sans', sans-serif";

/// A file of its own, in the reader's theme. Programs that do not support style sheets show the light
/// theme.
pub fn file(picture: &Picture) -> String {
    let style = format!("<style>{}</style>\n", dark_rules());
    let [width, height] = picture.size;
    let paper = format!(
        "<rect width=\"{}\" height=\"{}\"{}/>\n",
        number(width),
        number(height),
        painted("fill", Ink::Paper)
    );
    drawn(picture, &(style + &paper))
}

/// For embedding in a page whose style sheet has [`dark_rules`].
pub fn embedded(picture: &Picture) -> String {
    drawn(picture, "")
}

/// A style sheet that gives pictures the dark theme for readers who prefer it.
pub fn dark_rules() -> String {
    let rules = |ink: Ink| {
        let [r, g, b] = ink.colour(Theme::Dark);
        let rule = |name: &str| {
            format!(
                ".f-{name}{{fill:#{r:02x}{g:02x}{b:02x}}}.s-{name}{{stroke:#{r:02x}{g:02x}{b:02x}}}"
            )
        };
        ink.name().map(rule)
    };
    let rules: String = Ink::NAMED.into_iter().filter_map(rules).collect();
    format!("@media screen and (prefers-color-scheme:dark){{{rules}}}")
}

fn drawn(picture: &Picture, first: &str) -> String {
    let [width, height] = picture.size.map(number);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         font-family=\"{FONT}\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\
         <title>{}</title>\n{first}",
        escaped(&picture.title)
    );
    for mark in &picture.marks {
        svg += &markup(mark);
        svg.push('\n');
    }
    svg + "</svg>\n"
}

fn markup(mark: &Mark) -> String {
    match mark {
        Mark::Lines { lines, is_closed, fill, stroke } => {
            let end = if *is_closed { "Z" } else { "" };
            let path: String =
                lines.iter().filter(|line| !line.is_empty()).map(|line| path(line) + end).collect();
            let rule = if *is_closed && lines.len() > 1 { " fill-rule=\"evenodd\"" } else { "" };
            format!("<path d=\"{path}\"{rule}{}/>", looks(*fill, *stroke))
        }
        Mark::Dots { at, radius, fill, stroke: None } => {
            // A line of length zero with round ends is a dot and takes few bytes.
            let path: String = at.iter().map(|dot| format!("{}h0", path(&[*dot]))).collect();
            let stroke = Stroke { ink: fill.unwrap_or(Ink::Text), width: 2.0 * radius, dash: None };
            format!("<path d=\"{path}\"{}/>", looks(None, Some(stroke)))
        }
        Mark::Dots { at, radius, fill, stroke } => {
            let dot = |[x, y]: &[f64; 2]| {
                let [x, y, radius] = [*x, *y, *radius].map(number);
                format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>")
            };
            format!("<g{}>{}</g>", looks(*fill, *stroke), at.iter().map(dot).collect::<String>())
        }
        Mark::Words { at: [x, y], anchor, size, is_bold, ink, words } => {
            let anchor = match anchor {
                Anchor::Start => "",
                Anchor::Middle => " text-anchor=\"middle\"",
                Anchor::End => " text-anchor=\"end\"",
            };
            let weight = if *is_bold { " font-weight=\"600\"" } else { "" };
            let [x, y, size] = [*x, *y, *size].map(number);
            let (painted, words) = (painted("fill", *ink), escaped(words));
            format!(
                "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{painted}{anchor}{weight}>{words}</text>"
            )
        }
    }
}

/// A path through points, written as the steps between them in whole tenths of px. Integers are
/// formatted many times as fast as fractions.
fn path(points: &[[f64; 2]]) -> String {
    let mut path = String::new();
    let tenths = |at: &[f64; 2]| at.map(|of| (of * 10.0).round() as i64);
    let mut last = [0, 0];
    for (index, point) in points.iter().map(tenths).enumerate() {
        let [x, y] = if index == 0 { point } else { [point[0] - last[0], point[1] - last[1]] };
        path.push(if index == 0 { 'M' } else { 'l' });
        push_tenths(&mut path, x);
        if y >= 0 {
            path.push(' ');
        }
        push_tenths(&mut path, y);
        last = point;
    }
    path
}

/// Writes an integer number of tenths as a decimal.
fn push_tenths(text: &mut String, tenths: i64) {
    let (whole, rest) = (tenths.unsigned_abs() / 10, tenths.unsigned_abs() % 10);
    let sign = if tenths < 0 { "-" } else { "" };
    // Writing to memory never fails.
    let _ = match rest {
        0 => write!(text, "{sign}{whole}"),
        _ => write!(text, "{sign}{whole}.{rest}"),
    };
}

fn looks(fill: Option<Ink>, stroke: Option<Stroke>) -> String {
    let mut looks = match (fill, stroke) {
        (Some(fill), Some(Stroke { ink, .. })) => twice_painted(fill, ink),
        (Some(fill), None) => painted("fill", fill),
        (None, Some(Stroke { ink, .. })) => " fill=\"none\"".to_owned() + &painted("stroke", ink),
        (None, None) => " fill=\"none\"".to_owned(),
    };
    if let Some(Stroke { width, dash, .. }) = stroke {
        let _ = write!(looks, " stroke-width=\"{}\"", number(width));
        if let Some(dash) = dash {
            let _ = write!(looks, " stroke-dasharray=\"{}\"", number(dash));
        }
    }
    looks
}

/// The light colour of an ink, and the class that lets a style sheet change it.
fn painted(what: &str, ink: Ink) -> String {
    let class = class(what, ink).map_or(String::new(), |class| format!(" class=\"{class}\""));
    format!("{class} {what}=\"{}\"", colour(ink))
}

fn twice_painted(fill: Ink, stroke: Ink) -> String {
    let classes: Vec<String> =
        [class("fill", fill), class("stroke", stroke)].into_iter().flatten().collect();
    let [fill, stroke] = [fill, stroke].map(colour);
    format!(" class=\"{}\" fill=\"{fill}\" stroke=\"{stroke}\"", classes.join(" "))
}

fn class(what: &str, ink: Ink) -> Option<String> {
    ink.name().map(|name| format!("{}-{name}", &what[..1]))
}

fn colour(ink: Ink) -> String {
    let [r, g, b] = ink.colour(Theme::Light);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A number of px to a hundredth, without trailing zeros.
fn number(px: f64) -> String {
    let text = format!("{px:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Escapes text for the content of an element.
fn escaped(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(marks: Vec<Mark>) -> Picture {
        Picture { title: "a < b".to_owned(), size: [10.0, 20.0], marks }
    }

    #[test]
    fn a_line_is_told_by_its_ways_and_rounding_does_not_add_up() {
        let step = |index: u32| [f64::from(index) * 0.16, 0.04];
        let line: Vec<[f64; 2]> = (0..101).map(step).collect();
        let text = path(&line);
        let numbers: Vec<f64> = text
            .split(['M', 'l'])
            .filter(|part| !part.is_empty())
            .map(|part| part.split(' ').next().unwrap().parse::<f64>().unwrap())
            .collect();
        assert!((numbers.iter().sum::<f64>() - 16.0).abs() < 1e-9, "{text}");
        assert_eq!(path(&[[1.0, -2.0], [0.0, 3.5]]), "M1-2l-1 5.5");
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
        let svg = file(&picture(vec![words]));
        assert!(svg.contains("&lt;/text&gt;&lt;script&gt;&amp;\"</text>"), "{svg}");
        assert!(svg.contains("<title>a &lt; b</title>"), "{svg}");
    }

    #[test]
    fn a_file_knows_both_themes_and_a_page_brings_its_own() {
        let dots =
            Mark::Dots { at: vec![[1.0, 2.0]], radius: 1.5, fill: Some(Ink::Left), stroke: None };
        let picture = picture(vec![dots]);
        assert!(file(&picture).contains("prefers-color-scheme:dark"));
        let embedded = embedded(&picture);
        assert!(
            !embedded.contains("<style") && embedded.contains("class=\"s-left\""),
            "{embedded}"
        );
    }
}
