//! The fonts of a PDF: subsets of the program's fonts with the glyphs that it uses, embedded with their
//! meaning, so that its text can be searched and copied.

use std::collections::BTreeMap;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, Str};
use subsetter::GlyphRemapper;

use super::PdfFault;
use crate::picture::font::{Font, UNITS_PER_EM};

/// Names of the fonts on a page, regular and bold.
pub(super) const NAMES: [Name<'static>; 2] = [Name(b"R"), Name(b"B")];

const SYSTEM: SystemInfo =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// The letters of one font that a PDF uses.
pub(super) struct Letters {
    is_bold: bool,
    cut: GlyphRemapper,
    /// The letter of each glyph, by its number in the subset.
    meaning: BTreeMap<u16, char>,
}

/// The objects of one font.
pub(super) struct FontRefs {
    /// The font object that pages refer to.
    pub font: Ref,
    glyphs: Ref,
    descriptor: Ref,
    file: Ref,
    meaning: Ref,
}

impl FontRefs {
    pub(super) fn new(mut next: impl FnMut() -> Ref) -> FontRefs {
        FontRefs { font: next(), glyphs: next(), descriptor: next(), file: next(), meaning: next() }
    }
}

impl Letters {
    pub(super) fn new(is_bold: bool) -> Letters {
        Letters { is_bold, cut: GlyphRemapper::new(), meaning: BTreeMap::new() }
    }

    /// Encodes writable text as the glyph numbers of this PDF, two bytes each.
    pub(super) fn encoded(&mut self, words: &str) -> Vec<u8> {
        let font = Font::with_weight(self.is_bold);
        let mut bytes = Vec::with_capacity(2 * words.len());
        for letter in words.chars() {
            let Some(glyph) = font.glyph(letter) else { continue };
            let number = self.cut.remap(glyph);
            self.meaning.entry(number).or_insert(letter);
            bytes.extend(number.to_be_bytes());
        }
        bytes
    }

    /// Writes the objects of this font.
    pub(super) fn write(&self, pdf: &mut Pdf, refs: &FontRefs) -> Result<(), PdfFault> {
        let font = Font::with_weight(self.is_bold);
        let file = subsetter::subset(font.file, 0, &self.cut)
            .map_err(|fault| PdfFault::Font { message: fault.to_string() })?;
        let name = self.name();
        let name = Name(name.as_bytes());
        pdf.type0_font(refs.font)
            .base_font(name)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(refs.glyphs)
            .to_unicode(refs.meaning);
        let mut glyphs = pdf.cid_font(refs.glyphs);
        glyphs
            .subtype(CidFontType::Type2)
            .base_font(name)
            .system_info(SYSTEM)
            .font_descriptor(refs.descriptor)
            .default_width(0.0)
            .cid_to_gid_map_predefined(Name(b"Identity"));
        let widths = self.cut.remapped_gids().map(|glyph| f32::from(font.advance(glyph)));
        glyphs.widths().consecutive(0, widths);
        glyphs.finish();
        self.describe(pdf, refs, name);
        let packed_file = packed(&file);
        pdf.stream(refs.file, &packed_file)
            .filter(Filter::FlateDecode)
            .pair(Name(b"Length1"), file.len() as i32);
        let mut meaning = UnicodeCmap::new(Name(b"Letters"), SYSTEM);
        for (number, letter) in &self.meaning {
            meaning.pair(*number, *letter);
        }
        pdf.stream(refs.meaning, &packed(meaning.finish().as_slice())).filter(Filter::FlateDecode);
        Ok(())
    }

    /// Describes the font for viewers that need a substitute. The values are those of Noto Sans.
    fn describe(&self, pdf: &mut Pdf, refs: &FontRefs, name: Name) {
        let em = UNITS_PER_EM as f32;
        pdf.font_descriptor(refs.descriptor)
            .name(name)
            .flags(FontFlags::NON_SYMBOLIC)
            .bbox(Rect::new(-0.2 * em, -0.25 * em, 1.26 * em, 1.01 * em))
            .italic_angle(0.0)
            .ascent(1.069 * em)
            .descent(-0.293 * em)
            .cap_height(0.714 * em)
            .stem_v(if self.is_bold { 0.14 * em } else { 0.09 * em })
            .font_file2(refs.file);
    }

    /// The font's name after a tag of six letters that identifies the subset (ISO 32000-1, 9.6.4). The
    /// tag is derived from the glyphs by FNV-1a.
    fn name(&self) -> String {
        let mix = |sum: u64, glyph: u16| (sum ^ u64::from(glyph)).wrapping_mul(0x0100_0000_01b3);
        let mut sum = self.cut.remapped_gids().fold(0xcbf2_9ce4_8422_2325, mix);
        let mut letter = || {
            let letter = b'A' + (sum % 26) as u8;
            sum /= 26;
            char::from(letter)
        };
        let tag: String = (0..6).map(|_| letter()).collect();
        format!("{tag}+NotoSans-{}", if self.is_bold { "Bold" } else { "Regular" })
    }
}

/// Fast rather than small, because every scan gets a PDF: level 6 saves a seventh of its size but takes
/// five times as long.
const LEVEL: Compression = Compression::fast();

/// Compresses bytes for the `FlateDecode` filter.
pub(super) fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(bytes.len() / 3), LEVEL);
    // Writing to memory never fails. Uncompressed bytes would not be a valid stream.
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.unwrap_or_default()
}
