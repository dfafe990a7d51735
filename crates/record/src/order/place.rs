//! Where a point of a form is in the rows of an order.

use gaiter_sizes::{Beyond, Point};

use super::{Order, OrderFigure, OrderSide, Row};

/// Whether a figure is the girth or the length of its row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Girth,
    Length,
}

/// The point of the row that contains a point of a form, and its part of the row.
pub(super) fn place(point: Point) -> (String, Part) {
    match point {
        Point::Girth(level) => (level.name().to_owned(), Part::Girth),
        Point::Length(level) => (level.name().to_owned(), Part::Length),
        Point::Between(low, high) => (format!("{}{}", low.name(), high.name()), Part::Length),
        Point::Foot => ("foot".to_owned(), Part::Length),
        Point::InsideLeg => ("K".to_owned(), Part::Length),
        Point::Beyond(Beyond::HipGirth) => ("H".to_owned(), Part::Girth),
        Point::Beyond(Beyond::HipLength) => ("H".to_owned(), Part::Length),
        Point::Beyond(Beyond::WaistGirth) => ("T".to_owned(), Part::Girth),
        Point::Beyond(Beyond::WaistLength) => ("T".to_owned(), Part::Length),
    }
}

/// Where the length of a point begins; `None` for a girth.
pub(super) fn length_from(point: Point) -> Option<&'static str> {
    match (place(point).1, point) {
        (Part::Girth, _) => None,
        (Part::Length, Point::Foot) => Some("heel"),
        (Part::Length, Point::Between(low, _)) => Some(low.name()),
        (Part::Length, _) => Some("floor"),
    }
}

impl Row {
    /// The girth or the length.
    pub(super) fn part(&self, part: Part) -> Option<&OrderFigure> {
        match part {
            Part::Girth => self.girth.as_ref(),
            Part::Length => self.length.as_ref(),
        }
    }

    /// Girth and length, as far as the form has boxes for them.
    pub(super) fn figures(&self) -> impl Iterator<Item = &OrderFigure> {
        [&self.girth, &self.length].into_iter().flatten()
    }
}

impl Order {
    /// The row of a point that counts.
    pub(super) fn counting(&self, side: OrderSide, point: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.counts && row.side == side && row.point == point)
    }

    /// The sides that have rows, in their order.
    pub(super) fn sides(&self) -> Vec<OrderSide> {
        let mut sides: Vec<OrderSide> = self.rows.iter().map(|row| row.side).collect();
        sides.dedup();
        sides
    }
}
