//! Why the whole station ends. A single scan's faults never do that.

use std::fmt;
use std::io;
use std::path::PathBuf;

use tokio::task::JoinError;

use super::custody::CustodyFault;
use super::delivery::measure::ConfineFault;
use super::journal::{JournalError, LockError};

/// Why the station could not start or had to end. The journal makes a restart harmless.
#[derive(Debug, thiserror::Error)]
pub enum StationError {
    /// The state folder could not be made or opened.
    #[error("preparing the state folder {path} failed")]
    State {
        /// The folder.
        path: PathBuf,
        /// How it failed.
        #[source]
        source: io::Error,
    },
    /// The state folder is not ours.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// An export folder is another station's.
    #[error(
        "another station on this machine works the export folder {path}: every scan would get two \
         records"
    )]
    ExportTaken {
        /// The folder.
        path: PathBuf,
    },
    /// The journal could not be opened.
    #[error("opening the journal {path} failed")]
    Journal {
        /// The journal.
        path: PathBuf,
        /// How it failed.
        #[source]
        source: JournalError,
    },
    /// A ruined journal could not be set aside.
    #[error("setting a ruined journal aside failed")]
    SetAside {
        /// How it failed.
        #[source]
        source: io::Error,
    },
    /// The state of the last run could not be taken up.
    #[error("taking up the state of the last run failed")]
    Recovery(#[source] CustodyFault),
    /// The pattern of patient ids cannot be applied to a whole id.
    #[error("the pattern of patient ids cannot be used")]
    Pattern(#[from] regex::Error),
    /// Measuring processes cannot be confined as the configuration requires.
    #[error("measuring processes cannot be confined")]
    Unconfined(#[source] ConfineFault),
    /// Work of before does not end, and the station must not go on beside it.
    #[error(
        "work in hand did not end in time for a new beginning; the process is to be started again"
    )]
    Stuck,
    /// The start was cut off by a panic.
    #[error("the start panicked")]
    Start(#[source] JoinError),
    /// A worker panicked.
    #[error("{worker} panicked")]
    WorkerPanicked {
        /// Which.
        worker: Worker,
        /// Its end.
        #[source]
        source: JoinError,
    },
    /// A worker could not go on.
    #[error("{worker} could not go on")]
    WorkerFailed {
        /// Which.
        worker: Worker,
        /// Why.
        #[source]
        source: JoinError,
    },
    /// A worker ended although nobody asked it to.
    #[error("{worker} ended unasked")]
    WorkerStopped {
        /// Which.
        worker: Worker,
    },
}

/// The workers of a station.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Worker {
    /// Looks at one export folder and takes what has settled.
    Intake {
        /// The folder's place in the configuration, from 0.
        folder: usize,
    },
    /// Looks for orders of practice software.
    Orders,
    /// Measures scans and makes deliveries.
    Delivery,
    /// Shows the legs of held scans.
    Preview,
    /// Keeps captures and the light.
    Booth,
    /// Lets go what has served.
    Housekeeping,
    /// Answers on the control socket.
    Control,
    /// Gives metrics and health.
    Http,
    /// Attends a port of the booth.
    Trigger {
        /// The port's name.
        port: &'static str,
    },
}

impl fmt::Display for Worker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Worker::Intake { folder } => write!(f, "the intake of export folder {folder}"),
            Worker::Orders => f.write_str("the orders"),
            Worker::Delivery => f.write_str("the delivery"),
            Worker::Preview => f.write_str("the previews"),
            Worker::Booth => f.write_str("the booth"),
            Worker::Housekeeping => f.write_str("the housekeeping"),
            Worker::Http => f.write_str("the metrics and health"),
            Worker::Trigger { port } => write!(f, "the {port} port"),
            Worker::Control => f.write_str("the control socket"),
        }
    }
}

/// An error and its causes in one line.
pub fn chain(error: &dyn std::error::Error) -> String {
    let mut line = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        line = format!("{line}: {error}");
        cause = error.source();
    }
    line
}
