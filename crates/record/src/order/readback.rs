//! The `order.json` of an earlier order, read back. The file may have been changed since it was written, so its
//! figures must be possible for a leg before they are ordered again.

use serde_json::Value;

use super::text::is_line;
use super::{Order, OrderFigure, Row, SCHEMA, State};

/// The longest file that is read, bytes: an order of tights with a reason at every point has less.
pub const BYTES_MAX: usize = 1024 * 1024;

/// Girths, lengths and uncertainties that an order can have, mm.
const FIGURES_MM: [f64; 2] = [0.0, 3000.0];

/// The most rows: every point of both legs, twice, is fewer.
const ROWS_MAX: usize = 400;

/// The longest text, characters.
const TEXT_MAX: usize = 500;

/// Why a file is no order that can be ordered again.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LastFault {
    /// It is longer than any order.
    #[error("it has {found} bytes; an order has at most {BYTES_MAX}: name an order.json")]
    TooLong {
        /// Its length, bytes.
        found: usize,
    },
    /// It is not JSON.
    #[error("it is no JSON: {0}: name an order.json")]
    NotJson(String),
    /// It has another format.
    #[error("its schema is {found}, not \"{SCHEMA}\": name an order.json of this version")]
    Format {
        /// As written.
        found: String,
    },
    /// A part of an order is missing, or has another kind.
    #[error("it is no whole order: {0}")]
    Shape(String),
    /// A figure that no leg has.
    #[error("{place}: {found} is not within {} to {} mm", FIGURES_MM[0], FIGURES_MM[1])]
    Range {
        /// Side and box.
        place: String,
        /// The figure, mm.
        found: f64,
    },
    /// A figure that does not match its description.
    #[error("{place}: it is said to be {said}, which does not match its figure")]
    Mismatch {
        /// Side and box.
        place: String,
        /// The description.
        said: &'static str,
    },
    /// A text that cannot stand in a line.
    #[error("{place}: must be a text of at most {TEXT_MAX} characters in a line")]
    Text {
        /// Which text.
        place: &'static str,
    },
    /// A point that counts twice.
    #[error("the {side} point {point} counts twice")]
    Twice {
        /// Its side.
        side: &'static str,
        /// The point.
        point: String,
    },
    /// More rows than points.
    #[error("it has {found} rows; an order has at most {ROWS_MAX}")]
    Rows {
        /// Their number.
        found: usize,
    },
}

/// Reads an order.
///
/// # Errors
/// The first [`LastFault`].
pub fn read(bytes: &[u8]) -> Result<Order, LastFault> {
    if bytes.len() > BYTES_MAX {
        return Err(LastFault::TooLong { found: bytes.len() });
    }
    let json: Value =
        serde_json::from_slice(bytes).map_err(|error| LastFault::NotJson(error.to_string()))?;
    match json.get("schema") {
        Some(Value::String(schema)) if schema == SCHEMA => {}
        found => {
            let found = found.map_or("missing".to_owned(), short);
            return Err(LastFault::Format { found });
        }
    }
    let order: Order = serde_json::from_value(json).map_err(|error| {
        LastFault::Shape(error.to_string().chars().flat_map(char::escape_default).collect())
    })?;
    checked(&order).map(|()| order)
}

/// A value in a line, cut where it is long.
fn short(value: &Value) -> String {
    value.to_string().chars().take(60).flat_map(char::escape_default).collect()
}

fn checked(order: &Order) -> Result<(), LastFault> {
    if order.rows.len() > ROWS_MAX {
        return Err(LastFault::Rows { found: order.rows.len() });
    }
    let garment = &order.garment;
    let boxes = garment.boxes.iter().map(|name| ("garment.boxes", Some(name)));
    let texts = [
        ("order_ref", order.order_ref.as_ref()),
        ("garment.name", Some(&garment.name)),
        ("scan.reference", Some(&order.scan.reference)),
        ("record.station", order.record.station.as_ref()),
        ("posture", order.posture.as_ref()),
        ("basis", Some(&order.basis)),
    ];
    texts.into_iter().chain(boxes).try_for_each(|(place, text)| in_a_line(place, text))?;
    for (index, row) in order.rows.iter().enumerate() {
        row_checked(row)?;
        let is_same =
            |other: &&Row| other.counts && other.side == row.side && other.point == row.point;
        if row.counts && order.rows[..index].iter().any(|other| is_same(&other)) {
            let (side, point) = (row.side.word(), row.point.escape_default().to_string());
            return Err(LastFault::Twice { side, point });
        }
    }
    Ok(())
}

fn in_a_line(place: &'static str, text: Option<&String>) -> Result<(), LastFault> {
    match text.is_none_or(|text| is_line(text, TEXT_MAX)) {
        true => Ok(()),
        false => Err(LastFault::Text { place }),
    }
}

fn row_checked(row: &Row) -> Result<(), LastFault> {
    let texts = [
        ("rows.point", Some(&row.point)),
        ("rows.length_from", row.length_from.as_ref()),
        ("rows.edited_by", row.edited_by.as_ref()),
        ("rows.reason", row.reason.as_ref()),
    ];
    texts.into_iter().try_for_each(|(place, text)| in_a_line(place, text))?;
    row.figures().try_for_each(|figure| figure_checked(row, figure))
}

fn figure_checked(row: &Row, figure: &OrderFigure) -> Result<(), LastFault> {
    in_a_line("rows.form_box", Some(&figure.form_box))?;
    figure.doubts.iter().try_for_each(|doubt| in_a_line("rows.doubts", Some(doubt)))?;
    let place = || format!("{} {}", row.side.word(), figure.form_box);
    let printed_mm = figure.printed_cm.map(|cm| 10.0 * cm);
    let [low_mm, high_mm] = FIGURES_MM;
    let mut figures = [figure.mm, figure.u95_mm, printed_mm].into_iter().flatten();
    if let Some(found) = figures.find(|mm| !(low_mm..=high_mm).contains(mm)) {
        return Err(LastFault::Range { place: place(), found });
    }
    let needs_one = figure.is.is_sure();
    let may_have_one = needs_one || matches!(figure.is, State::Estimated | State::Doubtful);
    let is_printed_unsure = figure.printed_cm.is_some() && !needs_one;
    match figure.mm {
        None if needs_one => {}
        Some(_) if !may_have_one => {}
        _ if is_printed_unsure => {}
        _ => return Ok(()),
    }
    Err(LastFault::Mismatch { place: place(), said: figure.is.word() })
}
