//! Events for observers of the station, such as `gaiter demo`. They are not the log: an event may name
//! files and folders, which the log never does.

use std::ffi::OsString;
use std::path::PathBuf;

use tokio::sync::mpsc::UnboundedSender;

use gaiter_flow::ScanId;

/// Something that happened at the station.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StationEvent {
    /// The journal is open and every folder in reach has been looked at.
    Ready,
    Pressed,
    NoExport,
    /// Its format shows that more data will come; the station waits for it.
    AwaitsRest {
        /// Its name.
        file: OsString,
    },
    /// A new scan is safely in the spool.
    Spooled {
        /// Its name at the scanner.
        file: OsString,
        /// First digits of its id.
        scan: String,
    },
    /// The same bytes were seen for another patient; an operator decides.
    Held {
        /// First digits of the scan's id.
        scan: String,
    },
    /// A scan was refused and is in quarantine.
    Refused {
        /// Stable code.
        code: String,
        /// Message for the operator.
        message: String,
    },
    /// A delivery did not succeed and will be tried again.
    PutOff {
        /// First digits of the scan's id.
        scan: String,
        /// Stable code.
        code: String,
    },
    /// A record is in the store.
    Delivered {
        /// First digits of the scan's id.
        scan: String,
        /// The record's folder.
        folder: PathBuf,
    },
}

/// An observer, if there is one.
#[derive(Debug, Clone, Default)]
pub struct Observer(pub Option<UnboundedSender<StationEvent>>);

impl Observer {
    /// Sends an event. A receiver that is gone is not an error.
    pub fn notify(&self, event: StationEvent) {
        if let Some(sender) = &self.0 {
            let _ = sender.send(event);
        }
    }
}

/// The first digits of a scan's id, as events carry them.
pub fn short(scan: &ScanId) -> String {
    scan.short().to_owned()
}
