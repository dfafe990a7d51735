//! The station's status, as an answer of the control socket; `gaiter status --json` prints it.

use std::collections::BTreeMap;

use gaiter_flow::account::Seen;
use gaiter_flow::cause::Cause;
use gaiter_flow::complaint::Complaint;
use gaiter_flow::confinement::Confinement;
use gaiter_flow::facts::{
    Alarm, SourceFacts, StoreFacts, StoreRefusal, TriggerFacts, WorklistFacts,
};
use gaiter_flow::orders::OrdersComeLate;
use gaiter_flow::views::ViewsSeries;
use gaiter_language::Language;
use gaiter_record::phantom::LastCheck;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::station::booth::BoothState;

/// The station's status. It names no patient, file or folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// `gaiter.status/1`
    pub schema: String,
    /// Whether scans become records.
    pub ready: bool,
    /// What prevents that, and what a person should know.
    pub complaints: Vec<ComplaintStatus>,
    /// The station's name.
    pub station: String,
    /// Gaiter's version.
    pub gaiter: String,
    pub pid: u32,
    pub started: Timestamp,
    /// How long it has been running, s.
    pub running_s: u64,
    /// The time of this answer.
    pub now: Timestamp,
    /// Whether scans are taken in: `open`, `paused` or `disk_low`.
    pub intake: String,
    /// The scan that has waited longest for its record.
    pub oldest: Option<Seen>,
    /// How long it has waited, s; `None` if unknown because the clock was set back.
    pub oldest_age_s: Option<u64>,
    /// The scan seen last.
    pub last: Option<Seen>,
    /// Scans by state. `held`, `closed` and `withdrawing` scans are counted in their own state too,
    /// except refused ones that are closed. Empty if the journal cannot be read.
    pub scans: BTreeMap<String, u64>,
    /// The export folders, in the order of the configuration.
    pub sources: Vec<SourceStatus>,
    /// The record stores by name; empty before the first delivery.
    pub stores: BTreeMap<String, StoreStatus>,
    /// The ports of the booth by name; only those that the configuration names.
    pub triggers: BTreeMap<String, TriggerStatus>,
    /// The booth: its light, and what is awaited there.
    pub booth: BoothStatus,
    /// Free space on the disk of the state folder, bytes.
    pub disk_free_bytes: Option<u64>,
    /// Size of that disk, bytes.
    pub disk_bytes: Option<u64>,
    /// The guards around measuring processes; `None` if they could not be tried.
    pub confinement: Option<Confinement>,
    /// Scans measured in this run.
    pub measured: u64,
    /// How long the last measurement took, s.
    pub last_measurement_s: Option<f64>,
    /// The checks with the phantom; `None` if none is configured.
    #[serde(default)]
    pub phantom: Option<PhantomStatus>,
    /// The worklist; `None` if none is configured.
    #[serde(default)]
    pub worklist: Option<WorklistStatus>,
    /// What the last scans show about the scanner's cameras, oldest first.
    #[serde(default)]
    pub views: ViewsSeries,
    /// What an operator must know, by code.
    pub alarms: BTreeMap<String, AlarmStatus>,
    /// What was wrong with the configuration at the last reload.
    pub refused_reload: Option<String>,
}

/// What keeps the station from being ready, or what a person should know, for programs in English.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComplaintStatus {
    #[serde(flatten)]
    pub complaint: Complaint,
    /// What is wrong, a sentence without its full stop.
    pub message: String,
    /// What the technician can do, in the same form.
    pub remedy: String,
}

impl From<Complaint> for ComplaintStatus {
    fn from(complaint: Complaint) -> ComplaintStatus {
        let (message, remedy) = (complaint.message(Language::En), complaint.remedy(Language::En));
        ComplaintStatus { complaint, message, remedy }
    }
}

/// The status of an export folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SourceStatus {
    /// Its place in the configuration, from 0, as in the log.
    pub export_dir: usize,
    /// `not_looked`, `watched`, `out_of_reach`, `not_mounted`, `taken` or `stalled`.
    pub state: String,
    /// Why, in English.
    pub why: Option<String>,
    /// The same as data, for people of another language.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<Cause>,
    pub since: Timestamp,
    /// The kind of file system.
    pub file_system: Option<String>,
    /// It has no watch and is only polled.
    pub polled: bool,
    /// When it was last looked through.
    pub last_look: Option<Timestamp>,
    /// Files not taken yet.
    pub waiting: usize,
    /// Of these, files that have waited longer than they should.
    pub overdue: usize,
    /// Files ignored.
    pub ignored: usize,
    /// How much is ignored that may be an export, by its reason: `sub_folder`, `too_deep`, `no_access`,
    /// `link`, `packed`; `hidden` or `unfinished` for long.
    #[serde(default)]
    pub unread: BTreeMap<String, usize>,
    /// Exports that were overwritten or deleted before they were taken.
    #[serde(default)]
    pub gone: usize,
}

/// The status of the booth; names no patient.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct BoothStatus {
    /// What its light shows: `ready`, `armed`, `receiving`, `done`, `attention` or `no_export`.
    pub light: String,
    pub awaited: usize,
    /// A patient is named for the next press.
    pub named: bool,
    /// A press may have been missed: scans of named patients are held.
    pub in_doubt: bool,
    /// A suggested change of the configuration, from what has been seen; `None` if it is right.
    #[serde(default)]
    pub advice: Option<String>,
    /// The same as figures.
    #[serde(default)]
    pub orders_come_late: Option<OrdersComeLate>,
}

impl From<BoothState> for BoothStatus {
    fn from(state: BoothState) -> BoothStatus {
        let BoothState { signal, awaited, is_named, is_in_doubt, orders_come_late, .. } = state;
        let light = signal.word().to_owned();
        let advice = orders_come_late.map(|late| late.in_words(Language::En));
        BoothStatus {
            light,
            awaited,
            named: is_named,
            in_doubt: is_in_doubt,
            advice,
            orders_come_late,
        }
    }
}

/// The status of the checks with the phantom.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PhantomStatus {
    /// Whether it should be scanned now.
    pub due: bool,
    /// The last checks, oldest first, a month at most.
    pub checks: Vec<LastCheck>,
}

/// The status of the worklist; names no patient.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WorklistStatus {
    /// The last attempt's fault in English; `None` if there was an answer, or no attempt yet.
    pub fault: Option<String>,
    /// The same as data, for people of another language.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<Cause>,
    pub since: Timestamp,
    /// When it last gave an answer.
    pub answered: Option<Timestamp>,
    /// How many entries can be chosen.
    pub entries: usize,
    /// How many entries of this station name no patient.
    pub left_out: usize,
}

/// The status of a record store.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StoreStatus {
    /// The last attempt's fault in English; `None` if it succeeded.
    pub fault: Option<String>,
    /// The same as data, for people of another language.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<Cause>,
    /// The fault is that the practice software has not fetched the last result.
    #[serde(default)]
    pub waits_for_fetch: bool,
    pub since: Timestamp,
}

/// The status of a port of the booth.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerStatus {
    /// `not_looked`, `absent`, `busy`, `denied`, `failed`, `settling`, `open`, `stuck` or `hung`.
    pub state: String,
    /// Why it is not listened to, in English.
    pub why: Option<String>,
    /// The same as data, for people of another language.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<Cause>,
    pub since: Timestamp,
    /// Presses in this run.
    pub presses: u64,
    /// Ids read in this run.
    pub ids: u64,
    /// Bytes or keys in this run that had no meaning.
    pub garbage: u64,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AlarmStatus {
    /// Message for people.
    pub message: String,
    pub since: Timestamp,
}

impl SourceStatus {
    /// The status of the export folder at this place.
    pub fn from_facts(export_dir: usize, facts: &SourceFacts) -> SourceStatus {
        let unread = facts.passed_over.iter().filter(|(why, _)| why.is_unread());
        SourceStatus {
            export_dir,
            state: facts.state.word().to_owned(),
            why: facts.state.why().map(Cause::to_string),
            cause: facts.state.why().cloned(),
            since: facts.since,
            file_system: facts.file_system.clone(),
            polled: facts.polled,
            last_look: facts.last_look,
            waiting: facts.waiting.len(),
            overdue: facts.waiting.values().filter(|file| file.overdue).count(),
            ignored: facts.ignored.len(),
            unread: unread.map(|(why, count)| (why.word().to_owned(), *count)).collect(),
            gone: facts.gone_count,
        }
    }
}

impl From<&StoreFacts> for StoreStatus {
    fn from(facts: &StoreFacts) -> StoreStatus {
        let refusal = facts.refusal.as_ref();
        StoreStatus {
            fault: refusal.map(|refusal| refusal.in_words(Language::En)),
            cause: refusal.and_then(StoreRefusal::fault).cloned(),
            waits_for_fetch: facts.waits_for_fetch(),
            since: facts.since,
        }
    }
}

impl From<&WorklistFacts> for WorklistStatus {
    fn from(facts: &WorklistFacts) -> WorklistStatus {
        WorklistStatus {
            fault: facts.fault.as_ref().map(Cause::to_string),
            cause: facts.fault.clone(),
            since: facts.since,
            answered: facts.answered,
            entries: facts.entries,
            left_out: facts.left_out,
        }
    }
}

impl From<&TriggerFacts> for TriggerStatus {
    fn from(facts: &TriggerFacts) -> TriggerStatus {
        TriggerStatus {
            state: facts.state.word().to_owned(),
            why: facts.why.as_ref().map(Cause::to_string),
            cause: facts.why.clone(),
            since: facts.since,
            presses: facts.presses,
            ids: facts.ids,
            garbage: facts.garbage,
        }
    }
}

impl AlarmStatus {
    /// The status of an alarm with this code, in English.
    pub fn from_alarm(code: &str, alarm: &Alarm) -> AlarmStatus {
        let complaint = Complaint::new(code, alarm.figures.clone());
        AlarmStatus { message: complaint.message(Language::En), since: alarm.since }
    }
}
