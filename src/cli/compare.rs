//! `gaiter compare`: what changed from visit to visit of a patient.

mod known;
mod records;
mod text;

use std::io;

use gaiter_record::report::{Paper, PdfFault, Print, page, paper as pdf};
use gaiter_record::{Record, RecordFile};
use gaiter_visits::report::ReportOf;
use gaiter_visits::schema::figures;
use gaiter_visits::{Affected, Choice, Course, CourseFault, GIRTH_COMMON_MM, LeftOut};
use jiff::Zoned;

use self::known::known;
use super::args::{CompareArgs, CompareChoice};
use super::ask::read_patient;
use super::report::{self, placed, written};
use super::terminal::{self, screen};
use super::{Exit, config_if_any, exit_of_printing, failed, print, report_choice, terminal_safe};
use crate::config::{Config, FolderStoreConfig};
use crate::station::runtime::chain;
use crate::store::revision::visits::PlacedRecord;
use crate::store::{FolderStore, RecordStore, StoreFault};

/// Why nothing was compared, or not written.
#[derive(Debug, thiserror::Error)]
enum CompareFault {
    /// A record cannot be read, or the files cannot be written.
    #[error(transparent)]
    Files(#[from] report::ReportFault),
    /// The records cannot be compared.
    #[error("{fault}; the records: {names}")]
    Course {
        fault: CourseFault,
        /// The paths, counted from 1.
        names: String,
    },
    /// No configuration names a store.
    #[error(
        "no configuration names a store; name one with --config FILE, or compare records by their paths: gaiter compare"
    )]
    NoStore,
    /// The store is out of reach.
    #[error("the store is out of reach: {}", terminal_safe(chain(.0)))]
    Unreached(StoreFault),
    /// The patient's id cannot be read.
    #[error("the patient's id cannot be read: {0}")]
    NoId(io::Error),
    /// No id was given.
    #[error("no patient's id was given")]
    EmptyId,
    /// The store has no record of the patient.
    #[error("the store has no record of this patient")]
    NoRecords,
    /// There is one visit only.
    #[error("this patient has records of one day only: there is nothing to compare")]
    OneVisit,
    /// Only one visit can be used.
    #[error("fewer than two visits of this patient can be used, because records are left out")]
    OneUsable,
    /// The comparison cannot be written as JSON.
    #[error("the comparison cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// The PDF cannot be made.
    #[error(transparent)]
    Paper(#[from] PdfFault),
}

impl From<&CompareFault> for Exit {
    fn from(fault: &CompareFault) -> Exit {
        match fault {
            CompareFault::Files(fault) => Exit::from(fault),
            CompareFault::Course { .. } | CompareFault::OneVisit | CompareFault::OneUsable => {
                Exit::Unmeasurable
            }
            CompareFault::NoStore | CompareFault::EmptyId => Exit::Usage,
            CompareFault::NoRecords => Exit::NoFile,
            CompareFault::NoId(_) | CompareFault::Unreached(_) => Exit::Io,
            CompareFault::Json(_) | CompareFault::Paper(_) => Exit::Internal,
        }
    }
}

/// Compares records and prints or writes what changed.
pub fn compare(args: &CompareArgs) -> Result<Exit, Exit> {
    ended(&args.how, |_| {
        let found = records::at(&args.records)?;
        let make = Course::comparable;
        let (left_out, affected) = (Vec::new(), None);
        Ok(Chosen { found, left_out, affected, is_affected_unreadable: false, make })
    })
}

/// Compares the visits of a patient in the station's store. The id comes from the operator.
pub fn visits(how: &CompareChoice) -> Result<Exit, Exit> {
    ended(how, |config| {
        let config = config.ok_or(CompareFault::NoStore)?;
        let FolderStoreConfig { path: root, access } = &config.store.folder;
        let (first, station) = (FolderStore::FIRST, &config.station.id);
        let store = FolderStore::new(first, root.clone(), station, *access);
        store.reach().map_err(CompareFault::Unreached)?;
        let patient = read_patient().map_err(CompareFault::NoId)?;
        if patient.is_empty() {
            return Err(CompareFault::EmptyId);
        }
        // First what was delivered, then what is there: a delivery in between is not reported as removed.
        let known = known(&how.config, &patient);
        let (found, left_out) = records::of_patient(root, &patient, &known.delivered)?;
        match (found.len(), left_out.is_empty()) {
            (0, true) => Err(CompareFault::NoRecords),
            (0 | 1, false) => Err(CompareFault::OneUsable),
            (1, true) => Err(CompareFault::OneVisit),
            _ => {
                let affected = known.affected.as_deref().and_then(Affected::of_word);
                let is_affected_unreadable = known.is_affected_unreadable;
                Ok(Chosen {
                    found,
                    left_out,
                    affected,
                    is_affected_unreadable,
                    make: Course::from_records,
                })
            }
        }
    })
}

/// What is compared.
struct Chosen {
    found: Vec<PlacedRecord>,
    left_out: Vec<LeftOut>,
    /// The affected leg, as it is kept with the patient.
    affected: Option<Affected>,
    /// Whether what is kept cannot be read.
    is_affected_unreadable: bool,
    make: fn(&[Record], Choice) -> Result<Course, CourseFault>,
}

fn ended(
    how: &CompareChoice,
    chosen: impl FnOnce(Option<&Config>) -> Result<Chosen, CompareFault>,
) -> Result<Exit, Exit> {
    let config = config_if_any(&how.config)?;
    let compared = chosen(config.as_ref()).and_then(|of| compared(how, config.as_ref(), of));
    compared.map_err(|fault| failed(&fault))
}

fn compared(
    how: &CompareChoice,
    config: Option<&Config>,
    Chosen { found, left_out, affected, is_affected_unreadable, make }: Chosen,
) -> Result<Exit, CompareFault> {
    let (configured, _) = report_choice(config);
    let thresholds = config.map(|config| config.visits.thresholds.as_slice()).unwrap_or_default();
    let records: Vec<Record> = found.iter().map(|of| of.record.clone()).collect();
    let choice = Choice {
        volume: how.volume,
        affected: how.affected.or(affected),
        girth_common_mm: config.map_or(GIRTH_COMMON_MM, |config| config.scanner.girth_error_mm),
    };
    let course = make(&records, choice).map_err(|fault| {
        let named = found.iter().enumerate();
        let named =
            named.map(|(at, of)| format!("{} {}", at + 1, terminal_safe(of.folder.display())));
        CompareFault::Course { fault, names: named.collect::<Vec<_>>().join(", ") }
    })?;
    let course = course.with_left_out(left_out);
    let course = course.with_affected_unreadable(is_affected_unreadable);
    let report = ReportOf {
        course: &course,
        records: &records,
        thresholds,
        today: Zoned::now().date(),
        age_max: configured.age_max,
        language: how.language.unwrap_or(configured.language),
    };
    let json = serde_json::to_string_pretty(&figures(&course, thresholds))? + "\n";
    let printed = match (&how.out, how.json) {
        (Some(out), _) => {
            let paths = placed(&files(&report, how.paper, json)?, out, how.force)?;
            print(written(&paths, false))
        }
        (None, true) => print(json),
        (None, false) => {
            terminal::print_painted(text::render(&report.document(), screen::columns()))
        }
    };
    Ok(exit_of_printing("the comparison", printed))
}

/// The file of the PDF.
const PAPER_NAME: &str = "visits.pdf";

/// The page, the PDF and the figures.
fn files(report: &ReportOf, paper: Paper, json: String) -> Result<[RecordFile; 3], CompareFault> {
    let document = report.document_beside(PAPER_NAME);
    let page = page(&document, paper)?;
    let file = |name: &str, bytes: Vec<u8>| RecordFile { name: name.to_owned(), bytes };
    Ok([
        file("visits.html", page.into_bytes()),
        file(PAPER_NAME, pdf(&document, Print { paper, has_appendix: false })?),
        file("visits.json", json.into_bytes()),
    ])
}
