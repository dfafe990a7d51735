//! Why a server did not store an object. DICOMweb and DIMSE have the same codes (PS3.4, B.2.3; PS3.18, I.2.2).

use std::ops::RangeInclusive;

/// An object of this UID is there already: what the server shows tells whether it is.
const DUPLICATE: u64 = 0x0111;

/// Failures of the server, not of the object: it cannot do it now, does not let the station, has no room (two codes).
const PASSING: [RangeInclusive<u64>; 4] =
    [0x0110..=0x0110, 0x0124..=0x0124, 0x0213..=0x0213, 0xa700..=0xa7ff];

/// An object that a server did not store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotStored {
    /// The reason (0008,1197) or status (0000,0900), 0 for none.
    pub reason: u64,
}

impl NotStored {
    /// What a reason of a server means; `None` if the server has the object.
    pub(crate) fn for_reason(reason: u64) -> Option<NotStored> {
        (reason != DUPLICATE).then_some(NotStored { reason })
    }

    /// Whether the server may store it later.
    pub fn is_passing(&self) -> bool {
        self.reason == 0 || PASSING.iter().any(|reasons| reasons.contains(&self.reason))
    }
}
