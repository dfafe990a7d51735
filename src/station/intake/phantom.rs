//! Takes in a scan of the phantom: it is measured at once and added to the series of checks. It belongs to no
//! patient, so it answers no press and goes to no store; its file stays where it is.

use std::io;

use gaiter_flow::facts::PhantomFacts;
use gaiter_flow::phantom::{PHANTOM_ALARM, SHOWN_MOST};
use gaiter_record::phantom::{CheckRecord, CheckResult};
use gaiter_scan::Format;
use jiff::Timestamp;
use tracing::{info, warn};

use super::stable_read::Export;
use crate::config::PhantomConfig;
use crate::station::board::Board;
use crate::station::core::Core;
use crate::station::custody::phantom_series::PhantomSeries;
use crate::station::measure::{
    CheckJob, Ended, Job, JobAnswer, MeasureFault, Purpose, measure_bytes,
};

/// Why a scan of the phantom could not be taken now.
#[derive(Debug, thiserror::Error)]
pub enum CheckFault {
    /// It could not be measured now.
    #[error("it could not be measured now")]
    Measure(#[from] MeasureFault),
    /// The check could not be kept.
    #[error("the check could not be kept")]
    Series(#[from] io::Error),
}

/// Measures a settled scan of the phantom, unless it is in the series already. Blocks.
///
/// # Errors
/// [`CheckFault`]; the file must then be offered again.
pub fn take(
    core: &Core,
    phantom: &PhantomConfig,
    export: &Export,
    format: Format,
) -> Result<(), CheckFault> {
    let Some(series) = core.custody.phantom_series() else { return Ok(()) };
    if !series.holds(&export.scan) {
        let check = measured(core, phantom, export, format)?;
        log(&check);
        series.keep(check)?;
        note(&core.board, phantom, series);
    }
    Ok(())
}

/// Notes on the board what the series shows now.
pub fn note(board: &Board, phantom: &PhantomConfig, series: &PhantomSeries) {
    let known = PhantomFacts { every: phantom.every, checks: series.newest(SHOWN_MOST) };
    board.note(|facts| {
        match known.alarm() {
            Some(alarm) => _ = facts.alarms.insert(PHANTOM_ALARM, alarm),
            None => _ = facts.alarms.remove(PHANTOM_ALARM),
        }
        facts.phantom = Some(known);
    });
}

fn measured(
    core: &Core,
    phantom: &PhantomConfig,
    export: &Export,
    format: Format,
) -> Result<CheckRecord, MeasureFault> {
    // In whole seconds, as the time at which a scan was first seen.
    let now = Timestamp::now();
    let now = Timestamp::from_second(now.as_second()).unwrap_or(now);
    let purpose = Purpose::Check(Box::new(CheckJob {
        method: core.config.method.clone(),
        phantom: phantom.phantom.clone(),
        tolerance_mm: phantom.tolerance_mm,
        at: now,
        sha256: export.scan.to_string(),
    }));
    let (config, length) = (&core.config.measure, export.bytes.len() as u64);
    let job = Job::new(config, purpose, format.ending(), length);
    let measured = measure_bytes(Some(&export.scan), &job, &export.bytes)?;
    let not_measured = |why: String| {
        CheckRecord::not_measured(now, export.scan.to_string(), why, phantom.tolerance_mm)
    };
    Ok(match measured {
        Ended::Answered(JobAnswer::Checked(check)) => *check,
        Ended::Answered(JobAnswer::Refused { message, .. }) => not_measured(message),
        Ended::Answered(JobAnswer::Inspected(_) | JobAnswer::Files { .. }) => {
            not_measured("the measuring process gave no check".to_owned())
        }
        Ended::Trouble(trouble) => not_measured(trouble.to_string()),
    })
}

fn log(check: &CheckRecord) {
    let worst_mm = check.figures.as_ref().map(|figures| figures.worst_mm);
    match check.result {
        CheckResult::Within => info!(event = "phantom-within", worst_mm),
        CheckResult::Beyond => warn!(event = "phantom-beyond", worst_mm),
        CheckResult::NotMeasured => warn!(event = "phantom-not-measured", why = check.why),
    }
}
