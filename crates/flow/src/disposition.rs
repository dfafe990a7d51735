//! What became of a scan, and whether a person must do something about it. Decided here once, from the scan and its
//! deliveries; light, page, terminal and search read it.

use serde::{Deserialize, Serialize};

use crate::account::{Delivered, Summary};
use crate::lifecycle::{DeliveryState, ScanState};

/// What matters most about a scan: a decision that is needed, then what is still to be done, then where its
/// record is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Disposition {
    /// It cannot be measured, or its record cannot be stored: it lies in quarantine until a person decides.
    Refused,
    /// A person must say whose it is.
    Held,
    /// Its record is still to be made, or waits for a store.
    Spooled,
    /// It was taken back, and its record is not removed from every store yet.
    Withdrawing,
    /// A patient has its record.
    Delivered,
    /// It was refused or held, and needs no decision any more.
    Closed,
    /// Its record is stored without a patient: a person must say whose it is.
    Unassigned,
    /// Its record is stored without a patient, and a person left it there.
    Left,
}

impl Disposition {
    /// That of a scan with these deliveries.
    pub fn of(summary: &Summary, deliveries: &[Delivered]) -> Disposition {
        let is_any = |state| deliveries.iter().any(|delivery| delivery.state == state);
        let has_owner = deliveries.iter().any(|of| of.patient.is_some() && of.is_there());
        match (summary.state, summary.closed.is_some()) {
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

    /// The word for it on the page and in the terminal; on the page it decides colour and sign.
    pub fn word(self) -> &'static str {
        match self {
            Disposition::Refused => "refused",
            Disposition::Held => "held",
            Disposition::Spooled => "spooled",
            Disposition::Withdrawing => "withdrawing",
            Disposition::Delivered => "delivered",
            Disposition::Closed => "closed",
            Disposition::Unassigned | Disposition::Left => "unassigned",
        }
    }

    /// Whether a person must decide about it.
    pub fn needs_decision(self) -> bool {
        matches!(self, Disposition::Refused | Disposition::Held | Disposition::Unassigned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::account::tests::whole;
    use crate::lifecycle::{Closed, UNASSIGNED};

    #[test]
    fn what_matters_most_is_told() {
        use DeliveryState::{Delivered, Held, Pending, Refused, Withdrawing, Withdrawn};
        let (first, second, nobody) = (Some("1"), Some("2"), None);
        for (scan, closed, deliveries, disposition) in [
            (ScanState::Spooled, false, vec![(first, Pending)], Disposition::Spooled),
            (ScanState::Refused, false, vec![(first, Refused)], Disposition::Refused),
            (ScanState::Refused, true, vec![(first, Refused)], Disposition::Closed),
            // One store has its record, and another's disk was full.
            (
                ScanState::Refused,
                false,
                vec![(first, Delivered), (first, Refused)],
                Disposition::Refused,
            ),
            (ScanState::Spooled, false, vec![(first, Pending), (second, Held)], Disposition::Held),
            (ScanState::Delivered, false, vec![(first, Held)], Disposition::Held),
            (ScanState::Delivered, true, vec![(first, Held)], Disposition::Closed),
            (
                ScanState::Delivered,
                true,
                vec![(first, Delivered), (second, Held)],
                Disposition::Delivered,
            ),
            (
                ScanState::Spooled,
                false,
                vec![(first, Pending), (nobody, Delivered)],
                Disposition::Spooled,
            ),
            (
                ScanState::Delivered,
                false,
                vec![(first, Delivered), (nobody, Withdrawing)],
                Disposition::Withdrawing,
            ),
            (ScanState::Delivered, false, vec![(first, Delivered)], Disposition::Delivered),
            (ScanState::Delivered, false, vec![(nobody, Delivered)], Disposition::Unassigned),
            (ScanState::Delivered, true, vec![(nobody, Delivered)], Disposition::Left),
            (
                ScanState::Delivered,
                false,
                vec![(first, Withdrawn), (nobody, Delivered)],
                Disposition::Unassigned,
            ),
        ] {
            let mut whole = whole(scan, Pending, 0);
            whole.summary.closed = closed.then_some(Closed::GivenUp);
            let delivery = whole.deliveries.remove(0);
            whole.deliveries = deliveries
                .iter()
                .map(|(patient, state)| crate::account::Delivered {
                    patient: patient.map(str::to_owned),
                    state: *state,
                    ..delivery.clone()
                })
                .collect();
            assert_eq!(whole.disposition(), disposition, "{scan:?} {closed} {deliveries:?}");
            assert_eq!(
                disposition.needs_decision(),
                !closed
                    && disposition.word() != "spooled"
                    && !matches!(disposition, Disposition::Delivered | Disposition::Withdrawing)
            );
        }
    }

    #[test]
    fn a_record_that_is_to_go_is_nobodys() {
        let mut taken_back = whole(ScanState::Delivered, DeliveryState::Delivered, 0);
        assert_eq!(taken_back.disposition(), Disposition::Delivered);
        taken_back.deliveries[0].code = Some(UNASSIGNED.to_owned());
        assert_eq!(taken_back.disposition(), Disposition::Unassigned);
    }
}
