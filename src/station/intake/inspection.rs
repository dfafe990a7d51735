//! What intake must know of an export's content, asked of a confined process: the station itself never reads
//! what the scanner wrote.

use std::sync::Mutex;

use gaiter_scan::{End, Format};

use super::stable_read::Export;
use crate::station::core::Core;
use crate::station::delivery::measuring::{self, TRIES_MAX};
use crate::station::measure::{
    self, Blame, Ended, Inspection, Job, JobAnswer, MeasureFault, Purpose, Trouble,
};
use crate::station::runtime::{chain, locked};

/// Why an export could not be inspected now. The machine is at fault, and the file waits where it is.
#[derive(Debug, thiserror::Error)]
pub enum InspectFault {
    /// The process could not be started or could not be fed.
    #[error(transparent)]
    NotStarted(#[from] MeasureFault),
    /// It ended without an answer.
    #[error("inspecting the export gave no answer")]
    Unanswered(#[source] Trouble),
}

/// Held while an export is inspected: of the processes that may use their whole memory, only one more than those
/// that measure.
static ALONE: Mutex<()> = Mutex::new(());

/// What is known of an export whose content shows nothing, or nothing new: it continues; where it is new, it is
/// refused when it is measured.
pub const NOTHING_SHOWN: Inspection = Inspection { end: End::Whole, fingerprint: None };

/// Inspects an export. Blocks.
///
/// # Errors
/// [`InspectFault`]; the file must then be offered again.
pub fn inspected(core: &Core, export: &Export, format: Format) -> Result<Inspection, InspectFault> {
    let _alone = locked(&ALONE);
    let found = asked(core, export, format);
    match &found {
        Ok(_) => measuring::note_possible(core),
        Err(fault) => measuring::note_impaired(&core.board, &chain(fault)),
    }
    found
}

fn asked(core: &Core, export: &Export, format: Format) -> Result<Inspection, InspectFault> {
    let (config, length) = (&core.config.measure, export.bytes.len() as u64);
    let job = Job::new(config, Purpose::Inspection, format.ending(), length);
    let mut tries = 0;
    loop {
        let trouble = match measure::measure_bytes(None, &job, &export.bytes)? {
            Ended::Answered(JobAnswer::Inspected(found)) => return Ok(found),
            // The reader panicked.
            Ended::Answered(_) => return Ok(NOTHING_SHOWN),
            Ended::Trouble(trouble) => trouble,
        };
        tries += 1;
        let is_the_scans = match trouble.blame() {
            Blame::Scan => true,
            Blame::Machine => false,
            Blame::Either if tries < TRIES_MAX => continue,
            // If other bytes cannot be read either, the machine is at fault.
            Blame::Either => measure::answers(&job)?,
        };
        return match is_the_scans {
            true => Ok(NOTHING_SHOWN),
            false => Err(InspectFault::Unanswered(trouble)),
        };
    }
}
