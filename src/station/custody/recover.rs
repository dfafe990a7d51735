//! Makes spool, quarantine and journal agree after the last run, however it ended.

use std::io::ErrorKind;
use std::time::Duration;

use gaiter_flow::round::CaptureMatch;
use gaiter_flow::{ScanId, ScanState};
use jiff::Timestamp;

use super::{Custody, CustodyFault, held_code, io, row};
use crate::station::custody::quarantine::{Reason, Stage};
use crate::station::journal::ScanRow;

impl Custody {
    /// Makes spool, quarantine and journal agree after the last run, however it ended. Returns how many
    /// scans of the spool the journal did not know.
    pub fn recover(&self) -> Result<usize, CustodyFault> {
        let _change = self.changing();
        let mut adopted = 0;
        for scan in io("listing the spool", self.spool.entries())? {
            match self.journal.scan(&scan)?.map(|row| row.state) {
                None => {
                    self.adopt_or_refuse(&scan)?;
                    adopted += 1;
                }
                Some(_) => {
                    self.quarantine_refused(&scan)?;
                    self.give_up_served(&scan)?;
                }
            }
        }
        for scan in self.journal.scans_in(ScanState::Spooled)? {
            // Its bytes are already in quarantine, or another process removed them.
            if !self.spool.holds(&scan)
                && let Some(row) = self.journal.scan(&scan)?
            {
                let message = "its bytes were removed from the spool by another program".to_owned();
                let reason = Reason::new("spool-lost", message, Stage::Intake, row.first_seen);
                self.refused(&scan, reason)?;
            }
        }
        self.journal.take_back_unwanted()?;
        self.journal.resume_amending()?;
        Ok(adopted)
    }

    /// Removes the spooled bytes of a scan if they are no longer needed.
    pub(super) fn give_up_served(&self, scan: &ScanId) -> Result<(), CustodyFault> {
        let served = match self.journal.scan(scan)?.map(|row| row.state) {
            None | Some(ScanState::Spooled) => false,
            Some(ScanState::Delivered) => {
                self.kept == Duration::ZERO && self.journal.has_served(scan)?
            }
            Some(ScanState::Refused) => self.quarantine.holds(scan),
        };
        if served {
            io("giving up spooled bytes", self.spool.remove(scan))?;
        }
        Ok(())
    }

    /// Enters a scan of the spool that the journal does not know. Refuses one with an unreadable intake: it must not
    /// block every start.
    pub(super) fn adopt_or_refuse(
        &self,
        scan: &ScanId,
    ) -> Result<Option<CaptureMatch>, CustodyFault> {
        let intake = match self.spool.intake(scan) {
            Err(unreadable) if is_of_the_entry(&unreadable) => {
                let message = format!("its intake.json cannot be read: {unreadable}");
                let now = Timestamp::now();
                let reason = Reason::new("spool-damaged", message, Stage::Intake, now);
                return self.quarantined(scan, &reason).map(|()| None);
            }
            intake => io("reading an intake", intake)?,
        };
        self.enter(&intake, held_code(&intake), &[], &row(&intake, scan))?;
        Ok(Some(intake.judged))
    }

    /// Enters the scans of the quarantine that the journal does not know, as refused. Returns how many.
    /// An entry that cannot be read stays as it is.
    pub fn adopt_quarantined(&self) -> Result<usize, CustodyFault> {
        let _change = self.changing();
        let mut adopted = 0;
        for scan in io("listing the quarantine", self.quarantine.entries())? {
            if self.journal.scan(&scan)?.is_some() {
                continue;
            }
            let reason = io("reading a reason", self.quarantine.reason(&scan))?;
            let intake = match self.quarantine.intake(&scan) {
                Err(error) if is_of_the_entry(&error) => continue,
                intake => io("reading an intake", intake)?,
            };
            let Some(reason) = reason else { continue };
            let row = ScanRow { state: ScanState::Spooled, ..row(&intake, &scan) };
            self.enter(&intake, None, &[], &row)?;
            self.journal.refused(&scan, &reason.code, &reason.message)?;
            adopted += 1;
        }
        Ok(adopted)
    }
}

/// Whether an entry itself cannot be read; any other error is the disk's and may pass.
fn is_of_the_entry(error: &std::io::Error) -> bool {
    matches!(error.kind(), ErrorKind::InvalidData | ErrorKind::NotFound)
}
