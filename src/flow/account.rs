//! What the journal knows of scans, as it is told to people and programs, and one scan in a sentence.

use std::collections::BTreeMap;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::facts::StoreFacts;
use super::health::{ago, words};
use super::identity::{NO_PRESS, PATIENTS_DIFFER, SAME_SCAN_OTHER_PATIENT};
use super::lifecycle::{HANDED_OVER, SUPERSEDED, UNASSIGNED};
use super::{DeliveryState, ScanState, capture};

/// A scan, when it was first seen, and where it is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seen {
    /// First digits of its id.
    pub scan: String,
    /// When the station first saw it.
    pub first_seen: Timestamp,
    /// The word of its state.
    pub state: String,
}

/// A scan in a list: nothing that tells whose it is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Listed {
    /// First digits of its id.
    pub scan: String,
    /// When the station first saw it.
    pub first_seen: Timestamp,
    /// The word of its state.
    pub state: String,
    /// A delivery of it waits for a person.
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
    /// Why it needs no decision any more, though it was refused or held: `given-up`,
    /// `superseded` or `let-go`.
    pub closed: Option<String>,
    /// A record of it lies, or may lie, where it is to be taken back.
    pub withdrawing: bool,
}

/// Which scans a list is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Filter {
    /// Waiting for a record.
    Spooled,
    /// Nothing is left to be delivered without a person.
    Delivered,
    /// Refused, in quarantine.
    Refused,
    /// A delivery waits for a person.
    Held,
}

/// The words of the filters, in the order in which a scan meets them.
pub const FILTERS: [(&str, Filter); 4] = [
    ("spooled", Filter::Spooled),
    ("delivered", Filter::Delivered),
    ("refused", Filter::Refused),
    ("held", Filter::Held),
];

/// Everything the journal knows of a scan and its deliveries, the patients' ids included.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Whole {
    /// Its id, all digits.
    pub scan: String,
    /// The scan itself.
    #[serde(flatten)]
    pub summary: Summary,
    /// Its deliveries, in the order of patients and stores.
    pub deliveries: Vec<Delivered>,
    /// The ids of those whose it may be, where it is held.
    pub candidates: Vec<String>,
    /// The folder in which its legs can be seen while it is held.
    pub preview: Option<String>,
    /// What happened to it, oldest first.
    pub history: Vec<Happened>,
}

/// One row of a scan's history.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Happened {
    /// When, UTC.
    pub at: String,
    /// What happened.
    pub event: String,
    /// Its details, JSON; they may hold patients' ids.
    pub detail: String,
}

/// The scan itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Summary {
    /// The word of its state.
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
    /// Likewise, for people.
    pub message: Option<String>,
    /// Why it needs no decision any more, though it was refused or held: `given-up`,
    /// `superseded` or `let-go`.
    pub closed: Option<String>,
}

/// One delivery.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Delivered {
    /// The patient's id; none while nobody named the patient.
    pub patient: Option<String>,
    /// The store.
    pub store: String,
    /// The word of its state.
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
    /// Whether its record lies, or may lie, where it is not to stay: it is to be taken back.
    pub fn is_to_go(&self) -> bool {
        let unwanted = [UNASSIGNED, SUPERSEDED, HANDED_OVER];
        self.state == DeliveryState::Withdrawing.word()
            || self.state == DeliveryState::Delivered.word()
                && self.code.as_deref().is_some_and(|code| unwanted.contains(&code))
    }

    /// Whether its record lies in the store for whose scan it is.
    pub fn is_there(&self) -> bool {
        self.state == DeliveryState::Delivered.word() && !self.is_to_go()
    }
}

/// Why a scan is held, in words, by its code.
pub fn why_held(code: &str) -> &'static str {
    match code {
        capture::AMBIGUOUS => "it could be of more than one of those who were named or scanned",
        capture::UNCLEAR => "it may have been written before the button was pressed or a name said",
        capture::LATE => "it came after the time in which the export of the press is awaited",
        capture::UNHEARD => "a press of the button may have gone unheard",
        capture::UNREAD => "a card or an order before it could not be read or kept",
        capture::REPEATED => "the order that names its patient came a second time",
        NO_PRESS => "nobody pressed the button for it",
        PATIENTS_DIFFER => "two sources name different patients",
        _ => "its bytes came in for a second patient",
    }
}

/// Why a scan that was refused or held needs no decision any more, in words.
fn why_closed(closed: &str) -> &'static str {
    match closed {
        "superseded" => "the same patient's next scan was delivered",
        "let-go" => "nobody decided, and its time in quarantine is over",
        _ => "a person gave it up",
    }
}

/// What became of a scan, in words that follow "it"; `held` is why it is held, if it is.
pub fn in_words(summary: &Summary, held: Option<&str>) -> String {
    if let Some(code) = held {
        return format!("is held, for {}, until a person decides", why_held(code));
    }
    let refused = summary.state == ScanState::Refused.word();
    match &summary.code {
        Some(code) if refused => format!("was refused ({code}) and lies in quarantine"),
        None if refused => "was refused and lies in quarantine".into(),
        _ if summary.state == ScanState::Delivered.word() => "was delivered".into(),
        _ => "was taken and waits for its record to be delivered".into(),
    }
}

/// Why a scan is where it is, in one sentence; names no patient. `stores` tells how each store is.
pub fn explain(whole: &Whole, stores: &BTreeMap<&str, StoreFacts>, now: Timestamp) -> String {
    let (scan, summary) = (whole.scan.get(..8).unwrap_or(&whole.scan), &whole.summary);
    let code = |code: &Option<String>| code.clone().unwrap_or_else(|| "no code".to_owned());
    let in_state = |state: DeliveryState| {
        whole.deliveries.iter().find(|delivery| delivery.state == state.word())
    };
    if summary.state == ScanState::Refused.word() {
        let why = summary.message.as_deref().unwrap_or("the reason lies beside it");
        let code = code(&summary.code);
        let closed = summary.closed.as_deref().map(why_closed);
        let closed =
            closed.map_or(String::new(), |why| format!("; it needs no decision, for {why}"));
        return format!("Scan {scan} lies in quarantine [{code}]: {why}{closed}.");
    }
    if let Some(pending) = in_state(DeliveryState::Pending) {
        let waited = ago(summary.first_seen, now);
        let store = stores.get(pending.store.as_str());
        if let Some(fault) = store.and_then(|store| store.fault.as_ref()) {
            let store = &pending.store;
            return format!(
                "Scan {scan} is safe in the spool since {waited} and waits for the store \
                 \"{store}\", which takes nothing now: {fault}."
            );
        }
        return match (pending.attempts, pending.next_at) {
            (0, _) => format!(
                "Scan {scan} is safe in the spool since {waited} and waits for its turn to be \
                 measured."
            ),
            (attempts, next_at) => {
                let next = next_at.map(|at| words(at.duration_since(now).unsigned_abs()));
                let next = next.map_or(String::new(), |next| format!(", the next time in {next}"));
                let store = &pending.store;
                let code = pending.code.as_ref().map_or(String::new(), |code| format!(" [{code}]"));
                format!(
                    "Scan {scan} is safe in the spool since {waited}; the store \"{store}\" did \
                     not take its record at {attempts} attempts{code}, and it is tried for as long \
                     as it takes{next}."
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
            "Scan {scan} was taken back, and its record has not left the folder it was taken back from \
             yet; it is tried for as long as it takes (gaiter show {scan})."
        );
    }
    let unassigned = done.next().is_some_and(|delivery| delivery.patient.is_none());
    let whose = if unassigned {
        "nobody named its patient, so it lies under _unassigned"
    } else {
        "nothing is left to do"
    };
    format!("Scan {scan} is delivered; {whose}.")
}

#[cfg(test)]
mod tests;
