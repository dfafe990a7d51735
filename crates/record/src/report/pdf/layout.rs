//! The layout of the PDF: fills each page from the top and continues on the next one.

use pdf_writer::types::StructRole;

use super::drawing;
use super::sheet::{SIZE, Sheets};
use super::tags::{ElementIndex, ROOT};
use super::wrap::{Type, cut, lines};
use crate::picture::font::writable;
use crate::picture::{Anchor, Ink, Picture};
use crate::report::{Head, Paper};

/// The column of the text, pt: left and right margins of 17 mm.
pub(super) const COLUMN: [f64; 2] = [48.0, SIZE[0] - 48.0];

/// Its width, pt.
pub(super) const WIDTH: f64 = COLUMN[1] - COLUMN[0];

/// Top of the text, pt from the top of the page.
const TOP: f64 = 66.0;

/// Distance of the bottom of the text from the lower edge, pt.
const BOTTOM_MARGIN: f64 = 56.0;

/// The baselines of the head, pt from the top, and of the foot, pt from the lower edge.
const HEAD: f64 = 42.0;
const FOOT_MARGIN: f64 = 36.0;

/// A picture is printed at most as large as on a screen of 96 dots per inch, pt per px.
const LARGEST_SCALE: f64 = 0.75;

/// A picture may shrink by this factor to fit below the content before it.
const SHRUNK_SCALE: f64 = 0.7;

/// Space above a heading, pt.
const HEADING_GAP: f64 = 15.0;

/// Space below a heading, pt.
const HEADING_BELOW: f64 = 4.0;

/// Height of a heading of one line with the gaps around it, pt.
pub(super) const HEADING_ROOM: f64 = HEADING_GAP + 12.5 * 1.32 + HEADING_BELOW;

/// Sums of heights in a different order differ by less than this, pt.
const ROUNDING: f64 = 1e-6;

pub(super) const BODY_TYPE: Type = Type { size: 9.0, is_bold: false };
pub(super) const BOLD_TYPE: Type = Type { size: 9.0, is_bold: true };
pub(super) const SMALL_TYPE: Type = Type { size: 8.0, is_bold: false };
pub(super) const HEADING_TYPE: Type = Type { size: 12.5, is_bold: true };
pub(super) const TITLE_TYPE: Type = Type { size: 19.0, is_bold: true };

/// A PDF being written.
pub(super) struct Flow<'a> {
    pub sheets: Sheets,
    head: &'a Head,
    /// How far the last page is filled, pt from the top.
    pub y: f64,
}

impl<'a> Flow<'a> {
    pub(super) fn new(head: &'a Head, paper: Paper) -> Flow<'a> {
        let mut flow = Flow { sheets: Sheets::new(paper), head, y: 0.0 };
        flow.turn();
        flow
    }

    /// Bottom of the text, pt from the top of the page.
    fn bottom(&self) -> f64 {
        self.sheets.paper.size_pt()[1] - BOTTOM_MARGIN
    }

    /// Begins a new page and writes its head.
    pub(super) fn turn(&mut self) {
        self.sheets.turn();
        self.y = TOP;
        let page = self.sheets.current();
        let patient = writable(&self.head.patient);
        let whole = self.head.language.text("report.cut_id");
        let patient = cut(&patient, 0.58 * WIDTH, BOLD_TYPE, whole);
        let taken = cut(&writable(&self.head.taken), 0.4 * WIDTH, SMALL_TYPE, "…");
        self.sheets.decorate(page, |pen| {
            pen.words(&patient, [COLUMN[0], HEAD], Anchor::Start, BOLD_TYPE, Ink::Text);
            pen.words(&taken, [COLUMN[1], HEAD], Anchor::End, SMALL_TYPE, Ink::Muted);
            pen.rule(COLUMN.map(|x| [x, HEAD + 7.0]), Ink::Grid, 0.7);
        });
    }

    /// Begins a new page if less than this height is left, pt. Returns whether it did.
    pub(super) fn need(&mut self, height: f64) -> bool {
        let is_full = !self.has_room(height) && self.y > TOP;
        if is_full {
            self.turn();
        }
        is_full
    }

    pub(super) fn space(&mut self, height: f64) {
        self.y += height;
    }

    /// Whether this height is left on the page, pt.
    pub(super) fn has_room(&self, height: f64) -> bool {
        self.y + height <= self.bottom() + ROUNDING
    }

    /// Height of an empty page, pt.
    pub(super) fn page_height(&self) -> f64 {
        self.bottom() - TOP
    }

    /// Writes a heading that stays on the same page as the first `follows` pt after it.
    pub(super) fn heading(&mut self, words: &str, follows: f64) {
        self.space(self.heading_gap());
        self.need(Flow::heading_height(words) + follows);
        self.text(words, StructRole::H2, HEADING_TYPE, Ink::Text);
        self.space(HEADING_BELOW);
    }

    /// Space above a heading at this place, pt.
    pub(super) fn heading_gap(&self) -> f64 {
        if self.y > TOP { HEADING_GAP } else { 0.0 }
    }

    /// Height of a heading with the space below it, pt.
    pub(super) fn heading_height(words: &str) -> f64 {
        Flow::height_of(words, HEADING_TYPE) + HEADING_BELOW
    }

    /// Height of a text over the whole column, pt.
    pub(super) fn height_of(words: &str, letters: Type) -> f64 {
        lines(&writable(words), WIDTH, letters).len() as f64 * letters.leading()
    }

    /// Writes a text over the whole column, on as many lines and pages as it needs.
    pub(super) fn text(&mut self, words: &str, role: StructRole, letters: Type, ink: Ink) {
        let element = self.sheets.tags.add(ROOT, role);
        for line in lines(&writable(words), WIDTH, letters) {
            self.need(letters.leading());
            self.line(&line, element, letters, ink);
        }
    }

    fn line(&mut self, line: &str, element: ElementIndex, letters: Type, ink: Ink) {
        let at = [COLUMN[0], self.y + letters.size];
        self.sheets.draw(element, |pen| pen.words(line, at, Anchor::Start, letters, ink));
        self.y += letters.leading();
    }

    /// Height that is left on the page, pt.
    pub(super) fn room(&self) -> f64 {
        self.bottom() - self.y
    }

    /// Height of a picture that has `words` pt of heading and caption, with which it takes at most this share of a
    /// page, pt. It is smaller if that saves a page.
    pub(super) fn share_height(&self, picture: &Picture, words: f64, share: f64) -> f64 {
        let own = Flow::drawn_height(picture, LARGEST_SCALE);
        let most = own.min(share * self.page_height() - words);
        let left = self.room() - words;
        if left >= SHRUNK_SCALE * most { most.min(left) } else { most }
    }

    /// Height of a picture at a scale at which it is not too wide, pt.
    pub(super) fn drawn_height(picture: &Picture, scale: f64) -> f64 {
        let [width, height] = picture.size;
        height * (WIDTH / width).min(LARGEST_SCALE).min(scale)
    }

    /// Draws a picture, at most this high, pt.
    pub(super) fn drawing(&mut self, picture: &Picture, height_max: f64) {
        let [width, height] = picture.size;
        let scale = (WIDTH / width).min(height_max / height).min(LARGEST_SCALE);
        let figure = self.sheets.tags.add_figure(&picture.title);
        let at = [COLUMN[0] + (WIDTH - width * scale) / 2.0, self.y];
        self.sheets.draw(figure, |pen| drawing::draw(pen, picture, at, scale));
        self.y += height * scale;
    }

    /// Writes the name of a field at its left, on a line from there to its right, pt.
    pub(super) fn field(&mut self, name: &str, [left, right]: [f64; 2]) {
        let y = self.y;
        let name = writable(name);
        let element = self.sheets.tags.add(ROOT, StructRole::P);
        self.sheets.draw(element, |pen| {
            pen.words(&name, [left, y - 2.5], Anchor::Start, SMALL_TYPE, Ink::Muted);
        });
        let page = self.sheets.current();
        let from = left + SMALL_TYPE.width(&name) + 4.0;
        self.sheets.decorate(page, |pen| pen.rule([[from, y], [right, y]], Ink::Muted, 0.5));
    }

    /// Adds the page numbers and returns the pages.
    pub(super) fn finished(mut self) -> Sheets {
        let count = self.sheets.pages.len();
        let foot = self.sheets.paper.size_pt()[1] - FOOT_MARGIN;
        let language = self.head.language;
        for page in 0..count {
            let number =
                language.filled("report.page_number", &[("page", &(page + 1)), ("count", &count)]);
            let title = writable(&self.head.title);
            self.sheets.decorate(page, |pen| {
                pen.words(&title, [COLUMN[0], foot], Anchor::Start, SMALL_TYPE, Ink::Muted);
                pen.words(&number, [COLUMN[1], foot], Anchor::End, SMALL_TYPE, Ink::Muted);
            });
        }
        self.sheets
    }
}
