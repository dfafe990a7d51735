//! How long data is kept after it is no longer needed.

use std::time::Duration;

use jiff::Timestamp;

/// How long each kind of data is kept; `None` means for ever.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Retention {
    /// The station's own copy of a scan, counted from the day its last record reached its store. Zero
    /// means that it is deleted with the receipt.
    pub spool: Duration,
    /// A refused scan and its reason, from the day it was refused.
    pub quarantine: Option<Duration>,
    /// What the journal knows about a scan whose records all reached their stores, from that day.
    pub journal: Option<Duration>,
}

/// Data that was last needed before this time is deleted now; `None` if it is kept. A clock that jumps
/// back causes no deletion.
pub fn before(kept: Option<Duration>, now: Timestamp) -> Option<Timestamp> {
    now.checked_sub(kept?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_for_ever_is_never_let_go() {
        assert_eq!(before(None, Timestamp::MAX), None);
        let now = "2026-11-21T09:15:00Z".parse().unwrap();
        let hour = Some(Duration::from_secs(3600));
        assert_eq!(before(hour, now), Some("2026-11-21T08:15:00Z".parse().unwrap()));
        assert_eq!(before(Some(Duration::MAX), now), None);
    }
}
