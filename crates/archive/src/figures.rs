//! What of a result is in the index: the figures that questions are about. All others are in its object.

use gaiter_record::Record;
use gaiter_record::archive::{Outcome, ScanResult};
use serde_json::{Map, Value, json};

/// The outcome of a scan that was measured; any other is the code of a refusal.
pub const MEASURED: &str = "measured";

/// A row of the table `result`.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    /// [`MEASURED`], or the code of a refusal.
    pub outcome: String,
    /// The stature.
    pub stature_mm: Option<f64>,
    /// The height of the crotch.
    pub crotch_height_mm: Option<f64>,
    /// The codes of the findings.
    pub findings: Vec<String>,
    /// By leg and level: height and girth as a tape reads it, with its standard error.
    pub levels: Value,
}

impl Figures {
    /// The figures of a result.
    pub fn of(result: &ScanResult) -> Figures {
        match &result.outcome {
            Outcome::Measured(record) => Figures::of_record(record),
            Outcome::Refused { code, .. } => Figures {
                outcome: code.clone(),
                stature_mm: None,
                crotch_height_mm: None,
                findings: Vec::new(),
                levels: json!({}),
            },
        }
    }

    fn of_record(record: &Record) -> Figures {
        let legs = record.legs.iter().map(|leg| {
            let levels = leg.landmarks.iter().map(|(level, of)| {
                let figures = json!({
                    "height_mm": of.height_mm,
                    "girth_mm": of.girth_tape_mm,
                    "girth_sd_mm": of.girth_of_level_sd_mm,
                });
                (level.clone(), figures)
            });
            (leg.side.clone(), Value::Object(levels.collect()))
        });
        Figures {
            outcome: MEASURED.to_owned(),
            stature_mm: record.body.stature_mm,
            crotch_height_mm: record.body.crotch_height_mm,
            findings: record.findings.iter().map(|finding| finding.code.clone()).collect(),
            levels: Value::Object(legs.collect::<Map<String, Value>>()),
        }
    }
}
