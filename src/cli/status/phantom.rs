//! The checks with the known body: the last one in words, and the bias of the last month as a chart.

use std::fmt::Display;

use gaiter_flow::words::{ago, signed};
use gaiter_language::Language;
use gaiter_record::phantom::{CheckResult, LastCheck};
use gaiter_record::rounding::shortest;
use jiff::Timestamp;

use super::BARS;
use crate::station::operator::control::status::PhantomStatus;

/// The chart's ends, −2 and +2 tolerances.
const REACH: f64 = 2.0;

/// A check in which the body could not be measured.
const NOT_MEASURED: char = '×';

/// The rows of the screen.
pub(super) fn rows(
    phantom: &PhantomStatus,
    now: Timestamp,
    language: Language,
) -> Vec<(String, String)> {
    let label = language.text("terminal.label.phantom").to_owned();
    let mut rows = vec![(label, last(phantom, now, language))];
    if let Some(last) = phantom.checks.last().filter(|_| phantom.checks.len() > 1) {
        let reach_mm = shortest(REACH * last.tolerance_mm, language);
        let legend = language.filled("terminal.phantom.legend", &[("reach_mm", &reach_mm)]);
        rows.push((String::new(), format!("{}  {legend}", chart(&phantom.checks))));
    }
    rows
}

fn last(phantom: &PhantomStatus, now: Timestamp, language: Language) -> String {
    let due = if phantom.due { language.text("terminal.phantom.due") } else { "" };
    let Some(last) = phantom.checks.last() else {
        return format!("{}{due}", language.text("terminal.phantom.never"));
    };
    let figures = |(bias_mm, worst_mm)| {
        let words: [(&str, &dyn Display); 2] = [
            ("bias_mm", &signed(bias_mm, 1, language)),
            ("worst_mm", &signed(worst_mm, 1, language)),
        ];
        language.filled("terminal.phantom.figures", &words)
    };
    let figures = last.bias_mm.zip(last.worst_mm).map_or(String::new(), figures);
    let tolerance_mm = shortest(last.tolerance_mm, language);
    let of_tolerance = |key| language.filled(key, &[("tolerance_mm", &tolerance_mm)]);
    let result = match last.result {
        CheckResult::Within => of_tolerance("terminal.phantom.within"),
        CheckResult::Beyond => of_tolerance("terminal.phantom.beyond"),
        CheckResult::NotMeasured => language.text("page.part.phantom.not_measured").to_owned(),
    };
    let words: [(&str, &dyn Display); 4] = [
        ("result", &result),
        ("time", &ago(last.at, now, language)),
        ("figures", &figures),
        ("due", &due),
    ];
    language.filled("terminal.phantom.last", &words)
}

fn chart(checks: &[LastCheck]) -> String {
    let bar = |check: &LastCheck| {
        let Some(bias_mm) = check.bias_mm else { return NOT_MEASURED };
        let share = (bias_mm / (REACH * check.tolerance_mm) + 1.0) / 2.0;
        let place = (share * BARS.len() as f64).clamp(0.0, BARS.len() as f64 - 1.0);
        BARS[place as usize]
    };
    checks.iter().map(bar).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(second: i64, result: CheckResult, bias_mm: Option<f64>) -> LastCheck {
        let at = Timestamp::from_second(second).unwrap();
        LastCheck { at, result, bias_mm, worst_mm: bias_mm, tolerance_mm: 2.0 }
    }

    #[test]
    fn a_drift_shows_in_the_chart_and_the_last_check_in_words() {
        let checks = vec![
            check(0, CheckResult::Beyond, Some(-9.0)),
            check(1, CheckResult::Within, Some(0.1)),
            check(2, CheckResult::NotMeasured, None),
            check(3, CheckResult::Beyond, Some(3.94)),
        ];
        let now = Timestamp::from_second(3603).unwrap();
        let rows = rows(&PhantomStatus { due: false, checks: checks.clone() }, now, Language::En);
        assert_eq!(rows[0].1, "not within 2 mm 60 minutes ago: bias +3.9 mm, worst +3.9 mm");
        assert!(rows[1].1.starts_with("▁▅×█  "), "{}", rows[1].1);
        assert!(rows[1].1.ends_with("▁ −4 mm to █ +4 mm"), "{}", rows[1].1);
        let german = last(&PhantomStatus { due: true, checks }, now, Language::De);
        let expected = "nicht innerhalb von 2 mm, vor 60 Minuten: im Mittel +3,9 mm, höchstens +3,9 mm; \
                        den Prüfkörper jetzt scannen";
        assert_eq!(german, expected);
    }

    #[test]
    fn one_that_is_due_is_asked_for() {
        let now = Timestamp::from_second(0).unwrap();
        let rows = rows(&PhantomStatus { due: true, checks: Vec::new() }, now, Language::En);
        assert_eq!(rows.len(), 1);
        assert_eq!(rows[0].1, "the known body was never scanned; scan the known body now");
    }
}
