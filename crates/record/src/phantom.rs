//! The written form of a check with a phantom: `gaiter calibrate --json`, and a line of the station's
//! series of checks. A record names the last one.

use gaiter_leg::phantom::{GirthCheck, PhantomCheck, PhantomFault};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::rounding::{degrees, mm, share};

/// Name and number of this schema.
pub const PHANTOM_SCHEMA: &str = "gaiter.phantom-check/1";

/// A check with a phantom.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckRecord {
    /// [`PHANTOM_SCHEMA`]
    pub schema: String,
    /// When it was measured, UTC.
    pub at: Timestamp,
    /// SHA-256 of the scan's bytes, lower-case hexadecimal.
    pub sha256: String,
    /// gaiter's version.
    pub gaiter: String,
    /// The result.
    pub result: CheckResult,
    /// The largest difference that counts as none, mm.
    pub tolerance_mm: f64,
    /// The figures; null if the phantom could not be measured.
    pub figures: Option<CheckFigures>,
    /// Why it could not be measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
}

/// The result of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum CheckResult {
    /// Every girth is within the tolerance.
    Within,
    /// A girth is not.
    Beyond,
    /// The phantom could not be measured.
    NotMeasured,
}

/// The figures of a check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckFigures {
    /// Mean of measured minus known girths, mm.
    pub bias_mm: f64,
    /// The difference that is farthest from zero, mm.
    pub worst_mm: f64,
    /// Offset and scale; null if the known girths are too much alike, or
    /// not those of cylinders.
    pub line: Option<LineFigures>,
    /// Angle between the phantom's axis and the vertical.
    pub tilt_deg: f64,
    /// The girths, lowest first.
    pub girths: Vec<GirthFigures>,
}

/// Measured minus known girth as a line over the known girth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LineFigures {
    /// What every girth is too large by, mm.
    pub offset_mm: f64,
    /// Its standard error, mm.
    pub offset_sd_mm: f64,
    /// By what share lengths are too large.
    pub scale: f64,
    /// Its standard error.
    pub scale_sd: f64,
}

/// One girth of a check.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GirthFigures {
    /// Height above the phantom's lower end.
    pub height_mm: f64,
    /// Known girth.
    pub known_mm: f64,
    /// Measured girth.
    pub measured_mm: f64,
    /// Standard error of the measured girth.
    pub sd_mm: f64,
}

/// The last check before a scan, as its record names it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LastCheck {
    /// When it was measured, UTC.
    pub at: Timestamp,
    /// The result.
    pub result: CheckResult,
    /// Mean of measured minus known girths; null if the phantom could not be measured.
    pub bias_mm: Option<f64>,
    /// The difference that is farthest from zero; null if the phantom could not be measured.
    pub worst_mm: Option<f64>,
    /// The largest difference that counts as none.
    pub tolerance_mm: f64,
}

impl CheckRecord {
    /// The check of a scan with this hash.
    pub fn new(
        at: Timestamp,
        sha256: String,
        check: &Result<PhantomCheck, PhantomFault>,
        tolerance_mm: f64,
    ) -> CheckRecord {
        let record = |why| CheckRecord::not_measured(at, sha256, why, tolerance_mm);
        match check {
            Err(fault) => record(fault.to_string()),
            Ok(check) => CheckRecord {
                result: match check.is_within(tolerance_mm) {
                    true => CheckResult::Within,
                    false => CheckResult::Beyond,
                },
                figures: Some(figures(check)),
                why: None,
                ..record(String::new())
            },
        }
    }

    /// The check of a scan that could not be measured at all.
    pub fn not_measured(
        at: Timestamp,
        sha256: String,
        why: String,
        tolerance_mm: f64,
    ) -> CheckRecord {
        CheckRecord {
            schema: PHANTOM_SCHEMA.to_owned(),
            at,
            sha256,
            gaiter: env!("CARGO_PKG_VERSION").to_owned(),
            result: CheckResult::NotMeasured,
            tolerance_mm,
            figures: None,
            why: Some(why),
        }
    }

    /// What a record contains of it.
    pub fn brief(&self) -> LastCheck {
        let figures = self.figures.as_ref();
        LastCheck {
            at: self.at,
            result: self.result,
            bias_mm: figures.map(|figures| figures.bias_mm),
            worst_mm: figures.map(|figures| figures.worst_mm),
            tolerance_mm: self.tolerance_mm,
        }
    }
}

fn figures(check: &PhantomCheck) -> CheckFigures {
    let line = check.line().map(|line| LineFigures {
        offset_mm: mm(line.offset_mm),
        offset_sd_mm: mm(line.offset_sd_mm),
        scale: share(line.scale),
        scale_sd: share(line.scale_sd),
    });
    let girth = |girth: &GirthCheck| GirthFigures {
        height_mm: mm(girth.height_mm),
        known_mm: mm(girth.known_mm),
        measured_mm: mm(girth.measured_mm),
        sd_mm: mm(girth.sd_mm),
    };
    CheckFigures {
        bias_mm: mm(check.bias_mm()),
        worst_mm: mm(check.worst_mm()),
        line,
        tilt_deg: degrees(check.tilt_deg),
        girths: check.girths.iter().map(girth).collect(),
    }
}
