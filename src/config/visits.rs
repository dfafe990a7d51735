//! `[visits]`: how the visits of a patient are compared.

use gaiter_record::report::AgeMax;
use gaiter_visits::threshold::{Limited, Threshold};

use super::parse::{self, Absent, Reader, What};
use super::words::{LIMBS, LIMITED};

/// `[visits]`: how the visits of a patient are compared.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VisitsConfig {
    /// The clinic's own thresholds, in the order of the file.
    pub thresholds: Vec<Threshold>,
}

/// Reads `report.max_age`: how old a scan may be for an order, whole days.
pub(super) fn age_max(reader: &mut Reader) -> Option<AgeMax> {
    const DAY_S: u64 = 24 * 3600;
    let max_age = reader.value("report.max_age", "4320h", parse::duration_in("24h"..="87600h"))?;
    u32::try_from(max_age.as_secs() / DAY_S).ok().map(AgeMax)
}

/// Reads the keys of the section.
pub(super) fn config(reader: &mut Reader) -> VisitsConfig {
    let thresholds = reader.tables("visits.thresholds", threshold);
    VisitsConfig { thresholds }
}

/// A threshold: its name, its source, the limb it was made for, what it limits and the limit.
fn threshold(reader: &mut Reader) -> Option<Threshold> {
    use Absent::Required;
    let text = |text: &str| match text.trim() {
        "" => Err(What::own("must not be empty", "write a text that people understand")),
        text => Ok(text.to_owned()),
    };
    let name = reader.text("visits.thresholds.name", Required("DXA, mild"), text);
    let source =
        reader.text("visits.thresholds.source", Required("Lymphat Res Biol 2018;16:75"), text);
    let limb = reader.text("visits.thresholds.limb", Required("leg"), parse::word(LIMBS));
    let of = reader.text("visits.thresholds.of", Required("excess"), parse::word(LIMITED));
    let limit = reader.text("visits.thresholds.limit", Required("3%"), |text| match of.as_ref() {
        Some(of) => limit(of.value, text),
        None => Ok(0.0),
    });
    limb?;
    Some(Threshold { name: name?.value, source: source?.value, of: of?.value, limit: limit?.value })
}

/// A limit with the unit of what it limits.
fn limit(of: Limited, text: &str) -> Result<f64, What> {
    let limit = parse::decimal(text, of.unit()).filter(|limit| *limit > 0.0);
    limit.ok_or_else(|| {
        let hint = match of.unit() {
            _ if text.to_lowercase().ends_with("ml") => {
                "no limit is in mL: that of arms does not hold for legs"
            }
            "%" => r#"write a number and %: "3%", "4.5%""#,
            _ => r#"write a number and mm: "20mm""#,
        };
        What::own(format!("\"{text}\" is not a limit in {}", of.unit()), hint)
    })
}
