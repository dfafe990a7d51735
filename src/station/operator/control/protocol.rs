//! What is said over the control socket. Both ends are of the same binary, so nothing here is kept
//! compatible; what `--json` prints is, and those parts say so.

use std::collections::BTreeMap;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::flow::account::{Filter, Listed, Seen, Whole};
use crate::flow::confinement::Confinement;
use crate::flow::facts::{Alarm, SourceFacts, SourceState, StoreFacts, TriggerFacts};
use crate::flow::health::Complaint;
use crate::station::booth::BoothState;

/// The longest request, bytes: a path and a patient's id fit many times over.
pub const REQUEST_MOST: u64 = 64 * 1024;

/// The longest list that is given.
pub const LIST_MOST: u32 = 1000;

/// The fewest digits that name a scan.
pub const DIGITS_LEAST: usize = 4;

/// What is asked of the station.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "ask")]
pub enum Request {
    /// How it is.
    Status,
    /// Its scans, newest first.
    Scans {
        /// Which; all if none.
        filter: Option<Filter>,
        /// At most so many.
        limit: u32,
    },
    /// One scan, with whose it is.
    Show {
        /// The beginning of its id.
        scan: String,
    },
    /// Why a scan is where it is.
    ExplainScan {
        /// The beginning of its id.
        scan: String,
    },
    /// Why a file is where it is.
    ExplainFile {
        /// Its full path, as the bytes of the file system.
        path: Vec<u8>,
    },
    /// A refused scan is to be tried again, and one that waits at once.
    Retry {
        /// The beginning of its id.
        scan: String,
    },
    /// A held scan is the patient's for whom it came in.
    Release {
        /// The beginning of its id.
        scan: String,
    },
    /// A scan that came in for nobody is this patient's.
    Assign {
        /// The beginning of its id.
        scan: String,
        /// The patient's id.
        patient: String,
    },
    /// A scan is not its patient's: it is nobody's again.
    Unassign {
        /// The beginning of its id.
        scan: String,
    },
    /// A refused scan, or a held one that is somebody's already, needs no decision any more.
    GiveUp {
        /// The beginning of its id.
        scan: String,
    },
    /// The next scan is this patient's.
    NameNext {
        /// The patient's id.
        patient: String,
        /// Another patient who is named and was not scanned is so no more; else this is refused then.
        #[serde(default = "replaces")]
        replace: bool,
    },
    /// Nobody is named for the next scan, and no press awaits its export.
    CallOff,
    /// Who is named for the next scan.
    Next,
    /// An order of the practice software names the patient of the next scan.
    Order {
        /// The bytes of the order's file.
        bytes: Vec<u8>,
    },
    /// No scan is to be taken until somebody resumes.
    Pause,
    /// Go on.
    Resume,
    /// The link to the operator's page.
    Page,
}

/// Naming a patient without more is meant.
fn replaces() -> bool {
    true
}

/// What the station answers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "is", content = "of")]
pub enum Answer {
    /// How it is.
    Status(Box<Status>),
    /// Scans, newest first.
    Scans(Vec<Listed>),
    /// One scan.
    Scan(Box<Whole>),
    /// A sentence for people.
    Sentence(String),
    /// Nothing was done.
    Fault(Fault),
}

/// Why nothing was done.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fault {
    /// Stable code.
    pub code: String,
    /// For people.
    pub message: String,
    /// Whose fault it is.
    pub kind: FaultKind,
}

/// Whose fault it is that nothing was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// What was asked makes no sense, or not in this state.
    Request,
    /// What was named is not known.
    Unknown,
    /// The station could not do it now.
    Failed,
}

/// How the station is; `gaiter status --json` prints it. Names no patient, file or folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// `gaiter.status/1`
    pub schema: String,
    /// Whether scans become records.
    pub ready: bool,
    /// What keeps them from it.
    pub complaints: Vec<Complaint>,
    /// The station's name.
    pub station: String,
    /// Version.
    pub gaiter: String,
    /// The process.
    pub pid: u32,
    /// When it began.
    pub started: Timestamp,
    /// For how long it has been running, s.
    pub running_s: u64,
    /// The moment of this answer.
    pub now: Timestamp,
    /// Whether scans are taken in: `open`, `paused` or `disk_low`.
    pub intake: String,
    /// The scan that has waited longest for its record.
    pub oldest: Option<Seen>,
    /// How long, s; none where that is not known, for the clock was set back.
    pub oldest_age_s: Option<u64>,
    /// The scan seen last.
    pub last: Option<Seen>,
    /// Scans by state; `held`, `closed` and `withdrawing` ones are counted in their own state too, but
    /// for refused ones that are closed. Empty where the journal cannot be read.
    pub scans: BTreeMap<String, u64>,
    /// The export folders, in the order of the configuration.
    pub sources: Vec<SourceStatus>,
    /// The record stores by name; none before the first delivery.
    pub stores: BTreeMap<String, StoreStatus>,
    /// The ports of the booth by name; none that the configuration does not name.
    pub triggers: BTreeMap<String, TriggerStatus>,
    /// The booth: its light, and what is awaited there.
    pub booth: BoothStatus,
    /// Room on the disk of the state folder, bytes.
    pub disk_free_bytes: Option<u64>,
    /// Size of that disk, bytes.
    pub disk_bytes: Option<u64>,
    /// The guards around measuring processes; none where they could not be tried.
    pub confinement: Option<Confinement>,
    /// Scans measured in this run.
    pub measured: u64,
    /// How long the last measurement took, s.
    pub last_measurement_s: Option<f64>,
    /// What a person must know, by code.
    pub alarms: BTreeMap<String, AlarmStatus>,
    /// What was wrong with the configuration at the last reload.
    pub refused_reload: Option<String>,
}

/// An export folder in a status.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SourceStatus {
    /// Its place in the configuration, from 0, as the log calls it.
    pub export_dir: usize,
    /// `not_looked`, `watched`, `out_of_reach`, `not_mounted` or `stalled`.
    pub state: String,
    /// Why.
    pub why: Option<String>,
    /// Since when.
    pub since: Timestamp,
    /// The kind of file system.
    pub file_system: Option<String>,
    /// It is looked through at its own pace only.
    pub polled: bool,
    /// When it was last looked through.
    pub last_look: Option<Timestamp>,
    /// Files not taken yet.
    pub waiting: usize,
    /// Of these, files that have waited longer than they should.
    pub overdue: usize,
    /// Files passed over.
    pub ignored: usize,
}

/// The booth in a status; names nobody.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct BoothStatus {
    /// What its light shows: `ready`, `armed`, `receiving`, `done`, `attention` or `no_export`.
    pub light: String,
    /// How many exports are awaited.
    pub awaited: usize,
    /// A patient is named for the next press.
    pub named: bool,
    /// A press may have gone unheard: scans of named patients are held.
    pub in_doubt: bool,
    /// What the configuration should say, by what has been seen; none where it is right.
    #[serde(default)]
    pub advice: Option<String>,
}

impl From<BoothState> for BoothStatus {
    fn from(state: BoothState) -> BoothStatus {
        let BoothState { signal, awaited, is_named, is_in_doubt, orders_come_late } = state;
        let light = signal.word().to_owned();
        let advice = orders_come_late.map(|late| late.to_string());
        BoothStatus { light, awaited, named: is_named, in_doubt: is_in_doubt, advice }
    }
}

/// A record store in a status.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StoreStatus {
    /// The last attempt's fault; none where it went well.
    pub fault: Option<String>,
    /// Since when.
    pub since: Timestamp,
}

/// A port of the booth in a status.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerStatus {
    /// `not_looked`, `absent`, `busy`, `denied`, `failed`, `settling`, `open`, `stuck` or `hung`.
    pub state: String,
    /// Why it is not listened to.
    pub why: Option<String>,
    /// Since when it is so.
    pub since: Timestamp,
    /// Presses in this run.
    pub presses: u64,
    /// Ids read in this run.
    pub ids: u64,
    /// Bytes or keys in this run that meant nothing.
    pub garbage: u64,
}

/// An alarm in a status.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AlarmStatus {
    /// In words.
    pub message: String,
    /// Since when.
    pub since: Timestamp,
}

impl Fault {
    /// A fault of this code.
    pub fn new(kind: FaultKind, code: &str, message: impl Into<String>) -> Fault {
        Fault { code: code.to_owned(), message: message.into(), kind }
    }
}

impl SourceStatus {
    /// The export folder at this place.
    pub fn of(export_dir: usize, facts: &SourceFacts) -> SourceStatus {
        let (state, why) = state_words(&facts.state);
        SourceStatus {
            export_dir,
            state: state.to_owned(),
            why: why.cloned(),
            since: facts.since,
            file_system: facts.file_system.clone(),
            polled: facts.polled,
            last_look: facts.last_look,
            waiting: facts.waiting.len(),
            overdue: facts.waiting.values().filter(|file| file.overdue).count(),
            ignored: facts.ignored.len(),
        }
    }
}

/// The word of an export folder's state, and why it is so.
pub fn state_words(state: &SourceState) -> (&'static str, Option<&String>) {
    match state {
        SourceState::NotLooked => ("not_looked", None),
        SourceState::Watched => ("watched", None),
        SourceState::OutOfReach(why) => ("out_of_reach", Some(why)),
        SourceState::NotMounted(why) => ("not_mounted", Some(why)),
        SourceState::Taken => ("taken", None),
        SourceState::Stalled => ("stalled", None),
    }
}

impl From<&StoreFacts> for StoreStatus {
    fn from(facts: &StoreFacts) -> StoreStatus {
        StoreStatus { fault: facts.fault.clone(), since: facts.since }
    }
}

impl From<&TriggerFacts> for TriggerStatus {
    fn from(facts: &TriggerFacts) -> TriggerStatus {
        TriggerStatus {
            state: facts.state.word().to_owned(),
            why: facts.why.clone(),
            since: facts.since,
            presses: facts.presses,
            ids: facts.ids,
            garbage: facts.garbage,
        }
    }
}

impl From<&Alarm> for AlarmStatus {
    fn from(alarm: &Alarm) -> AlarmStatus {
        AlarmStatus { message: alarm.message.clone(), since: alarm.since }
    }
}
