//! `gaiter compare`: what changed from visit to visit of a patient.

mod records;
mod text;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use jiff::Zoned;

use self::records::Unusable;
use super::args::{CompareArgs, usual_config};
use super::report::put;
use super::terminal::{paint, screen};
use super::{Exit, complain, explain_config, print, shown};
use crate::config::{self, ConfigError, VisitsConfig};
use crate::language::Language;
use crate::record::report::{AgeMax, PdfFault, document_page, document_paper};
use crate::record::{Record, RecordFile, SUMS};
use crate::visits::report::ReportOf;
use crate::visits::schema::figures;
use crate::visits::{Choice, Course, CourseFault, GIRTH_COMMON_MM};

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
            Fault::Course { .. } => Exit::Unmeasurable,
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
}

/// Compares records and prints or writes what changed.
pub fn compare(args: &CompareArgs) -> Exit {
    let configured = match configured(&args.config) {
        Ok(configured) => configured,
        Err(exit) => return exit,
    };
    match compared(args, &configured) {
        Ok(()) => Exit::Done,
        Err(fault) => {
            complain(format_args!("gaiter: {fault}"));
            fault.exit()
        }
    }
}

fn compared(args: &CompareArgs, configured: &Configured) -> Result<(), Fault> {
    let found = records::at(&args.records)?;
    let records: Vec<Record> = found.iter().map(|of| of.record.clone()).collect();
    let choice = Choice {
        volume: args.volume,
        affected: args.affected,
        girth_common_mm: configured.girth_common_mm,
    };
    let course = Course::comparable(&records, choice).map_err(|fault| {
        let named = found.iter().enumerate();
        let named = named.map(|(at, of)| format!("{} {}", at + 1, shown(of.path.display())));
        Fault::Course { fault, names: named.collect::<Vec<_>>().join(", ") }
    })?;
    let report = ReportOf {
        course: &course,
        records: &records,
        thresholds: &configured.visits.thresholds,
        today: Zoned::now().date(),
        age_max: configured.age_max,
        language: args.language.unwrap_or(configured.language),
    };
    let json = format!(
        "{}\n",
        serde_json::to_string_pretty(&figures(&course, &configured.visits.thresholds))?
    );
    let said = match (&args.out, args.json) {
        (Some(out), _) => written(args, out, &report, json)?,
        (None, true) => json,
        (None, false) => text::of(&report.document(), screen::columns()),
    };
    let printed = match args.json || args.out.is_some() {
        true => print(said),
        false => paint::print(said),
    };
    printed.map_err(|source| Fault::Write { path: PathBuf::from("standard output"), source })
}

/// Writes the report and its figures, and returns their paths, one a line.
fn written(
    args: &CompareArgs,
    out: &Path,
    report: &ReportOf,
    json: String,
) -> Result<String, Fault> {
    if out.join(SUMS).symlink_metadata().is_ok() {
        return Err(Fault::RecordFolder(out.to_owned()));
    }
    let document = report.document();
    let page = document_page(&document, args.paper)?;
    let file = |name: &str, bytes: Vec<u8>| RecordFile { name: name.to_owned(), bytes };
    let files = [
        file("visits.html", page.into_bytes()),
        file("visits.pdf", document_paper(&document, args.paper)?),
        file("visits.json", json.into_bytes()),
    ];
    let fault = |path: &Path, source| Fault::Write { path: path.to_owned(), source };
    fs::create_dir_all(out).map_err(|source| fault(out, source))?;
    let mut said = String::new();
    for file in &files {
        let path = out.join(&file.name);
        put(&path, file, args.force).map_err(|source| match source.kind() {
            io::ErrorKind::AlreadyExists => Fault::There(path.clone()),
            _ => fault(&path, source),
        })?;
        said += &format!("{}\n", shown(path.display()));
    }
    Ok(said)
}

fn configured(path: &Path) -> Result<Configured, Exit> {
    match config::read(path) {
        Ok(config) => Ok(Configured {
            language: config.language,
            visits: config.visits,
            girth_common_mm: config.scanner.girth_error_mm,
            age_max: config.age_max,
        }),
        Err(ConfigError::Unreadable { source, .. })
            if source.kind() == io::ErrorKind::NotFound && path == usual_config() =>
        {
            Ok(Configured {
                language: Language::default(),
                visits: VisitsConfig::default(),
                girth_common_mm: GIRTH_COMMON_MM,
                age_max: AgeMax::default(),
            })
        }
        Err(error) => Err(explain_config(&error)),
    }
}
