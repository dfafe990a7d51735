//! What the last scans show about the scanner's cameras: how many have views apart, and a chart of the steps.

use std::fmt::Display;

use gaiter_flow::views::{ViewsSeen, ViewsSeries};
use gaiter_flow::words::decimals;
use gaiter_language::Language;

use super::BARS;

/// The chart's end, mm: cameras that are further apart leave no leg to measure.
const REACH_MM: f64 = 8.0;

/// A scan whose views meet.
const MEET: char = '·';

/// The rows of the screen; none while the views meet.
pub(super) fn rows(series: &ViewsSeries, language: Language) -> Vec<(String, String)> {
    let Some((count, largest_mm)) = series.apart() else { return Vec::new() };
    let words: [(&str, &dyn Display); 3] = [
        ("count", &count),
        ("scans", &series.scans().len()),
        ("step_mm", &decimals(largest_mm, 1, language)),
    ];
    let label = language.text("terminal.label.views").to_owned();
    let legend = language.filled("terminal.views.legend", &[("reach_mm", &REACH_MM)]);
    let chart: String = series.scans().iter().map(bar).collect();
    let text = language.filled("terminal.views.apart", &words);
    vec![(label, text), (String::new(), format!("{chart}  {legend}"))]
}

fn bar(seen: &ViewsSeen) -> char {
    let Some(step_mm) = seen.step_mm else { return MEET };
    let place = step_mm / REACH_MM * BARS.len() as f64;
    BARS[place.clamp(0.0, BARS.len() as f64 - 1.0) as usize]
}

#[cfg(test)]
mod tests {
    use jiff::Timestamp;

    use super::*;

    fn series(steps_mm: &[Option<f64>]) -> ViewsSeries {
        let mut series = ViewsSeries::default();
        for (second, step_mm) in (0..).zip(steps_mm) {
            let at = Timestamp::from_second(second).unwrap();
            series.add(ViewsSeen { at, step_mm: *step_mm });
        }
        series
    }

    #[test]
    fn a_camera_that_moves_shows_in_the_chart() {
        assert!(rows(&series(&[None, None]), Language::En).is_empty());
        let moved = series(&[None, Some(2.5), None, Some(3.04), Some(9.0)]);
        let rows = rows(&moved, Language::De);
        assert!(rows[0].1.contains("3 der letzten 5") && rows[0].1.contains("9,0 mm"), "{rows:?}");
        assert!(rows[1].1.starts_with("·▃·▄█  "), "{}", rows[1].1);
    }
}
