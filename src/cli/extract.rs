//! `gaiter extract`: measures scan files now, without a station.

mod found;
mod names;
mod place;
mod summary;

use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_cad::Output;
use gaiter_leg::method::Up;
use gaiter_leg::{BodyFault, Method, Refusal, extract as measure};
use gaiter_record::{
    self as record, FilesFault, Provenance, Record, RecordFile, ReportChoice, ScanFile,
};
use gaiter_scan::Format;

use super::args::ExtractArgs;
use super::parallel::{in_order, usual_jobs};
use super::terminal::progress::Progress;
use super::terminal::{self, screen, table};
use super::{
    Exit, complain, config_at, exit_of_printing, failed, ord, print, report_choice, terminal_safe,
};
use crate::config::words;
use found::{FolderFault, found};
use names::Names;
use place::{Foreign, put_folder};
use summary::{Row, summary};

/// Measures every file, prints a table or a JSON line for each, and returns the worst exit.
pub fn extract(args: &ExtractArgs) -> Result<Exit, Exit> {
    let choices = Choices::from_args(args)?;
    let scans = found(&args.scans, args.recursive);
    if let Some(out) = &args.out
        && let Some([one, other]) = same_folder(&scans)
    {
        let stem = one.file_stem().unwrap_or_default();
        complain(format_args!(
            "gaiter: {} and {} would both go to {}; rename one, or measure them with different --out",
            terminal_safe(one.display()),
            terminal_safe(other.display()),
            terminal_safe(out.join(stem).display()),
        ));
        return Err(Exit::Usage);
    }
    // A folder may hold one scan today and many tomorrow, so the output has the same form for both.
    let several = scans.len() > 1 || args.scans.iter().any(|scan| scan.is_dir());
    let names = Names::for_scans(scans.iter().flatten().map(PathBuf::as_path));
    let columns = screen::columns();
    let run = Run { args, choices, names, columns, is_one_of_several: several };
    if several
        && !args.json
        && let Some(folder) = run.names.folder()
    {
        // If it cannot be printed, neither can the tables, which report it.
        let _ = print(format_args!("{folder}:\n\n"));
    }
    let jobs = args.jobs.unwrap_or_else(usual_jobs);
    let progress = Progress::new(scans.len(), "measuring");
    let (mut worst, mut rows) = (Exit::Done, Vec::new());
    let work = |scan: &Result<PathBuf, FolderFault>| {
        let measured = scan.as_ref().ok().map(|path| Measured::measure(path, args, &run.choices));
        progress.advance();
        measured
    };
    in_order(&scans, jobs, work, |scan, measured| {
        let outcome = || match (scan, measured) {
            (Err(fault), _) => (failed(fault), None),
            (Ok(path), Ok(Some(measured))) => run.delivered(path, measured),
            (Ok(path), Err(panic)) => run.delivered(path, Err(FileFault::Panic(panic))),
            (Ok(_), Ok(None)) => (Exit::Done, None),
        };
        let (exit, row) = progress.aside(outcome);
        worst = worst.max(exit);
        rows.extend(row);
    });
    drop(progress);
    if several && !args.json && !rows.is_empty() {
        let printed = terminal::print_painted(summary(&rows, run.columns));
        worst = worst.max(exit_of_printing("the summary", printed));
    }
    Ok(worst)
}

/// What holds for all scans of one run.
struct Run<'a> {
    args: &'a ExtractArgs,
    choices: Choices,
    names: Names,
    /// Width of the output, characters.
    columns: usize,
    /// Whether the tables of several scans follow each other.
    is_one_of_several: bool,
}

impl Run<'_> {
    /// Prints the result for a file and writes its folder. Returns the exit and the file's summary row.
    fn delivered(&self, path: &Path, measured: Result<Measured, FileFault>) -> (Exit, Option<Row>) {
        let complain = |fault: &dyn Display| {
            complain(format_args!("gaiter: {}: {fault}", terminal_safe(path.display())));
        };
        let name = self.names.name(path);
        match measured {
            Ok(measured) => {
                let exit = match self.deliver(path, &measured) {
                    Ok(()) => Exit::Done,
                    Err(fault) => {
                        complain(&fault);
                        Exit::Io
                    }
                };
                let (garment, is_delivered) = (&self.choices.report.garment, exit == Exit::Done);
                (exit, Some(Row::measured(name, &measured.record, garment, is_delivered)))
            }
            Err(fault) => {
                complain(&fault);
                (Exit::from(&fault), Some(Row::not_measured(name, fault.code())))
            }
        }
    }

    /// Prints the record and, if `--out` is given, writes its folder.
    fn deliver(&self, path: &Path, measured: &Measured) -> Result<(), Undelivered> {
        let Measured { record, files } = measured;
        if self.args.json {
            print(format_args!("{}\n", serde_json::to_string(record)?))?;
        } else {
            let name = screen::shortened(&self.names.name(path), self.columns);
            let table = table::render(record, &self.choices.report.garment, self.columns);
            terminal::print_painted(format_args!("{name}\n{table}\n"))?;
        }
        // Written next to its place first, then moved there as a whole. It replaces an earlier record of
        // the same scan. Anything else stays and is a fault.
        if let (Some(out), Some(files)) = (&self.args.out, files) {
            let folder = out.join(path.file_stem().unwrap_or_default());
            put_folder(out, &folder, files, &record.scan.sha256)?;
            if !self.args.json {
                print(self.written(&folder, files))?;
            }
        }
        if self.is_one_of_several && !self.args.json {
            print("\n")?;
        }
        Ok(())
    }

    /// Where a record was written, and its files.
    fn written(&self, folder: &Path, files: &[RecordFile]) -> String {
        let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
        let text = format!("written to {}: {}", terminal_safe(folder.display()), names.join(", "));
        screen::indented(&text, "  ", self.columns)
    }
}

/// How to measure and what to write.
struct Choices {
    method: Method,
    output: Output,
    report: ReportChoice,
}

impl Choices {
    /// The values of the configuration, or the defaults, overridden by the command line.
    fn from_args(args: &ExtractArgs) -> Result<Choices, Exit> {
        let config = args.config.as_deref().map(config_at).transpose()?;
        let (configured, garments) = report_choice(config.as_ref());
        let (mut method, mut output) =
            config.map(|config| (config.method, config.output)).unwrap_or_default();
        let report = ReportChoice {
            language: args.language.unwrap_or(configured.language),
            garment: args.garment.chosen(&garments, &configured.garment)?,
            figures: args.figures,
            ..configured
        };
        method.scope = args.scope.unwrap_or(method.scope);
        method.unit = args.unit.unwrap_or(method.unit);
        method.up = args.up.unwrap_or(method.up);
        method.facing = args.facing.unwrap_or(method.facing);
        method.winding = args.winding.unwrap_or(method.winding);
        method.posture = args.posture.unwrap_or(method.posture);
        method.at_heights_mm = args.at.clone().unwrap_or(method.at_heights_mm);
        if let Some(files) = &args.files {
            output.files = files.iter().copied().collect();
        }
        if words::faces_up_or_down(method.up, method.facing) {
            complain("gaiter: --facing points along the up axis; it must be at right angles to it");
            return Err(Exit::Usage);
        }
        Ok(Choices { method, output, report })
    }
}

/// Finds two scans whose records would go to the same folder.
fn same_folder(scans: &[Result<PathBuf, FolderFault>]) -> Option<[&Path; 2]> {
    let mut seen = BTreeMap::new();
    scans.iter().flatten().find_map(|scan| {
        let earlier = seen.insert(scan.file_stem()?, scan)?;
        Some([earlier.as_path(), scan.as_path()])
    })
}

/// Why a file gave no record.
#[derive(Debug, thiserror::Error)]
pub(super) enum FileFault {
    #[error("{0}")]
    Unreadable(#[source] io::Error),
    /// Reading it might block forever, or return no file content.
    #[error("is not a regular file (a pipe or a device)")]
    NotAFile,
    /// It cannot be measured.
    #[error("cannot be measured [{}]: {refusal}{}", refusal.code(), advice(*other_up))]
    Refused {
        /// Why not.
        refusal: Refusal,
        /// The axis with which it can be measured, if another one than the declared axis is up.
        other_up: Option<Up>,
    },
    /// A fault of gaiter itself.
    #[error("cannot be measured [panic]: {0}")]
    Panic(String),
    /// A file of its record cannot be created.
    #[error("the record cannot be written: {0}")]
    Files(#[from] FilesFault),
}

impl From<Refusal> for FileFault {
    fn from(refusal: Refusal) -> FileFault {
        FileFault::Refused { refusal, other_up: None }
    }
}

/// The option that measures a scan with another axis up.
fn advice(other_up: Option<Up>) -> String {
    other_up.map_or(String::new(), |up| {
        format!("; the body stands along another axis: --up {} measures it", up.word())
    })
}

impl From<&FileFault> for Exit {
    fn from(fault: &FileFault) -> Exit {
        match fault {
            FileFault::Unreadable(error) => Exit::from(error),
            FileFault::NotAFile => Exit::Io,
            FileFault::Refused { .. } => Exit::Unmeasurable,
            FileFault::Panic(_) | FileFault::Files(_) => Exit::Internal,
        }
    }
}

impl FileFault {
    /// The code shown in the summary. The codes of refusals are stable.
    fn code(&self) -> &'static str {
        match self {
            FileFault::Unreadable(_) => "unreadable",
            FileFault::NotAFile => "no-regular-file",
            FileFault::Refused { refusal, .. } => refusal.code(),
            FileFault::Panic(_) => "panic",
            FileFault::Files(_) => "record-not-written",
        }
    }
}

/// The bytes of a scan file, and its format.
///
/// # Errors
/// If it cannot be read, or if its name is none of a scan.
pub(super) fn scan_at(path: &Path) -> Result<(Vec<u8>, Format), FileFault> {
    // Check before opening, because opening a pipe waits for a writer.
    if !fs::metadata(path).map_err(FileFault::Unreadable)?.is_file() {
        return Err(FileFault::NotAFile);
    }
    let bytes = fs::read(path).map_err(FileFault::Unreadable)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Ok((bytes, Format::of_file_name(&name).map_err(Refusal::from)?))
}

/// The result for a file that was measured.
struct Measured {
    record: Record,
    /// The files of its record folder, if `--out` is given.
    files: Option<Vec<RecordFile>>,
}

impl Measured {
    fn measure(path: &Path, args: &ExtractArgs, choices: &Choices) -> Result<Measured, FileFault> {
        let Choices { method, output, report } = choices;
        let (bytes, format) = scan_at(path)?;
        let refused = |refusal: Refusal| {
            let other_up = other_up(&bytes, format, method, &refusal);
            FileFault::Refused { refusal, other_up }
        };
        let mut extraction = measure(&bytes, format, method).map_err(refused)?;
        let (ord, opinions) = ord::opinions(path, &extraction);
        extraction.findings.extend(opinions);
        let provenance = Provenance::of_scan(record::sha256(&bytes));
        if args.out.is_none() {
            let record = record::record(&extraction, &provenance, method);
            return Ok(Measured { record, files: None });
        }
        let scan = ScanFile { bytes: &bytes, format, ord: ord.as_deref() };
        let made =
            record::files_beside_scan(&extraction, &provenance, method, output, report, scan);
        let (record, mut files) = made?;
        record::add_scan(&mut files, format, bytes);
        Ok(Measured { record, files: Some(files) })
    }
}

/// The axis with which a refused scan can be measured, if the declared one may be what is wrong: only for the message,
/// because the operator must decide which way is up.
fn other_up(bytes: &[u8], format: Format, method: &Method, refusal: &Refusal) -> Option<Up> {
    let Refusal::Body(fault) = refusal else { return None };
    if !may_be_lying(fault) {
        return None;
    }
    let others = [Up::Y, Up::Z, Up::X].into_iter().filter(|up| *up != method.up);
    let measures = |up: &Up| measure(bytes, format, &Method { up: *up, ..method.clone() }).is_ok();
    others.into_iter().find(measures)
}

/// Whether a body that lies on its side, by the declared axis, can lead to this fault.
fn may_be_lying(fault: &BodyFault) -> bool {
    match fault {
        BodyFault::NoPlausibleUnit { .. }
        | BodyFault::UnitImplausible { .. }
        | BodyFault::NotTwoLegs { .. }
        | BodyFault::FacingUnclear(_)
        | BodyFault::FacingContradicted { .. }
        | BodyFault::SideUnclear { .. }
        | BodyFault::NoPlausibleLeg { .. }
        | BodyFault::TwoLegs => true,
        BodyFault::OnlyFragments
        | BodyFault::FacingVertical
        | BodyFault::WoundInward
        | BodyFault::WoundOutward
        | BodyFault::Layers { .. } => false,
    }
}

/// Why a measured scan was not printed or written.
#[derive(Debug, thiserror::Error)]
enum Undelivered {
    /// Writing to standard output failed.
    #[error("the record cannot be printed: {0}")]
    Print(#[from] io::Error),
    /// The record cannot be written as JSON.
    #[error("the record cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A file or folder of the record cannot be written.
    #[error("cannot write {}: {source}", terminal_safe(path.display()))]
    Write { path: PathBuf, source: io::Error },
    /// Something else is in the record's place.
    #[error(
        "{} is not an unchanged record of this scan: {what}; nothing was written there; move it \
         away or choose another --out",
        terminal_safe(folder.display())
    )]
    Occupied {
        /// The record's folder.
        folder: PathBuf,
        /// What was found there.
        what: Foreign,
    },
}
