//! The method by which a stored scan is measured again.

use std::path::Path;

use gaiter_cad::Output;
use gaiter_leg::method::{B1, Scope, UnitChoice};
use gaiter_leg::{Method, Side};
use gaiter_record::{Record, ReportChoice};
use jiff::Zoned;

use crate::cli::{Exit, config_at};
use crate::config::words::{self, FACINGS, POSTURES, UNITS, UPS, WINDINGS};

/// Method, output and report of a configuration, for all records. Without one the default method: what the export
/// declares and which definitions of levels were requested is not part of it, and is taken from each record.
#[derive(Debug)]
pub struct Choices(Option<RecordChoices>);

/// How the scan of a record is measured, and what is made of it.
#[derive(Debug, Clone, Default)]
pub struct RecordChoices {
    /// How it is measured.
    pub method: Method,
    /// Its CAD files.
    pub output: Output,
    pub report: ReportChoice,
}

impl Choices {
    /// The choices of a configuration, or the default.
    ///
    /// # Errors
    /// The exit of a verb if the configuration has faults.
    pub fn from_config(config: Option<&Path>) -> Result<Choices, Exit> {
        Ok(Choices(config.map(config_at).transpose()?.map(|config| {
            let report = config.report_choice(Zoned::now().date());
            RecordChoices { method: config.method, output: config.output, report }
        })))
    }

    /// Those for the scan of a record.
    pub fn for_record(&self, record: &Record) -> RecordChoices {
        let default = || RecordChoices { method: as_asked(record), ..RecordChoices::default() };
        self.0.clone().unwrap_or_else(default)
    }
}

/// The default method with the options that were requested when the record was made.
fn as_asked(record: &Record) -> Method {
    let mut method = Method::default();
    let setting = |key: &str| record.made_by.method.get(key).map(String::as_str);
    let scopes = [Scope::Body, Scope::Leg(Side::Left), Scope::Leg(Side::Right)];
    let scope = setting("scope").and_then(|word| scopes.into_iter().find(|s| s.word() == word));
    method.scope = scope.unwrap_or(method.scope);
    // A unit that was inferred once is inferred again, with the same result unless it was wrong.
    let unit = setting("unit").and_then(|word| words::meaning(UNITS, word));
    method.unit = unit.unwrap_or(UnitChoice::Auto);
    method.up = setting("up").and_then(|word| words::meaning(UPS, word)).unwrap_or(method.up);
    let facing = setting("facing").and_then(|word| words::meaning(FACINGS, word));
    method.facing = facing.unwrap_or(method.facing);
    let winding = setting("winding").and_then(|word| words::meaning(WINDINGS, word));
    method.winding = winding.unwrap_or(method.winding);
    let posture = setting("posture").and_then(|word| words::meaning(POSTURES, word));
    method.posture = posture.unwrap_or(method.posture);
    let heights =
        setting("at_heights_mm").map(|list| list.split(", ").flat_map(str::parse).collect());
    method.at_heights_mm = heights.unwrap_or_default();
    let mm = |key| setting(key)?.strip_suffix("mm")?.parse::<f64>().ok();
    let levels = &mut method.levels;
    levels.g_below_crotch_mm = mm("g_below_crotch").unwrap_or(levels.g_below_crotch_mm);
    if let Some(distance_mm) = mm("b1_above_b") {
        levels.b1 = B1::AboveB { distance_mm };
    }
    method
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use gaiter_leg::method::{Axis, FacingChoice, Posture, Unit, Up, Winding};

    #[test]
    fn what_a_record_was_asked_for_is_asked_again() {
        let record = json!({
            "schema": "gaiter.leg-record/1", "revision": 1, "station": null, "patient": null,
            "acquired": null,
            "made_by": {"gaiter": "0.1.0", "method": {
                "scope": "right leg", "unit": "cm", "up": "z", "facing": "-x",
                "winding": "inward", "posture": "sitting",
                "at_heights_mm": "300, 412.5", "g_below_crotch": "40mm", "b1_above_b": "70mm",
            }},
            "scan": {"sha256": "0", "format": "obj", "unit": "cm", "unit_inferred": false,
                     "points": 0, "triangles": 0},
            "body": {"stature_mm": null, "crotch_height_mm": null, "crotch_from": "saddle",
                     "facing_deg": 0.0,
                     "facing_from": "feet", "from_export": vec![0.0; 16]},
            "legs": [], "differences": null, "findings": [],
        });
        let record: Record = serde_json::from_value(record).unwrap();
        let method = Choices(None).for_record(&record).method;
        assert_eq!(method.scope, Scope::Leg(Side::Right));
        assert_eq!(method.unit, UnitChoice::Declared(Unit::Cm));
        assert_eq!(method.up, Up::Z);
        assert_eq!(method.facing, FacingChoice::Declared(Axis::MinusX));
        assert_eq!(method.winding, Winding::Inward);
        assert_eq!(method.posture, Posture::Sitting);
        assert_eq!(method.at_heights_mm, [300.0, 412.5]);
        assert_eq!(method.levels.g_below_crotch_mm, 40.0);
        assert_eq!(method.levels.b1, B1::AboveB { distance_mm: 70.0 });
    }
}
