//! Why a decision was not carried out.

use std::fmt::Display;

use gaiter_flow::ScanId;
use gaiter_flow::cause::Cause;
use gaiter_flow::page::of_fault;
use gaiter_language::Language;
use gaiter_record::measure::amendment::AmendFault;

use crate::station::custody::CustodyFault;
use crate::station::journal::JournalError;
use crate::store::revision::amend as amend_record;

/// Why a decision was not carried out; nothing was changed. Displayed in English.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.in_words(Language::En))]
pub enum ActFault {
    /// No scan has this id.
    Unknown,
    /// The scan's state does not allow the decision.
    NoOccasion {
        scan: ScanId,
        /// The key of its state, and of what there is not to be done.
        why: &'static str,
    },
    /// It could belong to more than one patient, and the decision names none.
    Several(ScanId),
    /// The bytes are gone.
    NoBytes(ScanId),
    /// The id does not match `patient.pattern`.
    NotAnId,
    /// Another patient is named and must not be replaced.
    AnotherNamed,
    /// The entry is not on the worklist any more.
    EntryGone,
    /// The value to set is not possible.
    NotSet(AmendFault),
    /// The record cannot be amended now.
    NotAmended(amend_record::AmendRecordFault),
    /// The scan already belongs to a patient.
    HasPatient,
    #[error(transparent)]
    Custody(#[from] CustodyFault),
    Journal(#[from] JournalError),
    /// The store is out of reach, and only it has the bytes.
    Store(Cause),
}

impl ActFault {
    /// The stable code.
    pub fn code(&self) -> &'static str {
        match self {
            ActFault::Unknown => "unknown-scan",
            ActFault::NoOccasion { .. } => "no-occasion",
            ActFault::Several(_) => "scan-of-several",
            ActFault::NoBytes(_) => "bytes-gone",
            ActFault::NotAnId => "patient-id-not-allowed",
            ActFault::AnotherNamed => "another-is-named",
            ActFault::EntryGone => "worklist-entry-gone",
            ActFault::NotSet(fault) if fault.is_far_off() => "measure-far-off",
            ActFault::NotSet(_) => "measure-not-possible",
            ActFault::NotAmended(_) => "record-not-amended",
            ActFault::HasPatient => "scan-of-a-patient",
            ActFault::Custody(_) => "custody-failed",
            ActFault::Journal(_) => "journal-failed",
            ActFault::Store(_) => "store-unavailable",
        }
    }

    /// The fault in a sentence for the terminal.
    pub fn in_words(&self, language: Language) -> String {
        let text = |key| language.text(key).to_owned();
        let of_scan = |key, scan: &ScanId| language.filled(key, &[("scan", &scan.short())]);
        let because = |key, why: &dyn Display| language.filled(key, &[("why", why)]);
        match self {
            ActFault::Unknown => text("act.fault.unknown"),
            ActFault::NoOccasion { scan, why } => {
                let why = language.text(why);
                language.filled("act.fault.no_occasion", &[("scan", &scan.short()), ("why", &why)])
            }
            ActFault::Several(scan) => of_scan("act.fault.several", scan),
            ActFault::NoBytes(scan) => of_scan("act.fault.no_bytes", scan),
            ActFault::NotAnId => text("act.fault.not_an_id"),
            ActFault::NotSet(fault) => because("act.fault.not_set", &fault.in_words(language)),
            ActFault::NotAmended(fault) => {
                because("act.fault.not_set", &fault.cause().in_words(language))
            }
            // They have no figures: page and terminal have the same text.
            ActFault::AnotherNamed | ActFault::EntryGone | ActFault::HasPatient => {
                of_fault(self.code(), language).unwrap_or_else(|| self.code()).to_owned()
            }
            ActFault::Custody(fault) => fault.to_string(),
            ActFault::Journal(_) => text("act.fault.journal"),
            ActFault::Store(why) => because("act.fault.store", &why.in_words(language)),
        }
    }

    /// What the page shows instead of the text of the code: a sentence with figures.
    pub fn on_page(&self, language: Language) -> Option<String> {
        match self {
            ActFault::NotSet(fault) => Some(fault.in_words(language)),
            _ => None,
        }
    }
}

impl From<amend_record::AmendRecordFault> for ActFault {
    fn from(fault: amend_record::AmendRecordFault) -> ActFault {
        match fault {
            amend_record::AmendRecordFault::Amend(fault) => ActFault::NotSet(fault),
            fault => ActFault::NotAmended(fault),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red while the terminal had words of its own for them.
    #[test]
    fn what_needs_no_figures_is_said_at_the_terminal_as_on_the_page() {
        for fault in [ActFault::AnotherNamed, ActFault::EntryGone, ActFault::HasPatient] {
            for language in Language::ALL {
                let on_page = of_fault(fault.code(), language);
                assert_eq!(Some(fault.in_words(language).as_str()), on_page, "{language:?}");
            }
        }
    }
}
