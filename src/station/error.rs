//! Why the whole station ends. A fault of a single scan never ends it.

use std::fmt;
use std::io;
use std::path::PathBuf;

use tokio::task::JoinError;

use super::custody::CustodyFault;
use super::journal::{JournalError, LockError};
use super::measure::ConfineFault;

/// Why the station could not start or had to end. The journal makes a restart harmless.
#[derive(Debug, thiserror::Error)]
pub enum StationError {
    /// The state folder could not be made or opened.
    #[error("preparing the state folder {path} failed")]
    State {
        /// The folder.
        path: PathBuf,
        #[source]
        source: io::Error,
    },
    /// The state folder is another user's.
    #[error(
        "the state folder {path} belongs to another user, who could read and change what the station \
         keeps there: give it to the station's user (chown)"
    )]
    StateOfAnother {
        /// The folder.
        path: PathBuf,
    },
    /// The state folder could not be locked.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// Another station uses an export folder.
    #[error(
        "another station on this machine already uses the export folder {path}: every scan would \
         get two records"
    )]
    ExportTaken {
        /// The folder.
        path: PathBuf,
    },
    /// The journal could not be opened.
    #[error("opening the journal {path} failed")]
    Journal {
        path: PathBuf,
        #[source]
        source: JournalError,
    },
    /// A corrupt journal could not be set aside.
    #[error("setting a corrupt journal aside failed")]
    SetAside {
        #[source]
        source: io::Error,
    },
    /// The state of the last run could not be taken over.
    #[error("restoring the state of the last run failed")]
    Recovery(#[source] CustodyFault),
    /// The pattern of patient ids cannot be applied to a whole id.
    #[error("the pattern of patient ids cannot be used")]
    Pattern(#[from] regex::Error),
    /// Measuring processes cannot be confined as the configuration requires.
    #[error("measuring processes cannot be confined")]
    Unconfined(#[source] ConfineFault),
    /// Earlier work does not end, and the station must not run beside it.
    #[error("running work did not end in time; restart the process")]
    Stuck,
    /// The start panicked.
    #[error("the start panicked")]
    Start(#[source] JoinError),
    /// A worker panicked, or a step of its own.
    #[error("{worker} panicked")]
    WorkerPanicked {
        worker: Worker,
        #[source]
        source: JoinError,
    },
    /// A worker ended without being asked to.
    #[error("{worker} ended unexpectedly")]
    WorkerStopped { worker: Worker },
}

/// The workers of a station.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Worker {
    /// Looks at one export folder and takes in files that have settled.
    Intake {
        /// The folder's place in the configuration, from 0.
        folder: usize,
    },
    /// Looks for orders of practice software.
    Orders,
    /// Asks for the worklist.
    Worklist,
    /// Measures scans and makes deliveries.
    Delivery,
    /// Shows the legs of held scans.
    Preview,
    /// Keeps captures and the light.
    Booth,
    /// Removes what is no longer needed.
    Housekeeping,
    /// Tells an archive of many stations how this one is.
    Fleet,
    /// Serves the page, metrics and health, and answers on the control socket.
    Http,
    /// Serves a port of the booth.
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
            Worker::Worklist => f.write_str("the worklist"),
            Worker::Delivery => f.write_str("the delivery"),
            Worker::Preview => f.write_str("the previews"),
            Worker::Booth => f.write_str("the booth"),
            Worker::Housekeeping => f.write_str("the housekeeping"),
            Worker::Fleet => f.write_str("the heartbeat for the archive"),
            Worker::Http => f.write_str("the page and the control socket"),
            Worker::Trigger { port } => write!(f, "the {port} port"),
        }
    }
}
