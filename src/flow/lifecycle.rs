//! The states of a scan and of a delivery, and the steps between them.
//!
//! ```text
//! scan       spooled ──Finish──▶ delivered          delivery   pending ──Deliver──▶ delivered
//!               └──────Refuse──▶ refused                          └─────Refuse────▶ refused
//!                                                              held      (waits for a person)
//! ```

/// Where a scan is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScanState {
    /// Its bytes are in the spool; at least one delivery is to be made.
    Spooled,
    /// Nothing is left to be delivered without a person.
    Delivered,
    /// It cannot be measured, or its record cannot be stored; it lies in quarantine.
    Refused,
}

/// What may happen to a scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScanStep {
    /// The last pending delivery was made.
    Finish,
    /// It was refused for good.
    Refuse,
}

/// Where a delivery is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeliveryState {
    /// To be made.
    Pending,
    /// The store has given its receipt.
    Delivered,
    /// A person must say whose scan this is.
    Held,
    /// It will not be made: the scan was refused.
    Refused,
}

/// What may happen to a delivery.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeliveryStep {
    /// The store gave its receipt.
    Deliver,
    /// The scan was refused.
    Refuse,
}

/// A step that the state does not allow; always a fault of ours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the state \"{state}\" does not allow the step {step}")]
pub struct IllegalStep {
    /// The state's word.
    pub state: &'static str,
    /// The step's word.
    pub step: &'static str,
}

impl ScanState {
    /// All states.
    pub const ALL: [ScanState; 3] = [ScanState::Spooled, ScanState::Delivered, ScanState::Refused];

    /// The word in the journal.
    pub fn word(self) -> &'static str {
        match self {
            ScanState::Spooled => "spooled",
            ScanState::Delivered => "delivered",
            ScanState::Refused => "refused",
        }
    }

    /// The state of a word in the journal.
    pub fn of_word(word: &str) -> Option<ScanState> {
        ScanState::ALL.into_iter().find(|state| state.word() == word)
    }

    /// The state after a step.
    ///
    /// # Errors
    /// [`IllegalStep`] where the state does not allow it.
    pub fn after(self, step: ScanStep) -> Result<ScanState, IllegalStep> {
        match (self, step) {
            (ScanState::Spooled, ScanStep::Finish) => Ok(ScanState::Delivered),
            (ScanState::Spooled, ScanStep::Refuse) => Ok(ScanState::Refused),
            (ScanState::Delivered | ScanState::Refused, ScanStep::Finish) => {
                Err(IllegalStep { state: self.word(), step: "finish" })
            }
            (ScanState::Delivered | ScanState::Refused, ScanStep::Refuse) => {
                Err(IllegalStep { state: self.word(), step: "refuse" })
            }
        }
    }
}

impl DeliveryState {
    /// All states.
    pub const ALL: [DeliveryState; 4] = [
        DeliveryState::Pending,
        DeliveryState::Delivered,
        DeliveryState::Held,
        DeliveryState::Refused,
    ];

    /// The word in the journal.
    pub fn word(self) -> &'static str {
        match self {
            DeliveryState::Pending => "pending",
            DeliveryState::Delivered => "delivered",
            DeliveryState::Held => "held",
            DeliveryState::Refused => "refused",
        }
    }

    /// The state of a word in the journal.
    pub fn of_word(word: &str) -> Option<DeliveryState> {
        DeliveryState::ALL.into_iter().find(|state| state.word() == word)
    }

    /// The state after a step.
    ///
    /// # Errors
    /// [`IllegalStep`] where the state does not allow it.
    pub fn after(self, step: DeliveryStep) -> Result<DeliveryState, IllegalStep> {
        match (self, step) {
            (DeliveryState::Pending, DeliveryStep::Deliver) => Ok(DeliveryState::Delivered),
            (DeliveryState::Pending, DeliveryStep::Refuse) => Ok(DeliveryState::Refused),
            (_, DeliveryStep::Deliver) => Err(IllegalStep { state: self.word(), step: "deliver" }),
            (_, DeliveryStep::Refuse) => Err(IllegalStep { state: self.word(), step: "refuse" }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_leaves_an_end_state() {
        for step in [ScanStep::Finish, ScanStep::Refuse] {
            assert!(ScanState::Delivered.after(step).is_err());
            assert!(ScanState::Refused.after(step).is_err());
        }
        for step in [DeliveryStep::Deliver, DeliveryStep::Refuse] {
            assert!(DeliveryState::Delivered.after(step).is_err());
            assert!(DeliveryState::Refused.after(step).is_err());
        }
    }

    #[test]
    fn a_held_delivery_is_never_made_without_a_person() {
        let illegal = IllegalStep { state: "held", step: "deliver" };
        assert_eq!(DeliveryState::Held.after(DeliveryStep::Deliver), Err(illegal));
    }

    #[test]
    fn every_word_reads_back_as_its_state() {
        for state in ScanState::ALL {
            assert_eq!(ScanState::of_word(state.word()), Some(state));
        }
        for state in DeliveryState::ALL {
            assert_eq!(DeliveryState::of_word(state.word()), Some(state));
        }
        assert_eq!(ScanState::of_word("pending"), None);
    }
}
