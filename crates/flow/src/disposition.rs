//! What became of a scan, and whether a person must do something about it. Decided here once, from the scan and its
//! deliveries; light, page, terminal and search read it.

use serde::{Deserialize, Serialize};

use crate::lifecycle::{DeliveryState, ScanState};

gaiter_record::word_enum! {
    /// What matters most about a scan: a decision that is needed, then what is still to be done, then where its
    /// record is.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Disposition as serde {
        /// It cannot be measured, or its record cannot be stored: it lies in quarantine until a person decides.
        Refused => "refused",
        /// A person must decide whose it is.
        Held => "held",
        /// Its record is still to be made, or waits for a store.
        Spooled => "spooled",
        /// It was taken back, and its record is not removed from every store yet.
        Withdrawing => "withdrawing",
        /// A patient has its record.
        Delivered => "delivered",
        /// It was refused or held, and needs no decision any more.
        Closed => "closed",
        /// Its record is stored without a patient: a person must decide whose it is.
        Unassigned => "unassigned",
        /// Its record is stored without a patient, and a person left it there.
        Left => "left",
    }
}

impl Disposition {
    /// That of a scan with these deliveries: of each its state, and whether its record lies with a patient to whom
    /// the scan belongs. `is_closed`: it needs no decision any more.
    pub fn from_states(
        scan: ScanState,
        is_closed: bool,
        deliveries: impl Iterator<Item = (DeliveryState, bool)> + Clone,
    ) -> Disposition {
        let is_any = |wanted| deliveries.clone().any(|(state, _)| state == wanted);
        let has_owner = deliveries.clone().any(|(_, is_theirs)| is_theirs);
        match (scan, is_closed) {
            (ScanState::Refused, false) => Disposition::Refused,
            (ScanState::Refused, true) => Disposition::Closed,
            (_, false) if is_any(DeliveryState::Held) => Disposition::Held,
            _ if is_any(DeliveryState::Pending) => Disposition::Spooled,
            _ if is_any(DeliveryState::Withdrawing) => Disposition::Withdrawing,
            _ if has_owner => Disposition::Delivered,
            (_, true) if is_any(DeliveryState::Held) => Disposition::Closed,
            (_, true) => Disposition::Left,
            (_, false) => Disposition::Unassigned,
        }
    }

    /// Whether measures that its record lacks are asked for, if a patient has it: also while another store, or the
    /// result for the practice software, still waits for it.
    pub fn may_lack_measures(self) -> bool {
        matches!(self, Disposition::Delivered | Disposition::Spooled)
    }

    /// Whether its record is stored without a patient.
    pub fn is_unassigned(self) -> bool {
        matches!(self, Disposition::Unassigned | Disposition::Left)
    }

    /// Whether a person must decide about it.
    pub fn needs_decision(self) -> bool {
        matches!(self, Disposition::Refused | Disposition::Held | Disposition::Unassigned)
    }
}

/// What a person must do about a scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Task {
    Nothing,
    Decide,
    /// Take measures by hand that its record lacks, or scan the patient again.
    Complete,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_matters_most_is_told() {
        use DeliveryState::{Delivered, Held, Pending, Refused, Withdrawing, Withdrawn};
        use Disposition as Is;
        let done = ScanState::Delivered;
        for (scan, is_closed, deliveries, disposition) in [
            (ScanState::Spooled, false, vec![(Pending, false)], Is::Spooled),
            (ScanState::Refused, false, vec![(Refused, false)], Is::Refused),
            (ScanState::Refused, true, vec![(Refused, false)], Is::Closed),
            // One store has its record, and another took none.
            (ScanState::Refused, false, vec![(Delivered, true), (Refused, false)], Is::Refused),
            (ScanState::Spooled, false, vec![(Pending, false), (Held, false)], Is::Held),
            (done, false, vec![(Held, false)], Is::Held),
            (done, true, vec![(Held, false)], Is::Closed),
            (done, true, vec![(Delivered, true), (Held, false)], Is::Delivered),
            (ScanState::Spooled, false, vec![(Pending, false), (Delivered, false)], Is::Spooled),
            (done, false, vec![(Delivered, true), (Withdrawing, false)], Is::Withdrawing),
            (done, false, vec![(Delivered, true)], Is::Delivered),
            (done, false, vec![(Delivered, false)], Is::Unassigned),
            (done, true, vec![(Delivered, false)], Is::Left),
            (done, false, vec![(Withdrawn, false), (Delivered, false)], Is::Unassigned),
        ] {
            let found = Disposition::from_states(scan, is_closed, deliveries.iter().copied());
            assert_eq!(found, disposition, "{scan:?} {is_closed} {deliveries:?}");
            assert!(!(is_closed && found.needs_decision()), "{found:?}");
        }
    }
}
