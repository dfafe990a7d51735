//! The pages of a PDF and what is drawn on them: points from the upper left corner, y down.

use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Name, Str};

use super::letters::{Letters, NAMES};
use super::tags::{ElementIndex, Tags};
use super::wrap::Type;
use crate::picture::{Anchor, Ink, Theme};
use crate::report::Paper;

/// The sheet on which everything is laid out, pt. Other paper has the same upper edge and middle.
pub(super) const SIZE: [f64; 2] = Paper::A4.size_pt();

/// The pages of a PDF.
pub(super) struct Sheets {
    pub pages: Vec<Content>,
    /// The letters in use, regular and bold.
    pub letters: [Letters; 2],
    /// The structure of the content.
    pub tags: Tags,
    /// What it is printed on.
    pub paper: Paper,
}

impl Sheets {
    pub(super) fn new(paper: Paper) -> Sheets {
        let letters = [false, true].map(Letters::new);
        Sheets { pages: Vec::new(), letters, tags: Tags::new(), paper }
    }

    /// Begins a new page, which becomes the current one.
    pub(super) fn turn(&mut self) {
        let mut page = Content::new();
        page.set_line_cap(LineCapStyle::RoundCap).set_line_join(LineJoinStyle::RoundJoin);
        self.pages.push(page);
    }

    /// Number of the current page, from 0; [`Sheets::turn`] begins the first.
    pub(super) fn current(&self) -> usize {
        self.pages.len() - 1
    }

    /// Draws a part of an element on the current page.
    pub(super) fn draw(&mut self, element: ElementIndex, draw: impl FnOnce(&mut Pen<'_>)) {
        let page = self.current();
        let (number, role) = self.tags.draw(element, page);
        let content = &mut self.pages[page];
        content.begin_marked_content_with_properties(role).properties().identify(number);
        draw(&mut Pen { content, letters: &mut self.letters });
        content.end_marked_content();
    }

    /// Draws on a page what is decoration only: lines, page heads.
    pub(super) fn decorate(&mut self, page: usize, draw: impl FnOnce(&mut Pen<'_>)) {
        let content = &mut self.pages[page];
        content.begin_marked_content(Name(b"Artifact"));
        draw(&mut Pen { content, letters: &mut self.letters });
        content.end_marked_content();
    }
}

/// Draws on a page.
pub(super) struct Pen<'a> {
    pub content: &'a mut Content,
    letters: &'a mut [Letters; 2],
}

impl Pen<'_> {
    /// Writes writable text on a line that starts, is centred or ends at a place, pt.
    pub(super) fn words(
        &mut self,
        words: &str,
        [x, y]: [f64; 2],
        anchor: Anchor,
        letters: Type,
        ink: Ink,
    ) {
        let left = x - anchor.share() * letters.width(words);
        self.show(words, letters, ink, [1.0, 0.0, 0.0, 1.0, short(left), short(SIZE[1] - y)]);
    }

    /// Writes writable text in this type, placed by a matrix.
    pub(super) fn show(&mut self, words: &str, letters: Type, ink: Ink, matrix: [f32; 6]) {
        let font = usize::from(letters.is_bold);
        let bytes = self.letters[font].encoded(words);
        self.fill(ink);
        self.content
            .begin_text()
            .set_font(NAMES[font], short(letters.size))
            .set_text_matrix(matrix)
            .show(Str(&bytes))
            .end_text();
    }

    /// A line from one place to another, pt.
    pub(super) fn rule(&mut self, [from, to]: [[f64; 2]; 2], ink: Ink, width: f64) {
        self.stroke(ink);
        self.content
            .set_line_width(short(width))
            .move_to(short(from[0]), short(SIZE[1] - from[1]))
            .line_to(short(to[0]), short(SIZE[1] - to[1]))
            .stroke();
    }

    /// Sets the ink for filling.
    pub(super) fn fill(&mut self, ink: Ink) {
        let [r, g, b] = rgb(ink);
        self.content.set_fill_rgb(r, g, b);
    }

    /// Sets the ink for lines.
    pub(super) fn stroke(&mut self, ink: Ink) {
        let [r, g, b] = rgb(ink);
        self.content.set_stroke_rgb(r, g, b);
    }
}

/// Rounded to a thousandth of the range, which is finer than the colours are.
fn rgb(ink: Ink) -> [f32; 3] {
    ink.colour(Theme::Light).map(|part| (f32::from(part) / 0.255).round() / 1000.0)
}

/// A number of pt rounded to a hundredth, which is finer than any printer.
pub(super) fn short(pt: f64) -> f32 {
    ((pt * 100.0).round() / 100.0) as f32
}
