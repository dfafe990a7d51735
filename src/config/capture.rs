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
    use Absent::Default;
    let window = reader.text("capture.window", Default("90s"), parse::duration_in("5s"..="1h"));
    let late = reader.text("capture.late", Default("90s"), parse::duration_in("0s"..="1h"));
    let words = parse::word(WITHOUT_TRIGGER);
    let without = reader.text("capture.without_trigger", Default("process"), words);
    let pattern = Default("^P?[0-9]{1,12}$");
    let pattern = reader.text("patient.pattern", pattern, parse::patient_pattern);
    let check = reader.text("patient.check_digit", Default("none"), parse::word(CHECK_DIGITS));
    let sidecar = reader.text("patient.sidecar", Default(""), parse::or_none(parse::file_name));
    let wait =
        reader.text("patient.sidecar_wait", Default("30s"), parse::duration_in("0s"..="10m"));
    let lasts = reader.text("patient.expires", Default("15m"), parse::duration_in("10s"..="24h"));
    let capture = CaptureConfig {
        window: window?.value,
        late: late?.value,
        without_trigger: without?.value,
        name_lasts: lasts?.value,
    };
    let patient = PatientConfig {
        pattern: pattern?.value,
        check_digit: check?.value,
        sidecar: sidecar?.value,
        sidecar_wait: wait?.value,
        orders: None,
        #[cfg(feature = "dicom")]
        worklist: None,
    };
    Some((capture, patient))
}
