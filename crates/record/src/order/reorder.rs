//! An order that repeats another: with its figures, or with those of another scan beside them.

use gaiter_sizes::Garment;

use super::compose::{open, ordered_garment};
use super::text::OrderRef;
use super::{Again, LastFigure, LastRow, Order, OrderFigure, Reorder, Row, State};
use crate::{Record, rounding};

/// What makes girths and heights of two scans different things, as keys of `made_by.method`.
const OF_THE_METHOD: [&str; 7] =
    ["scope", "tape", "axis", "fit", "b1", "b1_above_b", "g_below_crotch"];

/// Why an order does not repeat another.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ReorderFault {
    /// It belongs to another patient.
    #[error("the last order is of another patient than the record: nothing was ordered")]
    OtherPatient,
    /// Nothing shows that both belong to one patient.
    #[error(
        "nothing shows that the last order is of the record's patient, because one of the two names \
         none: order anew, without --reorder"
    )]
    NoPatient,
    /// It is for another garment.
    #[error(
        "the last order is of the garment {last}, this one of {now}: order anew, without --reorder"
    )]
    OtherGarment {
        /// The last order's.
        last: String,
        /// This one's.
        now: String,
    },
    /// The form of the garment has changed.
    #[error(
        "the form of {0} has other boxes or roundings than at the last order: order anew, without --reorder"
    )]
    OtherForm(String),
}

impl Order {
    /// The last order again, with its figures. The record is only asked whether it belongs to the same
    /// patient.
    ///
    /// # Errors
    /// See [`ReorderFault`].
    pub fn exact(
        last: &Order,
        record: &Record,
        garment: &Garment,
        order_ref: Option<&OrderRef>,
    ) -> Result<Order, ReorderFault> {
        is_of_the_same(last, record, garment)?;
        let rows = last.rows.iter().map(|row| Row { last: None, ..row.clone() });
        Ok(Order {
            gaiter: env!("CARGO_PKG_VERSION").to_owned(),
            order_ref: order_ref.map(|of| of.as_str().to_owned()),
            reorder: Some(repeated(last, Again::Exact, Vec::new())),
            rows: rows.collect(),
            ..last.clone()
        })
    }

    /// An order of the record with the figures of the last order, and the differences from them, beside its own.
    /// It states what is larger or smaller, and never what is better.
    ///
    /// # Errors
    /// See [`ReorderFault`].
    pub fn with_changes(
        last: &Order,
        record: &Record,
        garment: &Garment,
        order_ref: Option<&OrderRef>,
        scanner_girth_mm: f64,
    ) -> Result<Order, ReorderFault> {
        is_of_the_same(last, record, garment)?;
        let mut order = Order::from_record(record, garment, order_ref, scanner_girth_mm);
        let otherwise = taken_otherwise(last, &order);
        let has_changes = otherwise.is_empty();
        for row in order.rows.iter_mut().filter(|row| row.counts) {
            let of_last = last.counting(row.side, &row.point);
            row.last = of_last.map(|of_last| last_row(row, of_last, has_changes));
        }
        order.rows.extend(gone(last, &order));
        order.open = open(garment, &order.rows);
        order.reorder = Some(repeated(last, Again::Changes, otherwise));
        Ok(order)
    }
}

/// Checks that an order can be repeated for a record and a garment.
fn is_of_the_same(last: &Order, record: &Record, garment: &Garment) -> Result<(), ReorderFault> {
    match last.can_be_of(record) {
        Some(true) => {}
        Some(false) => return Err(ReorderFault::OtherPatient),
        None if last.scan.sha256 == record.scan.sha256 => {}
        None => return Err(ReorderFault::NoPatient),
    }
    let now = ordered_garment(garment);
    match last.garment == now {
        true => Ok(()),
        false if last.garment.name == now.name => Err(ReorderFault::OtherForm(now.name)),
        false => {
            let last = last.garment.name.clone();
            Err(ReorderFault::OtherGarment { last, now: now.name })
        }
    }
}

fn repeated(last: &Order, is: Again, taken_otherwise: Vec<String>) -> Reorder {
    Reorder { is, last_ref: last.order_ref.clone(), last_scan: last.scan.clone(), taken_otherwise }
}

/// What two scans were taken or measured with differently.
fn taken_otherwise(last: &Order, now: &Order) -> Vec<String> {
    let setting = |order: &Order, key: &str| order.made_by.method.get(key).cloned();
    let method = OF_THE_METHOD.into_iter().filter(|key| setting(last, key) != setting(now, key));
    let schema = (last.record.schema != now.record.schema).then_some("schema");
    let posture = (last.posture != now.posture).then_some("posture");
    schema.into_iter().chain(posture).chain(method).map(str::to_owned).collect()
}

fn last_row(now: &Row, last: &Row, has_changes: bool) -> LastRow {
    LastRow {
        girth: last_figure(now.girth.as_ref(), last.girth.as_ref(), has_changes),
        length: last_figure(now.length.as_ref(), last.length.as_ref(), has_changes),
    }
}

/// A figure of the last order beside that of this one.
fn last_figure(
    now: Option<&OrderFigure>,
    last: Option<&OrderFigure>,
    has_changes: bool,
) -> Option<LastFigure> {
    let last = last?;
    let last_mm = last.mm?;
    let now = now.filter(|now| has_changes && now.is.is_sure() && last.is.is_sure());
    let change_mm = now.and_then(|now| now.mm).map(|mm| rounding::mm(mm - last_mm));
    let u95s_mm = now.and_then(|now| now.u95_mm).zip(last.u95_mm);
    Some(LastFigure {
        is: last.is,
        mm: last_mm,
        u95_mm: last.u95_mm,
        change_mm,
        // The errors of two scans are taken as independent.
        change_u95_mm: change_mm
            .and(u95s_mm)
            .map(|(now_mm, of_mm)| rounding::mm(now_mm.hypot(of_mm))),
    })
}

/// The rows of the last order on a side that this one does not have: their boxes are open now.
fn gone(last: &Order, now: &Order) -> Vec<Row> {
    let sides = now.sides();
    let rows = last.rows.iter().filter(|row| row.counts && !sides.contains(&row.side));
    let figure = |of: &OrderFigure| OrderFigure {
        form_box: of.form_box.clone(),
        is: State::NotMeasured,
        mm: None,
        u95_mm: None,
        method: None,
        doubts: Vec::new(),
        printed_cm: None,
    };
    let row = |row: &Row| Row {
        girth: row.girth.as_ref().map(figure),
        length: row.length.as_ref().map(figure),
        edited_by: None,
        edited_at: None,
        reason: None,
        last: Some(last_row(row, row, false)),
        ..row.clone()
    };
    rows.map(row).collect()
}
