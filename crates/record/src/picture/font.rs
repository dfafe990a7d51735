//! The letters of pictures and of the PDF: two fonts within the program, parsed once.
//!
//! The fonts are TrueType files made by `fonts/make.py`: one `cmap` of format 4 and an advance for every
//! glyph. Only these are read.
//! Source: OpenType 1.9.1, `cmap`, `maxp`, `hmtx`.

use std::sync::LazyLock;

/// Noto Sans, regular and bold.
const FILES: [&[u8]; 2] =
    [include_bytes!("fonts/NotoSans-Regular.ttf"), include_bytes!("fonts/NotoSans-Bold.ttf")];

static FONTS: LazyLock<[Font; 2]> =
    LazyLock::new(|| FILES.map(|file| Font::read(file).unwrap_or_default()));

/// Font units per em, which is the font size.
pub const UNITS_PER_EM: f64 = 1000.0;

/// One of the embedded fonts.
#[derive(Debug, Default)]
pub struct Font {
    /// The TrueType file.
    pub file: &'static [u8],
    /// The glyph of each letter, by its code point; 0 for none. A page of a report looks up tens of
    /// thousands of letters, and the last one of the fonts has a small code point.
    glyphs: Vec<u16>,
    advances: Vec<u16>,
}

impl Font {
    /// The regular or the bold font.
    pub fn with_weight(is_bold: bool) -> &'static Font {
        &FONTS[usize::from(is_bold)]
    }

    /// The glyph of a letter; `None` if the font lacks it.
    pub fn glyph(&self, letter: char) -> Option<u16> {
        self.glyphs.get(letter as usize).copied().filter(|glyph| *glyph != 0)
    }

    /// How far a glyph moves the pen, 1/[`UNITS_PER_EM`].
    pub fn advance(&self, glyph: u16) -> u16 {
        self.advances.get(usize::from(glyph)).copied().unwrap_or(0)
    }

    /// Width of a text at a letter size, in the unit of that size.
    pub fn width(&self, words: &str, size: f64) -> f64 {
        let glyphs = words.chars().map(|letter| self.glyph(letter).unwrap_or(0));
        let units: u32 = glyphs.map(|glyph| u32::from(self.advance(glyph))).sum();
        f64::from(units) / UNITS_PER_EM * size
    }

    fn read(file: &'static [u8]) -> Option<Font> {
        let count = word(table(file, b"maxp")?, 4)?;
        let hmtx = table(file, b"hmtx")?;
        Some(Font {
            file,
            glyphs: glyphs(table(file, b"cmap")?)?,
            advances: (0..count)
                .map(|glyph| word(hmtx, 4 * usize::from(glyph)))
                .collect::<Option<_>>()?,
        })
    }
}

/// A text that both fonts can write. A letter that they lack, or that is invisible, is replaced by its
/// code point, and every blank by a plain one. So no two ids look alike because a letter is missing, and
/// nothing is ever written from right to left.
pub fn writable(words: &str) -> String {
    let mut written = String::with_capacity(words.len());
    for letter in words.chars() {
        match letter {
            '\t' | '\n' | '\r' => written.push(' '),
            _ if is_writable(letter) => written.push(letter),
            _ => written.push_str(&format!("[U+{:04X}]", u32::from(letter))),
        }
    }
    written
}

fn is_writable(letter: char) -> bool {
    // A soft hyphen has a glyph but is invisible.
    letter != '\u{AD}'
        && [false, true].iter().all(|bold| Font::with_weight(*bold).glyph(letter).is_some())
}

fn table(file: &'static [u8], tag: &[u8; 4]) -> Option<&'static [u8]> {
    let count = usize::from(word(file, 4)?);
    let mut entries = file.get(12..12 + 16 * count)?.chunks_exact(16);
    let entry = entries.find(|entry| entry.starts_with(tag))?;
    let [from, length] = [long(entry, 8)?, long(entry, 12)?];
    file.get(from..from.checked_add(length)?)
}

/// Maps letters to glyphs, from the first table, which has format 4.
fn glyphs(cmap: &[u8]) -> Option<Vec<u16>> {
    let sub = cmap.get(long(cmap, 8)?..)?;
    if word(sub, 0)? != 4 {
        return None;
    }
    let twice = usize::from(word(sub, 6)?);
    // Four columns: last letter, first letter, delta, offset of the glyph list.
    let [ends, starts, deltas, offsets] = [14, 16 + twice, 16 + 2 * twice, 16 + 3 * twice];
    let mut found = Vec::new();
    for row in (0..twice).step_by(2) {
        let [end, start] = [word(sub, ends + row)?, word(sub, starts + row)?];
        let [delta, offset] = [word(sub, deltas + row)?, word(sub, offsets + row)?];
        for code in start..=end {
            let listed = || {
                let place = offsets + row + usize::from(offset) + 2 * usize::from(code - start);
                word(sub, place).map(|glyph| if glyph == 0 { 0 } else { glyph.wrapping_add(delta) })
            };
            let glyph = if offset == 0 { code.wrapping_add(delta) } else { listed()? };
            if glyph != 0 {
                found.resize(found.len().max(usize::from(code) + 1), 0);
                found[usize::from(code)] = glyph;
            }
        }
    }
    Some(found)
}

/// A 16-bit number, high byte first.
fn word(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..at + 2)?.try_into().ok().map(u16::from_be_bytes)
}

/// A 32-bit number, highest byte first.
fn long(bytes: &[u8], at: usize) -> Option<usize> {
    bytes.get(at..at + 4)?.try_into().ok().map(u32::from_be_bytes)?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fonts_have_what_reports_in_both_languages_are_written_with() {
        let needed = "ÄÖÜäöüßẞ ±−–—…·×²³⁻°%‰≈≠≤≥←→↑↓●○‘’“”„‚«»✓Ωλ\u{202F}\u{2009}\u{2007}\u{A0}Жя";
        let ascii: String = (' '..='~').collect();
        assert_eq!(writable(needed), needed);
        assert_eq!(writable(&ascii), ascii);
    }

    #[test]
    fn figures_are_of_one_width_and_letters_have_noto_s_own() {
        for (bold, a) in [(false, 639), (true, 690)] {
            let font = Font::with_weight(bold);
            for digit in '0'..='9' {
                assert_eq!(font.advance(font.glyph(digit).unwrap()), 572, "{digit}");
            }
            assert_eq!(font.advance(font.glyph('A').unwrap()), a);
        }
        assert!((Font::with_weight(false).width("A0", 10.0) - 12.11).abs() < 1e-9);
    }

    #[test]
    fn letters_that_cannot_be_written_stand_as_their_code_points() {
        assert_eq!(writable("a\u{5E9}\u{202E}1\u{AD}\n漢"), "a[U+05E9][U+202E]1[U+00AD] [U+6F22]");
    }
}
