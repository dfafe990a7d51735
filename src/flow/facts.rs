//! What the station knows of itself at one moment, for those who ask: `gaiter status`, metrics,
//! health. Workers note their own part; nothing here decides anything.

use std::collections::BTreeMap;
use std::path::PathBuf;

use jiff::Timestamp;
use serde::Serialize;

use super::confinement::Confinement;
use super::trigger::PortState;

/// Everything that is known of a running station besides its journal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Facts {
    /// When this run began.
    pub started: Timestamp,
    /// The export folders, in the order of the configuration.
    pub sources: Vec<SourceFacts>,
    /// The record stores by their name in the journal.
    pub stores: BTreeMap<&'static str, StoreFacts>,
    /// The ports of the booth by their names: serial, usb, keys, reader.
    pub triggers: BTreeMap<&'static str, TriggerFacts>,
    /// The endpoints of the page whose address cannot be had, and why: local, network.
    pub endpoints: BTreeMap<&'static str, String>,
    /// Whether scans are taken in.
    pub intake: IntakeState,
    /// What a person must know and nothing else shows, by code; kept until the station restarts.
    pub alarms: BTreeMap<&'static str, Alarm>,
    /// What was wrong with the configuration at the last reload; none when it was taken up.
    pub refused_reload: Option<String>,
    /// The guards around measuring processes; none where they could not be tried.
    pub confinement: Option<Confinement>,
    /// Scans measured in this run, refused ones included.
    pub measured: u64,
    /// How long the last measurement took, seconds.
    pub last_measurement_s: Option<f64>,
}

/// One export folder.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SourceFacts {
    /// The folder; none before its worker has begun. Paths are never shown in a status.
    #[serde(skip)]
    pub folder: Option<PathBuf>,
    /// How it is.
    pub state: SourceState,
    /// Since when.
    pub since: Timestamp,
    /// The kind of file system it lies on, such as "ext4" or "SMB"; none before the first look.
    pub file_system: Option<String>,
    /// Changes are not reported there: it is looked through at its own pace only.
    pub polled: bool,
    /// When it was last looked through to the end.
    pub last_look: Option<Timestamp>,
    /// Files that are not taken yet, and why. Names may name patients: never shown in a status.
    #[serde(skip)]
    pub waiting: BTreeMap<PathBuf, WaitingFile>,
    /// Files that are passed over, and why. Never shown in a status either.
    #[serde(skip)]
    pub ignored: BTreeMap<PathBuf, &'static str>,
}

/// How an export folder is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "is", content = "why")]
pub enum SourceState {
    /// It has not been looked at yet.
    NotLooked,
    /// It is looked through.
    Watched,
    /// It cannot be listed; the error without the path.
    OutOfReach(String),
    /// It is there, but what should be mounted is not.
    NotMounted(String),
    /// Another station on this machine works it.
    Taken,
    /// A look has not come back for longer than its deadline.
    Stalled,
}

/// A file that is not taken yet.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct WaitingFile {
    /// What it waits for, in words that follow "it".
    pub why: String,
    /// Since when, as the station's wall clock says.
    pub since: Timestamp,
    /// It has waited longer than a file should.
    pub overdue: bool,
}

/// One record store.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StoreFacts {
    /// The last attempt's fault; none where it went well.
    pub fault: Option<String>,
    /// Since when it is so.
    pub since: Timestamp,
}

/// One port of the booth.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TriggerFacts {
    /// How it is.
    pub state: PortState,
    /// Why it is not listened to, without its path.
    pub why: Option<String>,
    /// Since when it is so.
    pub since: Timestamp,
    /// Since when it has not been listened to for a while without a break; none where it has.
    pub unsound_since: Option<Timestamp>,
    /// Presses in this run.
    pub presses: u64,
    /// Ids read in this run.
    pub ids: u64,
    /// Bytes or keys in this run that meant nothing.
    pub garbage: u64,
}

impl TriggerFacts {
    /// A port that has not been looked for.
    pub fn new(now: Timestamp) -> TriggerFacts {
        TriggerFacts {
            state: PortState::NotLooked,
            why: None,
            since: now,
            unsound_since: Some(now),
            presses: 0,
            ids: 0,
            garbage: 0,
        }
    }
}

/// Whether scans are taken in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "is")]
pub enum IntakeState {
    /// They are.
    Open,
    /// A person has paused the station.
    Paused,
    /// The disk of the state folder is nearly full; exports stay where they are.
    DiskLow {
        /// What is free, bytes.
        free: u64,
        /// What must stay free, bytes.
        floor: u64,
    },
}

/// Something a person must know.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Alarm {
    /// In words.
    pub message: String,
    /// Since when.
    pub since: Timestamp,
}

impl Facts {
    /// A station that has just begun.
    pub fn new(started: Timestamp, sources: usize) -> Facts {
        let source = SourceFacts {
            folder: None,
            state: SourceState::NotLooked,
            since: started,
            file_system: None,
            polled: false,
            last_look: None,
            waiting: BTreeMap::new(),
            ignored: BTreeMap::new(),
        };
        Facts {
            started,
            sources: vec![source; sources],
            stores: BTreeMap::new(),
            triggers: BTreeMap::new(),
            endpoints: BTreeMap::new(),
            intake: IntakeState::Open,
            alarms: BTreeMap::new(),
            refused_reload: None,
            confinement: None,
            measured: 0,
            last_measurement_s: None,
        }
    }
}
