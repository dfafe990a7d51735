//! `[capture]` and `[patient]`: which export belongs to which press, and to whom.

use std::collections::BTreeSet;
use std::time::Duration;

use gaiter_flow::OrdersWhen;
use gaiter_flow::patient::check_digit::CheckDigit;
use gaiter_flow::round::Rules;
use regex::Regex;

use super::OrdersConfig;
use super::parse::{self, Absent, Reader};
use super::words::{CHECK_DIGITS, WITHOUT_TRIGGER, WithoutTrigger};

/// `[capture]`: how the station waits for the export of a press.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CaptureConfig {
    /// How long to wait for the export.
    pub window: Duration,
    /// How long after that a late export is still accepted; it is then held.
    pub late: Duration,
    /// What happens to an export without a press.
    pub without_trigger: WithoutTrigger,
    /// How long the name of the next patient stays valid.
    pub name_lasts: Duration,
}

/// `[patient]`: what an id may be and how it becomes known.
#[derive(Debug, Clone)]
pub struct PatientConfig {
    /// What a patient id may be, from any source; matched against the whole id.
    pub pattern: Regex,
    /// The check-digit scheme of ids.
    pub check_digit: CheckDigit,
    /// Regular expression that finds the id on a line of the scanner's own measures.
    pub sidecar: Option<Regex>,
    /// How long a scan waits for those measures; without `sidecar` nothing waits.
    pub sidecar_wait: Duration,
    /// `[patient.orders]`: where orders from practice software arrive, if configured.
    pub orders: Option<OrdersConfig>,
    /// `[patient.worklist]`: the worklist of a hospital system, if configured.
    #[cfg(feature = "dicom")]
    pub worklist: Option<super::WorklistConfig>,
}

impl CaptureConfig {
    /// The capture rules for a station with buttons on these ports and the practice's habit.
    pub fn rules(&self, buttons: &BTreeSet<&str>, orders: OrdersWhen) -> Rules {
        let CaptureConfig { window, late, name_lasts, .. } = *self;
        Rules { by_press: !buttons.is_empty(), window, late, name_lasts, orders }
    }
}

/// Reads the keys of both sections.
pub(super) fn config(reader: &mut Reader) -> Option<(CaptureConfig, PatientConfig)> {
    let window = reader.value("capture.window", "90s", parse::duration_in("5s"..="1h"))?;
    let late = reader.value("capture.late", "90s", parse::duration_in("0s"..="1h"))?;
    let words = parse::word(WITHOUT_TRIGGER);
    let without_trigger = reader.value("capture.without_trigger", "process", words)?;
    let pattern = Absent::Default("^P?[0-9]{1,12}$");
    let pattern = reader.text("patient.pattern", pattern, parse::patient_pattern);
    let check_digit = reader.value("patient.check_digit", "none", parse::word(CHECK_DIGITS))?;
    let sidecar = reader.value("patient.sidecar", "", parse::or_none(parse::file_name))?;
    let sidecar_wait =
        reader.value("patient.sidecar_wait", "30s", parse::duration_in("0s"..="10m"))?;
    let name_lasts = reader.value("patient.expires", "15m", parse::duration_in("10s"..="24h"))?;
    let patient = PatientConfig {
        pattern: pattern?.value,
        check_digit,
        sidecar,
        sidecar_wait,
        orders: None,
        #[cfg(feature = "dicom")]
        worklist: None,
    };
    Some((CaptureConfig { window, late, without_trigger, name_lasts }, patient))
}
