//! A scan on the page: its outcome, the reason, and what the operator can decide.

use std::collections::BTreeSet;

use gaiter_language::Language;
use gaiter_record::{RecordSummary, shown};
use jiff::Timestamp;
use serde::Serialize;

use super::reasons::{Advice, of_held, of_refused};
use super::rows::key;
use super::{PatientShown, distinct};
use crate::account::{Delivered, Whole};
use crate::patient::identity::{PATIENTS_DIFFER, SAME_SCAN_OTHER_PATIENT};
use crate::{DeliveryState, ScanState, round};

/// One scan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScanShown {
    /// Its id, all digits.
    pub scan: String,
    /// The key of its patient's row, in addresses of this row's files; empty without a patient's record.
    pub of: String,
    /// When the station first saw it.
    pub at: Timestamp,
    /// `spooled`, `delivered`, `unassigned`, `withdrawing`, `held`, `refused` or `closed`; it decides
    /// colour and sign.
    pub state: &'static str,
    /// Its outcome, in a word or two.
    pub word: &'static str,
    /// Why it is held or was refused.
    pub code: Option<String>,
    /// The same in words, and what to do.
    pub advice: Option<Advice>,
    /// The ids of the patients to whom it belongs; for a held scan, of those for whom it is held.
    pub patients: Vec<String>,
    /// For a held scan, the patients to whom it may belong and can be given.
    pub candidates: Vec<PatientShown>,
    /// For a record that can be taken back, the patient who has it.
    pub owner: Option<PatientShown>,
    /// For a refused scan, the one patient to whom it belongs, who can be named to be scanned again.
    pub again: Option<PatientShown>,
    /// What the operator can decide.
    pub acts: Vec<&'static str>,
    /// Measures must be taken by hand, or the patient scanned again, as far as the journal knows.
    pub incomplete: bool,
    /// Its measures, once its record was read; for a held scan, those of its preview.
    pub measures: Option<RecordSummary>,
    /// The files of its record, or of its preview.
    pub files: Vec<String>,
    /// Why a held scan has no preview.
    pub unmeasured: Option<String>,
}

/// What was read from a scan's record, or from the preview of a held scan.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Told {
    /// Its measures.
    pub measures: Option<RecordSummary>,
    /// Its files.
    pub files: Vec<String>,
    /// The code for why a held scan cannot be measured.
    pub unmeasured: Option<String>,
}

/// The state of a scan, for the operator's decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Refused,
    Held,
    /// It was refused or held, and no longer needs a decision.
    Closed,
    /// It was taken back, but its record is not removed yet.
    Withdrawing,
    Waiting,
    Unassigned,
    Somebodys,
}

impl Place {
    /// The stable word; it decides colour and sign.
    fn word(self) -> &'static str {
        match self {
            Place::Refused => "refused",
            Place::Held => "held",
            Place::Closed => "closed",
            Place::Withdrawing => "withdrawing",
            Place::Waiting => "spooled",
            Place::Unassigned => "unassigned",
            Place::Somebodys => "delivered",
        }
    }
}

/// A scan as the page shows it.
pub fn shown(whole: &Whole, told: &Told, language: Language) -> ScanShown {
    let place = place(whole);
    let held = |delivery: &&Delivered| delivery.state == DeliveryState::Held.word();
    let code = match place {
        Place::Refused | Place::Closed => whole.summary.code.clone(),
        Place::Held => {
            let code = whole.deliveries.iter().find(held).and_then(|held| held.code.clone());
            Some(code.unwrap_or_else(|| SAME_SCAN_OTHER_PATIENT.to_owned()))
        }
        _ => None,
    };
    let advice = code.as_deref().and_then(|code| match place {
        Place::Refused => Some(of_refused(code, language)),
        Place::Held => Some(of_held(code, language)),
        _ => None,
    });
    let state = place.word();
    let word = match place {
        Place::Closed => {
            let why = whole.summary.closed.as_deref().unwrap_or_default();
            let word = language.find(&format!("page.scan.closed.{why}"));
            word.unwrap_or_else(|| language.text("page.scan.closed.given-up"))
        }
        _ => language.word("page.scan", state),
    };
    let acts = acts(place, code.as_deref(), whole);
    let unmeasured = told.unmeasured.as_deref().filter(|_| place == Place::Held);
    let of = of(whole).unwrap_or_default();
    ScanShown {
        scan: whole.scan.clone(),
        of,
        at: whole.summary.first_seen,
        state,
        word,
        code,
        advice,
        patients: patients(whole),
        candidates: candidates(place, &acts, whole),
        owner: only(place == Place::Somebodys, whole),
        again: only(place == Place::Refused, whole),
        acts,
        incomplete: whole.summary.incomplete,
        measures: told.measures.clone(),
        files: told.files.clone(),
        unmeasured: unmeasured.map(|code| no_preview(code, language)),
    }
}

/// The key of the row of the only patient who has a record of a scan.
pub fn of(whole: &Whole) -> Option<String> {
    let theirs = theirs(whole);
    let mut has_record = whole.deliveries.iter().filter(|of| of.is_there());
    let only = theirs.first().filter(|_| theirs.len() == 1)?;
    has_record.any(|of| of.patient.as_deref() == Some(only)).then(|| key(&whole.scan, only))
}

/// Why there is no picture of a held scan.
fn no_preview(code: &str, language: Language) -> String {
    let none = language.text("page.scan.no_picture");
    format!("{none} {} [{code}]", of_refused(code, language).what)
}

/// A refusal or a missing decision takes precedence over anything else that is in progress.
fn place(whole: &Whole) -> Place {
    let is_any = |state: DeliveryState| {
        whole.deliveries.iter().any(|delivery| delivery.state == state.word())
    };
    let has_owner =
        whole.deliveries.iter().any(|delivery| delivery.patient.is_some() && delivery.is_there());
    let is_closed = whole.summary.closed.is_some();
    if whole.summary.state == ScanState::Refused.word() {
        if is_closed { Place::Closed } else { Place::Refused }
    } else if is_any(DeliveryState::Held) && !is_closed {
        Place::Held
    } else if is_any(DeliveryState::Pending) {
        Place::Waiting
    } else if is_any(DeliveryState::Withdrawing) {
        Place::Withdrawing
    } else if has_owner {
        Place::Somebodys
    } else if is_closed && is_any(DeliveryState::Held) {
        Place::Closed
    } else {
        Place::Unassigned
    }
}

/// The verbs that help, the likeliest first. If the scan could belong to either of two patients, a
/// release would be a guess, so it is not offered.
fn acts(place: Place, code: Option<&str>, whole: &Whole) -> Vec<&'static str> {
    let is_guess =
        matches!(code, Some(PATIENTS_DIFFER | round::AMBIGUOUS)) || whole.candidates.len() > 1;
    let is_for_one = theirs(whole).len() == 1;
    match place {
        Place::Refused => vec!["retry", "give_up"],
        // Its bytes are gone; they come back with another export of the scan.
        Place::Closed if whole.summary.closed.as_deref() == Some("let-go") => Vec::new(),
        Place::Closed if whole.summary.state == ScanState::Refused.word() => vec!["retry"],
        Place::Closed => vec!["assign"],
        // It already belongs to a patient, so an assignment would be refused.
        Place::Held if code == Some(SAME_SCAN_OTHER_PATIENT) && is_for_one => {
            vec!["release", "give_up"]
        }
        Place::Held if code == Some(SAME_SCAN_OTHER_PATIENT) => vec!["give_up"],
        Place::Held if is_guess || !is_for_one => vec!["assign", "give_up"],
        Place::Held => vec!["release", "assign", "give_up"],
        Place::Waiting if whole.deliveries.iter().any(|delivery| delivery.attempts > 0) => {
            vec!["retry"]
        }
        Place::Waiting | Place::Withdrawing => Vec::new(),
        Place::Unassigned if whole.summary.closed.is_some() => vec!["assign"],
        Place::Unassigned => vec!["assign", "leave"],
        Place::Somebodys => vec!["unassign"],
    }
}

/// To whom a held scan can be given with one click, without the patient to whom a release gives it.
fn candidates(place: Place, acts: &[&str], whole: &Whole) -> Vec<PatientShown> {
    if ![Place::Held, Place::Closed].contains(&place) || !acts.contains(&"assign") {
        return Vec::new();
    }
    let released = if acts.contains(&"release") { theirs(whole) } else { BTreeSet::new() };
    distinct(whole.candidates.iter().filter(|id| !released.contains(id.as_str())))
}

/// The only patient to whom a scan belongs, if it is in the right place.
fn only(is_there: bool, whole: &Whole) -> Option<PatientShown> {
    let theirs = theirs(whole);
    let only = theirs.first().filter(|_| is_there && theirs.len() == 1);
    only.map(|id| PatientShown::of(id))
}

/// Whether an operator must decide about a scan.
pub fn needs_decision(whole: &Whole) -> bool {
    match place(whole) {
        Place::Refused | Place::Held => true,
        Place::Unassigned => whole.summary.closed.is_none(),
        Place::Closed | Place::Withdrawing | Place::Waiting | Place::Somebodys => false,
    }
}

/// Whether a scan is held, so that it may have a preview.
pub fn is_held(whole: &Whole) -> bool {
    place(whole) == Place::Held
}

/// The folder in `store` of the record that may be opened from a scan: one without a patient, or that of
/// the only patient with whom the scan is shown. One patient's name never opens another's record.
pub fn record_folder<'a>(whole: &'a Whole, store: &str) -> Option<&'a str> {
    record_of(whole, store)?.folder.as_deref()
}

/// The patient whose record can be opened from a row; `None` for an unassigned or held scan.
pub fn record_patient<'a>(whole: &'a Whole, store: &str) -> Option<&'a str> {
    record_of(whole, store)?.patient.as_deref()
}

fn record_of<'a>(whole: &'a Whole, store: &str) -> Option<&'a Delivered> {
    let shown = theirs(whole);
    let may_be_opened = |of: &&Delivered| {
        let is_theirs = |patient| shown.len() == 1 && shown.contains(patient);
        of.patient.as_deref().is_none_or(is_theirs)
    };
    let is_there = |of: &&Delivered| of.store == store && of.is_there();
    let records = whole.deliveries.iter().filter(is_there).filter(may_be_opened);
    // A patient's record takes precedence over an unassigned one, which is about to be taken back.
    records.max_by_key(|of| of.patient.is_some())
}

/// The patients to whom it belongs, as they are shown.
fn patients(whole: &Whole) -> Vec<String> {
    theirs(whole).into_iter().map(shown::id).collect()
}

/// The ids of the patients to whom it belongs, each once; for a held scan, of those for whom it is held.
fn theirs(whole: &Whole) -> BTreeSet<&str> {
    let gone = |of: &Delivered| of.is_to_go() || of.state == DeliveryState::Withdrawn.word();
    let is_closed = whole.summary.closed.is_some();
    let is_held = |of: &Delivered| of.state == DeliveryState::Held.word();
    let is_any_held = whole.deliveries.iter().any(is_held) && !is_closed;
    let theirs = whole.deliveries.iter().filter(|of| match is_any_held {
        true => is_held(of),
        false => !(gone(of) || is_closed && is_held(of)),
    });
    theirs.filter_map(|of| of.patient.as_deref()).collect()
}
