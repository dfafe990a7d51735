//! An order: what a record gives for the form of a garment, as data for a maker or a shop system.
//!
//! An order has no patient, and states for every figure whether it is sure. What the scan measured stays
//! readable where a person set another value: it has a row of its own, before the one that counts.

mod choice;
mod compose;
mod csv;
mod mapped;
mod place;
mod readback;
mod reading;
mod reorder;
mod text;

use jiff::Timestamp;
use jiff::civil::Date;
use serde::{Deserialize, Serialize};

use super::provenance::Acquired;
use super::schema::MadeBy;
pub use choice::{OrderFile, is_order_file, order_files};
pub use csv::{csv, spreadsheet};
pub use mapped::{mapped, mapped_name};
pub use readback::{BYTES_MAX, LastFault, read};
pub use reorder::ReorderFault;
pub use text::{OrderRef, RefFault};

/// Name and number of the schema of an order as JSON, and the first cell of each of its rows as CSV.
pub const SCHEMA: &str = "gaiter.order/1";

/// The girths of an order are of skin: no tension is applied to them.
const BASIS: &str = "skin";

/// What an order needs besides measures. No scan gives it, so it is always open.
const NOT_OF_A_SCAN: [&str; 7] = ["class", "knit", "product", "colour", "toe", "band", "quantity"];

/// The code of an order whose scan was too old for one, or taken on a day that is not known.
const SCAN_AGE: &str = "scan-age";

/// An order, or a further one of the same garment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Order {
    /// The name and number of this schema.
    #[cfg_attr(test, schemars(extend("const" = SCHEMA)))]
    pub schema: String,
    /// gaiter's version that wrote the order.
    pub gaiter: String,
    /// The reference by which shop and maker know the order; null if none was given.
    pub order_ref: Option<String>,
    /// Which order it repeats; null for an order that repeats none.
    pub reorder: Option<Reorder>,
    /// What is ordered, and its form.
    pub garment: OrderedGarment,
    /// The scan that was measured.
    pub scan: OrderedScan,
    /// The last day on which its measures hold for an order, by the station's greatest age of a scan; null if the
    /// day of the scan is not known.
    pub holds_until: Option<Date>,
    /// The record that was read.
    pub record: OrderedRecord,
    /// Program and method that measured the scan.
    pub made_by: MadeBy,
    /// Always `skin`: no tension is applied to the girths.
    #[cfg_attr(test, schemars(extend("const" = BASIS)))]
    pub basis: String,
    /// How the patient held the legs: `both-legs`, `one-leg`, `sitting` or `lying`; null if the record does not
    /// state it.
    pub posture: Option<String>,
    /// Whether the weight was on both legs, and so not on the measured one alone; null if it is not known.
    pub weight_on_both_legs: Option<bool>,
    /// The units of the figures.
    pub units: Units,
    /// A standard error common to all girths of the scanner, mm; 0 if none is known.
    pub scanner_girth_mm: f64,
    /// What to do before the order: `complete`, `not-measurable`, `by-hand` or `scan-again`.
    pub state: String,
    /// What a person must make sure of, as codes; empty if nothing is. `scan-age`: on the day of the order the scan
    /// was too old for one, or its day is not known.
    pub to_check: Vec<String>,
    /// By which a further order notices another patient: four digits of a hash of the scan and the patient's
    /// id, too few to find the id. Null if no patient is known.
    pub patient_check: Option<String>,
    /// One row per side and point, in the order of the form, and a further one for what a person set.
    pub rows: Vec<Row>,
    /// The boxes of the form that are not filled, each with the reason.
    pub open: Vec<OpenBox>,
    /// What the order needs and no scan gives.
    pub not_of_a_scan: Vec<String>,
}

/// The garment and its form.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct OrderedGarment {
    /// Its name on order forms.
    pub name: String,
    /// The boxes of its form, in the form's order.
    pub boxes: Vec<String>,
    /// Girths are rounded to a multiple of this for print.
    pub round_girths_mm: f64,
    /// Lengths are rounded to a multiple of this for print.
    pub round_lengths_mm: f64,
}

/// The scan of an order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct OrderedScan {
    /// SHA-256 of its bytes, lower-case hexadecimal.
    #[cfg_attr(test, schemars(regex(pattern = r"^[0-9a-f]{64}$")))]
    pub sha256: String,
    /// Its short reference: the first digits of the hash, and the revision of the record from 2 on.
    pub reference: String,
    /// When it was taken; null if unknown.
    pub acquired: Option<Acquired>,
    /// The time of day by the clock at the scanner, `HH:MM`; null if that clock is not known.
    pub time_of_day: Option<String>,
}

/// The record of an order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct OrderedRecord {
    /// Its schema.
    pub schema: String,
    /// Its revision.
    pub revision: u32,
    /// The station that made it; null for a bare `extract`.
    pub station: Option<String>,
}

/// The units of an order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Units {
    /// Of girths, lengths and their uncertainties.
    #[cfg_attr(test, schemars(extend("const" = "mm")))]
    pub figures: String,
    /// Of figures rounded for print.
    #[cfg_attr(test, schemars(extend("const" = "cm")))]
    pub printed: String,
}

impl Default for Units {
    fn default() -> Units {
        Units { figures: "mm".to_owned(), printed: "cm".to_owned() }
    }
}

/// A point of a leg.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Row {
    /// The patient's `left` or `right`; `body` for a point of neither.
    pub side: OrderSide,
    /// A level, `BD` for a length between two, `foot`, `K` for the inside of the leg, `H` or `T`.
    pub point: String,
    /// Whether its figures count for the order. Those of a scan do not where a person set others.
    pub counts: bool,
    /// The girth; null if the form has no box for it.
    pub girth: Option<OrderFigure>,
    /// The length; null if the form has no box for it.
    pub length: Option<OrderFigure>,
    /// Where the length begins: `floor`, `heel`, or a level; null without a length.
    pub length_from: Option<String>,
    /// Who set a figure by hand; null if none did, or if the text holds the patient's id.
    pub edited_by: Option<String>,
    /// When they did.
    pub edited_at: Option<Timestamp>,
    /// Why they did; null if nobody did, or if the text holds the patient's id.
    pub reason: Option<String>,
    /// The figures of the order that is ordered again; null in every other order.
    pub last: Option<LastRow>,
}

gaiter_leg::word_enum! {
    /// Where a point lies.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
    #[cfg_attr(test, derive(schemars::JsonSchema))]
    pub enum OrderSide as serde {
        /// On the right leg.
        Right => "right",
        /// On the left leg.
        Left => "left",
        /// On neither.
        Body => "body",
    }
}

/// A girth or a length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema), schemars(rename = "Figure"))]
pub struct OrderFigure {
    /// The name of its box on the form.
    pub form_box: String,
    /// How sure it is.
    pub is: State,
    /// The figure, not rounded; null if there is none.
    pub mm: Option<f64>,
    /// About 95 % of repeated scans lie within this of the figure, mm; null if it is unknown.
    pub u95_mm: Option<f64>,
    /// How it was taken; null if there is none.
    pub method: Option<Way>,
    /// Codes of the doubts about it.
    pub doubts: Vec<String>,
    /// The figure rounded for the form; null if it is not sure or does not count.
    pub printed_cm: Option<f64>,
}

gaiter_leg::word_enum! {
    /// How sure a figure is.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[cfg_attr(test, derive(schemars::JsonSchema))]
    pub enum State as serde {
        /// The scan shows it without a doubt that matters.
        Measured => "measured",
        /// A person set it.
        ByHand => "by-hand",
        /// It is estimated by a proportion of the body.
        Estimated => "estimated",
        /// There is a doubt about it.
        Doubtful => "doubtful",
        /// The scan does not show it, and nobody measured it.
        NotMeasured => "not-measured",
        /// A person noted that it cannot be measured.
        NotMeasurable => "not-measurable",
        /// No scan of the legs gives it.
        NotByScan => "not-by-scan",
    }
}

impl State {
    /// Whether the figure may be used without another look.
    pub fn is_sure(self) -> bool {
        matches!(self, State::Measured | State::ByHand)
    }
}

gaiter_leg::word_enum! {
    /// How a figure was taken.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[cfg_attr(test, derive(schemars::JsonSchema))]
    pub enum Way as serde {
        /// By the scanner.
        Scan => "scan",
        /// By a person with a tape: a girth.
        Tape => "tape",
        /// By a person: a height or a length.
        ByHand => "by-hand",
    }
}

/// A box of the form that is not filled.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct OpenBox {
    /// Where its point lies.
    pub side: OrderSide,
    /// Its name on the form.
    pub form_box: String,
    /// Why it is not filled.
    pub why: State,
    /// Whether it may stay empty.
    pub is_optional: bool,
}

/// That an order repeats another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Reorder {
    /// How.
    pub is: Again,
    /// The reference of the other order; null if it had none.
    pub last_ref: Option<String>,
    /// The scan of the other order.
    pub last_scan: OrderedScan,
    /// What the two scans were taken or measured with differently, as keys of `made_by.method` or `schema`;
    /// differences of figures are then not reported.
    pub taken_otherwise: Vec<String>,
}

gaiter_leg::word_enum! {
    /// How an order repeats another.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[cfg_attr(test, derive(schemars::JsonSchema))]
    pub enum Again as serde {
        /// With its figures.
        Exact => "exact",
        /// With the figures of another scan.
        Changes => "changes",
    }
}

/// The figures of the order that is ordered again.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LastRow {
    /// The girth; null if that order had none.
    pub girth: Option<LastFigure>,
    /// The length; null if that order had none.
    pub length: Option<LastFigure>,
}

/// A figure of the order that is ordered again, and the difference from it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LastFigure {
    /// How sure it was.
    pub is: State,
    /// The figure, mm.
    pub mm: f64,
    /// Its uncertainty, mm; null if it was unknown.
    pub u95_mm: Option<f64>,
    /// The figure of this order minus that one, mm; null if one of them is not sure, or if they were taken
    /// differently.
    pub change_mm: Option<f64>,
    /// The uncertainty of the difference, mm; null without one, or if that of a figure is unknown.
    pub change_u95_mm: Option<f64>,
}

/// The JSON Schema (draft 2020-12) of an order as this version writes it.
pub const JSON_SCHEMA: &str = include_str!("../schemas/order.schema.json");
