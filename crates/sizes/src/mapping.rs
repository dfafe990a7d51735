//! How an order is written for a maker or a shop system, as data: which columns, in which order, with which
//! names, in which unit. Knows no orders; `gaiter_record::order` fills it.

mod date;
mod fault;
mod file_name;
mod parse;
mod value;

use serde::{Deserialize, Serialize};

use super::Point;
pub use date::DateFormat;
pub use fault::MappingWhat;
pub use file_name::{FileName, Named};
pub use parse::parse;
pub use value::{BodyPart, Cell, Dated, Fact, Of, Which};

/// Name and number of the format of the files.
pub const FORMAT: &str = "gaiter-order-mapping/1";

/// How an order is written for a maker or a shop system.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mapping {
    /// Its name, which no other mapping of a station has.
    pub id: String,
    /// Its name for people.
    pub name: String,
    /// Where the form of the file was read.
    pub source: String,
    /// How its files are named.
    pub file_name: FileName,
    /// The kind of file.
    pub layout: Layout,
    /// What a row is.
    pub rows: Rows,
    /// The points of the rows, for a row per level or point; `None` for those of the order's form.
    pub points: Option<Vec<Point>>,
    /// The columns, in their order; at least one.
    pub columns: Vec<Column>,
    /// How figures are written.
    pub figures: NumberFormat,
    /// What is written in the place of a figure that is not.
    pub instead: Instead,
    /// The words for the right and the left leg, and for what belongs to neither.
    pub sides: [String; 3],
}

/// The kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Layout {
    /// A table with a separator.
    Csv(Csv),
    /// One object, or a list of objects with one for each row.
    Json,
}

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Csv {
    /// The sign between cells.
    pub separator: char,
    /// Whether every cell is in quotes, or only one that needs them.
    pub quotes_all: bool,
    /// The end of a line.
    pub line_end: LineEnd,
    /// The character set.
    pub encoding: Encoding,
    /// Whether the first line has the names of the columns.
    pub has_header: bool,
    /// Whether a person opens it in a spreadsheet: texts that this would take for numbers or days then stay texts.
    pub is_spreadsheet: bool,
}

gaiter_leg::word_enum! {
    /// The end of a line.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum LineEnd {
        /// Carriage return and line feed.
        CrLf => "crlf",
        /// Line feed alone.
        Lf => "lf",
    }
}

impl LineEnd {
    /// Its characters.
    pub fn text(self) -> &'static str {
        match self {
            LineEnd::CrLf => "\r\n",
            LineEnd::Lf => "\n",
        }
    }
}

/// The character set of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Encoding {
    /// UTF-8.
    Utf8,
    /// UTF-8 with a byte order mark, by which a spreadsheet recognises it.
    Utf8Bom,
    /// Windows code page 1252.
    Cp1252,
}

gaiter_leg::word_enum! {
    /// What a row is.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Rows {
        /// The whole order: there is one row.
        Order => "order",
        /// A leg.
        Leg => "leg",
        /// A level of a leg, with girth and length.
        Level => "level",
        /// A box of a leg: a girth or a length.
        Point => "point",
    }
}

/// A column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// What stands in it.
    pub cell: Cell,
}

/// How figures are written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NumberFormat {
    /// The unit, mm.
    pub unit_mm: f64,
    /// Figures are multiples of this, in the unit.
    pub step: f64,
    /// To which multiple they are rounded.
    pub rounding: Rounding,
    /// How many decimals are written.
    pub decimals: usize,
    /// The sign before the decimals.
    pub sign: char,
}

/// To which multiple of the step a figure is rounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Rounding {
    /// The nearest; half a step goes away from zero.
    Nearest,
    /// The next one above.
    Up,
    /// The next one below.
    Down,
}

/// A share of a step by which a figure may be off a multiple and is still taken for it: records have
/// thousandths of a millimetre, and the steps of a mapping no exact binary value.
const OFF: f64 = 1e-6;

impl NumberFormat {
    /// The multiple of the step to which a length is rounded, in the unit.
    pub fn rounded(&self, mm: f64, rounding: Rounding) -> f64 {
        let steps = mm / self.unit_mm / self.step;
        let steps = match rounding {
            Rounding::Nearest => (steps.abs() + OFF).round().copysign(steps),
            Rounding::Up => (steps - OFF).ceil(),
            Rounding::Down => (steps + OFF).floor(),
        };
        // A negative zero becomes zero.
        steps * self.step + 0.0
    }

    /// A length as text, rounded, with the decimal sign of the file.
    pub fn text(&self, mm: f64, rounding: Rounding) -> String {
        let text = format!("{:.*}", self.decimals, self.rounded(mm, rounding));
        text.replace('.', &self.sign.to_string())
    }
}

/// What is written in the place of a figure, and which figures that are not sure are written all the same.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Instead {
    /// For a point that nobody measured.
    pub missing: String,
    /// For one that is estimated by a proportion of the body.
    pub estimated: String,
    /// For one that is in doubt.
    pub doubtful: String,
    /// Whether an estimated figure is written.
    pub writes_estimated: bool,
    /// Whether a doubtful figure is written.
    pub writes_doubtful: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(unit_mm: f64, step: f64, decimals: usize) -> NumberFormat {
        NumberFormat { unit_mm, step, rounding: Rounding::Nearest, decimals, sign: ',' }
    }

    #[test]
    fn a_figure_is_the_nearest_the_next_or_the_last_multiple_of_the_step() {
        let cm = figures(10.0, 0.5, 1);
        let told = |rounding| [212.4, 212.5, 215.0, 217.5].map(|mm| cm.text(mm, rounding));
        assert_eq!(told(Rounding::Nearest), ["21,0", "21,5", "21,5", "22,0"]);
        assert_eq!(told(Rounding::Up), ["21,5", "21,5", "21,5", "22,0"]);
        assert_eq!(told(Rounding::Down), ["21,0", "21,0", "21,5", "21,5"]);
    }

    #[test]
    fn a_multiple_of_the_step_is_itself_however_it_is_rounded() {
        for (of, last) in [(figures(10.0, 0.1, 1), 20_000), (figures(25.4, 0.0625, 4), 600)] {
            for steps in 0..last {
                let mm = f64::from(steps) * of.step * of.unit_mm;
                // As records have it: to a thousandth of a millimetre.
                let mm = (mm * 1000.0).round() / 1000.0;
                let nearest = of.text(mm, Rounding::Nearest);
                let exact = format!("{:.*}", of.decimals, f64::from(steps) * of.step);
                assert_eq!(nearest, exact.replace('.', ","), "{mm}");
            }
        }
        assert_eq!(figures(10.0, 0.1, 1).text(385.0, Rounding::Up), "38,5");
        assert_eq!(figures(10.0, 0.1, 1).text(385.0, Rounding::Down), "38,5");
    }

    #[test]
    fn nothing_is_no_minus() {
        let of = figures(10.0, 0.1, 1);
        assert_eq!([-0.2, -0.6].map(|mm| of.text(mm, Rounding::Nearest)), ["0,0", "-0,1"]);
    }
}
