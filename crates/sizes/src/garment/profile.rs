//! The file of a garment → [`Profile`], or every fault of it.

use gaiter_leg::Level;
use serde::{Deserialize, Serialize};

use super::Words;
use crate::document::{Section, SectionKeys, number, read};
use crate::fault::{DocumentFault, What};
use crate::parse::points;
use crate::point::Point;

/// Name and number of the format of the files.
pub const FORMAT: &str = "gaiter-garment/1";

/// The keys of a file.
const KEYS: &str =
    "format name boxes optional unit round_girths_mm round_lengths_mm title in_sentence notation";

/// The place of a level's letter in a notation.
const LETTER: &str = "{level}";

/// The roundings for print, mm: a tenth of a millimetre to five centimetres.
const ROUNDINGS_MM: [f64; 2] = [0.1, 50.0];

/// Rounding for print if the file has none, mm: as on a tape.
const ROUNDING_MM: f64 = 1.0;

/// What an order form of a garment asks for.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// The name on order forms and in the configuration.
    pub(super) name: String,
    /// It by itself, by language.
    pub(super) titles: Words,
    /// It within a sentence, by language.
    pub(super) in_sentence: Words,
    /// The boxes of the form, in its order.
    pub(super) boxes: Vec<FormBox>,
    /// The levels of the boxes that are needed, highest first.
    pub(super) levels: Vec<Level>,
    pub(super) unit: FormUnit,
    /// Girths are printed to the next multiple of this, mm.
    pub(super) round_girths_mm: f64,
    /// Lengths are printed to the next multiple of this, mm.
    pub(super) round_lengths_mm: f64,
}

/// A box of an order form.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FormBox {
    /// What stands in it.
    pub point: Point,
    /// Its name on the form.
    pub name: String,
    /// Whether it may stay empty.
    pub is_optional: bool,
}

gaiter_leg::word_enum! {
    /// The unit of an order form.
    #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
    pub enum FormUnit {
        /// Centimetres.
        #[default]
        Cm => "cm",
        /// Millimetres.
        Mm => "mm",
    }
}

/// The names of the boxes.
struct Notation {
    girth: String,
    length: String,
    foot: String,
    inside_leg: String,
}

/// Reads the file of a garment.
pub(super) fn parse(bytes: &[u8]) -> Result<Profile, Vec<DocumentFault>> {
    read(bytes, FORMAT, "format = \"gaiter-garment/1\"", profile)
}

fn profile(whole: Section<'_, '_>) -> Option<Profile> {
    SectionKeys::here(KEYS).only(whole);
    let name = whole.required_text("name", "name = \"AD\"");
    let unit = whole.choice("unit", &FormUnit::WORDS).unwrap_or_default();
    let roundings = ["round_girths_mm", "round_lengths_mm"].map(|key| rounding(whole, key));
    let notation = notation(whole);
    let boxes = boxes(whole, &notation);
    let titles = words(whole, "title");
    if titles.0.is_empty() {
        whole.must_have("title.en", "[title] and en = \"calf stocking (AD)\"");
    }
    let is_needed = |level: &Level| {
        let mut needed = boxes.iter().filter(|of| !of.is_optional);
        needed.any(|of| of.point.levels().any(|its| its == *level))
    };
    let levels = Level::ALL.into_iter().rev().filter(is_needed).collect();
    let in_sentence = words(whole, "in_sentence");
    let [round_girths_mm, round_lengths_mm] = roundings;
    Some(Profile {
        name: name?,
        titles,
        in_sentence,
        levels,
        boxes,
        unit,
        round_girths_mm,
        round_lengths_mm,
    })
}

/// The boxes of the form: those of `boxes`, of which `optional` may stay empty.
fn boxes(whole: Section<'_, '_>, notation: &Notation) -> Vec<FormBox> {
    let Some(value) = whole.get("boxes") else {
        whole.must_have("boxes", "boxes = [\"cB\", \"lB\", \"cC\", \"lC\"]");
        return Vec::new();
    };
    let all = points(whole, value, "boxes");
    let optional = whole.get("optional").map(|value| (points(whole, value, "optional"), value));
    let optional = optional.map_or(Vec::new(), |(points, value)| {
        for point in points.iter().filter(|point| !all.contains(point)) {
            whole.note(&value.span(), "optional", What::NotABox(point.to_string()));
        }
        points
    });
    let form_box = |point: Point| FormBox {
        point,
        name: notation.name(point),
        is_optional: optional.contains(&point),
    };
    all.into_iter().map(form_box).collect()
}

impl Notation {
    fn name(&self, point: Point) -> String {
        match point {
            Point::Girth(level) => self.girth.replace(LETTER, level.name()),
            Point::Length(level) => self.length.replace(LETTER, level.name()),
            Point::Between(low, high) => {
                self.length.replace(LETTER, &format!("{}{}", low.name(), high.name()))
            }
            Point::Foot => self.foot.clone(),
            Point::InsideLeg => self.inside_leg.clone(),
            Point::Beyond(_) => point.to_string(),
        }
    }
}

/// `[notation]`: how the form names its boxes.
fn notation(whole: Section<'_, '_>) -> Notation {
    let example = "[notation] and below it girth = \"c{level}\"";
    let section = whole.section("notation", "notation", "a section", example);
    let text = |name: &str, usual: String| section.and_then(|of| of.text(name)).unwrap_or(usual);
    let notation = Notation {
        girth: text("girth", format!("c{LETTER}")),
        length: text("length", format!("l{LETTER}")),
        foot: text("foot", Point::Foot.to_string()),
        inside_leg: text("inside_leg", Point::InsideLeg.to_string()),
    };
    let Some(section) = section else { return notation };
    SectionKeys { words: "girth length foot inside_leg", points: "", above: KEYS }.only(section);
    for (name, found) in [("girth", &notation.girth), ("length", &notation.length)] {
        if !found.contains(LETTER) {
            section.note(&section.at(), section.key(name), What::NoPlace(found.clone()));
        }
    }
    notation
}

/// A rounding for print, mm.
fn rounding(whole: Section<'_, '_>, name: &str) -> f64 {
    let Some(value) = whole.get(name) else { return ROUNDING_MM };
    match number(value.get_ref()) {
        Some((_, mm)) if (ROUNDINGS_MM[0]..=ROUNDINGS_MM[1]).contains(&mm) => mm,
        Some((written, _)) => {
            whole.note(&value.span(), name, What::Rounding(written));
            ROUNDING_MM
        }
        None => {
            whole.note_kind(value, name, "a number of mm", "a number without quotes: 1");
            ROUNDING_MM
        }
    }
}

/// A section with words by language.
fn words(whole: Section<'_, '_>, name: &str) -> Words {
    let (expected, example) =
        ("a section with a text per language", "[title] and below it en = \"calf stocking (AD)\"");
    let Some(section) = whole.section(name, name, expected, example) else {
        return Words::default();
    };
    let mut words = Vec::new();
    for (tag, _) in section.pairs() {
        let text = section.text(tag.get_ref());
        words.extend(text.map(|text| (tag.get_ref().to_string(), text)));
    }
    Words(words)
}
