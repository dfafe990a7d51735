//! What is known of bytes before they are judged: that they came in before, or that they are the rest of
//! a scan that was cut short.

use std::sync::PoisonError;

use super::{Custody, CustodyFault, io};
use crate::flow::ScanId;
use crate::flow::capture::{Judged, Named};
use crate::record::SourceKind;
use crate::store::sums;

/// A refused scan with fewer bytes than this tells nothing by being the beginning of another: exports
/// may share a header.
const COMPLETED_LEAST: u64 = 64 * 1024;

/// So many refused scans are compared with the beginning of a new one.
const COMPLETED_MOST: u32 = 64;

impl Custody {
    /// Enters the scan of an earlier attempt, which kept the bytes and failed at the journal or at
    /// their name's sync; says which capture it answered.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn enter_kept(&self, scan: &ScanId) -> Result<Option<Judged>, CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        if self.journal.scan(scan)?.is_some() || !self.spool.holds(scan) {
            return Ok(None);
        }
        io("syncing the spool", self.spool.sync())?;
        self.adopt(scan).map(Some)
    }

    /// The scan that these bytes are, or that has the same geometry, if it came in before.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn known(&self, scan: &ScanId, geometry: &str) -> Result<Option<ScanId>, CustodyFault> {
        if self.journal.scan(scan)?.is_some() {
            return Ok(Some(scan.clone()));
        }
        if geometry.is_empty() {
            return Ok(None);
        }
        Ok(self.journal.of_geometry(geometry)?)
    }

    /// The refused scan with which these bytes begin, and the one patient whose it was: it was cut
    /// short, and this is all of it.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn completed_by(&self, bytes: &[u8]) -> Result<Option<Option<Named>>, CustodyFault> {
        let sizes = COMPLETED_LEAST..bytes.len() as u64;
        for (scan, size) in self.journal.refused_of(sizes, COMPLETED_MOST)? {
            let part = usize::try_from(size).ok().and_then(|size| bytes.get(..size));
            if part.is_some_and(|part| sums::scan_id(part) == scan) {
                let patients = self.journal.patients(&scan)?;
                let mut named = patients.into_iter().flatten();
                let id = named.next().filter(|_| named.next().is_none());
                return Ok(Some(id.map(|id| Named { id, by: SourceKind::Record })));
            }
        }
        Ok(None)
    }
}
