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
use crate::lifecycle::REVISION_REFUSED;
use crate::patient::erasure::ERASED;
use crate::patient::identity::{PATIENTS_DIFFER, SAME_SCAN_OTHER_PATIENT};
use crate::{Closed, Disposition, ScanState, Task, round};

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
    /// Why it is held or was refused, or why a store does not take a later revision of its record.
    pub code: Option<String>,
    /// The same in words, and what to do.
    pub advice: Option<Advice>,
    /// Why it was refused, with figures, in English; for the technician.
    pub detail: Option<String>,
    /// The ids of the patients to whom it belongs; for a held scan, of those for whom it is held.
    pub patients: Vec<String>,
    /// For a held scan, the patients to whom it may belong and can be given.
    pub candidates: Vec<PatientShown>,
    /// For a record that can be taken back, the patient who has it.
    pub owner: Option<PatientShown>,
    /// For a refused scan that no store has, the one patient to whom it belongs, who can be named to be scanned
    /// again.
    pub again: Option<PatientShown>,
    /// What a person must do.
    pub task: Task,
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

/// What is known of a scan apart from the journal: read from its record, or from the preview of a held scan.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ScanDetails {
    /// Its record is stored, and only a result that nobody has fetched yet keeps another from its place.
    pub is_to_be_fetched: bool,
    pub measures: Option<RecordSummary>,
    pub files: Vec<String>,
    /// The code for why a held scan cannot be measured.
    pub unmeasured: Option<String>,
}

/// A scan as the page shows it.
pub fn scan_shown(whole: &Whole, details: &ScanDetails, language: Language) -> ScanShown {
    let is = whole.disposition();
    let code = match is {
        Disposition::Refused | Disposition::Closed => whole.summary.code.clone(),
        Disposition::Held => whole.held_for().map(str::to_owned),
        Disposition::Delivered => whole.is_revision_refused().then(|| REVISION_REFUSED.to_owned()),
        _ => None,
    };
    let held_as = |code| whole.held_as().unwrap_or(code);
    let unmeasured = details.unmeasured.as_deref().filter(|_| is == Disposition::Held);
    let advice = code.as_deref().and_then(|code| match (is, unmeasured) {
        (Disposition::Refused | Disposition::Delivered, _) => Some(of_refused(code, language)),
        // Whose it is does not matter where it cannot be used.
        (Disposition::Held, Some(why)) => {
            Some(of_refused(why, language).before(&of_held(held_as(code), language)))
        }
        (Disposition::Held, None) => Some(of_held(held_as(code), language)),
        _ => None,
    });
    let may_be_erased = is == Disposition::Held && whole.candidates.iter().any(|id| id == ERASED);
    let advice = advice.map(|advice| match may_be_erased {
        true => advice.and(language.text("page.scan.erased")),
        false => advice,
    });
    let state = if details.is_to_be_fetched { Disposition::Delivered } else { is }.word();
    let word = match (is, whole.summary.closed) {
        (Disposition::Closed, Some(why)) => language.word("page.scan.closed", why.word()),
        _ if details.is_to_be_fetched => language.text("page.scan.unfetched"),
        _ => language.word("page.scan", state),
    };
    let mut acts = acts(is, code.as_deref(), whole);
    acts.sort_by_key(|act| unmeasured.is_some() && *act != "give_up");
    let of = row_key(whole).unwrap_or_default();
    ScanShown {
        scan: whole.scan.clone(),
        of,
        at: whole.summary.first_seen,
        state,
        word,
        detail: whole.summary.message.clone().filter(|_| is == Disposition::Refused),
        code,
        advice,
        patients: whole.owners().into_iter().map(shown::id).collect(),
        candidates: candidates(is, &acts, whole),
        owner: only(is == Disposition::Delivered, whole),
        again: only(is == Disposition::Refused && !whole.has_record(), whole),
        task: whole.task(),
        acts,
        incomplete: whole.summary.incomplete,
        measures: details.measures.clone(),
        files: details.files.clone(),
        unmeasured: unmeasured
            .map(|code| format!("{} [{code}]", language.text("page.scan.no_picture"))),
    }
}

/// The key of the row of the only patient who has a record of a scan.
pub fn row_key(whole: &Whole) -> Option<String> {
    let theirs = whole.owners();
    let mut has_record = whole.deliveries.iter().filter(|of| of.is_there());
    let only = theirs.first().filter(|_| theirs.len() == 1)?;
    has_record.any(|of| of.patient.as_deref() == Some(only)).then(|| key(&whole.scan, only))
}

/// The verbs that help, the likeliest first. If the scan could belong to either of two patients, a
/// release would be a guess, so it is not offered.
fn acts(is: Disposition, code: Option<&str>, whole: &Whole) -> Vec<&'static str> {
    let is_guess = matches!(code, Some(PATIENTS_DIFFER | round::AMBIGUOUS | round::BESIDE))
        || whole.candidates.len() > 1;
    let is_for_one = whole.owners().len() == 1;
    let was_tried = whole.deliveries.iter().any(|delivery| delivery.attempts > 0);
    let was_taken_back = whole.deliveries.iter().any(Delivered::is_to_go);
    match is {
        // It was measured, and another store refused it: the id may be wrong.
        Disposition::Refused if whole.has_record() && is_for_one => {
            vec!["retry", "unassign", "give_up"]
        }
        Disposition::Refused if was_taken_back && whole.owners().is_empty() => {
            vec!["assign", "retry", "give_up"]
        }
        Disposition::Refused => vec!["retry", "give_up"],
        // Its bytes are gone; they come back with another export of the scan.
        Disposition::Closed if whole.summary.closed == Some(Closed::LetGo) => Vec::new(),
        Disposition::Closed if whole.summary.state == ScanState::Refused => vec!["retry"],
        Disposition::Closed | Disposition::Left => vec!["assign"],
        // It already belongs to a patient, so an assignment would be refused.
        Disposition::Held if code == Some(SAME_SCAN_OTHER_PATIENT) && is_for_one => {
            vec!["release", "give_up"]
        }
        Disposition::Held if code == Some(SAME_SCAN_OTHER_PATIENT) => vec!["give_up"],
        Disposition::Held if is_guess || !is_for_one => vec!["assign", "give_up"],
        Disposition::Held => vec!["release", "assign", "give_up"],
        Disposition::Spooled if was_tried => vec!["retry"],
        Disposition::Spooled | Disposition::Withdrawing => Vec::new(),
        Disposition::Unassigned => vec!["assign", "leave"],
        Disposition::Delivered if code == Some(REVISION_REFUSED) => vec!["retry", "unassign"],
        Disposition::Delivered => vec!["unassign"],
    }
}

/// To whom a held scan can be given with one click, without the patient to whom a release gives it, and without
/// persons who were erased.
fn candidates(is: Disposition, acts: &[&str], whole: &Whole) -> Vec<PatientShown> {
    if ![Disposition::Held, Disposition::Closed].contains(&is) || !acts.contains(&"assign") {
        return Vec::new();
    }
    let released = if acts.contains(&"release") { whole.owners() } else { BTreeSet::new() };
    let can_be_given = |id: &&String| *id != ERASED && !released.contains(id.as_str());
    distinct(whole.candidates.iter().filter(can_be_given))
}

/// The only patient to whom a scan belongs, if it is in the right place.
fn only(is_there: bool, whole: &Whole) -> Option<PatientShown> {
    let theirs = whole.owners();
    let only = theirs.first().filter(|_| is_there && theirs.len() == 1);
    only.map(|id| PatientShown::new(id))
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
    let shown = whole.owners();
    let may_be_opened = |of: &&Delivered| {
        let is_theirs = |patient| shown.len() == 1 && shown.contains(patient);
        of.patient.as_deref().is_none_or(is_theirs)
    };
    let is_there = |of: &&Delivered| of.store == store && of.is_there();
    let records = whole.deliveries.iter().filter(is_there).filter(may_be_opened);
    // A patient's record takes precedence over an unassigned one, which is about to be taken back.
    records.max_by_key(|of| of.patient.is_some())
}
