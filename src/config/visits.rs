//! `[visits]`: how the visits of a patient are compared.

use std::time::Duration;

use super::fault::What;
use super::parse::{self, Bounds};
use super::reader::{Absent, Reader};
use super::words::{LIMBS, LIMITED};
use crate::visits::threshold::{Limited, Threshold};

/// `[visits]`: how the visits of a patient are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct VisitsConfig {
    /// A scan that is older than this is told as old.
    pub max_age: Duration,
    /// The clinic's own thresholds, in the order of the file.
    pub thresholds: Vec<Threshold>,
}

impl VisitsConfig {
    /// How old a scan may be, whole days.
    pub fn max_age_days(&self) -> i64 {
        const HOUR_S: u64 = 3600;
        i64::try_from(self.max_age.as_secs() / (24 * HOUR_S)).unwrap_or(i64::MAX)
    }
}

impl Default for VisitsConfig {
    fn default() -> VisitsConfig {
        VisitsConfig { max_age: MAX_AGE, thresholds: Vec::new() }
    }
}

/// How old a scan may be if nothing is configured: suppliers measure again after six months.
const MAX_AGE: Duration = Duration::from_secs(180 * 24 * 3600);

/// Reads the keys of the section.
pub(super) fn config(reader: &mut Reader) -> Option<VisitsConfig> {
    let bounds = Bounds { least: "24h", most: "87600h" };
    let max_age =
        reader.text("visits.max_age", Absent::Default("4320h"), parse::duration_in(bounds));
    let thresholds = reader.tables("visits.thresholds", "visits.thresholds.", threshold);
    Some(VisitsConfig { max_age: max_age?.value, thresholds })
}

/// A threshold: its name, its source, the limb it was made for, what it limits and the limit.
fn threshold(reader: &mut Reader) -> Option<Threshold> {
    use Absent::Required;
    let text = |text: &str| match text.trim() {
        "" => Err(What::EmptyText),
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
    let number = text.strip_suffix(of.unit()).filter(|number| {
        number.starts_with(|c: char| c.is_ascii_digit())
            && number.chars().all(|c| c.is_ascii_digit() || c == '.')
    });
    let limit = number.and_then(|number| number.parse().ok()).filter(|limit| *limit > 0.0);
    limit.ok_or_else(|| What::NotALimit { text: text.to_owned(), unit: of.unit() })
}
