//! Texts from people in an order: its reference, and who changed what and why.

use super::Order;
use crate::{Record, sha256};

/// The longest reference, characters: as long as forms have room for.
pub const REF_MAX: usize = 60;

/// The digits of the hash by which another patient is noticed: one of 65536 others is not, and the id of
/// one of ten thousand cannot be found from it.
const CHECK_DIGITS: usize = 4;

/// The reference by which shop and maker know an order: text in a line that does not hold the patient's id.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OrderRef(String);

/// Why a text is no reference of an order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RefFault {
    /// It is empty, too long, or holds control characters.
    #[error("must be a text of 1 to {REF_MAX} characters in a line")]
    NotALine,
    /// It holds the patient's id.
    #[error("holds the patient's id, and an order names no patient: write another reference")]
    HoldsId,
}

impl OrderRef {
    /// The reference of an order of this record.
    ///
    /// # Errors
    /// See [`RefFault`].
    pub fn new(text: &str, record: &Record) -> Result<OrderRef, RefFault> {
        let text = text.trim();
        if !is_line(text, REF_MAX) || text.is_empty() {
            return Err(RefFault::NotALine);
        }
        match holds_id(text, record) {
            true => Err(RefFault::HoldsId),
            false => Ok(OrderRef(text.to_owned())),
        }
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Whether a text can stand in a line: no control characters and no marks that change the direction of writing.
pub(super) fn is_line(text: &str, most: usize) -> bool {
    let turns = |letter: char| matches!(letter, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    text.chars().count() <= most && !text.chars().any(|of| of.is_control() || turns(of))
}

/// A text of a person for an order; `None` if it holds the patient's id.
pub(super) fn without_id(text: &str, record: &Record) -> Option<String> {
    (!holds_id(text, record)).then(|| text.to_owned())
}

/// Whether a text contains the patient's id as a word of its own.
fn holds_id(text: &str, record: &Record) -> bool {
    let Some(patient) = &record.patient else { return false };
    let (text, id) = (text.to_lowercase(), patient.id.to_lowercase());
    let is_part = |letter: Option<char>| letter.is_some_and(char::is_alphanumeric);
    !id.is_empty()
        && text.match_indices(&id).any(|(at, found)| {
            let behind = text[at + found.len()..].chars().next();
            !is_part(text[..at].chars().next_back()) && !is_part(behind)
        })
}

/// By which a further order notices another patient.
pub(super) fn patient_check(scan_sha256: &str, patient: &str) -> String {
    let mut digits = sha256(format!("{}\0{scan_sha256}\0{patient}", super::SCHEMA).as_bytes());
    digits.truncate(CHECK_DIGITS);
    digits
}

impl Order {
    /// Whether it can be of the patient of a record; `None` if one of the two names no patient.
    pub(super) fn can_be_of(&self, record: &Record) -> Option<bool> {
        let patient = record.patient.as_ref()?;
        let expected = patient_check(&self.scan.sha256, &patient.id);
        self.patient_check.as_ref().map(|check| *check == expected)
    }
}
