//! A scan on the page: what became of it, why, and what a person can decide.

use std::collections::BTreeSet;

use jiff::Timestamp;
use serde::Serialize;

use super::reasons::{Advice, of_held, of_refused};
use super::words::say;
use crate::flow::account::{Delivered, Whole};
use crate::flow::identity::{PATIENTS_DIFFER, SAME_SCAN_OTHER_PATIENT};
use crate::flow::{DeliveryState, ScanState, capture};
use crate::record::{Brief, Language, shown};

/// One scan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScanShown {
    /// Its id, all digits.
    pub scan: String,
    /// When the station first saw it.
    pub at: Timestamp,
    /// `spooled`, `delivered`, `unassigned`, `held` or `refused`; colour and sign hang on it.
    pub state: &'static str,
    /// What became of it, in a word or two.
    pub word: &'static str,
    /// Why it is held or was refused.
    pub code: Option<String>,
    /// Likewise in words, and what to do.
    pub advice: Option<Advice>,
    /// The ids of those whose it is; of a held scan, of those for whom it is held.
    pub patients: Vec<String>,
    /// What a person can decide.
    pub acts: Vec<&'static str>,
    /// Its measures, once its record was read.
    pub measures: Option<Brief>,
    /// The files of its record that can be opened.
    pub files: Vec<&'static str>,
}

/// What was read of a scan's record.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Told {
    /// Its measures.
    pub measures: Option<Brief>,
    /// Its files that can be opened.
    pub files: Vec<&'static str>,
}

/// Where a scan is, for a person who decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Refused,
    Held,
    Waiting,
    Nobodys,
    Somebodys,
}

/// A scan as the page shows it.
pub fn shown(whole: &Whole, told: &Told, language: Language) -> ScanShown {
    let place = place(whole);
    let held = |delivery: &&Delivered| delivery.state == DeliveryState::Held.word();
    let code = match place {
        Place::Refused => whole.summary.code.clone(),
        Place::Held => {
            let code = whole.deliveries.iter().find(held).and_then(|held| held.code.clone());
            Some(code.unwrap_or_else(|| SAME_SCAN_OTHER_PATIENT.to_owned()))
        }
        _ => None,
    };
    let advice = code.as_deref().map(|code| match place {
        Place::Refused => of_refused(code, language),
        _ => of_held(code, language),
    });
    let word = match place {
        Place::Refused => ("Refused", "Abgelehnt"),
        Place::Held => ("Held", "Angehalten"),
        Place::Waiting => ("On its way", "Unterwegs"),
        Place::Nobodys => ("For nobody", "Ohne Person"),
        Place::Somebodys => ("Stored", "Gespeichert"),
    };
    ScanShown {
        scan: whole.scan.clone(),
        at: whole.summary.first_seen,
        state: match place {
            Place::Refused => "refused",
            Place::Held => "held",
            Place::Waiting => "spooled",
            Place::Nobodys => "unassigned",
            Place::Somebodys => "delivered",
        },
        word: say(language, word),
        acts: acts(place, code.as_deref(), whole),
        code,
        advice,
        patients: patients(whole),
        measures: told.measures.clone(),
        files: told.files.clone(),
    }
}

/// A refusal and a decision that is missing go before what else may be under way.
fn place(whole: &Whole) -> Place {
    let is_any = |state: DeliveryState| {
        whole.deliveries.iter().any(|delivery| delivery.state == state.word())
    };
    let has_owner = whole.deliveries.iter().any(|delivery| {
        delivery.patient.is_some() && delivery.state == DeliveryState::Delivered.word()
    });
    if whole.summary.state == ScanState::Refused.word() {
        Place::Refused
    } else if is_any(DeliveryState::Held) {
        Place::Held
    } else if is_any(DeliveryState::Pending) {
        Place::Waiting
    } else if has_owner {
        Place::Somebodys
    } else {
        Place::Nobodys
    }
}

/// What helps, the likeliest first; the words are those of the verbs. Where it could be either of
/// two patients a release would be a guess, so it is not offered.
fn acts(place: Place, code: Option<&str>, whole: &Whole) -> Vec<&'static str> {
    let is_guess = matches!(code, Some(PATIENTS_DIFFER | capture::AMBIGUOUS));
    match place {
        Place::Refused => vec!["retry"],
        Place::Held if is_guess || patients(whole).is_empty() => vec!["assign"],
        // It is somebody else's already, and an assignment would be refused.
        Place::Held if code == Some(SAME_SCAN_OTHER_PATIENT) => vec!["release"],
        Place::Held => vec!["release", "assign"],
        Place::Waiting if whole.deliveries.iter().any(|delivery| delivery.attempts > 0) => {
            vec!["retry"]
        }
        Place::Waiting => Vec::new(),
        Place::Nobodys => vec!["assign"],
        // Of two patients' records a person takes the wrong one away, who sees both.
        Place::Somebodys if theirs(whole).len() > 1 => Vec::new(),
        Place::Somebodys => vec!["unassign"],
    }
}

/// The folder in `store` of the record that may be opened from a scan: one that names nobody, or the
/// only patient with whom the scan is shown. Whose name stands there never opens another's record.
pub fn record_folder<'a>(whole: &'a Whole, store: &str) -> Option<&'a str> {
    let shown = theirs(whole);
    let may_be_opened = |of: &&Delivered| {
        let is_theirs = |patient| shown.len() == 1 && shown.contains(patient);
        of.patient.as_deref().is_none_or(is_theirs)
    };
    let is_there =
        |of: &&Delivered| of.store == store && of.state == DeliveryState::Delivered.word();
    let records = whole.deliveries.iter().filter(is_there).filter(may_be_opened);
    // A patient's record goes before nobody's, which is about to be taken back.
    records.max_by_key(|of| of.patient.is_some())?.folder.as_deref()
}

/// Those whose it is, as they are shown.
fn patients(whole: &Whole) -> Vec<String> {
    theirs(whole).into_iter().map(shown::id).collect()
}

/// The ids of those whose it is, each once; of a held scan, of those for whom it is held.
fn theirs(whole: &Whole) -> BTreeSet<&str> {
    let gone = [DeliveryState::Withdrawing.word(), DeliveryState::Withdrawn.word()];
    let is_held = |of: &Delivered| of.state == DeliveryState::Held.word();
    let is_any_held = whole.deliveries.iter().any(is_held);
    let theirs = whole
        .deliveries
        .iter()
        .filter(|of| if is_any_held { is_held(of) } else { !gone.contains(&of.state.as_str()) });
    theirs.filter_map(|of| of.patient.as_deref()).collect()
}
