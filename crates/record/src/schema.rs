//! The written form of the record: `record.json`, schema `gaiter.leg-record/1`.
//!
//! Millimetres and degrees, in the body frame. Units are in the names. Fields may be added; the meaning
//! of a field never changes without a new schema number.

mod amendment;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::chart::{AlongFigures, AtFigures, DifferenceFigures, VolumeFigures};
use super::phantom::LastCheck;
use super::provenance::{Acquired, Patient};
use super::shape::{AxesFigures, AxisFigures, OutlineFigures, ShapeFigures};
use super::statement::Statement;
use super::surface::SurfaceFigures;
pub use amendment::{Amendment, Deed};
use gaiter_leg::Side;
use gaiter_leg::finding::Severity;

/// Name and number of this schema.
pub const SCHEMA: &str = "gaiter.leg-record/1";

/// The result for one scan and patient.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Record {
    /// The name and number of this schema.
    #[cfg_attr(test, schemars(extend("const" = SCHEMA)))]
    pub schema: String,
    /// 1, or more if the same scan was measured again.
    pub revision: u32,
    /// The station that made it; null for a bare `extract`.
    pub station: Option<String>,
    /// The patient; null if unknown.
    pub patient: Option<Patient>,
    /// When the scan was taken; null if unknown.
    pub acquired: Option<Acquired>,
    /// Program and method.
    pub made_by: MadeBy,
    /// The last check of the scanner with a body of known girths; null if there was none.
    pub phantom_check: Option<LastCheck>,
    /// The measured file.
    pub scan: ScanFile,
    /// The body as a whole.
    pub body: BodyFigures,
    /// The measured legs.
    pub legs: Vec<LegFigures>,
    /// The differences of the legs, left minus right; null if one leg is missing.
    pub differences: Option<DifferenceFigures>,
    /// Findings that readers of the record must know.
    pub findings: Vec<FindingNote>,
    /// Measures that people set in place of the scan's, oldest first. `legs` and `body` are the scan's.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub amendments: Vec<Amendment>,
}

/// The JSON Schema (draft 2020-12) of a record as this version writes it.
pub const JSON_SCHEMA: &str = include_str!("../schemas/record.schema.json");

impl Record {
    /// The leg of a side, if it was measured.
    pub fn leg(&self, side: Side) -> Option<&LegFigures> {
        self.legs.iter().find(|leg| leg.side == side.word())
    }

    /// Whether there is a finding of this code.
    pub fn has_finding(&self, code: &str) -> bool {
        self.findings.iter().any(|finding| finding.code == code)
    }

    /// Whether there is a finding of this code about a leg, or about a level of it.
    pub(crate) fn has_finding_at(&self, code: &str, side: Side, level: Option<&str>) -> bool {
        self.findings
            .iter()
            .any(|of| of.code == code && of.side() == Some(side) && of.level.as_deref() == level)
    }
}

/// Program and method that made a record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MadeBy {
    /// gaiter's version.
    pub gaiter: String,
    /// The options it was made with, by name.
    pub method: BTreeMap<String, String>,
}

/// The file that was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ScanFile {
    /// SHA-256 of its bytes, lower-case hexadecimal.
    #[cfg_attr(test, schemars(regex(pattern = r"^[0-9a-f]{64}$")))]
    pub sha256: String,
    /// The usual file ending of its format.
    pub format: String,
    /// Unit of its coordinates.
    pub unit: String,
    /// Whether the unit was found rather than declared.
    pub unit_inferred: bool,
    /// Points in the file.
    pub points: usize,
    /// Triangles in the file.
    pub triangles: usize,
}

/// Figures of the whole body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct BodyFigures {
    /// Height of the highest point above the floor; null for a lone leg.
    pub stature_mm: Option<f64>,
    /// Height of the crotch above the floor; null if it is not in the scan.
    pub crotch_height_mm: Option<f64>,
    /// Standard error of the crotch's height, that of the floor included; null with it.
    pub crotch_sd_mm: Option<f64>,
    /// What shows the crotch, and so what G is measured from.
    #[cfg_attr(test, schemars(extend("enum" = ["saddle", "border", "grown-together", "thighs", "notch", "one-leg", "proportion"])))]
    pub crotch_from: String,
    /// Standard error of the floor's height, from which all heights are counted; null if unknown.
    pub floor_sd_mm: Option<f64>,
    /// Direction of the toes in the export.
    pub facing_deg: f64,
    /// Source of the facing: `feet`, `calves` or `declared`.
    #[cfg_attr(test, schemars(extend("enum" = ["feet", "calves", "declared"])))]
    pub facing_from: String,
    /// 4 × 4, row by row: from the export's coordinates to the body frame. Not rounded.
    pub from_export: [f64; 16],
}

/// Figures of one leg.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LegFigures {
    /// The patient's `left` or `right`.
    #[cfg_attr(test, schemars(extend("enum" = ["left", "right"])))]
    pub side: String,
    /// Angle between the axis of the shank and the vertical.
    pub tilt_deg: f64,
    /// The axis of the shank with the frame of its sections.
    pub axis: AxisFigures,
    /// The axes of shank and thigh; null with another `tape` than `shank`.
    pub axes: Option<AxesFigures>,
    /// Levels found, by name; an absent level has no key.
    pub landmarks: BTreeMap<String, LandmarkFigures>,
    /// Levels estimated by a proportion only, by name. They are not landmarks.
    pub estimates: BTreeMap<String, EstimateFigures>,
    /// The foot; null if it is not seen from heel to toes.
    pub foot: Option<FootFigures>,
    /// Girth over height.
    pub girth_curve: GirthColumns,
    /// The section at each level found.
    pub sections: Vec<SectionFigures>,
    /// Feature points of these sections.
    pub features: Vec<FeatureFigures>,
    /// The surface; null if there is none.
    pub surface: Option<SurfaceFigures>,
    /// Volumes.
    pub volume: VolumeFigures,
    /// Girths at the requested heights.
    pub at: Vec<AtFigures>,
    /// Girths every 4 cm above the floor, lowest first, for comparing legs and scans at the same heights.
    pub profile: Vec<AtFigures>,
    /// Girths every 4 cm along the axis from the floor, lowest first, for comparing scans of different days:
    /// these places do not depend on how the leg was held.
    pub along: Vec<AlongFigures>,
    /// The shape from which pictures are drawn.
    pub shape: ShapeFigures,
}

/// Figures of one level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LandmarkFigures {
    /// The rule by which it was found, in English.
    pub by: String,
    /// The rule as data.
    pub rule: Statement,
    /// Vertical height of the section's centre above the floor.
    pub height_mm: f64,
    /// Distance along the leg's axis from the floor.
    pub along_axis_mm: f64,
    /// The section's centre, body frame; null on the foot.
    pub centre_mm: Option<[f64; 3]>,
    /// Length from the floor along the skin of the leg's medial side; null on the foot.
    pub surface_length_mm: Option<f64>,
    /// Circumference of the convex hull, as a tape reads it.
    pub girth_tape_mm: f64,
    /// Circumference along the skin.
    pub girth_contour_mm: f64,
    /// Standard error of the height; null if unknown.
    pub height_sd_mm: Option<f64>,
    /// Standard error of the tape girth at this height; null if unknown.
    pub girth_sd_mm: Option<f64>,
    /// Standard error of the tape girth as that of the level: with what the uncertain height adds; null if unknown.
    pub girth_of_level_sd_mm: Option<f64>,
    /// How much the tape girth changes at most per degree by which the tape is tilted; null if unknown.
    pub girth_per_deg_mm: Option<f64>,
    /// Codes of doubts.
    pub doubts: Vec<String>,
}

/// Figures of one level that is estimated by proportion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct EstimateFigures {
    /// The proportion by which it was estimated, in English.
    pub by: String,
    /// The proportion as data.
    pub rule: Statement,
    /// Vertical height of the section's centre above the floor.
    pub height_mm: f64,
    /// Distance along the leg's axis from the floor.
    pub along_axis_mm: f64,
    /// Circumference of the convex hull there.
    pub girth_tape_mm: f64,
    /// Standard error of the height, from the variation between people; null if unknown.
    pub height_sd_mm: Option<f64>,
    /// Standard error of the girth at this height; null if unknown.
    pub girth_sd_mm: Option<f64>,
    /// Standard error of the girth as that of the level: with what the uncertain height adds; null if unknown.
    pub girth_of_level_sd_mm: Option<f64>,
    /// Codes of doubts.
    pub doubts: Vec<String>,
}

/// Figures of a foot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FootFigures {
    /// From the heel to the longest toe, along the foot.
    pub length_mm: f64,
    /// Largest breadth, at right angles to the length.
    pub breadth_mm: f64,
}

/// The girth curve as columns of equal length; null if a section is open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GirthColumns {
    /// Heights of the sections' centres.
    pub height_mm: Vec<Option<f64>>,
    /// Distances along the axis.
    pub along_axis_mm: Vec<f64>,
    /// Tape girths.
    pub tape_mm: Vec<Option<f64>>,
    /// Contour girths.
    pub contour_mm: Vec<Option<f64>>,
    /// Growth of the continuous curve's tape girth per length along the axis, mm per mm.
    pub slope: Vec<Option<f64>>,
    /// Coefficient of determination of the continuous curve.
    pub r2: f64,
    /// Root mean square deviation of the sections from it.
    pub rms_mm: f64,
}

impl GirthColumns {
    /// Each figure of one of these columns with the height of its section; `None` where either is missing.
    pub(crate) fn over_height(
        &self,
        column: &[Option<f64>],
    ) -> impl Iterator<Item = Option<[f64; 2]>> {
        column.iter().zip(&self.height_mm).map(|(figure, height)| Some([(*figure)?, (*height)?]))
    }
}

/// Figures of the section at a level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SectionFigures {
    /// The level.
    pub level: String,
    /// Height of its centre.
    pub height_mm: f64,
    /// Coefficient of determination of the radius.
    pub r2: f64,
    /// Root mean square of the radial residuals.
    pub rms_mm: f64,
    /// Widest gap in its points.
    pub largest_gap_deg: f64,
    /// Its course.
    pub outline: OutlineFigures,
}

/// One feature point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FeatureFigures {
    /// The level of its section.
    pub level: String,
    /// P1, P2, … around from the front towards lateral.
    pub label: String,
    /// `peak` or `valley`.
    #[cfg_attr(test, schemars(extend("enum" = ["peak", "valley"])))]
    pub kind: String,
    /// Angle around the section's centre: 0 front, 90 lateral.
    pub angle_deg: f64,
    /// Place in the body frame.
    pub position_mm: [f64; 3],
    /// Standard error of the place along the skin; null if unknown.
    pub position_sd_mm: Option<f64>,
    /// Curvature, positive where convex.
    pub curvature_per_mm: f64,
    /// How much it stands out from its neighbours.
    pub prominence_per_mm: f64,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FindingNote {
    /// Stable code; docs/codes.md explains what to do.
    pub code: String,
    /// `info`, `warning` or `error`.
    #[cfg_attr(test, schemars(extend("enum" = ["info", "warning", "error"])))]
    pub severity: String,
    /// `left`, `right` or null.
    pub leg: Option<String>,
    /// A level or null.
    pub level: Option<String>,
    /// The finding in English, with figures.
    pub message: String,
    /// The finding as data; missing for findings with an English text only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub says: Option<Statement>,
}

/// The code of a finding that only a report has: nobody can check the record's bytes.
pub const NOT_VOUCHED: &str = "not-vouched";

impl FindingNote {
    /// The leg that it is about; `None` for the whole scan.
    pub(crate) fn side(&self) -> Option<Side> {
        Side::of_word(self.leg.as_deref()?)
    }

    /// Whether another finding has the same meaning and place. Their figures may differ.
    pub(crate) fn is_like(&self, other: &FindingNote) -> bool {
        (&self.code, &self.leg, &self.level) == (&other.code, &other.leg, &other.level)
    }

    /// For a report of a record whose bytes nobody can check: without `SHA256SUMS` beside it, its figures
    /// may be anybody's.
    pub fn not_vouched() -> FindingNote {
        FindingNote {
            code: NOT_VOUCHED.to_owned(),
            severity: Severity::Error.word().to_owned(),
            leg: None,
            level: None,
            message: "no SHA256SUMS was beside the record".to_owned(),
            says: Some(Statement { is: NOT_VOUCHED.to_owned(), figures: BTreeMap::new() }),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods)]

    // The JSON Schemas that are shipped are those of the types. `tests/schema_check.py` holds records to them.
    //
    // `GAITER_RENEW=1 cargo test -p gaiter-record --lib schema::` writes them again.

    use std::fs;

    use schemars::JsonSchema;
    use schemars::generate::SchemaSettings;

    use super::*;
    use crate::order::Order;

    fn check<T: JsonSchema>(name: &str, shipped: &str) {
        let settings = SchemaSettings::draft2020_12().for_serialize();
        let schema = settings.into_generator().into_root_schema_for::<T>();
        let made = format!("{}\n", serde_json::to_string_pretty(&schema).unwrap());
        if std::env::var_os("GAITER_RENEW").is_some() {
            let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/schemas");
            fs::write(format!("{folder}/{name}.schema.json"), &made).unwrap();
        }
        assert!(shipped == made, "renew schemas/{name}.schema.json");
    }

    #[test]
    fn the_shipped_schemas_are_those_of_the_types() {
        check::<Record>("record", JSON_SCHEMA);
        check::<Order>("order", crate::order::JSON_SCHEMA);
    }
}
