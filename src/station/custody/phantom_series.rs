//! The series of checks with the phantom: `phantom/<sha256>.json`, a file a check, kept apart from the
//! journal, which cannot bring them back.

use std::io;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use gaiter_flow::ScanId;
use gaiter_record::phantom::{CheckRecord, LastCheck, PHANTOM_SCHEMA};
use jiff::Timestamp;

use crate::store::json_folder::JsonFolder;

/// The checks of a station.
#[derive(Debug)]
pub struct PhantomSeries {
    folder: JsonFolder,
    /// Oldest first.
    checks: Mutex<Vec<CheckRecord>>,
}

impl PhantomSeries {
    /// Opens the series of a state folder, creates its folder if needed, and removes files that a crash
    /// left half written. A file that is not a check of this schema stays and is left out.
    pub fn open(state_dir: &Path) -> io::Result<PhantomSeries> {
        let folder = JsonFolder::open(state_dir, "phantom")?;
        let mut checks = Vec::new();
        for name in folder.names()? {
            let text = folder.bytes(&name)?.unwrap_or_default();
            let check = serde_json::from_slice::<CheckRecord>(&text).ok();
            checks.extend(check.filter(|check| check.schema == PHANTOM_SCHEMA));
        }
        checks.sort_by_key(|check| check.at);
        Ok(PhantomSeries { folder, checks: Mutex::new(checks) })
    }

    /// Whether a scan is in the series already.
    pub fn holds(&self, scan: &ScanId) -> bool {
        self.all(|checks| checks.iter().any(|check| check.sha256 == scan.as_str()))
    }

    /// Adds a check; durable on return.
    ///
    /// # Errors
    /// Any I/O error; the series is then as before.
    pub fn keep(&self, check: CheckRecord) -> io::Result<()> {
        self.folder.keep(&check.sha256, &serde_json::to_vec_pretty(&check)?)?;
        self.all(|checks| {
            let place = checks.partition_point(|earlier| earlier.at <= check.at);
            checks.insert(place, check);
        });
        Ok(())
    }

    /// The last check before a time.
    pub fn last_before(&self, at: Timestamp) -> Option<LastCheck> {
        self.all(|checks| checks.iter().rev().find(|check| check.at <= at).map(CheckRecord::brief))
    }

    /// The newest checks, oldest first.
    pub fn newest(&self, most: usize) -> Vec<LastCheck> {
        self.all(|checks| {
            let from = checks.len().saturating_sub(most);
            checks[from..].iter().map(CheckRecord::brief).collect()
        })
    }

    fn all<T>(&self, of: impl FnOnce(&mut Vec<CheckRecord>) -> T) -> T {
        of(&mut self.checks.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use gaiter_leg::phantom::{GirthCheck, PhantomCheck};

    fn at(seconds: i64) -> Timestamp {
        Timestamp::from_second(1_800_000_000 + seconds).unwrap()
    }

    fn check(number: u8, seconds: i64, off_mm: f64) -> CheckRecord {
        let sha256 = format!("{number:064x}");
        let (height_mm, known_mm, sd_mm, slope) = (100.0, 350.0, 0.1, 0.0);
        let measured_mm = known_mm + off_mm;
        let girths = vec![GirthCheck { height_mm, known_mm, measured_mm, sd_mm, slope }];
        CheckRecord::new(at(seconds), sha256, &Ok(PhantomCheck { girths, tilt_deg: 0.0 }), 2.0)
    }

    #[test]
    fn checks_outlast_a_start_in_the_order_of_their_times() {
        let dir = tempfile::tempdir().unwrap();
        let series = PhantomSeries::open(dir.path()).unwrap();
        for (number, seconds) in [(1, 20), (2, 0), (3, 40)] {
            series.keep(check(number, seconds, f64::from(number))).unwrap();
        }
        for series in [series, PhantomSeries::open(dir.path()).unwrap()] {
            let found: Vec<_> = series.newest(2).iter().map(|check| check.bias_mm).collect();
            assert_eq!(found, [Some(1.0), Some(3.0)]);
            assert_eq!(series.last_before(at(39)).unwrap().bias_mm, Some(1.0));
            assert_eq!(series.last_before(at(-1)), None);
            assert!(series.holds(&ScanId::parse(&format!("{:064x}", 2)).unwrap()));
            assert!(!series.holds(&ScanId::parse(&format!("{:064x}", 4)).unwrap()));
        }
    }

    #[test]
    fn what_is_no_check_is_left_out_and_stays() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("phantom");
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("note.txt"), "new phantom since May").unwrap();
        fs::write(folder.join(".half.json"), "{").unwrap();
        let series = PhantomSeries::open(dir.path()).unwrap();
        assert!(series.newest(9).is_empty());
        assert!(folder.join("note.txt").exists() && !folder.join(".half.json").exists());
    }
}
