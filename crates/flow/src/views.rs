//! What the last scans show about the scanner's cameras: whether their views meet. One scan may be chance; if
//! most of the last ones show it, the booth is at fault, and every girth is wrong until that is put right.

use gaiter_record::phantom::{CheckResult, LastCheck};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::complaint::{Complaint, ComplaintFigures};

/// The code of the notice that views do not meet.
const VIEWS_NOTICE: &str = "scanner-views-apart";

/// How many of the last scans are kept and shown: some days of a clinic.
const SHOWN_MOST: usize = 30;

/// The last scans that are judged together, and how many of them must have views apart. A lone scan is no fault
/// of the booth, and a camera that was moved shows on every scan.
const JUDGED: usize = 5;
const APART_LEAST: usize = 3;

/// What a measured scan shows about the cameras.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ViewsSeen {
    /// When the scan came in.
    pub at: Timestamp,
    /// How far apart the views are, mm; `None` if they meet.
    pub step_mm: Option<f64>,
}

/// What the last scans show about the cameras, oldest first.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ViewsSeries(Vec<ViewsSeen>);

impl ViewsSeries {
    /// Adds a scan. One with the same time and the same values is the same scan, measured again.
    pub fn add(&mut self, seen: ViewsSeen) {
        self.0.retain(|earlier| *earlier != seen);
        let place = self.0.partition_point(|earlier| earlier.at <= seen.at);
        self.0.insert(place, seen);
        let surplus = self.0.len().saturating_sub(SHOWN_MOST);
        self.0.drain(..surplus);
    }

    /// The scans, oldest first.
    pub fn scans(&self) -> &[ViewsSeen] {
        &self.0
    }

    /// How many of the scans have views apart, and the largest step, mm; `None` if none has.
    pub fn apart(&self) -> Option<(usize, f64)> {
        apart(&self.0)
    }

    /// The cameras' views do not meet, if most of the last scans show it. `checks` are those with the phantom,
    /// oldest first. A check that found the girths right clears the scans before it.
    pub fn complaint(&self, checks: &[LastCheck]) -> Option<Complaint> {
        let right = checks.iter().rev().find(|check| check.result == CheckResult::Within);
        let since = right.map_or(Timestamp::MIN, |check| check.at);
        let after = &self.0[self.0.partition_point(|seen| seen.at < since)..];
        let judged = &after[after.len().saturating_sub(JUDGED)..];
        let (count, largest_mm) = apart(judged).filter(|(count, _)| *count >= APART_LEAST)?;
        let figures = ComplaintFigures::default().count("count", count as u64);
        let figures = figures.count("scans", judged.len() as u64).number("step_mm", largest_mm);
        Some(Complaint::notice(VIEWS_NOTICE, figures))
    }
}

fn apart(scans: &[ViewsSeen]) -> Option<(usize, f64)> {
    let steps_mm = || scans.iter().filter_map(|seen| seen.step_mm);
    let largest_mm = steps_mm().reduce(f64::max)?;
    Some((steps_mm().count(), largest_mm))
}

#[cfg(test)]
mod tests {
    use gaiter_language::Language;

    use super::*;

    fn at(second: i64) -> Timestamp {
        Timestamp::from_second(second).unwrap()
    }

    /// Scans at the seconds 1, 2, 3 and so on.
    fn series(steps_mm: &[Option<f64>]) -> ViewsSeries {
        let mut series = ViewsSeries::default();
        for (second, step_mm) in (1..).zip(steps_mm) {
            series.add(ViewsSeen { at: at(second), step_mm: *step_mm });
        }
        series
    }

    #[test]
    fn three_of_the_last_five_scans_are_the_booth_s_fault() {
        let (meet, off) = (None, Some(3.2));
        for (steps_mm, is_said) in [
            (vec![], false),
            (vec![off, off], false),
            (vec![off, meet, off, meet, off], true),
            (vec![off, off, off, meet, meet], true),
            (vec![off, off, off, meet, meet, meet], false),
            (vec![meet, meet, off, meet, off], false),
        ] {
            assert_eq!(series(&steps_mm).complaint(&[]).is_some(), is_said, "{steps_mm:?}");
        }
        let said = series(&[meet, off, Some(4.04), off]).complaint(&[]).unwrap();
        let words = said.message(Language::En);
        assert!(words.contains("3 of the last 4") && words.contains(" 4.0 mm"), "{words}");
        assert!(!said.is_fault(), "records go to the stores all the same");
    }

    #[test]
    fn a_check_that_is_right_answers_for_the_scans_before_it() {
        let scans = series(&[Some(3.2); 3]);
        let is_said = |second, result| {
            let (at, off_mm) = (at(second), Some(0.1));
            let (bias_mm, worst_mm, tolerance_mm) = (off_mm, off_mm, 2.0);
            let check = LastCheck { at, result, bias_mm, worst_mm, tolerance_mm };
            scans.complaint(&[check]).is_some()
        };
        assert!(is_said(0, CheckResult::Within), "before them");
        assert!(!is_said(4, CheckResult::Within), "after them");
        assert!(is_said(4, CheckResult::Beyond) && is_said(4, CheckResult::NotMeasured));
    }

    #[test]
    fn a_scan_that_is_measured_again_counts_once_and_old_ones_go() {
        let mut series = ViewsSeries::default();
        for second in [7, 3, 7, 3, 7] {
            series.add(ViewsSeen { at: at(second), step_mm: Some(2.5) });
        }
        assert_eq!(series.apart(), Some((2, 2.5)));
        (10..50).for_each(|second| series.add(ViewsSeen { at: at(second), step_mm: None }));
        assert_eq!((series.scans().len(), series.apart()), (30, None));
    }
}
