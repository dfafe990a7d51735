//! Refused scans whose bytes were lost: they are taken in again when the same bytes are exported again.

use gaiter_flow::{DeliveryState, ScanId, ScanState};
use tracing::info;

use super::{Arrival, Custody, CustodyFault, intake_of, io};

impl Custody {
    /// Reports whether the bytes of a refused scan are missing from the state folder but were not
    /// deleted by retention: the spool lost them, or they were removed from quarantine by hand. The
    /// caller holds the custody lock.
    pub(super) fn is_lost(&self, scan: &ScanId) -> Result<bool, CustodyFault> {
        let known = self.journal.scan(scan)?;
        Ok(known.is_some_and(|row| row.state == ScanState::Refused)
            && !self.quarantine.holds_bytes(scan)
            && !self.journal.was_let_go(scan)?)
    }

    /// Takes lost bytes in again for the patient they were to be delivered to, if there is only one;
    /// otherwise the scan is held. Ignores the patient they are sighted for now. The caller holds the
    /// custody lock.
    pub(super) fn take_in_again(&self, arrival: &Arrival<'_>) -> Result<(), CustodyFault> {
        let scan = arrival.scan;
        let Some(row) = self.journal.scan(scan)? else { return Ok(()) };
        let refused = self.journal.deliveries_in(scan, DeliveryState::Refused)?;
        let first = refused.first().and_then(|due| due.patient.clone());
        let is_one =
            refused.windows(2).all(|pair| pair[0].patient_cell() == pair[1].patient_cell());
        let (bytes, companions) = (arrival.bytes, arrival.companions);
        if !self.spool.holds(scan) {
            let intake = intake_of(&row, first.as_ref().filter(|_| is_one));
            io("keeping a scan", self.spool.keep(scan, intake, bytes, companions))?;
        }
        // Removes the bare reason that stands in for the lost bytes; another refusal has its own reason.
        io("clearing a refusal", self.quarantine.remove(scan))?;
        self.journal.taken_again(scan)?;
        info!(event = "scan-taken-again", scan = scan.short());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::super::tests::{BYTES, admit, open, reason, refused, says};
    use super::*;
    use crate::station::journal::Due;
    use crate::store::sums;
    use gaiter_flow::patient::identity::SAME_SCAN_OTHER_PATIENT;
    use gaiter_flow::{Verdict, Whose};

    fn for_whom(custody: &Custody) -> Vec<String> {
        let due = custody.journal.pending().unwrap();
        due.iter().map(|due| due.patient_cell().to_owned()).collect()
    }

    fn lose_quarantine(dir: &Path, scan: &ScanId) {
        fs::remove_dir_all(dir.join("quarantine").join(scan.as_str())).unwrap();
    }

    #[test]
    fn bytes_that_the_spool_lost_are_taken_in_again_for_the_patient_first_named() {
        let dir = tempfile::tempdir().unwrap();
        let custody = open(dir.path());
        let scan = sums::scan_id(BYTES);
        admit(&custody, says("4711"));
        fs::remove_dir_all(custody.spool.entry(&scan)).unwrap();
        custody.recover().unwrap();
        let seen = custody.journal.scan(&scan).unwrap().unwrap().first_seen;
        // A patient named now does not show whose scan it was.
        assert_eq!(admit(&custody, Whose::default()), Verdict::Already);
        assert_eq!(for_whom(&custody), ["4711"]);
        assert_eq!(fs::read(custody.spool.scan_file(&scan, "obj")).unwrap(), BYTES);
        assert_eq!(custody.spool.intake(&scan).unwrap().first_seen, seen);
        assert!(!custody.quarantine.holds(&scan), "its refusal is over");
        assert_eq!(
            custody.refuse(&scan, reason()).unwrap(),
            reason(),
            "another has its own reason"
        );
    }

    #[test]
    fn a_refused_scan_that_somebody_removed_from_quarantine_is_taken_in_again() {
        let dir = tempfile::tempdir().unwrap();
        let custody = open(dir.path());
        let scan = refused(&custody);
        assert_eq!(admit(&custody, says("4711")), Verdict::Already);
        assert!(for_whom(&custody).is_empty(), "it lies in quarantine");
        lose_quarantine(dir.path(), &scan);
        assert_eq!(admit(&custody, says("4711")), Verdict::Already);
        assert_eq!(for_whom(&custody), ["4711"]);
        assert!(custody.spool.holds(&scan));
    }

    #[test]
    fn for_another_patient_it_is_held_and_the_first_has_it_again() {
        let dir = tempfile::tempdir().unwrap();
        let custody = open(dir.path());
        let scan = refused(&custody);
        lose_quarantine(dir.path(), &scan);
        assert_eq!(admit(&custody, says("0815")), Verdict::Held(SAME_SCAN_OTHER_PATIENT));
        assert_eq!(for_whom(&custody), ["4711"]);
    }

    #[test]
    fn where_it_was_refused_for_two_a_person_decides() {
        let dir = tempfile::tempdir().unwrap();
        let custody = open(dir.path());
        let scan = sums::scan_id(BYTES);
        admit(&custody, says("4711"));
        admit(&custody, says("0815"));
        assert!(matches!(custody.release(&scan).unwrap(), super::super::Acted::Done(1)));
        custody.refuse(&scan, reason()).unwrap();
        lose_quarantine(dir.path(), &scan);
        assert_eq!(admit(&custody, Whose::default()), Verdict::Already);
        assert!(for_whom(&custody).is_empty());
        let held = custody.journal.deliveries_in(&scan, DeliveryState::Held).unwrap();
        assert_eq!(held.iter().map(Due::patient_cell).collect::<Vec<_>>(), ["0815", "4711"]);
        assert!(custody.spool.holds(&scan));
    }

    #[test]
    fn a_refused_scan_that_the_configuration_let_go_is_not_lost() {
        let dir = tempfile::tempdir().unwrap();
        let custody = open(dir.path());
        let scan = refused(&custody);
        let future = "2099-01-01T00:00:00Z".parse().unwrap();
        assert_eq!(custody.let_go_quarantined(future).unwrap(), 1);
        assert_eq!(admit(&custody, says("4711")), Verdict::Already);
        assert!(for_whom(&custody).is_empty() && !custody.holds(&scan));
    }

    #[test]
    fn a_crash_while_it_is_taken_in_again_leaves_it_to_the_next_sight() {
        let dir = tempfile::tempdir().unwrap();
        let custody = open(dir.path());
        let scan = refused(&custody);
        let quarantined = dir.path().join("quarantine").join(scan.as_str());
        // The bytes are in the spool and the refusal is cleared, but the journal was not reached.
        fs::rename(quarantined, custody.spool.entry(&scan)).unwrap();
        custody.recover().unwrap();
        assert_eq!(admit(&custody, says("4711")), Verdict::Already);
        assert_eq!(for_whom(&custody), ["4711"]);
    }
}
