//! What the operator's page shows, ready to be displayed: which sentence, which decisions, in which
//! language. The page itself only puts these texts into place.
//!
//! ```text
//! facts, complaints, booth ─▶ light, next patient, parts ┐
//! scans of the journal, their measures ─▶ scans ─────────┴▶ Shown
//! ```

pub mod files;
mod light;
mod next;
mod parts;
mod reasons;
pub mod rows;
mod scans;
mod sentence;

use gaiter_language::Language;
use gaiter_record::shown;
use jiff::Timestamp;
use serde::Serialize;

use super::complaint::{Complaint, Severity};
use super::facts::{Facts, IntakeState};
use super::light::first_fault;
use super::patient::identity::NO_PRESS;
pub use light::{LightShown, Situation};
pub use next::{NextShown, next_shown};
pub use parts::PartShown;
pub use reasons::{Advice, of_complaint, of_fault, of_held, of_refused};
pub use scans::{ScanDetails, ScanShown, record_folder, record_patient, row_key, scan_shown};
pub use sentence::Sentence;

/// Who sees patients' ids on the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IdsShown {
    Nobody,
    /// People with the station's token.
    Operator,
    /// Everyone who can read the page.
    Everyone,
}

impl IdsShown {
    /// Whether they are shown to a reader.
    pub fn to(self, is_operator: bool) -> bool {
        match self {
            IdsShown::Nobody => false,
            IdsShown::Operator => is_operator,
            IdsShown::Everyone => true,
        }
    }
}

/// The station as the page shows it at one moment. Every text is ready to be displayed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Shown {
    /// The version of the page's files: a page loaded from another version reloads itself.
    pub page: String,
    /// The station's name.
    pub station: String,
    pub light: LightShown,
    pub next: NextShown,
    /// The operator has paused the station.
    pub paused: bool,
    /// What keeps the station from being ready, then what a person should know.
    pub complaints: Vec<ComplaintShown>,
    /// Scans about which a person must do something, newest first.
    pub undecided: Vec<ScanShown>,
    /// How many more of these there are than are shown.
    pub more_undecided: u64,
    /// The latest scans, newest first, whatever their outcome.
    pub scans: Vec<ScanShown>,
    /// Export folders, ports and stores.
    pub parts: Vec<PartShown>,
    /// Which entries the worklist has; an operator's page asks for them when it changes. `None` if there is no
    /// worklist.
    pub worklist: Option<String>,
    /// Patients' ids are shown to this reader.
    pub ids: bool,
}

/// A patient on the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PatientShown {
    /// The id, as it is sent back with a decision.
    pub id: String,
    /// The id in readable form: nothing in it is hidden.
    pub shown: String,
}

impl PatientShown {
    /// The patient of this id.
    pub fn new(id: &str) -> PatientShown {
        PatientShown { id: id.to_owned(), shown: shown::id(id) }
    }
}

/// Patients by their ids, each once, in the given order.
fn distinct<'a>(ids: impl IntoIterator<Item = &'a String>) -> Vec<PatientShown> {
    let mut found: Vec<PatientShown> = Vec::new();
    for id in ids {
        if found.iter().all(|patient| patient.id != *id) {
            found.push(PatientShown::new(id));
        }
    }
    found
}

/// Something that keeps the station from being ready, or that a person should know.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ComplaintShown {
    /// Stable code.
    pub code: String,
    /// Whether it keeps the station from being ready; it decides the colour.
    pub severity: Severity,
    /// What is wrong and what to do.
    #[serde(flatten)]
    pub advice: Advice,
}

/// What is known about the station apart from its scans.
#[derive(Debug, Clone, Copy)]
pub struct StationView<'a> {
    /// The version of its page's files.
    pub page: &'a str,
    /// Its name.
    pub station: &'a str,
    /// What its workers know.
    pub facts: &'a Facts,
    /// What keeps it from being ready.
    pub complaints: &'a [Complaint],
    pub booth: Situation<'a>,
    pub now: Timestamp,
}

/// Assembles the page.
pub fn assemble(
    known: &StationView<'_>,
    mut undecided: Vec<ScanShown>,
    more_undecided: u64,
    scans: Vec<ScanShown>,
    language: Language,
) -> Shown {
    let complaints = known.complaints.iter().map(|complaint| ComplaintShown {
        code: complaint.code.clone(),
        severity: complaint.severity,
        advice: of_complaint(complaint, language),
    });
    offer_named(&known.booth, &mut undecided);
    let fault = first_fault(known.complaints);
    let mut next = next::next_shown(&known.booth, language);
    // That ends the complaint.
    next.can_be_called_off |= known.facts.gone() > 0;
    Shown {
        page: known.page.to_owned(),
        station: known.station.to_owned(),
        light: light::light_shown(&known.booth, fault, &undecided, language),
        next,
        paused: known.facts.intake == IntakeState::Paused,
        complaints: complaints.collect(),
        undecided,
        more_undecided,
        scans,
        parts: parts::parts_shown(known.facts, known.now, language),
        worklist: known.facts.worklist.as_ref().map(|worklist| {
            // The editions of another run are others.
            format!("{}-{}", known.facts.started.as_second(), worklist.edition)
        }),
        ids: true,
    }
}

/// The last scan may be that of somebody who is named, if its press may have been missed: it can be given to each of
/// them with one click.
fn offer_named(booth: &Situation<'_>, undecided: &mut [ScanShown]) {
    let is_to_assign = |scan: &ScanShown| {
        Some(scan.scan.as_str()) == booth.last_scan
            && (booth.is_in_doubt || scan.code.as_deref() == Some(NO_PRESS))
            && scan.candidates.is_empty()
            && scan.acts.contains(&"assign")
            && !scan.acts.contains(&"release")
    };
    for scan in undecided.iter_mut().filter(|scan| is_to_assign(scan)) {
        scan.candidates = distinct(booth.next);
    }
}

impl Shown {
    /// The same for readers who may not know whose scans these are.
    pub fn without_ids(mut self) -> Shown {
        self.ids = false;
        self.worklist = None;
        self.light.said.hide_ids();
        self.next.hide_ids();
        for scan in self.undecided.iter_mut().chain(&mut self.scans) {
            // It is made from the patient's id, and short ids can be tried.
            scan.of.clear();
            scan.patients.clear();
            scan.candidates.clear();
            scan.owner = None;
            scan.again = None;
            // A folder of the store has the name of a patient.
            scan.detail = None;
        }
        self
    }
}

#[cfg(test)]
mod tests;
