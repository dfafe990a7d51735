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
    /// A line is not valid TOML.
    #[error("{slip}: {written}")]
    Notation {
        /// What it was probably meant to be.
        slip: Slip,
        /// The line.
        written: String,
    },
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
        /// What it was probably meant to be, as advice.
        advice: Option<String>,
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
    #[error("must be {}, not {found}: {written}", form.words)]
    Kind {
        /// The required form.
        form: Form,
        /// The kind that was found.
        found: &'static str,
        /// As written.
        written: String,
    },
    /// Not two limits.
    #[error("these are not two limits: {written}")]
    Limits {
        /// As written.
        written: String,
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

/// What a line that is no TOML was probably meant to be.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Slip {
    /// A key that the section has already.
    #[error("this key stands twice in its section")]
    Twice,
    /// A range.
    #[error("these are not two limits in [ ]")]
    Range,
    /// A date.
    #[error("this is no date that can be read")]
    Day,
    /// A text without quotation marks, or with those of a word processor.
    #[error("this text is not in straight quotes")]
    Quotes,
    /// A line with spaces that only look like spaces.
    #[error("a space in this line is not an ordinary one")]
    Space,
    /// Anything else, in the parser's words.
    #[error("{0}")]
    Other(String),
}

/// What a value must look like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    /// In words.
    pub words: &'static str,
    /// What to write.
    pub example: &'static str,
}

impl Form {
    /// A text.
    pub const TEXT: Form = Form { words: "text in quotes", example: "\"II\", in straight quotes" };
    /// A list.
    pub const LIST: Form = Form { words: "a list in [ ]", example: "[\"cB\", \"cC\"]" };
    /// Sections of one kind.
    pub const SECTIONS: Form = Form {
        words: "a section in double brackets",
        example: "[[size]], [[length]] or [[variant]] above each",
    };
    /// A date.
    pub const DAY: Form =
        Form { words: "a date", example: "year-month-day without quotes: 2027-01-31" };
    /// A limit of a range.
    pub const LIMIT: Form = Form { words: "a number", example: "it without quotes: [18, 20.5]" };
    /// The ranges of a variant.
    pub const VARIANT: Form =
        Form { words: "ranges of a variant", example: "variant.\"wide thigh\".cG = [57, 64]" };
    /// How a form names its boxes.
    pub const NOTATION: Form =
        Form { words: "a section", example: "[notation] and below it girth = \"c{level}\"" };
    /// A rounding.
    pub const ROUNDING: Form =
        Form { words: "a number of mm", example: "a number without quotes: 1" };
    /// Words by language.
    pub const WORDS: Form = Form {
        words: "a section with a text per language",
        example: "[title] and below it en = \"calf stocking (AD)\"",
    };
}

impl Slip {
    /// What to do.
    fn hint(&self) -> &'static str {
        match self {
            Slip::Twice => "remove one of the two; each size begins with a line [[size]]",
            Slip::Range => RANGE,
            Slip::Day => "write year-month-day without quotes: 2027-01-31",
            Slip::Quotes => "write it in straight quotes: maker = \"Muster\"",
            Slip::Space => "delete the spaces of this line and type them again",
            Slip::Other(_) => "docs/sizes.md shows a whole file",
        }
    }
}

/// How a range is written.
const RANGE: &str = "write two numbers, a comma between them, decimals with a point: [18, 20.5]";

impl What {
    /// What to do.
    pub fn hint(&self) -> String {
        match self {
            What::NotUtf8 => "save the file as UTF-8".to_owned(),
            What::TooLong { .. } => "name a size table or a garment file".to_owned(),
            What::Notation { slip, .. } => slip.hint().to_owned(),
            What::Limits { .. } => RANGE.to_owned(),
            What::Format { found, .. } if found.starts_with("gaiter-garment/") => {
                "this is a garment: name it in report.garments, or by --garment-file".to_owned()
            }
            What::Format { found, .. } if found.starts_with("gaiter-size-table/1") => {
                "this is a size table: name it in sizes.tables, or by --table".to_owned()
            }
            What::Format { expected, .. } => {
                format!("write format = \"{expected}\" in a file of this kind")
            }
            What::Unknown { advice: Some(advice), .. } => advice.clone(),
            What::Unknown { known, .. } => format!("known here: {known}"),
            What::NoPoint(_) => {
                "girths are cA cY cB cB1 cC cD cE cF cG cH cT, lengths lB to lG, lBD, lK, foot"
                    .to_owned()
            }
            What::Missing { example } => format!("write {example}"),
            What::Kind { form, .. } => format!("write {}", form.example),
            What::Word { .. } => "write one of these words".to_owned(),
            What::Text { .. } => "shorten it, without line ends".to_owned(),
            What::Order { low, high } if low == high => "write two different limits".to_owned(),
            What::Order { low, high } => format!("write the lower limit first: [{high}, {low}]"),
            What::Reach { unit, .. } => {
                format!("look at the decimal point, and at unit = \"{unit}\"")
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
