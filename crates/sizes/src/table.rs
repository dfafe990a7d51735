//! A size table as its maker's leaflet gives it, in millimetres.

use jiff::civil::Date;
use serde::{Deserialize, Serialize};

use super::point::Point;

/// Name and number of the format of the files.
pub const FORMAT: &str = "gaiter-size-table/1";

/// A size table that has no fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SizeTable {
    /// Its name, which no other table has.
    pub id: String,
    /// Who makes the garment.
    pub maker: String,
    /// The garment.
    pub product: String,
    /// Edition or date of the maker's table.
    pub edition: String,
    /// Where the figures were read.
    pub source: String,
    /// How sure they are, in words; `None` if not stated.
    pub sureness: Option<String>,
    /// What it may be used for.
    pub status: Status,
    /// Who entered the figures.
    pub entered_by: Option<String>,
    /// Who checked them.
    pub checked_by: Option<String>,
    /// The last day on which it is valid; `None` if not stated.
    pub valid_until: Option<Date>,
    /// Whether a limit belongs to its range.
    pub limits: Limits,
    /// The point by which the size is sought first; `None` if no point is.
    pub decides: Option<Point>,
    /// Whether its girths are of skin; `None` if not stated.
    pub basis: Option<Basis>,
    /// Whether the file states where lengths begin; otherwise at the floor.
    pub states_where_lengths_begin: bool,
    /// The garments it is for; empty if it is for each whose points it has.
    pub garments: Vec<String>,
    /// The points that must fit; empty if each does that a size has.
    pub required: Vec<Required>,
    /// Its variants, such as a wide thigh.
    pub variants: Vec<Variant>,
    /// Its lengths, in the order of the file.
    pub lengths: Vec<LengthRow>,
    /// Its sizes, in the order of the file.
    pub sizes: Vec<Size>,
    /// SHA-256 of the file, lower-case hexadecimal.
    pub sha256: String,
}

gaiter_leg::word_enum! {
    /// What a table may be used for.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Status as serde {
        /// Not released yet.
        Draft => "draft",
        /// Only to try the program.
        TestOnly => "test-only",
        /// Two persons vouch for it.
        Released => "released",
    }
}

/// Whether a limit belongs to its range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Limits {
    /// Both limits belong to it.
    Closed,
    /// Neither does.
    Open,
}

/// What the girths of a table are measured on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// The tape lies on the skin without tension, as a scan measures.
    Skin,
    /// The tape is pulled. No rule converts one to the other.
    Tension,
}

/// The points that must fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Required {
    /// The garment they are required for; `None` for each that has them.
    pub garment: Option<String>,
    /// The points.
    pub points: Vec<Point>,
}

/// A variant, such as a wide thigh: a size with other ranges at some points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Variant {
    /// Its name.
    pub name: String,
    /// The garments it is made for; empty for all.
    pub applies_to: Vec<String>,
    /// The points whose ranges it replaces.
    pub replaces: Vec<Point>,
}

/// A length in which a garment is made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LengthRow {
    /// The garment.
    pub garment: String,
    /// The length's name: `short`.
    pub name: String,
    /// The ranges of its points.
    pub ranges: Vec<Ranged>,
}

/// One size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Size {
    /// Its name: `II`.
    pub name: String,
    /// Its article codes.
    pub codes: Vec<Code>,
    /// The ranges of its points, in the order of the file.
    pub ranges: Vec<Ranged>,
    /// The ranges of its variants, by their names.
    pub variants: Vec<(String, Vec<Ranged>)>,
}

/// An article code.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Code {
    /// The variant it is of; null for the size itself.
    pub variant: Option<String>,
    /// The garment it is of; null for all.
    pub garment: Option<String>,
    /// The length it is of; null for all.
    pub length: Option<String>,
    /// The code: an article number, PZN or GTIN.
    pub code: String,
}

/// The range of a point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ranged {
    /// The point.
    pub point: Point,
    /// Lower and upper limit, mm.
    pub mm: [f64; 2],
}

impl Limits {
    /// Whether a value lies within limits.
    pub fn hold(self, [low_mm, high_mm]: [f64; 2], value_mm: f64) -> bool {
        match self {
            Limits::Closed => low_mm <= value_mm && value_mm <= high_mm,
            Limits::Open => low_mm < value_mm && value_mm < high_mm,
        }
    }
}

impl SizeTable {
    /// Whether it is no longer valid on this day.
    pub fn is_expired(&self, today: Date) -> bool {
        self.valid_until.is_some_and(|last| today > last)
    }

    /// The points that must fit for a garment; `None` if each must that a size has.
    pub(crate) fn required_for(&self, garment: &str) -> Option<&Required> {
        let of =
            |name: Option<&str>| self.required.iter().find(move |of| of.garment.as_deref() == name);
        of(Some(garment)).or_else(|| of(None))
    }

    /// The variants that are made for a garment.
    pub(crate) fn variants_for<'a>(
        &'a self,
        garment: &'a str,
    ) -> impl Iterator<Item = &'a Variant> {
        let is_for = move |of: &&Variant| {
            of.applies_to.is_empty() || of.applies_to.iter().any(|name| name == garment)
        };
        self.variants.iter().filter(is_for)
    }

    /// The lengths in which a garment is made.
    pub(crate) fn lengths_for<'a>(
        &'a self,
        garment: &'a str,
    ) -> impl Iterator<Item = &'a LengthRow> {
        self.lengths.iter().filter(move |of| of.garment == garment)
    }
}

impl Size {
    /// The range of a point.
    pub fn range(&self, point: Point) -> Option<[f64; 2]> {
        self.ranges.iter().find(|of| of.point == point).map(|of| of.mm)
    }

    /// The ranges of a variant of it: those that the variant replaces, and its own elsewhere; `None` if it is
    /// not made in this variant.
    pub(crate) fn ranges_of(&self, variant: &str) -> Option<Vec<Ranged>> {
        let (_, replaced) = self.variants.iter().find(|(name, _)| name == variant)?;
        let its = |of: &Ranged| replaced.iter().find(|new| new.point == of.point).copied();
        let own = self.ranges.iter().map(|of| its(of).unwrap_or(*of));
        let more = replaced.iter().filter(|new| self.range(new.point).is_none()).copied();
        Some(own.chain(more).collect())
    }
}
