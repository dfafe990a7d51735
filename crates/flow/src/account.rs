//! What the journal knows about scans, as shown to people and programs, and one scan in a sentence.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

use gaiter_language::Language;
use gaiter_record::scan_id::SHORT;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::disposition::{Disposition, Task};
use super::facts::StoreFacts;
use super::lifecycle::{HANDED_OVER, REVISION_REFUSED, SUPERSEDED, UNASSIGNED};
use super::patient::erasure::ERASED;
use super::patient::identity::SAME_SCAN_OTHER_PATIENT;
use super::round::AMBIGUOUS;
use super::words::{ago, duration};
use super::{Closed, DeliveryState, ScanState};

/// The text for a scan that may belong to several patients, of whom at most one is known.
const ONE_NAMED: &str = "capture-ambiguous-one";

/// A scan, when it was first seen, and where it is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seen {
    /// First digits of its id.
    pub scan: String,
    /// When the station first saw it.
    pub first_seen: Timestamp,
    pub state: ScanState,
}

/// A scan in a list, without anything that identifies the patient.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Listed {
    /// First digits of its id.
    pub scan: String,
    /// When the station first saw it.
    pub first_seen: Timestamp,
    pub state: ScanState,
    pub disposition: Disposition,
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
    /// Why it no longer needs a decision, although it was refused or held.
    pub closed: Option<Closed>,
    /// A record of it is, or may be, in a place from which it must be taken back.
    pub withdrawing: bool,
}

impl Listed {
    /// A scan in a list.
    pub fn from_whole(whole: &Whole) -> Listed {
        let Whole { scan, summary, deliveries, .. } = whole;
        let codes = deliveries.iter().filter_map(|of| of.code.as_ref());
        let pending = deliveries.iter().filter(|of| of.state == DeliveryState::Pending);
        Listed {
            scan: scan.get(..SHORT).unwrap_or(scan).to_owned(),
            first_seen: summary.first_seen,
            state: summary.state,
            disposition: whole.disposition(),
            held: deliveries.iter().any(|of| of.state == DeliveryState::Held),
            format: summary.format.clone(),
            size: summary.size,
            code: summary.code.clone().or_else(|| codes.max().cloned()),
            attempts: deliveries.iter().map(|of| of.attempts).sum(),
            next_at: pending.filter_map(|of| of.next_at).min(),
            closed: summary.closed,
            withdrawing: deliveries.iter().any(|of| whole.is_to_be_taken_back(of)),
        }
    }
}

gaiter_record::word_enum! {
    /// Which scans to list, in the order in which a scan meets them.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Filter as serde {
        /// Waiting for a record.
        Spooled => "spooled",
        /// Nothing is left to be delivered without operator action.
        Delivered => "delivered",
        /// Refused, in quarantine.
        Refused => "refused",
        /// A person must decide whose it is.
        Held => "held",
        /// Its record is stored without a patient.
        Unassigned => "unassigned",
    }
}

/// What to search for among all scans, as the page asks.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(default)]
pub struct Search {
    /// The beginning of a scan's id, or a part of a patient's id; everything if empty.
    pub text: String,
    pub state: Option<SearchState>,
    /// First seen at this time or later.
    pub from: Option<Timestamp>,
    /// First seen before this time.
    pub until: Option<Timestamp>,
    /// Only scans whose record lacks measures.
    pub incomplete: bool,
    /// How many of the newest to leave out.
    pub offset: u32,
    /// The largest number of scans; the page cannot set it.
    #[serde(skip)]
    pub limit: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SearchState {
    /// It waits for a decision.
    Undecided,
    Refused,
    /// A patient has its record.
    Delivered,
    /// Its record is stored without a patient.
    Unassigned,
}

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
    /// The ids of the patients to whom it may belong, if it is held; `(erased)` for one who was erased.
    pub candidates: Vec<String>,
    /// The folder in which its legs can be seen while it is held.
    pub preview: Option<String>,
    /// What happened to it, oldest first.
    pub history: Vec<Happened>,
}

impl Whole {
    /// What became of it.
    pub fn disposition(&self) -> Disposition {
        let Whole { summary, deliveries, .. } = self;
        let deliveries = deliveries.iter();
        let states = deliveries.map(|of| (of.state, of.patient.is_some() && of.is_there()));
        Disposition::from_states(summary.state, summary.closed.is_some(), states)
    }

    /// Whether a record is to be removed from its store. One in a store that gets no other in its place is left
    /// to a person.
    fn is_to_be_taken_back(&self, of: &Delivered) -> bool {
        let mut others = self.deliveries.iter().filter(|other| other.store == of.store);
        let is_coming = |other: &Delivered| {
            matches!(other.state, DeliveryState::Pending | DeliveryState::Refused)
        };
        of.state == DeliveryState::Withdrawing || of.is_to_go() && others.any(is_coming)
    }

    /// Whether a patient to whom it belongs has its record.
    pub fn has_record(&self) -> bool {
        self.deliveries.iter().any(|of| of.patient.is_some() && of.is_there())
    }

    /// Whether a store that has its record does not take what was set by hand since.
    pub fn is_revision_refused(&self) -> bool {
        let is_refused = |of: &Delivered| of.code.as_deref() == Some(REVISION_REFUSED);
        self.deliveries.iter().any(|of| of.is_there() && is_refused(of))
    }

    /// What a person must do about it.
    pub fn task(&self) -> Task {
        match self.disposition() {
            found if found.needs_decision() => Task::Decide,
            found if self.summary.incomplete && found.may_lack_measures() && self.has_record() => {
                Task::Complete
            }
            _ => Task::Nothing,
        }
    }

    /// Whether the station works on it: it is to be measured, or its record delivered to another store than
    /// those of `unfetched`, which wait until somebody fetches what they have.
    pub fn is_in_work(&self, unfetched: &BTreeSet<&str>) -> bool {
        let is_due = |of: &Delivered| {
            of.state == DeliveryState::Pending && !unfetched.contains(of.store.as_str())
        };
        self.disposition() == Disposition::Spooled && self.deliveries.iter().any(is_due)
    }

    /// The patients to whom it belongs, as their ids are, each once; if it is held, those for whom it is held.
    pub fn owners(&self) -> BTreeSet<&str> {
        let gone = |of: &Delivered| of.is_to_go() || of.state == DeliveryState::Withdrawn;
        let is_closed = self.summary.closed.is_some();
        let is_held = |of: &Delivered| of.state == DeliveryState::Held;
        let is_any_held = self.deliveries.iter().any(is_held) && !is_closed;
        let theirs = self.deliveries.iter().filter(|of| match is_any_held {
            true => is_held(of),
            false => !(gone(of) || is_closed && is_held(of)),
        });
        theirs.filter_map(|of| of.patient.as_deref()).collect()
    }

    /// The patients to whom it belongs, or may belong if it is held, each once.
    pub fn possible_owners(&self) -> Vec<String> {
        let is_held = self.disposition() == Disposition::Held;
        let candidates = self.candidates.iter().filter(|id| is_held && *id != ERASED);
        let candidates = candidates.map(String::as_str);
        let all: BTreeSet<&str> = self.owners().into_iter().chain(candidates).collect();
        all.into_iter().map(str::to_owned).collect()
    }

    /// Why it is held, as a code, if it is.
    pub fn held_for(&self) -> Option<&str> {
        let is_held = self.disposition() == Disposition::Held;
        let held = self.deliveries.iter().find(|of| is_held && of.state == DeliveryState::Held)?;
        Some(held.code.as_deref().unwrap_or(SAME_SCAN_OTHER_PATIENT))
    }

    /// Why it is held, as the key of its text: that of its code, or a closer one.
    pub fn held_as(&self) -> Option<&str> {
        Some(match self.held_for()? {
            AMBIGUOUS if self.candidates.len() < 2 => ONE_NAMED,
            code => code,
        })
    }
}

/// One row of a scan's history.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Happened {
    /// When, UTC.
    pub at: String,
    pub event: String,
    /// Its details as JSON; may contain patients' ids.
    pub detail: String,
}

/// The scan itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Summary {
    pub state: ScanState,
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
    /// Why it no longer needs a decision, although it was refused or held.
    pub closed: Option<Closed>,
    /// Measures must be taken by hand, or the patient scanned again.
    #[serde(default)]
    pub incomplete: bool,
}

/// One delivery.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Delivered {
    /// The patient's id; `None` while no patient is named.
    pub patient: Option<String>,
    pub store: String,
    pub state: DeliveryState,
    /// Why it is held or was refused.
    pub code: Option<String>,
    /// Failed attempts.
    pub attempts: u64,
    /// When the next attempt is due.
    pub next_at: Option<Timestamp>,
    /// The record's folder, or by what a server has the record.
    pub folder: Option<String>,
}

impl Delivered {
    /// Whether its record is, or may be, in a place from which it must be taken back.
    pub fn is_to_go(&self) -> bool {
        let unwanted = [UNASSIGNED, SUPERSEDED, HANDED_OVER];
        self.state == DeliveryState::Withdrawing
            || self.state == DeliveryState::Delivered
                && self.code.as_deref().is_some_and(|code| unwanted.contains(&code))
    }

    /// Whether its record is in the store, under the patient to whom the scan belongs.
    pub fn is_there(&self) -> bool {
        self.state == DeliveryState::Delivered && !self.is_to_go()
    }
}

/// Why a scan is held, as a sentence for its code.
pub fn why_held(code: &str, language: Language) -> &'static str {
    let own = language.find(&format!("page.held.{code}.what"));
    own.unwrap_or_else(|| language.text("page.held.other.what"))
}

/// The outcome for a scan, in words that follow the scan. Why it is held is a sentence of its own, that of
/// [`why_held`].
pub fn in_words(whole: &Whole, language: Language) -> String {
    let summary = &whole.summary;
    let key = match whole.disposition() {
        _ if summary.state == ScanState::Refused => {
            let is_closed = summary.closed.is_some();
            let key = if is_closed { "explain.state.closed" } else { "explain.state.refused" };
            return language.filled(key, &[("code", &code_of(summary, language))]);
        }
        Disposition::Held => "explain.state.held",
        Disposition::Delivered => "explain.state.delivered",
        Disposition::Withdrawing => "explain.state.withdrawing",
        Disposition::Unassigned | Disposition::Left => "explain.state.unassigned",
        Disposition::Spooled => "explain.state.spooled",
        Disposition::Closed | Disposition::Refused => "explain.state.held_closed",
    };
    language.text(key).to_owned()
}

fn code_of(summary: &Summary, language: Language) -> &str {
    summary.code.as_deref().unwrap_or_else(|| language.text("explain.no_code"))
}

/// Why a scan is where it is, without a name of the patient. `stores` has the state of each store.
pub fn explain(
    whole: &Whole,
    stores: &BTreeMap<&str, StoreFacts>,
    now: Timestamp,
    language: Language,
) -> String {
    let (scan, summary) = (whole.scan.get(..SHORT).unwrap_or(&whole.scan), &whole.summary);
    let filled = |key| language.filled(key, &[("scan", &scan)]);
    let with_closed = |key| {
        let closed = not_needed(summary, language);
        language.filled(key, &[("scan", &scan), ("closed", &closed)])
    };
    match whole.disposition() {
        _ if summary.state == ScanState::Refused => refused(scan, summary, language),
        Disposition::Held | Disposition::Refused => {
            let code = whole.held_for().unwrap_or(SAME_SCAN_OTHER_PATIENT);
            let why = why_held(whole.held_as().unwrap_or(code), language);
            language.filled("explain.scan.held", &[("scan", &scan), ("code", &code), ("why", &why)])
        }
        Disposition::Spooled => {
            let waited = ago(summary.first_seen, now, language);
            let waits = waits(whole, stores, now, language);
            let words: [(&str, &dyn Display); 3] =
                [("scan", &scan), ("time", &waited), ("waits", &waits)];
            language.filled("explain.scan.spooled", &words)
        }
        Disposition::Withdrawing => filled("explain.scan.withdrawing"),
        Disposition::Delivered => filled("explain.scan.delivered"),
        Disposition::Closed => with_closed("explain.scan.closed"),
        Disposition::Unassigned | Disposition::Left => with_closed("explain.scan.unassigned"),
    }
}

/// Why a scan was refused, if that is known. Its figures are in English only.
pub fn why_refused(summary: &Summary, language: Language) -> Option<&str> {
    let code = summary.code.as_deref().unwrap_or_default();
    let own = match language {
        Language::En => None,
        _ => language.find(&format!("page.refused.{code}.what")),
    };
    own.or(summary.message.as_deref())
}

/// That a scan was refused.
fn refused(scan: &str, summary: &Summary, language: Language) -> String {
    let why = why_refused(summary, language);
    // Some reasons are sentences, or questions.
    let why = why.unwrap_or_else(|| language.text("explain.no_reason")).trim_end_matches('.');
    let closed = not_needed(summary, language);
    let words: [(&str, &dyn Display); 4] = [
        ("scan", &scan),
        ("code", &code_of(summary, language)),
        ("why", &why),
        ("closed", &closed),
    ];
    let sentence = language.filled("explain.scan.refused", &words);
    let is_ended = closed.is_empty() && why.ends_with(['?', '!']);
    if is_ended { sentence } else { sentence + "." }
}

/// Why a refused or held scan no longer needs a decision, in words that follow its state; empty if it does.
fn not_needed(summary: &Summary, language: Language) -> String {
    let Some(closed) = summary.closed else { return String::new() };
    let why = language.word("explain.closed", closed.word());
    language.filled("explain.not_needed", &[("why", &why)])
}

/// What a scan in the spool waits for, in words that follow the time.
fn waits(
    whole: &Whole,
    stores: &BTreeMap<&str, StoreFacts>,
    now: Timestamp,
    language: Language,
) -> String {
    let mut pending = whole.deliveries.iter().filter(|of| of.state == DeliveryState::Pending);
    let Some(pending) = pending.next() else { return String::new() };
    let store = &pending.store;
    let refusal = stores.get(store.as_str()).and_then(|store| store.refusal.as_ref());
    if let Some(refusal) = refusal {
        let words: [(&str, &dyn Display); 2] =
            [("store", store), ("why", &refusal.in_words(language))];
        return language.filled("explain.waits_for.store", &words);
    }
    if pending.attempts == 0 {
        return language.text("explain.waits_for.turn").to_owned();
    }
    let next = pending.next_at.map_or(String::new(), |at| {
        let time = duration(at.duration_since(now).unsigned_abs(), language);
        language.filled("explain.waits_for.next", &[("time", &time)])
    });
    let code = pending.code.as_ref().map_or(String::new(), |code| format!(" [{code}]"));
    let words: [(&str, &dyn Display); 4] =
        [("store", store), ("attempts", &pending.attempts), ("code", &code), ("next", &next)];
    language.filled("explain.waits_for.attempts", &words)
}

#[cfg(test)]
mod tests;
