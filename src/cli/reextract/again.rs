//! Checks one record, measures its scan again, and adds a revision if the result differs.

use std::io;

use gaiter_leg::{Refusal, extract as measure};
use gaiter_record::change::{Changes, Sameness, changes};
use gaiter_record::{self as record, FilesFault, ORD, Provenance, ScanFile};
use gaiter_scan::Format;
use serde::Serialize;

use super::choices::{Choices, RecordChoices};
use crate::cli::{Exit, ord};
use crate::store::revision::stored::{Stored, StoredFault};
use crate::store::revision::{Added, Family};

/// Why a record was not measured again.
#[derive(Debug, thiserror::Error)]
pub enum ReextractFault {
    /// It cannot be read.
    #[error(transparent)]
    Stored(#[from] StoredFault),
    /// Today's method refuses the scan.
    #[error("{refusal}")]
    Refused {
        #[from]
        refusal: Refusal,
    },
    /// The files of the new record cannot be created.
    #[error("the new record cannot be written: {0}")]
    NotMade(#[from] FilesFault),
    /// A fault of gaiter itself.
    #[error("{0}")]
    Panic(String),
    /// A folder or file cannot be read or written at the moment.
    #[error("reading or writing failed: {0}")]
    Io(#[from] io::Error),
}

impl ReextractFault {
    /// The stable code.
    pub fn code(&self) -> &'static str {
        match self {
            ReextractFault::Stored(fault) => fault.code(),
            ReextractFault::Refused { refusal } => refusal.code(),
            ReextractFault::NotMade(_) => "record-not-written",
            ReextractFault::Panic(_) => "panic",
            ReextractFault::Io(_) => "record-io",
        }
    }
}

impl From<&ReextractFault> for Exit {
    fn from(fault: &ReextractFault) -> Exit {
        match fault {
            ReextractFault::Stored(StoredFault::Io(_)) | ReextractFault::Io(_) => Exit::Io,
            ReextractFault::Stored(_) | ReextractFault::Refused { .. } => Exit::Unmeasurable,
            ReextractFault::NotMade(_) | ReextractFault::Panic(_) => Exit::Internal,
        }
    }
}

/// The outcome for a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ReextractOutcome {
    /// Today's method gives the same result, as far as the old record goes.
    Unchanged,
    /// It gives a different or more complete result, and a revision was added.
    Revised,
    /// It gives a different or more complete result, but nothing was to be written.
    WouldBeRevised,
    /// The record was taken back from its patient in the meantime.
    Withdrawn,
}

/// A record that was measured again.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Again {
    pub outcome: ReextractOutcome,
    /// The revision it was compared with: the latest.
    pub from_revision: u32,
    /// The new revision; null if none was added.
    pub revision: Option<u32>,
    #[serde(flatten)]
    pub changes: Changes,
}

/// What to write.
#[derive(Debug, Clone, Copy)]
pub struct Intent {
    /// Also write a revision if the record only lacks what an older gaiter did not write.
    pub complete: bool,
    /// Write nothing at all.
    pub dry_run: bool,
}

/// Measures the scan of a record again.
///
/// # Errors
/// See [`ReextractFault`]; the record stays unchanged.
pub fn again(family: &Family, choices: &Choices, intent: Intent) -> Result<Again, ReextractFault> {
    let stored = Stored::read(family)?;
    let format = Format::of_file_name(&stored.scan_file).map_err(Refusal::from)?;
    let scan = stored.listed_file(&stored.scan_file)?;
    let ord = stored.optional_file(ORD)?;
    let Stored { record: old, json: old_json, .. } = stored;
    let RecordChoices { method, output, report } = choices.for_record(&old);
    let mut extraction = measure(&scan, format, &method)?;
    if let Some(ord) = &ord {
        let opinions = ord::opinion(ord, &extraction);
        extraction.findings.extend(opinions);
    }
    let (name, _) = family.latest();
    let revision = name.revision.max(old.revision).saturating_add(1);
    let provenance = Provenance {
        station: old.station.clone(),
        patient: old.patient.clone(),
        acquired: old.acquired.clone(),
        sha256: old.scan.sha256.clone(),
        phantom_check: old.phantom_check.clone(),
        revision,
        amendments: old.amendments.clone(),
    };
    let scan = ScanFile { bytes: &scan, format, ord: ord.as_deref() };
    let made = record::record_files(&extraction, &provenance, &method, &output, &report, scan);
    let (new, files) = made?;
    let changes = changes(&old, &old_json, &new).map_err(FilesFault::from)?;
    let written = match changes.sameness {
        Sameness::Same => false,
        Sameness::Gained => intent.complete,
        Sameness::Differs => true,
    };
    let outcome = match (written, intent.dry_run) {
        (false, _) => ReextractOutcome::Unchanged,
        (true, true) => ReextractOutcome::WouldBeRevised,
        (true, false) => match family.add(revision, &files)? {
            Added::There(_) => ReextractOutcome::Revised,
            Added::Withdrawn => ReextractOutcome::Withdrawn,
        },
    };
    let revision = (outcome == ReextractOutcome::Revised).then_some(revision);
    Ok(Again { outcome, from_revision: old.revision, revision, changes })
}
