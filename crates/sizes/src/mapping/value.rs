//! What stands in a column of a mapping.

use serde::{Deserialize, Serialize};

use super::Rows;
use super::date::DateFormat;
use super::fault::MappingWhat;
use crate::Point;

/// What stands in a column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Cell {
    /// The same text in every row.
    Text(String),
    /// A fact about the order or the row.
    Fact(Fact),
    /// A date.
    Date(Dated, DateFormat),
    /// A figure, or what belongs to it.
    Figure(Which, Of),
}

gaiter_leg::word_enum! {
    /// A fact about an order or a row.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Fact {
        /// The order's reference.
        OrderRef => "order.ref",
        /// `exact` or `changes` for a reorder; empty for an order.
        Reorder => "order.reorder",
        /// The reference of the order that is ordered again.
        LastRef => "last.ref",
        /// The reference of the scan.
        ScanRef => "scan.ref",
        /// The reference of the last order's scan.
        LastScanRef => "last.scan.ref",
        /// The garment.
        Garment => "garment",
        /// The station.
        Station => "station",
        /// How the patient held the legs.
        Posture => "posture",
        /// `skin`: no tension is applied to the girths.
        Basis => "basis",
        /// The patient's id: only a mapping that asks for it writes it.
        PatientId => "patient.id",
        /// The leg of the row.
        Side => "side",
        /// The level of the row.
        Level => "level",
        /// The box of the row.
        Point => "point",
        /// Who set a figure of the row by hand.
        EditedBy => "edited_by",
        /// Why they did.
        Reason => "reason",
    }
}

gaiter_leg::word_enum! {
    /// What a date is of.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Dated {
        /// The scan.
        Scan => "scan.date",
        /// The scan of the order that is ordered again.
        Last => "last.date",
        /// The last day on which the measures hold for an order.
        HoldsUntil => "order.holds_until",
    }
}

gaiter_leg::word_enum! {
    /// Where a point lies.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum BodyPart {
        /// The right leg.
        Right => "right",
        /// The left leg.
        Left => "left",
        /// Neither.
        Body => "body",
    }
}

/// Which figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Which {
    /// That of a point; without a place, of the row's leg.
    At(Option<BodyPart>, Point),
    /// The girth of the row's level.
    Girth,
    /// The length of the row's level.
    Length,
    /// The figure of the row's box.
    Box,
}

/// What of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Of {
    /// The figure itself.
    Figure,
    /// Its uncertainty, rounded up.
    U95,
    /// Why it is not sure, or that a person set it.
    Flag,
    /// `scan`, `tape` or `by-hand`.
    Method,
    /// That of the order that is ordered again.
    Last,
    /// How much larger it is than that.
    Change,
}

/// What of a figure, by its words.
const OFS: [(&str, Of); 5] = [
    ("u95", Of::U95),
    ("flag", Of::Flag),
    ("method", Of::Method),
    ("last", Of::Last),
    ("change", Of::Change),
];

impl Cell {
    /// What a value stands for in a row of this kind.
    pub(super) fn of_value(value: &str, rows: Rows) -> Result<Cell, MappingWhat> {
        let here = |is_here: bool, cell: Cell| match is_here {
            true => Ok(cell),
            false => Err(MappingWhat::NotInRow { value: value.to_owned(), rows: rows.word() }),
        };
        if let Some(fact) = Fact::of_word(value) {
            return here(fact.is_in(rows), Cell::Fact(fact));
        }
        if let Some(dated) = Dated::of_word(value) {
            return Ok(Cell::Date(dated, DateFormat::default()));
        }
        let with_of = value.rsplit_once('.').and_then(|(figure, word)| {
            let (_, of) = OFS.iter().find(|(known, _)| *known == word)?;
            Some((figure, *of))
        });
        let (figure, of) = with_of.unwrap_or((value, Of::Figure));
        match figure {
            "girth" => here(rows == Rows::Level, Cell::Figure(Which::Girth, of)),
            "length" => here(rows == Rows::Level, Cell::Figure(Which::Length, of)),
            "figure" => here(rows == Rows::Point, Cell::Figure(Which::Box, of)),
            figure => Ok(Cell::Figure(at(figure, rows)?, of)),
        }
    }
}

/// The point of a text such as `right.cB`, or `cB` where the row has a leg.
fn at(text: &str, rows: Rows) -> Result<Which, MappingWhat> {
    let no_value = || MappingWhat::NoValue(text.to_owned());
    let (place, name) = match text.split_once('.') {
        Some((place, name)) => (Some(BodyPart::of_word(place).ok_or_else(no_value)?), name),
        None => (None, text),
    };
    let point = Point::named(name).ok_or_else(no_value)?;
    match (place, point) {
        (Some(BodyPart::Body), Point::Beyond(_)) => Ok(Which::At(place, point)),
        (_, Point::Beyond(_)) => Err(MappingWhat::OfTheBody(name.to_owned())),
        (Some(BodyPart::Body), _) => Err(no_value()),
        (None, _) if rows == Rows::Order => Err(MappingWhat::NoLeg(text.to_owned())),
        _ => Ok(Which::At(place, point)),
    }
}

impl Fact {
    /// Whether a row of this kind has it.
    fn is_in(self, rows: Rows) -> bool {
        match self {
            Fact::Side => rows != Rows::Order,
            Fact::Level => rows == Rows::Level,
            Fact::Point => rows == Rows::Point,
            Fact::EditedBy | Fact::Reason => matches!(rows, Rows::Level | Rows::Point),
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gaiter_leg::Level;

    #[test]
    fn a_value_stands_for_a_fact_a_date_or_a_figure() {
        let girth = Point::Girth(Level::B1);
        for (value, rows, cell) in [
            ("order.ref", Rows::Order, Cell::Fact(Fact::OrderRef)),
            (
                "right.cB1",
                Rows::Order,
                Cell::Figure(Which::At(Some(BodyPart::Right), girth), Of::Figure),
            ),
            ("cB1.u95", Rows::Leg, Cell::Figure(Which::At(None, girth), Of::U95)),
            ("length.change", Rows::Level, Cell::Figure(Which::Length, Of::Change)),
            ("figure.flag", Rows::Point, Cell::Figure(Which::Box, Of::Flag)),
            ("last.date", Rows::Leg, Cell::Date(Dated::Last, DateFormat::default())),
        ] {
            assert_eq!(Cell::of_value(value, rows), Ok(cell), "{value}");
        }
    }

    #[test]
    fn what_a_row_does_not_have_is_no_value_of_it() {
        for (value, rows) in [
            ("cB", Rows::Order),
            ("side", Rows::Order),
            ("girth", Rows::Leg),
            ("figure", Rows::Level),
            ("level", Rows::Point),
            ("reason", Rows::Leg),
            ("right.cT", Rows::Order),
            ("body.cB", Rows::Order),
            ("right.cX", Rows::Order),
            ("middle.cB", Rows::Order),
            ("right.cB.sd", Rows::Order),
            ("patient.name", Rows::Order),
            ("patient", Rows::Order),
        ] {
            assert!(Cell::of_value(value, rows).is_err(), "{value}");
        }
    }
}
