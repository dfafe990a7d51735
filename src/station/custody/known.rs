//! What is known about bytes before they are judged: whether they came in before, and whether they
//! complete a scan that was cut short.

use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Duration;

use gaiter_flow::patient::erasure::ERASED;
use gaiter_flow::round::{CaptureMatch, Named};
use gaiter_flow::{ScanId, Stamp};
use gaiter_record::SourceKind;
use gaiter_scan::Format;

use super::{Custody, CustodyFault, io};
use crate::store::sums;

/// A refused scan with fewer bytes than this is not compared with the beginning of another: exports may
/// share a header.
const COMPLETED_LEAST: u64 = 64 * 1024;

/// An exporter writes all formats of a scan within this time.
const SIBLINGS_APART: Duration = Duration::from_secs(600);

/// At most this many refused scans are compared with the beginning of a new one.
const COMPLETED_MOST: u32 = 64;

impl Custody {
    /// Enters the scans of earlier attempts that kept the bytes but failed at the journal or at the sync
    /// of the name. This must precede the judgement of another scan: their captures must not be answered
    /// again, and their fingerprints must be known. Calls `entered` with the capture each answered.
    ///
    /// # Errors
    /// See [`CustodyFault`]; the next call continues.
    pub fn enter_kept(
        &self,
        mut entered: impl FnMut(&ScanId, &CaptureMatch),
    ) -> Result<(), CustodyFault> {
        if !self.unentered.load(Ordering::Relaxed) {
            return Ok(());
        }
        let _change = self.changing();
        io("syncing the spool", self.spool.sync())?;
        for scan in io("listing the spool", self.spool.entries())? {
            if self.journal.scan(&scan)?.is_none()
                && let Some(judged) = self.adopt_or_refuse(&scan)?
            {
                entered(&scan, &judged);
            }
        }
        self.unentered.store(false, Ordering::Relaxed);
        Ok(())
    }

    /// The earlier scan with the same bytes or the same fingerprint, if there is one.
    pub fn known(&self, scan: &ScanId, geometry: &str) -> Result<Option<ScanId>, CustodyFault> {
        if self.journal.scan(scan)?.is_some() || self.erasures.refuse(scan, None) {
            return Ok(Some(scan.clone()));
        }
        if geometry.is_empty() {
            return Ok(None);
        }
        Ok(self.journal.of_geometry(geometry)?)
    }

    /// The patients of an earlier, partial scan that these bytes complete: one read from the same file
    /// at one of the lengths `read`, or one refused as cut short.
    pub fn completed_by(
        &self,
        bytes: &[u8],
        read: &[u64],
    ) -> Result<Option<Vec<Named>>, CustodyFault> {
        let sizes = COMPLETED_LEAST..bytes.len() as u64;
        let refused = self.journal.refused_of(sizes, COMPLETED_MOST)?;
        let length = |size: u64| usize::try_from(size).ok().filter(|size| *size < bytes.len());
        let read: Vec<usize> = read.iter().rev().filter_map(|size| length(*size)).collect();
        let lengths = refused.iter().filter_map(|(_, size)| length(*size)).chain(read.clone());
        let beginnings = sums::of_beginnings(bytes, &lengths.collect());
        for part in read.iter().filter_map(|length| beginnings.get(length)) {
            if self.journal.scan(part)?.is_some() {
                return self.whose(part).map(Some);
            }
        }
        let is_beginning = |(scan, size): &&(ScanId, u64)| {
            length(*size).is_some_and(|length| beginnings.get(&length) == Some(scan))
        };
        match refused.iter().find(is_beginning) {
            Some((scan, _)) => self.whose(scan).map(Some),
            None => Ok(None),
        }
    }

    /// Whether a scan of the same name in another format was taken that was written at about the same time:
    /// both are one export, which was answered already. Where the name was used before, the other format goes
    /// with the scan that was written nearer to it.
    pub fn is_sibling(&self, path: &Path, stamp: Stamp) -> Result<bool, CustodyFault> {
        let before = self.journal.sighted_as(path)?;
        for ending in Format::ENDINGS {
            let other = path.with_extension(ending);
            let Some((its, Some(_))) = self.journal.sighted_as(&other)? else { continue };
            let apart_ns = |of: Stamp| its.mtime_ns.abs_diff(of.mtime_ns);
            let is_nearer = before.as_ref().is_none_or(|(old, _)| apart_ns(stamp) < apart_ns(*old));
            if other != path && is_nearer && apart_ns(stamp) <= SIBLINGS_APART.as_nanos() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// All patients a scan belongs to or may belong to, without those who were erased.
    fn whose(&self, scan: &ScanId) -> Result<Vec<Named>, CustodyFault> {
        let patients = self.journal.patients(scan)?.into_iter().flatten();
        let mut ids: Vec<String> = patients.chain(self.journal.candidates(scan)?).collect();
        ids.retain(|id| id != ERASED);
        ids.sort();
        ids.dedup();
        Ok(ids.into_iter().map(|id| Named::new(id, SourceKind::Record)).collect())
    }
}
