//! The outcomes for an export, a name, a press, the passing of time, and giving up.

use gaiter_record::ImagingRequest;
use serde::{Deserialize, Serialize};

use super::capture::{Capture, Named, Why, distinct};

/// Which capture an export belongs to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CaptureMatch {
    /// None: the button was not pressed.
    Unpressed,
    /// None: the scan is known.
    Known,
    Of(Capture),
    /// The operator must decide.
    Held {
        why: Why,
        /// The one patient whom every capture in question names, if there is one.
        patient: Option<Named>,
        /// Every patient whom a capture in question names.
        candidates: Vec<Named>,
        /// The capture that it answers, if any.
        answered: Option<i64>,
        /// Rounds whose exports are in doubt from now on.
        doubtful: Vec<i64>,
    },
}

impl CaptureMatch {
    /// The result for an export whose own name is another patient's: of its capture it is not known whether
    /// this was its export.
    pub fn contradicted(self) -> CaptureMatch {
        let CaptureMatch::Of(capture) = self else { return self };
        CaptureMatch::Held {
            why: Why::Ambiguous,
            patient: None,
            candidates: capture.named().cloned().collect(),
            answered: Some(capture.number),
            doubtful: Vec::new(),
        }
    }

    /// The request that was chosen with this patient, if a capture in question names them with one.
    pub fn request_of(&self, id: &str) -> Option<&ImagingRequest> {
        let named: Vec<&Named> = match self {
            CaptureMatch::Of(capture) => capture.named().collect(),
            CaptureMatch::Held { candidates, .. } => candidates.iter().collect(),
            CaptureMatch::Unpressed | CaptureMatch::Known => Vec::new(),
        };
        named.into_iter().find(|named| named.id == id)?.request.as_ref()
    }

    /// The same result with these candidates besides.
    pub(super) fn or_of(mut self, others: Vec<Named>) -> CaptureMatch {
        if let CaptureMatch::Held { patient, candidates, .. } = &mut self {
            *patient = None;
            candidates.extend(others);
        }
        self
    }

    /// The result for an export that begins with an earlier scan of these patients, or of nobody: it is
    /// that scan, complete, and no other patient's.
    pub(super) fn completing(self, whose: &[Named]) -> CaptureMatch {
        let (why, candidates, doubtful) = match self {
            CaptureMatch::Of(capture) if capture.is_of_all(whose) => {
                return CaptureMatch::Of(capture);
            }
            CaptureMatch::Of(capture) => {
                (Why::Ambiguous, capture.named().cloned().collect::<Vec<_>>(), vec![capture.number])
            }
            // Only its own name can identify the patient.
            CaptureMatch::Unpressed | CaptureMatch::Known => return self,
            CaptureMatch::Held { why, candidates, answered, doubtful, .. } => {
                (why, candidates, doubtful.into_iter().chain(answered).collect())
            }
        };
        let candidates = distinct(candidates.iter().chain(whose));
        // The captures still wait for exports of their own.
        CaptureMatch::Held { why, patient: None, candidates, answered: None, doubtful }
    }
}

/// The outcome of naming the next patient.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NamedNext {
    /// The name waits for the next press.
    Waits {
        /// It replaced another waiting id.
        replaced: bool,
        /// It is not certain which patient the next press is for.
        in_doubt: bool,
    },
    /// The open press is this patient's.
    Paired(Capture),
    /// A capture was opened for it; these captures of patients named earlier were given up.
    Opened(Capture, Vec<i64>),
    /// The open capture is already this patient's; its window was prolonged.
    Prolonged(Capture),
}

/// The effects of the passing of time.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Passed {
    /// Rounds whose windows ended without an export.
    pub expired: Vec<i64>,
    /// A patient's name was not used in time.
    pub name_expired: bool,
    /// Rounds whose exports are no longer expected.
    pub over: Vec<i64>,
}

/// What was given up.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CalledOff {
    /// Rounds whose exports are no longer expected.
    pub captures: Vec<i64>,
    /// A name was waiting.
    pub name: bool,
}
