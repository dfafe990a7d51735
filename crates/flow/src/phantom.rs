//! The daily check with a phantom: which exports are scans of it, and what people must know of the last
//! checks.

use gaiter_record::phantom::CheckResult;
use jiff::Timestamp;

use super::complaint::{Complaint, ComplaintFigures};
use super::facts::{Alarm, Facts, PhantomFacts};
use super::words::age;

/// The code of the alarm about the last check.
pub const PHANTOM_ALARM: &str = "phantom-check";

/// How many of the last checks are shown: a month.
pub const SHOWN_MOST: usize = 30;

/// Whether an export with this name is a scan of the phantom: it begins with the phantom's name, in capitals
/// or not, and the name ends there.
pub fn is_phantom(file_name: &str, phantom: &str) -> bool {
    let Some((start, rest)) = file_name.split_at_checked(phantom.len()) else { return false };
    start.eq_ignore_ascii_case(phantom) && !rest.starts_with(|c: char| c.is_alphanumeric())
}

impl PhantomFacts {
    /// Whether the phantom has not been scanned for too long. A check of the future is none.
    fn is_due(&self, now: Timestamp) -> bool {
        let last = self.checks.iter().rev().find_map(|check| age(check.at, now));
        last.is_none_or(|age| age > self.every)
    }

    /// The alarm about the last check; `None` if it found nothing wrong.
    pub fn alarm(&self) -> Option<Alarm> {
        let last = self.checks.last()?;
        let figures = match (last.result, last.worst_mm) {
            (CheckResult::Within, _) => return None,
            (CheckResult::Beyond, Some(worst_mm)) => {
                let figures = ComplaintFigures::default().words("case", "beyond");
                figures.number("worst_mm", worst_mm).number("tolerance_mm", last.tolerance_mm)
            }
            (CheckResult::Beyond | CheckResult::NotMeasured, _) => {
                ComplaintFigures::default().words("case", "not_measured")
            }
        };
        Some(Alarm { figures, since: last.at })
    }
}

impl Facts {
    /// The cameras' views do not meet, if most of the last scans show it.
    pub fn views_apart(&self) -> Option<Complaint> {
        let checks = self.phantom.as_ref().map(|phantom| &phantom.checks[..]);
        self.views.complaint(checks.unwrap_or_default())
    }

    /// Whether the phantom should be scanned: its last check is too old, or the cameras' views do not meet.
    /// `false` without a phantom.
    pub fn is_phantom_due(&self, now: Timestamp) -> bool {
        let phantom = self.phantom.as_ref();
        phantom.is_some_and(|phantom| phantom.is_due(now) || self.views_apart().is_some())
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::views::ViewsSeen;
    use gaiter_language::Language;
    use gaiter_record::phantom::LastCheck;

    fn facts(checks: &[(i64, CheckResult, Option<f64>)]) -> PhantomFacts {
        let check = |&(at, result, off_mm): &(i64, CheckResult, Option<f64>)| LastCheck {
            at: Timestamp::from_second(at).unwrap(),
            result,
            bias_mm: off_mm,
            worst_mm: off_mm,
            tolerance_mm: 2.0,
        };
        let checks = checks.iter().map(check).collect();
        PhantomFacts { every: Duration::from_secs(100), checks }
    }

    #[test]
    fn only_the_phantom_s_own_name_is_the_phantom() {
        for name in ["PHANTOM.obj", "phantom_20261124.obj", "Phantom-2.ply", "PHANTOM"] {
            assert!(is_phantom(name, "PHANTOM"), "{name}");
        }
        for name in ["PHANTOMIAS.obj", "4711_PHANTOM.obj", "PHANT", "PHANTOM7.obj", "phantomé"] {
            assert!(!is_phantom(name, "PHANTOM"), "{name}");
        }
    }

    #[test]
    fn a_check_is_due_after_its_time_and_after_none() {
        let at = |second| Timestamp::from_second(second).unwrap();
        let one = facts(&[(1000, CheckResult::Within, Some(0.1))]);
        assert!(!one.is_due(at(1100)) && one.is_due(at(1101)));
        assert!(facts(&[]).is_due(at(0)));
        assert!(one.is_due(at(900)), "the clock was set back");
    }

    #[test]
    fn a_check_is_due_while_the_cameras_views_do_not_meet() {
        let at = |second| Timestamp::from_second(second).unwrap();
        let mut station = Facts::new(at(0), 1);
        for second in 1..4 {
            station.views.add(ViewsSeen { at: at(second), step_mm: Some(3.0) });
        }
        assert!(!station.is_phantom_due(at(5)), "there is no phantom");
        for (second, is_due) in [(0, true), (4, false)] {
            station.phantom = Some(facts(&[(second, CheckResult::Within, Some(0.1))]));
            assert_eq!(station.is_phantom_due(at(5)), is_due);
        }
    }

    #[test]
    fn the_last_check_alone_raises_the_alarm() {
        let good = (2, CheckResult::Within, Some(0.3));
        let bad = (1, CheckResult::Beyond, Some(-4.06));
        assert_eq!(facts(&[bad, good]).alarm(), None);
        let alarm = facts(&[good, bad]).alarm().unwrap();
        let said =
            |alarm: Alarm| Complaint::new(PHANTOM_ALARM, alarm.figures).message(Language::En);
        let alarm = said(alarm);
        assert!(alarm.contains("-4.1 mm") && alarm.contains("2 mm"), "{alarm}");
        let lost = facts(&[(1, CheckResult::NotMeasured, None)]).alarm().unwrap();
        assert!(said(lost).contains("could not be measured"));
    }
}
