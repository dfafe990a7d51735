//! What journal and spool know of contents before one more is judged.

use std::collections::BTreeSet;

use gaiter_flow::ScanState;
use gaiter_flow::round::{Capture, CaptureMatch, CaptureState};

use super::{CaptureRow, Content, Disk, DiskFault, End, Intake, Scan, ScanRow};

impl Disk {
    /// As `Custody::known`.
    pub fn known(&self, scan: Scan, geometry: &str) -> Option<Scan> {
        let same = |(known, row): &&(Scan, ScanRow)| {
            *known == scan || (!geometry.is_empty() && row.geometry == geometry)
        };
        let own = self.scans.iter().find(|(known, _)| *known == scan);
        own.or_else(|| self.scans.iter().find(same)).map(|(known, _)| *known)
    }

    /// The scan with which a content begins: one that the same file was when it had one of these
    /// lengths, or one that was refused, of at least `least` bytes.
    pub fn beginning(&self, content: &Content, read: &[u64], least: usize) -> Option<Scan> {
        let all = content.bytes();
        let is_part = |row: &ScanRow| {
            let part = row.content.bytes();
            part.len() < all.len() && all.starts_with(part)
        };
        let was_read = |row: &ScanRow| read.contains(&(row.content.length() as u64));
        let is_refused =
            |row: &ScanRow| row.state == ScanState::Refused && row.content.length() >= least;
        let parts: Vec<_> = self.scans.iter().rev().filter(|(_, row)| is_part(row)).collect();
        let of_file = parts.iter().find(|(_, row)| was_read(row));
        let found = of_file.or_else(|| parts.iter().find(|(_, row)| is_refused(row)));
        found.map(|(scan, _)| *scan)
    }

    /// As `Custody::whose`.
    pub fn whose(&self, scan: Scan) -> BTreeSet<String> {
        let mut whose: BTreeSet<String> = self.patients(scan).into_iter().flatten().collect();
        let judged = self.scan(scan).filter(|row| row.held.is_some()).map(|row| &row.judged);
        if let Some(CaptureMatch::Held { candidates, .. }) = judged {
            whose.extend(candidates.iter().map(|named| named.id.clone()));
        }
        whose
    }

    /// As `Journal::captures_taken`.
    pub fn taken(&self) -> Vec<Capture> {
        let is_open =
            |scan: Scan| self.scan(scan).is_some_and(|row| row.state != ScanState::Delivered);
        let rows = self.captures.values();
        let rows = rows.filter(|row| match row.end {
            Some(End::Answered) => row.scan.is_some_and(is_open),
            Some(End::Held) => true,
            Some(End::Over) | None => false,
        });
        let state = |row: &CaptureRow| match row.end {
            Some(End::Answered) => CaptureState::Taken,
            _ => CaptureState::Held,
        };
        rows.map(|row| Capture { state: state(row), ..row.capture.clone() }).collect()
    }

    /// As `Journal::booth_changed` for a decision: the scan answers this capture, and none besides.
    pub fn answers_now(&mut self, scan: Scan, capture: Option<i64>) {
        for (number, row) in &mut self.captures {
            if Some(*number) == capture {
                (row.end, row.scan) = (Some(End::Answered), Some(scan));
            } else if row.scan == Some(scan) {
                row.scan = None;
            }
        }
    }

    /// What the spool keeps and the journal does not know.
    pub fn unentered(&self) -> Vec<(Scan, Intake)> {
        let unknown = self.spool.iter().filter(|(scan, _)| self.scan(**scan).is_none());
        unknown.map(|(scan, intake)| (*scan, intake.clone())).collect()
    }

    /// As `Journal::captures_closed`.
    pub fn closed(&mut self, captures: &[i64]) -> Result<(), DiskFault> {
        if !captures.is_empty() {
            self.change()?;
        }
        for (number, row) in &mut self.captures {
            if captures.contains(number) {
                row.end = Some(End::Over);
            }
        }
        Ok(())
    }
}
