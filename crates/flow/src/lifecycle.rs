//! The states of a scan and of a delivery, and the steps between them.
//!
//! ```text
//! scan      spooled ──Finish──▶ delivered         delivery  pending ──Deliver──▶ delivered
//!           │  ▲ ▲                │                         │    ▲ ▲               │
//!           │  │ └────Reopen──────┘                       Refuse │ └─Release─ held Withdraw
//!         Refuse Reopen                                     ▼    │                 ▼
//!           ▼  │                                          refused┘          withdrawing ─Gone─▶ withdrawn
//!          refused                                           Retry
//! ```
//!
//! Finish, Deliver, Refuse and Gone are the station's own steps, and so is Keep, from withdrawing back
//! to delivered; the others need the operator.

use serde::{Deserialize, Serialize};

gaiter_record::word_enum! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum ScanState as serde {
        /// Its bytes are in the spool; at least one delivery is to be made.
        Spooled => "spooled",
        /// Nothing is left to be delivered without operator action.
        Delivered => "delivered",
        /// It cannot be measured, or its record cannot be stored; it is in quarantine.
        Refused => "refused",
    }
}

gaiter_record::word_enum! {
    /// The possible steps of a scan.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum ScanStep {
        /// The last pending delivery was made.
        Finish => "finish",
        /// It was refused for good.
        Refuse => "refuse",
        /// The operator wants a delivery made that was not to be made.
        Reopen => "reopen",
    }
}

gaiter_record::word_enum! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum DeliveryState as serde {
        /// To be made.
        Pending => "pending",
        /// The store has given its receipt.
        Delivered => "delivered",
        /// The operator must decide whose scan this is.
        Held => "held",
        /// It will not be made, because the scan was refused.
        Refused => "refused",
        /// It was made, or may have been, without a patient or for the wrong one; now the right patient has
        /// the record, and this one is to be taken back.
        Withdrawing => "withdrawing",
        /// It was taken back.
        Withdrawn => "withdrawn",
    }
}

gaiter_record::word_enum! {
    /// Why a scan that was refused or held, or is stored without a patient, needs no decision any more.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Closed as serde {
        /// A person gave it up.
        GivenUp => "given-up",
        /// The same patient's next scan was measured.
        Superseded => "superseded",
        /// Nobody decided before its time in quarantine was over; its bytes are gone.
        LetGo => "let-go",
    }
}

/// The code of a delivered record that the operator takes back from its patient.
pub const UNASSIGNED: &str = "unassigned";

/// The code of a delivery that was due when the operator decided otherwise: it may have been made.
pub const SUPERSEDED: &str = "superseded";

/// The code of a record that was to be taken back from a store that gives nothing back.
pub const HANDED_OVER: &str = "result-handed-over";

/// The code of a delivered record of which its store takes no later revision: it still has the earlier one.
pub const REVISION_REFUSED: &str = "revision-refused";

gaiter_record::word_enum! {
    /// The possible steps of a delivery.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum DeliveryStep {
        /// The store gave its receipt.
        Deliver => "deliver",
        /// The scan was refused.
        Refuse => "refuse",
        /// The operator wants it tried again.
        Retry => "retry",
        /// The operator decides that the scan is this patient's.
        Release => "release",
        /// The record of the same scan has reached the patient it belongs to.
        Withdraw => "withdraw",
        /// The store has taken it back.
        Gone => "gone",
        /// The store gives nothing back: the record stays there.
        Keep => "keep",
    }
}

/// A step that the state does not allow; always a bug in gaiter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the state \"{state}\" does not allow the step {step}")]
pub struct IllegalStep {
    /// The state's word.
    pub state: &'static str,
    /// The step's word.
    pub step: &'static str,
}

impl ScanState {
    /// The state after a step.
    ///
    /// # Errors
    /// [`IllegalStep`] if the state does not allow it.
    pub fn after(self, step: ScanStep) -> Result<ScanState, IllegalStep> {
        match (self, step) {
            (ScanState::Spooled, ScanStep::Finish) => Ok(ScanState::Delivered),
            (ScanState::Spooled, ScanStep::Refuse) => Ok(ScanState::Refused),
            (_, ScanStep::Reopen) => Ok(ScanState::Spooled),
            (_, step) => Err(IllegalStep { state: self.word(), step: step.word() }),
        }
    }
}

impl DeliveryState {
    /// The state after a step.
    ///
    /// # Errors
    /// [`IllegalStep`] if the state does not allow it.
    pub fn after(self, step: DeliveryStep) -> Result<DeliveryState, IllegalStep> {
        use DeliveryState::{Delivered, Held, Pending, Refused, Withdrawing, Withdrawn};
        use DeliveryStep::{Deliver, Gone, Keep, Refuse, Release, Retry, Withdraw};
        match (self, step) {
            (Pending, Deliver) => Ok(Delivered),
            (Pending, Refuse) => Ok(Refused),
            (Refused, Retry) | (Held, Release) => Ok(Pending),
            (Delivered, Withdraw) => Ok(Withdrawing),
            (Withdrawing, Keep) => Ok(Delivered),
            (Withdrawing, Gone) => Ok(Withdrawn),
            (_, step) => Err(IllegalStep { state: self.word(), step: step.word() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_leaves_an_end_state_without_a_person() {
        for step in [ScanStep::Finish, ScanStep::Refuse] {
            assert!(ScanState::Delivered.after(step).is_err());
            assert!(ScanState::Refused.after(step).is_err());
        }
        for step in [DeliveryStep::Deliver, DeliveryStep::Refuse, DeliveryStep::Gone] {
            assert!(DeliveryState::Delivered.after(step).is_err());
            assert!(DeliveryState::Refused.after(step).is_err());
            assert!(DeliveryState::Withdrawn.after(step).is_err());
        }
    }

    #[test]
    fn a_record_that_was_taken_back_stays_away() {
        use DeliveryStep::{Deliver, Gone, Keep, Refuse, Release, Retry, Withdraw};
        for step in [Deliver, Refuse, Retry, Release, Withdraw, Gone, Keep] {
            assert!(DeliveryState::Withdrawn.after(step).is_err());
        }
    }

    #[test]
    fn a_held_delivery_is_never_made_without_a_person() {
        let illegal = IllegalStep { state: "held", step: "deliver" };
        assert_eq!(DeliveryState::Held.after(DeliveryStep::Deliver), Err(illegal));
    }
}
