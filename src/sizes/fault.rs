//! A fault of a size table, garment or mapping file: where it is, what was found, and what to do.

use std::fmt;

use super::mapping::MappingWhat;

/// One fault in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// 1-based line.
    pub line: usize,
    /// 1-based column, in characters.
    pub column: usize,
    /// The key with its sections, such as `size.II.cB`; empty for a fault of the notation.
    pub key: String,
    /// What is wrong.
    pub what: What,
}

/// What is wrong.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum What {
    /// The file holds bytes that are not UTF-8.
    #[error("this is not UTF-8 text")]
    NotUtf8,
    /// The file is longer than any table.
    #[error("the file has {found} bytes; a file of this kind has at most {most}")]
    TooLong {
        /// Its length, bytes.
        found: usize,
        /// The greatest length that is read, bytes.
        most: usize,
    },
    /// The text is not valid TOML.
    #[error("{0}")]
    Notation(String),
    /// The file is of another kind or version.
    #[error("the format is \"{found}\", not \"{expected}\"")]
    Format {
        /// As written.
        found: String,
        /// The one that is read here.
        expected: &'static str,
    },
    /// A key that the format does not have.
    #[error("unknown key")]
    Unknown {
        /// The keys that are valid here.
        known: &'static str,
    },
    /// A name that is no point of an order form.
    #[error("\"{0}\" is no point of an order form")]
    NoPoint(String),
    /// A required key is missing.
    #[error("must be set")]
    Missing {
        /// A line that sets it.
        example: &'static str,
    },
    /// A value of the wrong kind.
    #[error("must be {expected}, not {found}")]
    Kind {
        /// The required kind.
        expected: &'static str,
        /// The kind that was found.
        found: &'static str,
    },
    /// Not one of the words of a choice.
    #[error("\"{found}\" is not one of {words}")]
    Word {
        /// As written.
        found: String,
        /// The words of the choice.
        words: &'static str,
    },
    /// A text that is empty, too long, or holds control characters.
    #[error("must be a text of 1 to {most} characters in a line")]
    Text {
        /// The greatest length, characters.
        most: usize,
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
    #[error("{found} {unit} is no measure of a leg")]
    Reach {
        /// As written.
        found: String,
        /// The table's unit.
        unit: &'static str,
    },
    /// A number of mm that is no rounding for print.
    #[error("{0} mm is no rounding for print")]
    Rounding(String),
    /// A name that stands twice.
    #[error("\"{0}\" stands twice")]
    Twice(String),
    /// A list that must have entries is empty.
    #[error("is empty")]
    Empty,
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

impl What {
    /// What to do.
    pub fn hint(&self) -> String {
        match self {
            What::NotUtf8 => "save the file as UTF-8".to_owned(),
            What::TooLong { .. } => "name a size table or a garment file".to_owned(),
            What::Notation(_) => "docs/sizes.md shows a whole file".to_owned(),
            What::Format { expected, .. } => {
                format!("write format = \"{expected}\" in a file of this kind")
            }
            What::Unknown { known } => format!("known here: {known}"),
            What::NoPoint(_) => {
                "girths are cA cY cB cB1 cC cD cE cF cG cH cT, lengths lB to lG, lBD, lK, foot"
                    .to_owned()
            }
            What::Missing { example } => format!("write {example}"),
            What::Kind { .. } => "docs/sizes.md shows every key".to_owned(),
            What::Word { .. } => "write one of these words".to_owned(),
            What::Text { .. } => "shorten it, without line ends".to_owned(),
            What::Order { .. } => "write the lower limit first: [18, 20]".to_owned(),
            What::Reach { .. } => {
                "look at unit = \"cm\" or \"mm\", and at the decimal point".to_owned()
            }
            What::Rounding(_) => "write 0.1 to 50, in mm".to_owned(),
            What::Twice(_) => "remove or rename one of the two".to_owned(),
            What::Empty => "write at least one entry".to_owned(),
            What::NoRange { .. } => "add the range, or do not require the point".to_owned(),
            What::ReplacesNothing(_) => "name points that the sizes have".to_owned(),
            What::NotReplaced { .. } => "name the point in replaces of the variant".to_owned(),
            What::NoVariant(_) => "describe it with applies_to and replaces".to_owned(),
            What::VariantLacks(_) => {
                "add the range, or leave the variant out of this size".to_owned()
            }
            What::NoLength { .. } => "write the name of a [[length]] of this garment".to_owned(),
            What::Unsigned => "let a second person check the figures and sign".to_owned(),
            What::SamePerson(_) => "let another person check the figures and sign".to_owned(),
            What::NotABox(_) => "add it to boxes, at its place on the form".to_owned(),
            What::NoPlace(_) => "write {level} where the letter belongs: \"c{level}\"".to_owned(),
            What::Mapping(what) => what.hint(),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Fault { line, column, key, what } = self;
        write!(f, "{line}:{column}: ")?;
        if !key.is_empty() {
            write!(f, "{}: ", printable(key))?;
        }
        write!(f, "{}; {}", printable(&what.to_string()), printable(&what.hint()))
    }
}

impl std::error::Error for Fault {}

/// A text in a line: what would turn or break it is escaped.
fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
                shown.extend(letter.escape_default())
            }
            letter if letter.is_control() => shown.extend(letter.escape_default()),
            letter => shown.push(letter),
        }
    }
    shown
}
