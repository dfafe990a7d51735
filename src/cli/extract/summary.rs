//! The summary that `gaiter extract` prints after several scans, one row per scan.

use std::collections::BTreeMap;
use std::fmt::Write;

use gaiter_flow::health::counted;
use gaiter_language::Language;
use gaiter_leg::{Level, Side};
use gaiter_record::Record;
use gaiter_record::completeness::{Completeness, Kind};
use gaiter_record::measure::Measure;
use gaiter_record::rounding::cm_words;
use gaiter_sizes::Garment;

use crate::cli::terminal::screen::{indented, shortened};
use crate::cli::terminal::table::colour;
use crate::cli::terminal::{self, painted};

/// The levels whose girths are shown, as on the measuring sheet: those of a stocking that ends below the
/// knee.
const LEVELS: [Level; 4] = [Level::D, Level::C, Level::B1, Level::B];

/// Width of a girth column: cm with one decimal.
const CELL: usize = 6;

/// Width of the columns after the name: the girths of both legs, and the longest verdict.
const FIGURES: usize = 8 * CELL + "  scan again".len();

/// Narrowest column of names.
const NAME_LEAST: usize = 12;

/// The row of one scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The name within the folder of all scans, made safe to print.
    name: String,
    came: Came,
}

/// The result for a scan.
#[derive(Debug, Clone, PartialEq)]
enum Came {
    Measured {
        /// Tape girths, mm: right, then left.
        girths_mm: [[Option<f64>; 4]; 2],
        verdict: Kind,
        /// Whether its record was printed and written as asked.
        is_delivered: bool,
    },
    Not {
        /// Why it was not measured.
        code: &'static str,
    },
}

impl Row {
    /// The row of a scan that was measured, with the verdict for an order of this garment; `is_delivered` unless its
    /// record could not be printed or written.
    pub fn measured(name: String, record: &Record, garment: &Garment, is_delivered: bool) -> Row {
        let girths_mm = Side::FROM_FRONT.map(|side| {
            LEVELS.map(|level| Some(Measure::find(record, side, level).ok()?.girth.mm))
        });
        let verdict = Completeness::from_record(record, garment).kind();
        Row { name, came: Came::Measured { girths_mm, verdict, is_delivered } }
    }

    /// The row of a scan that was not measured.
    pub fn not_measured(name: String, code: &'static str) -> Row {
        Row { name, came: Came::Not { code } }
    }
}

/// The summary with colours, in lines of at most this many characters: the names give way.
pub fn summary(rows: &[Row], columns: usize) -> String {
    let room = columns.saturating_sub(FIGURES).max(NAME_LEAST);
    let wide = rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0);
    let wide = wide.clamp("scan".len(), room);
    let leg = |side: Side| format!("{:>1$}", format!("{} girth cm", side.word()), 4 * CELL);
    let legs = Side::FROM_FRONT.map(leg).concat();
    let levels: String = LEVELS.iter().map(|level| format!("{:>CELL$}", level.name())).collect();
    let mut text = format!("{:wide$}{legs}\n", "");
    let _ = writeln!(text, "{:wide$}{levels}{levels}  verdict", "scan");
    for Row { name, came } in rows {
        let name = shortened(name, room);
        let _ = match came {
            Came::Measured { girths_mm, verdict, is_delivered } => {
                let cells: String = girths_mm.iter().flatten().map(|girth| cell(*girth)).collect();
                let (colour, label) = match is_delivered {
                    true => (colour(*verdict), label(*verdict)),
                    false => (terminal::BAD, "not written"),
                };
                writeln!(text, "{name:wide$}{cells}  {}", painted(colour, label))
            }
            Came::Not { code } => {
                let why = painted(terminal::BAD, format_args!("not measured [{code}]"));
                writeln!(text, "{name:wide$}  {why}")
            }
        };
    }
    text + &indented(&totals(rows), "", columns)
}

fn cell(girth_mm: Option<f64>) -> String {
    let figure = girth_mm.map_or("-".to_owned(), |mm| cm_words(mm, Language::En));
    format!("{figure:>CELL$}")
}

/// A verdict in a word or two.
fn label(verdict: Kind) -> &'static str {
    match verdict {
        Kind::Complete => "complete",
        Kind::NotMeasurable => "not measurable",
        Kind::ByHand => "by hand",
        Kind::ScanAgain => "scan again",
    }
}

/// The totals: scans measured, scans not measured by reason, and what to do with them.
fn totals(rows: &[Row]) -> String {
    let (mut verdicts, mut why) = (BTreeMap::<Kind, usize>::new(), BTreeMap::<&str, usize>::new());
    let mut unwritten = 0;
    for row in rows {
        match row.came {
            Came::Measured { verdict, is_delivered, .. } => {
                *verdicts.entry(verdict).or_default() += 1;
                unwritten += usize::from(!is_delivered);
            }
            Came::Not { code } => *why.entry(code).or_default() += 1,
        }
    }
    let not: usize = why.values().sum();
    let scans = counted(rows.len(), "scan");
    let mut text = format!("{scans}: {} measured", rows.len() - not);
    let counts: Vec<String> =
        verdicts.iter().map(|(kind, count)| format!("{count} {}", label(*kind))).collect();
    if !counts.is_empty() {
        let _ = write!(text, " ({})", counts.join(", "));
    }
    if unwritten > 0 {
        let _ = write!(text, ", {unwritten} not written");
    }
    if not > 0 {
        let codes: Vec<String> =
            why.iter().map(|(code, count)| format!("{count} {code}")).collect();
        let _ = write!(text, ", {not} not measured ({})", codes.join(", "));
    }
    text
}

#[cfg(test)]
mod tests {
    use gaiter_record::chart::VolumeFigures;
    use gaiter_record::shape::ShapeFigures;
    use serde_json::json;

    use super::*;

    fn row(name: &str, girths_mm: [[Option<f64>; 4]; 2], verdict: Kind) -> Row {
        Row {
            name: name.to_owned(),
            came: Came::Measured { girths_mm, verdict, is_delivered: true },
        }
    }

    #[test]
    fn a_row_has_the_girths_of_the_right_leg_first_and_the_verdict() {
        let leg = |side: &str, girth_mm: f64| {
            json!({
                "side": side, "tilt_deg": 1.0,
                "axis": {"foot_mm": vec![0.0; 3], "direction": vec![0.0; 3],
                    "front": vec![0.0; 3], "lateral": vec![0.0; 3]},
                "landmarks": {"C": {"by": "x", "rule": {"is": "turning-point"}, "height_mm": 300.0, "along_axis_mm": 301.0,
                    "girth_tape_mm": girth_mm, "girth_contour_mm": 381.0, "height_sd_mm": null,
                    "girth_sd_mm": null, "doubts": []}},
                "estimates": {},
                "girth_curve": {"height_mm": [], "along_axis_mm": [], "tape_mm": [],
                    "contour_mm": [], "slope": [], "r2": 1.0, "rms_mm": 0.0},
                "sections": [], "features": [], "surface": null, "volume": VolumeFigures::default(),
                "at": [], "profile": [], "along": [], "shape": ShapeFigures::default(),
            })
        };
        let record = json!({
            "schema": "gaiter.leg-record/1", "revision": 1, "station": null, "patient": null,
            "acquired": null, "made_by": {"gaiter": "0.1.0", "method": {}},
            "scan": {"sha256": "0", "format": "obj", "unit": "mm", "unit_inferred": false,
                     "points": 0, "triangles": 0},
            "body": {"stature_mm": null, "crotch_height_mm": null, "crotch_from": "saddle",
                     "facing_deg": 0.0,
                     "facing_from": "feet", "from_export": vec![0.0; 16]},
            "legs": [leg("left", 412.0), leg("right", 380.0)], "differences": null,
            "findings": [],
        });
        let record: Record = serde_json::from_value(record).unwrap();
        let of = |girth_mm: f64| [None, Some(girth_mm), None, None];
        let measured = Row::measured("a.obj".to_owned(), &record, &Garment::default(), true);
        assert_eq!(measured, row("a.obj", [of(380.0), of(412.0)], Kind::ByHand));
    }

    #[test]
    fn every_scan_has_a_row_and_the_totals_count_them() {
        let right = [None, Some(352.96), Some(287.0), Some(211.34)];
        let rows = [
            row("day/4711_first.obj", [right, [None; 4]], Kind::ScanAgain),
            row("4715.obj", [right, right], Kind::Complete),
            Row::not_measured("4712.obj".to_owned(), "no-leg"),
            Row::not_measured("4713.obj".to_owned(), "no-leg"),
        ];
        let told = anstream::adapter::strip_str(&summary(&rows, 76)).to_string();
        let expected = "                          right girth cm           left girth cm
scan                 D     C    B1     B     D     C    B1     B  verdict
day/4711…rst.obj     -  35.3  28.7  21.1     -     -     -     -  scan again
4715.obj             -  35.3  28.7  21.1     -  35.3  28.7  21.1  complete
4712.obj          not measured [no-leg]
4713.obj          not measured [no-leg]
4 scans: 2 measured (1 complete, 1 scan again), 2 not measured (2 no-leg)
";
        assert_eq!(told, expected);
    }

    #[test]
    fn a_record_that_could_not_be_written_is_counted_and_its_verdict_is_not_shown() {
        let whole = row("4715.obj", [[Some(352.96); 4]; 2], Kind::Complete);
        let mut unwritten = whole.clone();
        if let Came::Measured { is_delivered, .. } = &mut unwritten.came {
            *is_delivered = false;
        }
        let told = anstream::adapter::strip_str(&summary(&[unwritten, whole], 76)).to_string();
        let lines: Vec<&str> = told.lines().collect();
        assert!(lines[2].ends_with("not written") && lines[3].ends_with("complete"), "{told}");
        assert_eq!(lines[4], "2 scans: 2 measured (2 complete), 1 not written");
    }
}
