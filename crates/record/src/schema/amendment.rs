//! Measures that a person set, as the record holds them. [`crate::measure::amendment`] defines what they
//! mean.

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

/// One measure of one leg that a person set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Amendment {
    /// `left` or `right`.
    pub leg: String,
    /// A level, `foot-length`, `foot-breadth` or `inside-leg`.
    pub measure: String,
    /// What the person did.
    pub is: Deed,
    /// The girth by tape; null if it was not set.
    pub girth_mm: Option<f64>,
    /// The vertical height above the floor; null if it was not set.
    pub height_mm: Option<f64>,
    /// Length or breadth of a foot, or of the inside of the leg; null if it was not set.
    pub length_mm: Option<f64>,
    /// Why, in the person's words.
    pub reason: String,
    /// The person's name.
    pub by: String,
    /// When.
    pub at: Timestamp,
}

/// What a person did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Deed {
    /// They measured it.
    Measured,
    /// They noted that it cannot be measured on this patient.
    NotMeasurable,
    /// They took back what was set before: the scan's value counts again.
    TakenBack,
}
