//! What of a result is in the index: the figures that questions are about. All others are in its object.

use gaiter_leg::{Level, Side};
use gaiter_record::Record;
use gaiter_record::archive::{Outcome, ScanResult};
use gaiter_record::schema::LandmarkFigures;

/// The outcome of a scan that was measured; any other is the code of a refusal.
pub const MEASURED: &str = "measured";

/// A row of the table `result`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figures {
    /// [`MEASURED`], or the code of a refusal.
    pub outcome: String,
    pub stature_mm: Option<f64>,
    pub crotch_height_mm: Option<f64>,
    /// The codes of the findings.
    pub findings: Vec<String>,
    /// The height of each level of each leg, in the order of the table `place`; `None` where it is not found.
    pub height_mm: Vec<Option<f64>>,
    /// The girth there as a tape reads it.
    pub girth_mm: Vec<Option<f64>>,
    /// Its standard error.
    pub girth_sd_mm: Vec<Option<f64>>,
}

impl Figures {
    /// The figures of a result.
    pub fn of(result: &ScanResult) -> Figures {
        match &result.outcome {
            Outcome::Measured(record) => Figures::of_record(record),
            Outcome::Refused { code, .. } => {
                Figures { outcome: code.clone(), ..Figures::default() }
            }
        }
    }

    fn of_record(record: &Record) -> Figures {
        let of_each = |figure: fn(&LandmarkFigures) -> Option<f64>| {
            let at = places().map(|(side, level)| {
                let leg = record.legs.iter().find(|leg| leg.side == side.word())?;
                leg.landmarks.get(level.name()).and_then(figure)
            });
            at.collect()
        };
        Figures {
            outcome: MEASURED.to_owned(),
            stature_mm: record.body.stature_mm,
            crotch_height_mm: record.body.crotch_height_mm,
            findings: record.findings.iter().map(|finding| finding.code.clone()).collect(),
            height_mm: of_each(|of| Some(of.height_mm)),
            girth_mm: of_each(|of| Some(of.girth_tape_mm)),
            girth_sd_mm: of_each(|of| of.girth_of_level_sd_mm),
        }
    }
}

/// The rows of the table `place`, in their order.
fn places() -> impl Iterator<Item = (Side, Level)> {
    Side::BOTH.into_iter().flat_map(|side| Level::ALL.map(|level| (side, level)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schema_has_every_level_in_the_order_of_the_leg() {
        let listed = |words: Vec<&str>| format!("unnest(array['{}'])", words.join("', '"));
        let schema = include_str!("../schema.sql");
        assert!(schema.contains(&listed(Side::BOTH.map(Side::word).to_vec())));
        assert!(schema.contains(&listed(Level::ALL.map(Level::name).to_vec())));
    }
}
