//! What the journal knows about scans, as shown to people and programs, and one scan in a sentence.

use std::collections::BTreeMap;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::facts::StoreFacts;
use super::health::{ago, words};
use super::lifecycle::{HANDED_OVER, SUPERSEDED, UNASSIGNED};
use super::patient::identity::{NO_PRESS, PATIENTS_DIFFER, SAME_SCAN_OTHER_PATIENT};
use super::{DeliveryState, ScanState, round};

/// A scan, when it was first seen, and where it is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seen {
    /// First digits of its id.
    pub scan: String,
    /// When the station first saw it.
    pub first_seen: Timestamp,
    /// Its state, as a word.
    pub state: String,
}

/// A scan in a list, without anything that identifies the patient.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Listed {
    /// First digits of its id.
    pub scan: String,
    /// When the station first saw it.
    pub first_seen: Timestamp,
    /// Its state, as a word.
    pub state: String,
    /// A delivery of it waits for the operator.
    pub held: bool,
    /// Its format's file-name ending.
    pub format: String,
    /// Size, bytes.
    pub size: u64,
    /// Why it was refused or is held.
    pub code: Option<String>,
    /// Failed attempts at its deliveries.
    pub attempts: u64,
    /// When the next attempt is due.
    pub next_at: Option<Timestamp>,
    /// Why it no longer needs a decision, although it was refused or held: `given-up`, `superseded` or
    /// `let-go`.
    pub closed: Option<String>,
    /// A record of it is, or may be, in a place from which it must be taken back.
    pub withdrawing: bool,
}

impl Listed {
    /// Its state in a word for people, the same in every table.
    pub fn shown_state(&self) -> &str {
        shown_state(&self.state, self.closed.is_some(), self.held, self.withdrawing)
    }
}

/// What matters most about a scan: a decision that is made or needed, then a record in the wrong place, then
/// the state of the scan itself.
fn shown_state(state: &str, is_closed: bool, is_held: bool, is_withdrawing: bool) -> &str {
    match (is_closed, is_held, is_withdrawing) {
        (true, ..) => "closed",
        (_, true, _) => "held",
        (_, _, true) => "withdrawing",
        _ => state,
    }
}

/// Which scans to list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Filter {
    /// Waiting for a record.
    Spooled,
    /// Nothing is left to be delivered without operator action.
    Delivered,
    /// Refused, in quarantine.
    Refused,
    /// A delivery waits for the operator.
    Held,
}

/// What to search for among all scans.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Search {
    /// The beginning of a scan's id, or a part of a patient's id; everything if empty.
    pub text: String,
    /// The state.
    pub state: Option<SearchState>,
    /// First seen at this time or later.
    pub from: Option<Timestamp>,
    /// First seen before this time.
    pub until: Option<Timestamp>,
    /// Only scans whose record lacks measures.
    pub incomplete: bool,
    /// How many of the newest to leave out.
    pub offset: u32,
    /// The largest number of scans.
    pub limit: u32,
}

/// The states to search for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SearchState {
    /// It waits for a decision.
    Undecided,
    /// It was refused.
    Refused,
    /// A patient has its record.
    Delivered,
    /// Its record is stored without a patient.
    Unassigned,
}

/// The words for the filters, in the order in which a scan meets them.
pub const FILTERS: [(&str, Filter); 4] = [
    ("spooled", Filter::Spooled),
    ("delivered", Filter::Delivered),
    ("refused", Filter::Refused),
    ("held", Filter::Held),
];

/// Everything the journal knows about a scan and its deliveries, including patients' ids.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Whole {
    /// Its id, all digits.
    pub scan: String,
    /// The scan itself.
    #[serde(flatten)]
    pub summary: Summary,
    /// Its deliveries, in the order of patients and stores.
    pub deliveries: Vec<Delivered>,
    /// The ids of the patients to whom it may belong, if it is held.
    pub candidates: Vec<String>,
    /// The folder in which its legs can be seen while it is held.
    pub preview: Option<String>,
    /// What happened to it, oldest first.
    pub history: Vec<Happened>,
}

impl Whole {
    /// Its state in a word for people, the same in every table.
    pub fn shown_state(&self) -> &str {
        let in_state = |delivery: &Delivered, state: DeliveryState| delivery.state == state.word();
        let is_held = self.deliveries.iter().any(|of| in_state(of, DeliveryState::Held));
        // A record in a store that gets no other one in its place is left to the operator.
        let is_replaced = |of: &Delivered| {
            let mut others = self.deliveries.iter().filter(|other| other.store == of.store);
            others.any(|other| {
                in_state(other, DeliveryState::Pending) || in_state(other, DeliveryState::Refused)
            })
        };
        let is_withdrawing = self
            .deliveries
            .iter()
            .any(|of| in_state(of, DeliveryState::Withdrawing) || of.is_to_go() && is_replaced(of));
        let summary = &self.summary;
        shown_state(&summary.state, summary.closed.is_some(), is_held, is_withdrawing)
    }
}

/// One row of a scan's history.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Happened {
    /// When, UTC.
    pub at: String,
    /// What happened.
    pub event: String,
    /// Its details as JSON; may contain patients' ids.
    pub detail: String,
}

/// The scan itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Summary {
    /// Its state, as a word.
    pub state: String,
    /// When the station first saw it.
    pub first_seen: Timestamp,
    /// Its file's own time.
    pub file_time: Option<Timestamp>,
    /// Its format's file-name ending.
    pub format: String,
    /// Size, bytes.
    pub size: u64,
    /// Why it was refused.
    pub code: Option<String>,
    /// The same, for people.
    pub message: Option<String>,
    /// Why it no longer needs a decision, although it was refused or held: `given-up`, `superseded` or
    /// `let-go`.
    pub closed: Option<String>,
    /// Measures must be taken by hand, or the patient scanned again.
    #[serde(default)]
    pub incomplete: bool,
}

/// One delivery.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Delivered {
    /// The patient's id; `None` while no patient is named.
    pub patient: Option<String>,
    /// The store.
    pub store: String,
    /// Its state, as a word.
    pub state: String,
    /// Why it is held or was refused.
    pub code: Option<String>,
    /// Failed attempts.
    pub attempts: u64,
    /// When the next attempt is due.
    pub next_at: Option<Timestamp>,
    /// The record.
    pub folder: Option<String>,
}

impl Delivered {
    /// Whether its record is, or may be, in a place from which it must be taken back.
    pub fn is_to_go(&self) -> bool {
        let unwanted = [UNASSIGNED, SUPERSEDED, HANDED_OVER];
        self.state == DeliveryState::Withdrawing.word()
            || self.state == DeliveryState::Delivered.word()
                && self.code.as_deref().is_some_and(|code| unwanted.contains(&code))
    }

    /// Whether its record is in the store, under the patient to whom the scan belongs.
    pub fn is_there(&self) -> bool {
        self.state == DeliveryState::Delivered.word() && !self.is_to_go()
    }
}

/// Why a scan is held, in words for its code.
fn why_held(code: &str) -> &'static str {
    match code {
        round::AMBIGUOUS => {
            "it could belong to more than one patient, or another scan lay beside it"
        }
        round::UNCLEAR => {
            "it may have been written before the button was pressed or a patient named"
        }
        round::LATE => "it arrived after the time allowed for the export of the press",
        round::UNHEARD => "a press of the button may have been missed",
        round::UNREAD => "a card or an order before it could not be read or kept",
        round::REPEATED => "the order that names its patient came a second time",
        NO_PRESS => "the button was not pressed for it",
        PATIENTS_DIFFER => "two sources name different patients",
        _ => "the same data arrived for a second patient",
    }
}

/// Why a refused or held scan no longer needs a decision, in words.
fn why_closed(closed: &str) -> &'static str {
    match closed {
        "superseded" => "the same patient's next scan was delivered",
        "let-go" => "it was not decided on before its time in quarantine ended",
        _ => "the operator gave it up",
    }
}

/// The outcome for a scan, in words that follow "it"; `held` is the code for why it is held, if it is.
pub fn in_words(summary: &Summary, held: Option<&str>) -> String {
    if let Some(code) = held {
        return format!("is held because {}, until the operator decides", why_held(code));
    }
    let refused = summary.state == ScanState::Refused.word();
    match &summary.code {
        Some(code) if refused => format!("was refused ({code}) and is in quarantine"),
        None if refused => "was refused and is in quarantine".into(),
        _ if summary.state == ScanState::Delivered.word() => "was delivered".into(),
        _ => "was taken and waits for its record to be delivered".into(),
    }
}

/// Why a scan is where it is, in one sentence that names no patient. `stores` has the state of each
/// store.
pub fn explain(whole: &Whole, stores: &BTreeMap<&str, StoreFacts>, now: Timestamp) -> String {
    let (scan, summary) = (whole.scan.get(..8).unwrap_or(&whole.scan), &whole.summary);
    let code = |code: &Option<String>| code.clone().unwrap_or_else(|| "no code".to_owned());
    let in_state = |state: DeliveryState| {
        whole.deliveries.iter().find(|delivery| delivery.state == state.word())
    };
    if summary.state == ScanState::Refused.word() {
        let why = summary.message.as_deref().unwrap_or("the reason is in the file beside it");
        let code = code(&summary.code);
        let closed = summary.closed.as_deref().map(why_closed);
        let closed =
            closed.map_or(String::new(), |why| format!("; no decision is needed, because {why}"));
        return format!("Scan {scan} lies in quarantine [{code}]: {why}{closed}.");
    }
    if let Some(pending) = in_state(DeliveryState::Pending) {
        let waited = ago(summary.first_seen, now);
        let store = stores.get(pending.store.as_str());
        if let Some(fault) = store.and_then(|store| store.fault.as_ref()) {
            let store = &pending.store;
            return format!(
                "Scan {scan} has been safe in the spool for {waited} and waits for the store \
                 \"{store}\", which accepts no records now: {fault}."
            );
        }
        return match (pending.attempts, pending.next_at) {
            (0, _) => format!(
                "Scan {scan} has been safe in the spool for {waited} and waits for its turn to be \
                 measured."
            ),
            (attempts, next_at) => {
                let next = next_at.map(|at| words(at.duration_since(now).unsigned_abs()));
                let next = next.map_or(String::new(), |next| format!(", the next in {next}"));
                let store = &pending.store;
                let code = pending.code.as_ref().map_or(String::new(), |code| format!(" [{code}]"));
                format!(
                    "Scan {scan} has been safe in the spool for {waited}; the store \"{store}\" \
                     did not accept its record in {attempts} attempts{code}; attempts \
                     continue{next}."
                )
            }
        };
    }
    let held = in_state(DeliveryState::Held).filter(|_| summary.closed.is_none());
    if let Some(held) = held {
        let code = held.code.as_deref().unwrap_or(SAME_SCAN_OTHER_PATIENT);
        let why = why_held(code);
        return format!(
            "Scan {scan} is held [{code}]: {why}; operator action needed: look (gaiter show {scan}) and decide \
             (gaiter release or gaiter assign)."
        );
    }
    let mut done = whole.deliveries.iter().filter(|delivery| delivery.is_there());
    if in_state(DeliveryState::Withdrawing).is_some() {
        return format!(
            "Scan {scan} was taken back; its record could not be removed yet; attempts continue \
             (gaiter show {scan})."
        );
    }
    let unassigned = done.next().is_some_and(|delivery| delivery.patient.is_none());
    let whose = if unassigned {
        "no patient was named, so it is stored under _unassigned"
    } else {
        "nothing is left to do"
    };
    format!("Scan {scan} is delivered; {whose}.")
}

#[cfg(test)]
mod tests;
