//! Garments as data: what an order form asks for, and how it is printed.

mod profile;

use std::fmt;
use std::sync::OnceLock;

use gaiter_leg::Level;
use serde::{Deserialize, Serialize};

use super::fault::DocumentFault;
use super::point::Point;
use profile::Profile;
pub use profile::{FORMAT, FormBox, FormUnit};

/// A compression garment, by the levels at which it begins and ends (RAL-GZ 387) or by a name of its own.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub struct Garment(Profile);

/// The files of the garments that are shipped, the shortest first.
const SHIPPED: [&str; 4] = [
    include_str!("../garments/AD.toml"),
    include_str!("../garments/AF.toml"),
    include_str!("../garments/AG.toml"),
    include_str!("../garments/AT.toml"),
];

impl Garment {
    /// The garments that are shipped, the shortest first.
    pub fn shipped() -> &'static [Garment] {
        static ALL: OnceLock<Vec<Garment>> = OnceLock::new();
        // A test reads every file; one with a fault would be missing here.
        ALL.get_or_init(|| {
            let read = |text: &&str| profile::parse(text.as_bytes()).ok();
            SHIPPED.iter().filter_map(read).map(Garment).collect()
        })
    }

    /// The shipped garment of a name such as `AD`.
    pub fn named(name: &str) -> Option<Garment> {
        Garment::shipped().iter().find(|of| of.name() == name).cloned()
    }

    /// The garment of a file in the format [`FORMAT`].
    ///
    /// # Errors
    /// Every fault of the file, in the order of its lines; at least one.
    pub fn read(bytes: &[u8]) -> Result<Garment, Vec<DocumentFault>> {
        profile::parse(bytes).map(Garment)
    }

    /// The name on order forms and in the configuration.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// It by itself, in a language: `calf stocking (AD)`.
    pub fn title(&self, tag: &str) -> &str {
        self.0.titles.in_language(tag).unwrap_or(&self.0.name)
    }

    /// It within a sentence, in a language: `a calf stocking (AD)`.
    pub fn in_sentence(&self, tag: &str) -> &str {
        self.0.in_sentence.in_language(tag).unwrap_or_else(|| self.title(tag))
    }

    /// The levels whose girths or heights it needs, highest first.
    pub fn levels(&self) -> &[Level] {
        &self.0.levels
    }

    /// Whether it needs a point.
    pub fn needs(&self, point: Point) -> bool {
        self.0.boxes.iter().any(|of| of.point == point && !of.is_optional)
    }

    /// Whether a size table for it may ask for a point: one of its form, or a length between two of its
    /// levels.
    pub fn has(&self, point: Point) -> bool {
        match point {
            Point::Between(low, high) => {
                [low, high].iter().all(|level| self.levels().contains(level))
            }
            point => self.0.boxes.iter().any(|of| of.point == point),
        }
    }

    /// The boxes of its order form, in the order of the form.
    pub fn boxes(&self) -> &[FormBox] {
        &self.0.boxes
    }

    /// The unit of the form.
    pub fn unit(&self) -> FormUnit {
        self.0.unit
    }

    /// The step to which girths are rounded for the form, mm.
    pub fn round_girths_mm(&self) -> f64 {
        self.0.round_girths_mm
    }

    /// The step to which lengths are rounded for the form, mm.
    pub fn round_lengths_mm(&self) -> f64 {
        self.0.round_lengths_mm
    }

    /// The step to which a value is rounded for the form, mm. Everything else has all digits.
    pub fn step_mm(&self, point: Point) -> f64 {
        match point.is_girth() {
            true => self.0.round_girths_mm,
            false => self.0.round_lengths_mm,
        }
    }

    /// A value as the form prints it, mm: to the next step, half of one away from zero.
    pub fn printed_mm(&self, point: Point, mm: f64) -> f64 {
        let step_mm = self.step_mm(point);
        (mm / step_mm).round() * step_mm
    }

    /// Whether gaiter ships it.
    pub fn is_shipped(&self) -> bool {
        Garment::shipped().contains(self)
    }
}

impl Default for Garment {
    fn default() -> Garment {
        let nothing = || Garment(Profile::default());
        Garment::shipped().first().cloned().unwrap_or_else(nothing)
    }
}

impl fmt::Debug for Garment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Garment({})", self.name())
    }
}

/// Words of one meaning in the languages of the program.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Words(Vec<(String, String)>);

impl Words {
    /// The words in a language, else in English, else in the first language of the file.
    fn in_language(&self, tag: &str) -> Option<&str> {
        let of = |tag: &str| self.0.iter().find(|(language, _)| language == tag);
        let found = of(tag).or_else(|| of("en")).or(self.0.first());
        found.map(|(_, words)| words.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_garments_are_those_of_their_letters() {
        for text in SHIPPED {
            let faults = profile::parse(text.as_bytes()).err().unwrap_or_default();
            assert!(faults.is_empty(), "{faults:?}");
        }
        let names: Vec<&str> = Garment::shipped().iter().map(Garment::name).collect();
        assert_eq!(names, ["AD", "AF", "AG", "AT"]);
        assert_eq!(Garment::default().name(), "AD");
        let levels = |name: &str| Garment::named(name).unwrap().levels().to_vec();
        let mut calf = vec![Level::D, Level::C, Level::B1, Level::B, Level::Y];
        assert_eq!(levels("AD"), calf);
        calf.splice(0..0, [Level::F, Level::E]);
        assert_eq!(levels("AF"), calf);
        calf.insert(0, Level::G);
        assert_eq!((levels("AG"), levels("AT")), (calf.clone(), calf));
        let inside = Garment::shipped().iter().filter(|of| of.needs(Point::InsideLeg));
        assert_eq!(inside.map(Garment::name).collect::<Vec<_>>(), ["AT"]);
        assert!(Garment::shipped().iter().all(|of| of.needs(Point::Foot)));
        assert_eq!(Garment::named("BC"), None);
    }

    #[test]
    fn a_value_is_rounded_for_the_form_alone() {
        let form = Garment::read(
            b"format = \"gaiter-garment/1\"\nname = \"X\"\nboxes = [\"cB\", \"lB\"]\nunit = \"cm\"\n\
              round_girths_mm = 5\nround_lengths_mm = 10\n[title]\nen = \"x\"\n",
        )
        .unwrap();
        let girth = Point::Girth(Level::B);
        let printed = [212.4, 212.5, 207.6, 207.4].map(|mm| form.printed_mm(girth, mm));
        assert_eq!(printed, [210.0, 215.0, 210.0, 205.0]);
        assert_eq!(form.printed_mm(Point::Length(Level::B), 115.0), 120.0);
        assert_eq!((form.title("de"), form.in_sentence("en")), ("x", "x"));
    }
}
