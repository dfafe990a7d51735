//! Pictures as PNG, for programs that do not show SVG.

use thiserror::Error;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke as Pen,
    StrokeDash, Transform,
};

use super::font::{Font, UNITS_PER_EM, writable};
use super::outline::Segment;
use super::{Anchor, Ink, Mark, Picture, Stroke, Theme};

/// The largest image, pixels: a poster at 300 dots per inch, in 256 MB of memory.
const PIXELS_MAX: f64 = 64e6;

/// Why no image can be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PngFault {
    /// The picture has no area, or too large an area.
    #[error("an image of {width_px:.0} × {height_px:.0} pixels cannot be made")]
    Size {
        /// Requested width.
        width_px: f64,
        /// Requested height.
        height_px: f64,
    },
    /// The image could not be encoded.
    #[error("the image could not be packed: {message}")]
    Packing {
        /// The encoder's message.
        message: String,
    },
}

/// Draws a picture in a theme, with this many pixels per px of the picture.
///
/// # Errors
/// If the image would have no pixel or more than 64 million.
pub fn png(picture: &Picture, theme: Theme, scale: f64) -> Result<Vec<u8>, PngFault> {
    let [width_px, height_px] = picture.size.map(|side| (side * scale).ceil());
    let is_possible = width_px >= 1.0 && height_px >= 1.0 && width_px * height_px <= PIXELS_MAX;
    let image = is_possible.then(|| Pixmap::new(width_px as u32, height_px as u32)).flatten();
    let image = image.ok_or(PngFault::Size { width_px, height_px })?;
    let mut easel = Easel { image, theme, scale };
    easel.image.fill(colour(Ink::Paper, theme));
    for mark in &picture.marks {
        easel.draw(mark);
    }
    easel.image.encode_png().map_err(|fault| PngFault::Packing { message: fault.to_string() })
}

/// An image being drawn.
struct Easel {
    image: Pixmap,
    theme: Theme,
    scale: f64,
}

impl Easel {
    fn draw(&mut self, mark: &Mark) {
        match mark {
            Mark::Lines { lines, is_closed, fill, stroke } => {
                self.paint(path_of(lines, *is_closed), *fill, *stroke);
            }
            Mark::Dots { at, radius, fill, stroke } => {
                // One by one, so that overlapping dots cover each other.
                for dot in at {
                    let [x, y] = dot.map(|of| of as f32);
                    let circle = PathBuilder::from_circle(x, y, *radius as f32);
                    self.paint(circle, *fill, *stroke);
                }
            }
            Mark::Words { at, anchor, size, is_bold, ink, words } => {
                let path = letters(words, *at, *anchor, *size, *is_bold);
                self.fill(path, *ink, FillRule::Winding);
            }
        }
    }

    fn paint(&mut self, path: Option<Path>, fill: Option<Ink>, stroke: Option<Stroke>) {
        if let Some(ink) = fill {
            self.fill(path.clone(), ink, FillRule::EvenOdd);
        }
        let (Some(path), Some(stroke)) = (path, stroke) else { return };
        let dash = stroke.dash.and_then(|dash| StrokeDash::new(vec![dash as f32; 2], 0.0));
        let pen = Pen {
            width: stroke.width as f32,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            dash,
            ..Pen::default()
        };
        let (paint, view) = (self.paint_of(stroke.ink), self.view());
        self.image.stroke_path(&path, &paint, &pen, view, None);
    }

    fn fill(&mut self, path: Option<Path>, ink: Ink, rule: FillRule) {
        let (paint, view) = (self.paint_of(ink), self.view());
        if let Some(path) = path {
            self.image.fill_path(&path, &paint, rule, view, None);
        }
    }

    fn paint_of(&self, ink: Ink) -> Paint<'static> {
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color(colour(ink, self.theme));
        paint
    }

    fn view(&self) -> Transform {
        Transform::from_scale(self.scale as f32, self.scale as f32)
    }
}

fn colour(ink: Ink, theme: Theme) -> Color {
    let [r, g, b] = ink.colour(theme);
    Color::from_rgba8(r, g, b, u8::MAX)
}

/// Lines through their points; `None` if there is nothing to draw.
fn path_of(lines: &[Vec<[f64; 2]>], is_closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for line in lines {
        for (index, point) in line.iter().enumerate() {
            let [x, y] = point.map(|of| of as f32);
            if index == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        if is_closed && !line.is_empty() {
            path.close();
        }
    }
    path.finish()
}

/// The outlines of a text on its baseline.
fn letters(
    words: &str,
    [x, y]: [f64; 2],
    anchor: Anchor,
    size: f64,
    is_bold: bool,
) -> Option<Path> {
    let (font, words) = (Font::of(is_bold), writable(words));
    let mut pen_x = x - anchor.share() * font.width(&words, size);
    let scale = size / UNITS_PER_EM;
    let mut path = PathBuilder::new();
    for glyph in words.chars().filter_map(|letter| font.glyph(letter)) {
        let place =
            |[right, up]: [f64; 2]| [pen_x + right * scale, y - up * scale].map(|of| of as f32);
        for (index, segment) in font.outline(glyph).into_iter().enumerate() {
            match segment {
                Segment::Start(at) => {
                    if index > 0 {
                        path.close();
                    }
                    let [x, y] = place(at);
                    path.move_to(x, y);
                }
                Segment::Line(to) => {
                    let [x, y] = place(to);
                    path.line_to(x, y);
                }
                Segment::Parabola(by, to) => {
                    let ([x1, y1], [x, y]) = (place(by), place(to));
                    path.quad_to(x1, y1, x, y);
                }
            }
        }
        path.close();
        pen_x += f64::from(font.advance(glyph)) * scale;
    }
    path.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The image of these marks on a picture of 40 × 20 px.
    fn image(marks: Vec<Mark>, theme: Theme, scale: f64) -> Pixmap {
        let picture = Picture { title: String::new(), size: [40.0, 20.0], cuts: Vec::new(), marks };
        Pixmap::decode_png(&png(&picture, theme, scale).unwrap()).unwrap()
    }

    fn rgb(image: &Pixmap, x: u32, y: u32) -> [u8; 3] {
        let pixel = image.pixel(x, y).unwrap();
        [pixel.red(), pixel.green(), pixel.blue()]
    }

    #[test]
    fn an_image_has_the_picture_s_size_times_the_scale_and_the_theme_s_ground() {
        for theme in [Theme::Light, Theme::Dark] {
            let image = image(Vec::new(), theme, 2.5);
            assert_eq!((image.width(), image.height()), (100, 50));
            assert_eq!(rgb(&image, 99, 49), Ink::Paper.colour(theme));
        }
    }

    #[test]
    fn areas_lines_and_dots_lie_where_they_are_placed() {
        let square = vec![[2.0, 2.0], [8.0, 2.0], [8.0, 8.0], [2.0, 8.0]];
        let marks = vec![
            Mark::Lines {
                lines: vec![square],
                is_closed: true,
                fill: Some(Ink::Left),
                stroke: None,
            },
            Mark::Lines {
                lines: vec![vec![[12.0, 10.0], [20.0, 10.0]]],
                is_closed: false,
                fill: None,
                stroke: Stroke::of(Ink::Right, 4.0),
            },
            Mark::Dots { at: vec![[30.0, 10.0]], radius: 4.0, fill: Some(Ink::Scan), stroke: None },
        ];
        let image = image(marks, Theme::Light, 1.0);
        assert_eq!(rgb(&image, 5, 5), Ink::Left.colour(Theme::Light));
        assert_eq!(rgb(&image, 16, 10), Ink::Right.colour(Theme::Light));
        assert_eq!(rgb(&image, 30, 10), Ink::Scan.colour(Theme::Light));
        assert_eq!(rgb(&image, 5, 15), Ink::Paper.colour(Theme::Light));
    }

    #[test]
    fn dots_that_overlap_lie_over_each_other() {
        let at = vec![[20.0, 10.0], [24.0, 10.0]];
        let dots =
            |stroke| Mark::Dots { at: at.clone(), radius: 6.0, fill: Some(Ink::Scan), stroke };
        let scan = Ink::Scan.colour(Theme::Light);
        let plain = image(vec![dots(None)], Theme::Light, 1.0);
        assert_eq!([18, 22, 26].map(|x| rgb(&plain, x, 10)), [scan; 3]);
        let drawn = image(vec![dots(Stroke::of(Ink::Text, 4.0))], Theme::Light, 1.0);
        let text = Ink::Text.colour(Theme::Light);
        assert_eq!([17, 26].map(|x| rgb(&drawn, x, 10)), [text, scan]);
    }

    #[test]
    fn words_lie_before_around_or_behind_their_place() {
        let inked = |anchor: Anchor| {
            let words = Mark::Words {
                at: [20.0, 15.0],
                anchor,
                size: 10.0,
                is_bold: true,
                ink: Ink::Text,
                words: "HH".to_owned(),
            };
            let image = image(vec![words], Theme::Light, 1.0);
            let is_inked = |x: &u32| (0..20).any(|y| rgb(&image, *x, y) != [255; 3]);
            let columns: Vec<u32> = (0..40).filter(is_inked).collect();
            (columns[0], *columns.last().unwrap())
        };
        // Each H is as wide as 0.765 of the size, with room on both sides.
        assert!(matches!(inked(Anchor::Start), (20..=21, 33..=35)), "{:?}", inked(Anchor::Start));
        assert!(matches!(inked(Anchor::Middle), (12..=14, 26..=27)), "{:?}", inked(Anchor::Middle));
        assert!(matches!(inked(Anchor::End), (4..=6, 18..=19)), "{:?}", inked(Anchor::End));
    }

    #[test]
    fn images_without_pixels_or_with_too_many_are_refused() {
        for scale in [0.0, -1.0, f64::NAN, 1e4, f64::INFINITY] {
            let picture = Picture {
                title: String::new(),
                size: [40.0, 20.0],
                cuts: Vec::new(),
                marks: Vec::new(),
            };
            assert!(matches!(png(&picture, Theme::Light, scale), Err(PngFault::Size { .. })));
        }
    }
}
