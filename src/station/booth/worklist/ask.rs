//! Asks the server of a worklist: the one place that knows how (C-FIND of the Modality Worklist Information Model).

use gaiter_flow::cause::Cause;
use gaiter_flow::worklist::WorklistEntry;
use jiff::civil::Date;

use crate::config::WorklistConfig;

/// Why there is no answer. None holds what a server sent: it may be a name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum WorklistFault {
    /// This program was made without DICOM.
    #[error("this gaiter was built without its feature dicom")]
    NotBuilt,
}

impl WorklistFault {
    /// Why, as data.
    pub fn cause(&self) -> Cause {
        match self {
            WorklistFault::NotBuilt => Cause::verbatim(self),
        }
    }
}

/// The entries that the server has for this station on a day. Blocks, for as long as `config.limit` allows each of
/// its answers.
///
/// # Errors
/// [`WorklistFault`]: nothing is known then, and an earlier answer still holds.
pub fn ask(config: &WorklistConfig, day: Date) -> Result<Vec<WorklistEntry>, WorklistFault> {
    let _ = (config, day);
    Err(WorklistFault::NotBuilt)
}
