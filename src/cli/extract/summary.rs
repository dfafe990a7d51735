//! The summary that `gaiter extract` prints after several scans, one row per scan.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::cli::terminal::paint::{self, painted};
use crate::flow::health::counted;
use crate::leg::{Level, Side};
use crate::record::Record;

/// The levels whose girths are shown: those of the paper.
const LEVELS: [Level; 4] = [Level::B, Level::B1, Level::C, Level::D];

/// Width of a girth column: mm with one decimal.
const CELL: usize = 7;

/// The row of one scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The path as given on the command line, made safe to print.
    name: String,
    came: Came,
}

/// The result for a scan.
#[derive(Debug, Clone, PartialEq)]
enum Came {
    Measured {
        /// Tape girths, mm: left, then right.
        girths_mm: [[Option<f64>; 4]; 2],
        findings: usize,
    },
    Not {
        /// Why it was not measured.
        code: &'static str,
    },
}

impl Row {
    /// The row of a scan that was measured.
    pub fn measured(name: String, record: &Record) -> Row {
        let girths_mm = Side::BOTH.map(|side| {
            let leg = record.leg(side);
            LEVELS.map(|level| Some(leg?.landmarks.get(level.name())?.girth_tape_mm))
        });
        Row { name, came: Came::Measured { girths_mm, findings: record.findings.len() } }
    }

    /// The row of a scan that was not measured.
    pub fn not_measured(name: String, code: &'static str) -> Row {
        Row { name, came: Came::Not { code } }
    }
}

/// The summary with colours. Names come first and are never cut.
pub fn summary(rows: &[Row]) -> String {
    let wide = rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0).max("scan".len());
    let leg = |side: Side| format!("{:>1$}", format!("{} girth mm", side.word()), 4 * CELL);
    let levels: String = LEVELS.iter().map(|level| format!("{:>CELL$}", level.name())).collect();
    let mut text = format!("\n{:wide$}{}{}\n", "", leg(Side::Left), leg(Side::Right));
    let _ = writeln!(text, "{:wide$}{levels}{levels}  findings", "scan");
    for Row { name, came } in rows {
        let _ = match came {
            Came::Measured { girths_mm, findings } => {
                let cells: String = girths_mm.iter().flatten().map(|girth| cell(*girth)).collect();
                writeln!(text, "{name:wide$}{cells}  {findings:>8}")
            }
            Came::Not { code } => {
                let why = painted(paint::BAD, format_args!("not measured [{code}]"));
                writeln!(text, "{name:wide$}  {why}")
            }
        };
    }
    text + &totals(rows)
}

fn cell(girth_mm: Option<f64>) -> String {
    girth_mm.map_or_else(|| format!("{:>CELL$}", "-"), |mm| format!("{mm:CELL$.1}"))
}

/// The totals: scans measured, scans not measured by reason, and findings.
fn totals(rows: &[Row]) -> String {
    let (mut findings, mut why) = (0, BTreeMap::<&str, usize>::new());
    for row in rows {
        match row.came {
            Came::Measured { findings: more, .. } => findings += more,
            Came::Not { code } => *why.entry(code).or_default() += 1,
        }
    }
    let not: usize = why.values().sum();
    let scans = counted(rows.len(), "scan");
    let mut text = format!("{scans}: {} measured", rows.len() - not);
    if not > 0 {
        let codes: Vec<String> =
            why.iter().map(|(code, count)| format!("{count} {code}")).collect();
        let _ = write!(text, ", {not} not measured ({})", codes.join(", "));
    }
    let _ = writeln!(text, ", {}", counted(findings, "finding"));
    text
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn row(name: &str, girths_mm: [[Option<f64>; 4]; 2], findings: usize) -> Row {
        Row { name: name.to_owned(), came: Came::Measured { girths_mm, findings } }
    }

    #[test]
    fn a_row_has_the_girths_of_the_left_leg_first_and_counts_each_finding_once() {
        let leg = |side: &str, girth_mm: f64| {
            json!({
                "side": side, "tilt_deg": 1.0,
                "landmarks": {"C": {"by": "x", "height_mm": 300.0, "along_axis_mm": 301.0,
                    "girth_tape_mm": girth_mm, "girth_contour_mm": 381.0, "height_sd_mm": null,
                    "girth_sd_mm": null, "doubts": []}},
                "girth_curve": {"height_mm": [], "along_axis_mm": [], "tape_mm": [],
                    "contour_mm": [], "r2": 1.0, "rms_mm": 0.0},
                "sections": [], "features": [], "surface": null,
            })
        };
        let record = json!({
            "schema": "gaiter.leg-record/2", "revision": 1, "station": null, "patient": null,
            "acquired": null, "made_by": {"gaiter": "0.1.0", "method": {}},
            "scan": {"sha256": "0", "format": "obj", "unit": "mm", "unit_inferred": false,
                     "points": 0, "triangles": 0},
            "body": {"stature_mm": null, "crotch_height_mm": null, "facing_deg": 0.0,
                     "facing_from": "feet", "from_export": vec![0.0; 16]},
            "legs": [leg("right", 380.0), leg("left", 412.0)], "differences": null,
            "findings": [{"code": "x", "severity": "info", "leg": null, "level": null,
                          "message": ""}],
        });
        let record: Record = serde_json::from_value(record).unwrap();
        let of = |girth_mm: f64| [None, None, Some(girth_mm), None];
        let measured = Row::measured("a.obj".to_owned(), &record);
        assert_eq!(measured, row("a.obj", [of(412.0), of(380.0)], 1));
    }

    #[test]
    fn every_scan_has_a_row_and_the_totals_count_them() {
        let left = [Some(211.34), Some(287.0), Some(352.96), None];
        let rows = [
            row("day/4711_first.obj", [left, [None; 4]], 3),
            Row::not_measured("4712.obj".to_owned(), "no-leg"),
            Row::not_measured("4713.obj".to_owned(), "no-leg"),
        ];
        let told = anstream::adapter::strip_str(&summary(&rows)).to_string();
        let expected = "
                                 left girth mm              right girth mm
scan                    B     B1      C      D      B     B1      C      D  findings
day/4711_first.obj  211.3  287.0  353.0      -      -      -      -      -         3
4712.obj            not measured [no-leg]
4713.obj            not measured [no-leg]
3 scans: 1 measured, 2 not measured (2 no-leg), 3 findings
";
        assert_eq!(told, expected);
    }
}
