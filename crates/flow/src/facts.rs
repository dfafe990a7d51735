//! What the station knows about itself at one moment, for `gaiter status`, metrics and health. Workers
//! record their own part; nothing here makes decisions.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::time::Duration;

use gaiter_language::Language;
use gaiter_record::phantom::LastCheck;
use jiff::Timestamp;

use super::cause::Cause;
use super::complaint::ComplaintFigures;
use super::confinement::Confinement;
use super::export::passed_over::{Ignored, PassedOver};
use super::settle::Wait;
use super::trigger::PortState;
use super::views::ViewsSeries;
use super::worklist::AccessionNumbers;

/// Everything that is known about a running station apart from its journal. It is never serialised: it holds paths, and
/// paths may name patients.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Facts {
    /// When this run began.
    pub started: Timestamp,
    /// The export folders, in the order of the configuration.
    pub sources: Vec<SourceFacts>,
    /// The record stores by their name in the journal.
    pub stores: BTreeMap<&'static str, StoreFacts>,
    /// The ports of the booth by their names: serial, usb, keys, reader.
    pub triggers: BTreeMap<&'static str, TriggerFacts>,
    /// The endpoints of the page whose address is unavailable, and why: local, network.
    pub endpoints: BTreeMap<&'static str, Cause>,
    /// The worklist; `None` if none is configured.
    pub worklist: Option<WorklistFacts>,
    /// Whether scans are taken in.
    pub intake: IntakeState,
    /// What the operator must know and nothing else shows, by code; kept until the station restarts.
    pub alarms: BTreeMap<&'static str, Alarm>,
    /// The checks with the phantom; `None` if none is configured.
    pub phantom: Option<PhantomFacts>,
    /// What the last scans show about the scanner's cameras.
    pub views: ViewsSeries,
    /// What was wrong with the configuration at the last reload; `None` if it was accepted.
    pub refused_reload: Option<String>,
    /// The guards around measuring processes; `None` if they could not be tested.
    pub confinement: Option<Confinement>,
    /// Scans measured in this run, including refused ones.
    pub measured: u64,
    /// How long the last measurement took, seconds.
    pub last_measurement_s: Option<f64>,
}

/// One export folder.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SourceFacts {
    /// The folder; `None` before its worker starts. Paths are never shown in a status.
    pub folder: Option<PathBuf>,
    pub state: SourceState,
    /// Since when it is in this state.
    pub since: Timestamp,
    /// The kind of its file system, such as "ext4" or "SMB"; `None` before the first look.
    pub file_system: Option<String>,
    /// Changes are not reported there, so that it is only looked through at intervals.
    pub polled: bool,
    /// When it was last looked through to the end.
    pub last_look: Option<Timestamp>,
    /// Files that are not taken yet, and why. Names may name patients: never shown in a status.
    pub waiting: BTreeMap<PathBuf, WaitingFile>,
    /// Files that are ignored, and why. Never shown in a status either.
    pub ignored: BTreeMap<PathBuf, Ignored>,
    /// How much is ignored, by its reason.
    pub passed_over: BTreeMap<PassedOver, usize>,
    /// Files that were overwritten or deleted before they were taken, and when that was noticed. Never
    /// shown in a status either.
    pub gone: BTreeMap<PathBuf, Timestamp>,
    /// How many exports were overwritten or deleted before they were taken, since somebody called off
    /// what was expected.
    pub gone_count: usize,
}

/// The state of an export folder.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum SourceState {
    /// It has not been looked at yet.
    #[default]
    NotLooked,
    /// It is looked through regularly.
    Watched,
    /// It cannot be listed; the error without the path.
    OutOfReach(Cause),
    /// It is there, but what should be mounted is not.
    NotMounted(Cause),
    /// Another station on this machine uses it.
    Taken,
    /// A look has not returned within its deadline.
    Stalled,
}

impl SourceState {
    /// The word for it, in a status and in metrics.
    pub fn word(&self) -> &'static str {
        match self {
            SourceState::NotLooked => "not_looked",
            SourceState::Watched => "watched",
            SourceState::OutOfReach(_) => "out_of_reach",
            SourceState::NotMounted(_) => "not_mounted",
            SourceState::Taken => "taken",
            SourceState::Stalled => "stalled",
        }
    }

    /// Why it is not watched, where the state's word does not state it.
    pub fn why(&self) -> Option<&Cause> {
        match self {
            SourceState::OutOfReach(why) | SourceState::NotMounted(why) => Some(why),
            _ => None,
        }
    }
}

/// A file that is not taken yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WaitingFile {
    pub wait: Wait,
    /// Since when, by the station's wall clock.
    pub since: Timestamp,
    /// It has waited longer than a file should.
    pub overdue: bool,
}

/// One record store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoreFacts {
    /// Why it took nothing at the last attempt; `None` if it did.
    pub refusal: Option<StoreRefusal>,
    /// Since when it is in this state.
    pub since: Timestamp,
    /// A delivery met the fault. That the store can be reached does not disprove it.
    pub is_of_delivery: bool,
}

/// Why a store takes no record now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StoreRefusal {
    /// It does not work: the fault, without its path.
    Fault(Cause),
    /// The last result is still in the place of the next: the practice software has not fetched it.
    NotFetched,
}

impl StoreRefusal {
    /// Why it takes no record now.
    pub fn in_words(&self, language: Language) -> String {
        match self {
            StoreRefusal::Fault(why) => why.in_words(language),
            StoreRefusal::NotFetched => language.text("explain.not_fetched").to_owned(),
        }
    }

    /// The fault, if it is one.
    pub fn fault(&self) -> Option<&Cause> {
        match self {
            StoreRefusal::Fault(why) => Some(why),
            StoreRefusal::NotFetched => None,
        }
    }
}

/// What was done at a store, with the refusal it met.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StoreAttempt {
    /// A look whether it can be reached.
    Look(Option<StoreRefusal>),
    Delivery(Option<StoreRefusal>),
}

impl StoreFacts {
    /// The facts after an attempt. `is_awaited` states whether a record still waits for the store: until one
    /// is delivered, or none waits, the fault of a delivery stays.
    pub fn after(
        before: Option<&StoreFacts>,
        attempt: StoreAttempt,
        is_awaited: bool,
        now: Timestamp,
    ) -> StoreFacts {
        let was_of_delivery = before.is_some_and(|before| before.is_of_delivery);
        let (refusal, is_of_delivery) = match attempt {
            StoreAttempt::Look(None) if was_of_delivery && is_awaited => {
                (before.and_then(|before| before.refusal.clone()), true)
            }
            StoreAttempt::Look(refusal) => (refusal, was_of_delivery),
            StoreAttempt::Delivery(refusal) => (refusal, true),
        };
        let kind = |refusal: &Option<StoreRefusal>| refusal.as_ref().map(std::mem::discriminant);
        let is_same = before.is_some_and(|before| kind(&before.refusal) == kind(&refusal));
        let since = before.filter(|_| is_same).map_or(now, |before| before.since);
        let is_of_delivery = is_of_delivery && refusal.is_some();
        StoreFacts { refusal, since, is_of_delivery }
    }

    /// Whether it waits until somebody fetches what it has: it works, and takes the next record then.
    pub fn waits_for_fetch(&self) -> bool {
        self.refusal == Some(StoreRefusal::NotFetched)
    }
}

/// One port of the booth.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TriggerFacts {
    pub state: PortState,
    /// Why it is not open, without its path.
    pub why: Option<Cause>,
    /// Since when it is in this state.
    pub since: Timestamp,
    /// Since when it has not worked steadily; `None` if it works steadily.
    pub unsound_since: Option<Timestamp>,
    /// Presses in this run.
    pub presses: u64,
    /// Ids read in this run.
    pub ids: u64,
    /// Bytes or keys in this run that had no meaning.
    pub garbage: u64,
}

impl TriggerFacts {
    /// A port that has not been looked for.
    pub fn new(now: Timestamp) -> TriggerFacts {
        TriggerFacts { since: now, unsound_since: Some(now), ..TriggerFacts::default() }
    }
}

/// The state of the worklist of a hospital system, without its patients.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct WorklistFacts {
    /// Why the server gave no answer at the last attempt; `None` if it did, or was not asked yet.
    pub fault: Option<Cause>,
    /// Since when it is in this state.
    pub since: Timestamp,
    /// When it last gave an answer.
    pub answered: Option<Timestamp>,
    /// How many entries can be chosen.
    pub entries: usize,
    /// How many entries of this station name no patient.
    pub left_out: usize,
    /// How often the entries have changed in this run.
    pub edition: u64,
    /// What is known of the hospital's accession numbers; `None` where nobody reads codes.
    pub numbers: Option<AccessionNumbers>,
}

impl WorklistFacts {
    /// A server that was not asked yet.
    pub fn new(now: Timestamp) -> WorklistFacts {
        WorklistFacts { since: now, ..WorklistFacts::default() }
    }

    /// Notes how an attempt ended.
    pub fn note(&mut self, fault: Option<Cause>, now: Timestamp) {
        let is_first_answer = fault.is_none() && self.answered.is_none();
        if self.fault.is_some() != fault.is_some() || is_first_answer {
            self.since = now;
        }
        if fault.is_none() {
            self.answered = Some(now);
        }
        self.fault = fault;
    }
}

/// What is known of the checks with the phantom.
#[derive(Debug, Clone, PartialEq)]
pub struct PhantomFacts {
    /// How often the phantom should be scanned.
    pub every: Duration,
    /// The last checks, oldest first; a month at most.
    pub checks: Vec<LastCheck>,
}

/// Whether scans are taken in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum IntakeState {
    /// Scans are taken in.
    #[default]
    Open,
    Paused,
    /// The disk of the state folder is nearly full; exports stay where they are.
    DiskLow {
        /// Free space, bytes.
        free: u64,
        /// Space that must stay free, bytes.
        floor: u64,
    },
}

impl IntakeState {
    /// All words of [`IntakeState::word`].
    pub const WORDS: [&'static str; 3] = ["open", "paused", "disk_low"];

    /// The word for it, in a status and in metrics.
    pub fn word(self) -> &'static str {
        match self {
            IntakeState::Open => "open",
            IntakeState::Paused => "paused",
            IntakeState::DiskLow { .. } => "disk_low",
        }
    }
}

/// Something that the operator must know. Its words are under its code, as those of a complaint.
#[derive(Debug, Clone, PartialEq)]
pub struct Alarm {
    /// The figures in its message.
    pub figures: ComplaintFigures,
    pub since: Timestamp,
}

impl Facts {
    /// A station that has just started.
    pub fn new(started: Timestamp, sources: usize) -> Facts {
        let source = SourceFacts { since: started, ..SourceFacts::default() };
        Facts { started, sources: vec![source; sources], ..Facts::default() }
    }

    /// What came into the export folders after this time and may be exports that are not read, counted by
    /// its reason.
    pub fn unread_since(&self, opened: Duration, now: Duration) -> BTreeMap<PassedOver, usize> {
        let all = self.sources.iter().flat_map(|source| source.ignored.values());
        let mut counts = BTreeMap::new();
        for ignored in all.filter(|ignored| ignored.may_be_export_since(opened, now)) {
            *counts.entry(ignored.why).or_default() += 1;
        }
        counts
    }

    /// The stores that wait until somebody fetches what they have.
    pub fn unfetched(&self) -> BTreeSet<&'static str> {
        let stores = self.stores.iter().filter(|(_, facts)| facts.waits_for_fetch());
        stores.map(|(store, _)| *store).collect()
    }

    /// How many exports were overwritten or deleted before they were taken, and nobody has called off.
    pub fn gone(&self) -> usize {
        self.sources.iter().map(|source| source.gone_count).sum()
    }
}
