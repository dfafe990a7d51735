//! A fault of a size table, garment or mapping file: where it is, what was found, and what to do.

use gaiter_toml::Hint;

use super::mapping::MappingWhat;

/// One fault in a file.
pub type DocumentFault = gaiter_toml::Fault<What>;

/// What is wrong.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum What {
    /// What can be wrong with any file.
    #[error(transparent)]
    Toml(#[from] gaiter_toml::What),
    /// The file has another kind or version.
    #[error("the format is \"{found}\", not \"{expected}\"")]
    Format {
        /// As written.
        found: String,
        /// The one that is read here.
        expected: &'static str,
    },
    /// A key of the whole file in a section.
    #[error("unknown key")]
    OfTheWholeFile,
    /// A name that is no point of an order form.
    #[error("\"{0}\" is no point of an order form")]
    NoPoint(String),
    /// Not two limits.
    #[error("these are not two limits: {written}")]
    Limits {
        /// As written.
        written: String,
    },
    /// A range whose limits are in the wrong order, or equal.
    #[error("the lower limit {low} is not below the upper limit {high}")]
    Order {
        /// As written.
        low: String,
        /// As written.
        high: String,
    },
    /// A limit that no leg has in the table's unit.
    #[error("{found} {unit} is no {point} of a person ({least} to {most} {unit})")]
    Reach {
        /// As written.
        found: String,
        /// The table's unit.
        unit: &'static str,
        /// The point.
        point: String,
        /// The least that a person has, in that unit.
        least: String,
        /// The most that a person has, in that unit.
        most: String,
    },
    /// A number of mm that is no rounding for print.
    #[error("{0} mm is no rounding for print")]
    Rounding(String),
    /// A size lacks the range of a point that the table needs of every size.
    #[error("the size {size} has no range of {point}")]
    NoRange {
        /// The size.
        size: String,
        /// The point.
        point: String,
    },
    /// A variant replaces a point that no size has.
    #[error("replaces {0}, which no size has")]
    ReplacesNothing(String),
    /// A range of a variant for a point that it does not replace.
    #[error("the variant \"{variant}\" does not replace {point}")]
    NotReplaced {
        /// The variant.
        variant: String,
        /// The point.
        point: String,
    },
    /// A variant that is not described.
    #[error("there is no [[variant]] with the name \"{0}\"")]
    NoVariant(String),
    /// A size of a variant lacks a point that the variant replaces.
    #[error("lacks the range of {0}, which this variant replaces")]
    VariantLacks(String),
    /// A code for a length that is not described.
    #[error("there is no [[length]] of {garment} with the name \"{name}\"")]
    NoLength {
        /// The garment.
        garment: String,
        /// The length.
        name: String,
    },
    /// A released table without the names of two persons.
    #[error("a released table needs the names of two persons, in entered_by and checked_by")]
    Unsigned,
    /// A released table that was checked by the person who entered it.
    #[error("was entered and checked by the same person, \"{0}\"")]
    SamePerson(String),
    /// An optional box that the form does not have.
    #[error("{0} is not among the boxes")]
    NotABox(String),
    /// A notation without the place for the level's letter.
    #[error("\"{0}\" has no place for the letter of the level")]
    NoPlace(String),
    /// What only a mapping of an order can have wrong.
    #[error(transparent)]
    Mapping(#[from] MappingWhat),
}

/// How a range is written.
pub(super) const RANGE: &str =
    "write two numbers, a comma between them, decimals with a point: [18, 20.5]";

impl Hint for What {
    fn hint(&self) -> Option<String> {
        let hint = match self {
            What::Toml(what) => return what.hint(),
            What::Mapping(what) => return Some(what.hint()),
            What::Limits { .. } => RANGE,
            What::Format { found, .. } if found.starts_with("gaiter-garment/") => {
                "this is a garment: name it in report.garments, or by --garment-file"
            }
            What::Format { found, .. } if found.starts_with("gaiter-size-table/1") => {
                "this is a size table: name it in sizes.tables, or by --table"
            }
            What::Format { expected, .. } => {
                return Some(format!("write format = \"{expected}\" in a file of this kind"));
            }
            What::OfTheWholeFile => "write it above the first [[…]]: it is of the whole file",
            What::NoPoint(_) => {
                "girths are cA cY cB cB1 cC cD cE cF cG cH cT, lengths lB to lG, lBD, lK, foot"
            }
            What::Order { low, high } if low == high => "write two different limits",
            What::Order { low, high } => {
                return Some(format!("write the lower limit first: [{high}, {low}]"));
            }
            What::Reach { unit, .. } => {
                return Some(format!("look at the decimal point, and at unit = \"{unit}\""));
            }
            What::Rounding(_) => "write 0.1 to 50, in mm",
            What::NoRange { .. } => "add the range, or do not require the point",
            What::ReplacesNothing(_) => "name points that the sizes have",
            What::NotReplaced { .. } => "name the point in replaces of the variant",
            What::NoVariant(_) => "describe it with applies_to and replaces",
            What::VariantLacks(_) => "add the range, or leave the variant out of this size",
            What::NoLength { .. } => "write the name of a [[length]] of this garment",
            What::Unsigned => "let a second person check the figures and sign",
            What::SamePerson(_) => "let another person check the figures and sign",
            What::NotABox(_) => "add it to boxes, at its place on the form",
            What::NoPlace(_) => "write {level} where the letter belongs: \"c{level}\"",
        };
        Some(hint.to_owned())
    }
}
