//! One scan, several rows: a scan that belongs to two patients, or is held for a second one, has a row for
//! each. So each patient's report stays in reach, and no name opens another's record.

use std::collections::BTreeSet;

use gaiter_record::sha256;

use crate::account::{Delivered, Whole};
use crate::{DeliveryState, ScanState};

/// The digits of a row's key: enough to distinguish the patients of one scan.
const KEY_DIGITS: usize = 16;

/// The rows of a scan. The one that waits for a decision or a record is first, then the patients who have
/// a record, in the order of their ids. A scan of one patient is one row as it is.
pub fn rows(whole: Whole) -> Vec<Whole> {
    let has_record = whole.deliveries.iter().filter(|of| of.is_there());
    let owners: BTreeSet<String> = has_record.filter_map(|of| of.patient.clone()).collect();
    let is_closed = whole.summary.closed.is_some();
    let waits = |of: &Delivered| match of.state {
        DeliveryState::Pending => true,
        DeliveryState::Held | DeliveryState::Refused => !is_closed,
        _ => false,
    };
    let is_owners = |of: &Delivered| of.patient.as_ref().is_some_and(|id| owners.contains(id));
    let has_rest = whole.deliveries.iter().any(|of| waits(of) && !is_owners(of));
    if owners.len() + usize::from(has_rest) < 2 {
        return vec![whole];
    }
    let rest = has_rest.then(|| {
        let deliveries = whole.deliveries.iter().filter(|of| !is_owners(of)).cloned().collect();
        Whole { deliveries, ..whole.clone() }
    });
    let of_owners = owners.iter().map(|id| of_owner(&whole, id));
    rest.into_iter().chain(of_owners).collect()
}

/// The row of a patient who has a record.
fn of_owner(whole: &Whole, id: &str) -> Whole {
    let theirs = |of: &&Delivered| of.patient.as_deref() == Some(id) && !of.is_to_go();
    let deliveries = whole.deliveries.iter().filter(theirs).cloned().collect();
    let mut row = Whole { deliveries, candidates: Vec::new(), ..whole.clone() };
    // What became of the scan for others is in their rows.
    row.summary.state = ScanState::Delivered;
    (row.summary.code, row.summary.message, row.summary.closed) = (None, None, None);
    row
}

/// Identifies a patient's row of a scan in an address, without naming the patient.
pub fn key(scan: &str, patient: &str) -> String {
    let digest = sha256(format!("{scan} {patient}").as_bytes());
    digest.chars().take(KEY_DIGITS).collect()
}
