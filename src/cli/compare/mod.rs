//! `gaiter compare`: what changed from visit to visit of a patient.

mod known;
mod records;
mod text;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_language::Language;
use gaiter_record::report::{self, AgeMax, Paper, PdfFault, Print};
use gaiter_record::{Record, RecordFile, SUMS};
use gaiter_visits::report::ReportOf;
use gaiter_visits::schema::figures;
use gaiter_visits::{Affected, Choice, Course, CourseFault, GIRTH_COMMON_MM, LeftOut};
use jiff::Zoned;

use self::known::known;
use self::records::{Found, Unusable};
use super::args::{CompareArgs, CompareChoice, usual_config};
use super::ask::read_patient;
use super::report::put;
use super::terminal::{paint, screen};
use super::{Exit, complain, explain_config, print, shown};
use crate::config::{self, Config, ConfigError, FolderStoreConfig, VisitsConfig};
use crate::station::runtime::causes::chain;
use crate::store::{FolderStore, RecordStore, StoreFault};

/// Why nothing was compared, or not written.
#[derive(Debug, thiserror::Error)]
enum Fault {
    /// A record cannot be used.
    #[error(transparent)]
    Unusable(#[from] Unusable),
    /// The records cannot be compared.
    #[error("{fault}; the records: {names}")]
    Course {
        /// Why.
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
    #[error("the store is out of reach: {}", shown(chain(.0)))]
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
    /// The destination is the folder of a record.
    #[error(
        "{} is the folder of a record, and {SUMS} covers every file in it; nothing was written: \
         choose another folder with --out DIR",
        shown(.0.display())
    )]
    RecordFolder(PathBuf),
    /// A file of the name is there.
    #[error("{} is there already; nothing was replaced: --force replaces it", shown(.0.display()))]
    There(PathBuf),
    /// It cannot be written or printed.
    #[error("cannot write {}: {source}", shown(path.display()))]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// The underlying error.
        source: io::Error,
    },
}

impl Fault {
    fn exit(&self) -> Exit {
        match self {
            Fault::Unusable(unusable) => unusable.exit(),
            Fault::Course { .. } | Fault::OneVisit | Fault::OneUsable => Exit::Unmeasurable,
            Fault::NoStore | Fault::EmptyId => Exit::Usage,
            Fault::NoRecords => Exit::NoFile,
            Fault::NoId(_) | Fault::Unreached(_) => Exit::Io,
            Fault::RecordFolder(_) | Fault::There(_) => Exit::Usage,
            Fault::Json(_) | Fault::Paper(_) => Exit::Internal,
            Fault::Write { .. } => Exit::Io,
        }
    }
}

/// What the configuration of a station says about visits; the defaults on a machine without one.
struct Configured {
    language: Language,
    visits: VisitsConfig,
    girth_common_mm: f64,
    age_max: AgeMax,
    /// The folder of the first store; `None` without a configuration.
    store: Option<(FolderStore, PathBuf)>,
}

/// Compares records and prints or writes what changed.
pub fn compare(args: &CompareArgs) -> Exit {
    ended(&args.how, |_| {
        let found = records::at(&args.records)?;
        let make = Course::comparable;
        let (left_out, affected) = (Vec::new(), None);
        Ok(Chosen { found, left_out, affected, is_affected_unreadable: false, make })
    })
}

/// Compares the visits of a patient in the station's store. The id comes from the operator.
pub fn visits(how: &CompareChoice) -> Exit {
    ended(how, |configured| {
        let (store, root) = configured.store.as_ref().ok_or(Fault::NoStore)?;
        store.reach().map_err(Fault::Unreached)?;
        let patient = read_patient().map_err(Fault::NoId)?;
        if patient.is_empty() {
            return Err(Fault::EmptyId);
        }
        // First what was delivered, then what is there: a delivery in between is not told as removed.
        let known = known(&how.config, &patient);
        let (found, left_out) = records::of_patient(root, &patient, &known.delivered)?;
        match (found.len(), left_out.is_empty()) {
            (0, true) => Err(Fault::NoRecords),
            (0 | 1, false) => Err(Fault::OneUsable),
            (1, true) => Err(Fault::OneVisit),
            _ => {
                let affected = known.affected.as_deref().and_then(Affected::of_word);
                let is_affected_unreadable = known.is_affected_unreadable;
                Ok(Chosen { found, left_out, affected, is_affected_unreadable, make: Course::of })
            }
        }
    })
}

/// What is compared.
struct Chosen {
    found: Vec<Found>,
    left_out: Vec<LeftOut>,
    /// The affected leg, as it is kept with the patient.
    affected: Option<Affected>,
    /// Whether what is kept cannot be read.
    is_affected_unreadable: bool,
    /// Makes a course of records.
    make: fn(&[Record], Choice) -> Result<Course, CourseFault>,
}

fn ended(how: &CompareChoice, chosen: impl FnOnce(&Configured) -> Result<Chosen, Fault>) -> Exit {
    let configured = match configured(&how.config) {
        Ok(configured) => configured,
        Err(exit) => return exit,
    };
    match chosen(&configured).and_then(|chosen| compared(how, &configured, chosen)) {
        Ok(()) => Exit::Done,
        Err(fault) => {
            complain(format_args!("gaiter: {fault}"));
            fault.exit()
        }
    }
}

fn compared(
    how: &CompareChoice,
    configured: &Configured,
    Chosen { found, left_out, affected, is_affected_unreadable, make }: Chosen,
) -> Result<(), Fault> {
    let records: Vec<Record> = found.iter().map(|of| of.record.clone()).collect();
    let choice = Choice {
        volume: how.volume,
        affected: how.affected.or(affected),
        girth_common_mm: configured.girth_common_mm,
    };
    let course = make(&records, choice).map_err(|fault| {
        let named = found.iter().enumerate();
        let named = named.map(|(at, of)| format!("{} {}", at + 1, shown(of.path.display())));
        Fault::Course { fault, names: named.collect::<Vec<_>>().join(", ") }
    })?;
    let course = course.with_left_out(left_out);
    let course = course.with_affected_unreadable(is_affected_unreadable);
    let report = ReportOf {
        course: &course,
        records: &records,
        thresholds: &configured.visits.thresholds,
        today: Zoned::now().date(),
        age_max: configured.age_max,
        language: how.language.unwrap_or(configured.language),
    };
    let json = format!(
        "{}\n",
        serde_json::to_string_pretty(&figures(&course, &configured.visits.thresholds))?
    );
    let printed = match (&how.out, how.json) {
        (Some(out), _) => print(written(how, out, &report, json)?),
        (None, true) => print(json),
        (None, false) => paint::print(text::of(&report.document(), screen::columns())),
    };
    printed.map_err(|source| Fault::Write { path: PathBuf::from("standard output"), source })
}

/// Writes the report and its figures, and returns their paths, one a line.
fn written(
    how: &CompareChoice,
    out: &Path,
    report: &ReportOf,
    json: String,
) -> Result<String, Fault> {
    if out.join(SUMS).symlink_metadata().is_ok() {
        return Err(Fault::RecordFolder(out.to_owned()));
    }
    let files = files(report, how.paper, json)?;
    let fault = |path: &Path, source| Fault::Write { path: path.to_owned(), source };
    fs::create_dir_all(out).map_err(|source| fault(out, source))?;
    let mut said = String::new();
    for file in &files {
        let path = out.join(&file.name);
        put(&path, file, how.force).map_err(|source| match source.kind() {
            io::ErrorKind::AlreadyExists => Fault::There(path.clone()),
            _ => fault(&path, source),
        })?;
        said += &format!("{}\n", shown(path.display()));
    }
    Ok(said)
}

/// The file of the PDF.
const PAPER_NAME: &str = "visits.pdf";

/// The page, the PDF and the figures.
fn files(report: &ReportOf, paper: Paper, json: String) -> Result<[RecordFile; 3], Fault> {
    let document = report.document_beside(PAPER_NAME);
    let page = report::page(&document, paper)?;
    let file = |name: &str, bytes: Vec<u8>| RecordFile { name: name.to_owned(), bytes };
    Ok([
        file("visits.html", page.into_bytes()),
        file(PAPER_NAME, report::paper(&document, Print { paper, has_appendix: false })?),
        file("visits.json", json.into_bytes()),
    ])
}

fn configured(path: &Path) -> Result<Configured, Exit> {
    match config::read(path) {
        Ok(config) => Ok(Configured {
            language: config.language,
            visits: config.visits.clone(),
            girth_common_mm: config.scanner.girth_error_mm,
            age_max: config.age_max,
            store: Some(store(config)),
        }),
        Err(ConfigError::Unreadable { source, .. })
            if source.kind() == io::ErrorKind::NotFound && path == usual_config() =>
        {
            Ok(Configured {
                language: Language::default(),
                visits: VisitsConfig::default(),
                girth_common_mm: GIRTH_COMMON_MM,
                age_max: AgeMax::default(),
                store: None,
            })
        }
        Err(error) => Err(explain_config(&error)),
    }
}

/// The first store of a station, and its folder.
fn store(config: Config) -> (FolderStore, PathBuf) {
    let FolderStoreConfig { path, access } = config.store.folder;
    (FolderStore::new(FolderStore::FIRST, path.clone(), &config.station.id, access), path)
}
