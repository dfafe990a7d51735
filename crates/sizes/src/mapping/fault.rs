//! What a file can have wrong only as the mapping of an order.

/// What is wrong.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MappingWhat {
    /// A column with neither or both of `value` and `text`.
    #[error("a column has either a value or a text")]
    NeitherOrBoth,
    /// A value that no order has.
    #[error("\"{0}\" is no value of an order")]
    NoValue(String),
    /// A point without its leg in a file with one row.
    #[error("\"{0}\" names no leg, and the file has one row for both")]
    NoLeg(String),
    /// A point of the body that is declared as a leg's.
    #[error("\"{0}\" is a point of the body and of no leg")]
    OfTheBody(String),
    /// A value that a row of this kind does not have.
    #[error("a row per {rows} has no \"{value}\"")]
    NotInRow {
        /// The value.
        value: String,
        /// The word of the rows.
        rows: &'static str,
    },
    /// A date format for a value that is no date.
    #[error("\"{0}\" is no date and has no format")]
    NoDate(String),
    /// A text that is no format of a date.
    #[error("\"{0}\" is no format of a date")]
    DateFormat(String),
    /// A text that is no name of an order file.
    #[error("\"{0}\" is no name of an order file")]
    FileName(String),
    /// A text that a spreadsheet would take for a formula.
    #[error("\"{0}\" would be a formula in a spreadsheet")]
    Formula(String),
    /// A number that is no rounding step.
    #[error("{found} {unit} is no step to which figures are rounded")]
    Step {
        /// As written.
        found: String,
        /// The unit of the file.
        unit: &'static str,
    },
    /// Fewer or more decimals than figures can have.
    #[error("{found} is not a number of decimals from {least} to {most}")]
    Decimals {
        /// As written.
        found: String,
        /// As many as the step has.
        least: usize,
        /// The most.
        most: usize,
    },
    /// A key of tables in a mapping that makes none.
    #[error("is a key of layout = \"csv\" only")]
    OnlyCsv,
    /// Points in a mapping whose rows are none.
    #[error("is a key of rows = \"level\" and \"point\" only")]
    OnlyPoints,
    /// More columns than a form has.
    #[error("there are {found} columns; a mapping has at most {most}")]
    Columns {
        /// Their number.
        found: usize,
        /// The greatest number.
        most: usize,
    },
}

impl MappingWhat {
    /// What to do.
    pub fn hint(&self) -> String {
        let hint = match self {
            MappingWhat::NeitherOrBoth => "write value = \"right.cB\" or text = \"…\"",
            MappingWhat::NoValue(_) => {
                "values are points (right.cB, left.lD, body.cT), order.ref, scan.ref, scan.date, side, \
                 garment and those of docs/orders.md"
            }
            MappingWhat::NoLeg(value) => return format!("write right.{value} or left.{value}"),
            MappingWhat::OfTheBody(point) => return format!("write body.{point}"),
            MappingWhat::NotInRow { .. } => "docs/orders.md says which values each kind of row has",
            MappingWhat::NoDate(_) => "remove format",
            MappingWhat::DateFormat(_) => {
                "write %d, %m, %Y, %y, %H, %M and %S with signs between them: \"%d.%m.%Y\""
            }
            MappingWhat::FileName(_) => {
                "begin with \"order\", use a-z, A-Z, 0-9, - _ . and {id}, {scan}, {date}, {garment}, \
                 {ref}, end as in \"order-{id}.csv\"; order.csv and order.json are taken"
            }
            MappingWhat::Formula(_) => "do not begin it with = + - or @",
            MappingWhat::Step { .. } => {
                "write a number with at most 4 decimals, of 0.01 mm to 50 mm"
            }
            MappingWhat::Decimals { .. } => "leave decimals out, or change step",
            MappingWhat::OnlyCsv | MappingWhat::OnlyPoints => "remove it",
            MappingWhat::Columns { .. } => "split the file",
        };
        hint.to_owned()
    }
}
