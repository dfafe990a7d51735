//! The command line as types, with the help texts a technician reads.

mod asking;
mod calibrate;
mod reextract;
mod report;

use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Parser, Subcommand};
use clap_complete::Shell;

use crate::cad::FileKind;
use crate::config::words::{
    self, FACINGS, FIGURES, FILES, GARMENTS, HEIGHTS_CM, LANGUAGES, SCOPES, UNITS, UPS, WINDINGS,
    Words,
};
use crate::language::Language;
use crate::leg::method::{FacingChoice, Scope, UnitChoice, Up, Winding};
use crate::record::FigureFormat;
use crate::record::garment::Garment;
use crate::station::measure::VERB;
pub use asking::{
    AskArgs, ExplainArgs, Named, OneArgs, OrderArgs, ScansArgs, StatusArgs, UnassignArgs,
};
pub use calibrate::CalibrateArgs;
pub use reextract::ReextractArgs;
pub use report::ReportArgs;

/// The configuration file that `run` and `check` read if no file is named.
pub const DEFAULT_CONFIG: &str = "/etc/gaiter/station.toml";

/// Measures both legs from a body scan.
///
/// gaiter runs beside a body scanner. It takes every scan that the scanner exports, and writes girths
/// and heights at B, B1, C and D, a surface and a report of both legs to the patient's folder.
#[derive(Debug, Parser)]
#[command(name = "gaiter", version, after_help = EXIT_CODES)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub verb: Verb,
}

const EXIT_CODES: &str = "Exit codes: 0 done, 64 wrong command line, 65 a scan cannot be measured, \
66 no such file, 70 internal error, 74 reading or writing failed, 78 fault in the configuration.";

/// The verbs of gaiter.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Show a whole station at work with a simulated scanner; needs no configuration
    ///
    /// Starts a real station in the new folder ./demo, lets a simulated scanner export a few scans
    /// into it, and shows the measures and where the records are. Takes less than a minute.
    Demo(DemoArgs),
    /// Run the station: wait for scans and write records to the stores
    ///
    /// Runs until it is stopped (Ctrl-C or SIGTERM). Usually systemd starts it. Check the configuration
    /// with `gaiter check` first.
    Run(RunArgs),
    /// Measure scan files now, without a station
    ///
    /// Prints a table of both legs for each scan, and for several scans a summary with one row each.
    /// For a folder, measures all scans in it except hidden files, in the order of their names.
    Extract(ExtractArgs),
    /// Measure a body of known girths, and say how far off scanner and method are
    ///
    /// Compares the girths of a cylinder, a cone or another body with the known ones. Changes nothing;
    /// a station keeps a series of such checks by itself if `phantom.girths` is configured. Exits with
    /// 65 also if a girth is beyond the tolerance.
    Calibrate(CalibrateArgs),
    /// Measure the scans of a record store again, with the current method
    ///
    /// If the result differs from the record, writes a new revision beside it, in a folder of the same
    /// name with _r2, _r3 …; never changes the old one. Prints at the end what changed and by how
    /// much. A station may run at the same time. A second run adds nothing.
    Reextract(ReextractArgs),
    /// Write the report of a record again, in English or German
    ///
    /// Uses only record.json; the scan is not needed, and nothing is measured. The record is not
    /// changed, because its folder's SHA256SUMS would then be wrong.
    Report(ReportArgs),
    /// Measure one scan on standard input; the station runs this itself
    #[command(name = VERB, hide = true)]
    Measure(MeasureArgs),
    /// Check the configuration and the folders it names
    ///
    /// Names all faults in the configuration file at once, each with its line and a hint. If the file
    /// has none, tries the folders: whether exports can be read and records can be written. Run it as
    /// the station's user.
    Check(CheckArgs),
    /// Show the state of the running station: ready, or what is wrong and what to do
    ///
    /// Exits with 0 when the station is ready and with 74 when it is not, or when no station runs.
    /// Shows no patient's id and no file name. Run it as root or as the station's user.
    Status(StatusArgs),
    /// List the station's scans, newest first
    ///
    /// Shows no patient's id and no file name; `gaiter show ID` shows the id.
    Scans(ScansArgs),
    /// Show one scan with its deliveries and the patient's id
    ///
    /// For a held scan, also shows the patients it may belong to and the folder with pictures of its
    /// legs. Make sure that nobody else can see the screen.
    Show(OneArgs),
    /// Explain in one sentence why a file or a scan is where it is
    Explain(ExplainArgs),
    /// Try a refused scan again, or a waiting one at once
    ///
    /// For a refused scan, once the cause is fixed: for example after a change of the configuration or
    /// with a new version of gaiter.
    Retry(OneArgs),
    /// Deliver a held scan to the patient it came in for
    ///
    /// A scan is held when it is not certain whose it is, or when nobody pressed the button for it.
    /// Look at it first: `gaiter show ID` shows why it is held and whose it may be. If it did not come
    /// in for exactly one patient, use `gaiter assign ID`.
    Release(OneArgs),
    /// Assign an unassigned or held scan to a patient
    ///
    /// Asks for the patient's id, or reads it from standard input. It is never an argument, because
    /// every user of the machine can read those.
    Assign(OneArgs),
    /// Take a scan back from its patient: its record goes to _unassigned and leaves the patient's folder
    ///
    /// Notes that people put into the record's folder go with it. Delete results that the practice
    /// software already has in that software. A scan that belongs to more than one patient stays with the
    /// others.
    Unassign(UnassignArgs),
    /// Close a scan that was refused, is held, or is stored without a patient: it needs no decision
    ///
    /// The station no longer asks about it. A record that is stored stays where it is. `retention` in the configuration sets how long its
    /// bytes are kept; until then it can still be tried again or assigned.
    GiveUp(OneArgs),
    /// Set, clear or show the patient of the next scan
    #[command(subcommand)]
    Patient(PatientVerb),
    /// Hand an order of the practice software (GDT 6302) to the running station
    ///
    /// For practice software that can start a program with the order's file. The order names the
    /// patient of the next scan. gaiter only reads the file; the practice software removes it.
    GdtOrder(OrderArgs),
    /// Print the link to the operator's page, with the token; without the token the page is
    /// read-only
    ///
    /// Everybody who has the link can decide about scans. Open it on the station's machine, and do not
    /// send it to anybody. The browser keeps the token.
    Page(AskArgs),
    /// Take in and deliver no scans until `gaiter resume`, not even after a restart
    Pause(AskArgs),
    /// Take in and deliver scans again after `gaiter pause`
    Resume(AskArgs),
    /// Print the JSON Schema of record.json
    Schema,
    /// Print completions for a shell
    Completions(CompletionsArgs),
    /// Print the manual page, or write a page for each verb to a folder
    Man(ManArgs),
}

/// `gaiter patient …`
#[derive(Debug, clap::Subcommand)]
pub enum PatientVerb {
    /// Name the patient of the next scan
    ///
    /// Asks for the patient's id, or reads it from standard input. It is never an argument, because
    /// every user of the machine can read those. The name waits for the next press of the button, or
    /// without a button for the next export. It is used once, and replaces a name that waits.
    Set(AskArgs),
    /// Drop the waiting name and the presses whose export has not come
    Clear(AskArgs),
    /// Show who is next and whose exports are expected; shows patients' ids
    Show(AskArgs),
}

/// `gaiter demo`
#[derive(Debug, clap::Args)]
pub struct DemoArgs {
    /// Print only the records, as one JSON object at the end, for programs
    #[arg(long)]
    pub json: bool,
}

/// `gaiter completions`
#[derive(Debug, clap::Args)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL", value_parser = of_words(SHELLS))]
    pub shell: Shell,
}

/// `gaiter man`
#[derive(Debug, clap::Args)]
pub struct ManArgs {
    /// The folder for gaiter.1, gaiter-run.1 and so on; it must exist
    #[arg(value_name = "DIR")]
    pub dir: Option<PathBuf>,
}

/// The shells whose completions are tested.
const SHELLS: Words<Shell> = &[("bash", Shell::Bash), ("zsh", Shell::Zsh), ("fish", Shell::Fish)];

/// `gaiter run`
#[derive(Debug, clap::Args)]
pub struct RunArgs {
    /// The configuration of the station
    #[arg(long, value_name = "FILE", default_value = DEFAULT_CONFIG)]
    pub config: PathBuf,
}

/// `gaiter extract`; a choice that was not made is `None`, so that the configuration can make it.
#[derive(Debug, clap::Args)]
pub struct ExtractArgs {
    /// The scan files, as the scanner exported them (.obj, .ply, .stl, .wrl, .xyz, .asc, .txt), or
    /// folders of them
    #[arg(value_name = "SCAN", required = true)]
    pub scans: Vec<PathBuf>,
    /// Also look for scans in folders within folders
    #[arg(long)]
    pub recursive: bool,
    /// Number of scans to process at a time [default: number of processors]
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Print one JSON record per scan and line, for programs
    #[arg(long)]
    pub json: bool,
    /// Also write a record folder for every scan: DIR/NAME-OF-SCAN/
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// CAD files and meshes to make of each leg, with --out: --files step,iges,stl
    #[arg(
        long,
        value_name = "KIND,…",
        value_delimiter = ',',
        value_parser = of_words(FILES),
        requires = "out"
    )]
    pub files: Option<Vec<FileKind>>,
    /// Also write each figure of the report as a file of its own, with --out
    #[arg(
        long,
        value_name = "FORMAT,…",
        value_delimiter = ',',
        value_parser = of_words(FIGURES),
        requires = "out"
    )]
    pub figures: Option<Vec<FigureFormat>>,
    /// The language of the report, with --out [default: en, or that of --config]
    #[arg(long, value_parser = of_words(LANGUAGES), requires = "out")]
    pub language: Option<Language>,
    /// The garment that is ordered: the sheet says which of its measures are missing [default: AD, or that of
    /// --config]
    #[arg(long, value_parser = of_words(GARMENTS))]
    pub garment: Option<Garment>,
    /// What the scan contains: a whole body, or one leg with its foot; the scan does not show its side
    #[arg(long, value_parser = of_words(SCOPES))]
    pub scope: Option<Scope>,
    /// The unit of the scan's coordinates; auto finds it from the height of the body
    #[arg(long, value_parser = of_words(UNITS))]
    pub unit: Option<UnitChoice>,
    /// The axis of the scan that points up [default: y]
    #[arg(long, value_parser = of_words(UPS))]
    pub up: Option<Up>,
    /// The axis of the scan that the toes point along; auto finds it from the feet
    #[arg(long, value_parser = of_words(FACINGS), allow_hyphen_values = true)]
    pub facing: Option<FacingChoice>,
    /// Which way round the scan's triangles are wound [default: outward]
    #[arg(long, value_parser = of_words(WINDINGS))]
    pub winding: Option<Winding>,
    /// Heights above the floor at which girths are also measured, in cm: --at 10,20,30.5
    #[arg(long, value_name = "CM,…", value_delimiter = ',', value_parser = height_mm)]
    pub at: Option<Vec<f64>>,
    /// Take scope, unit, up, facing, method, output and language from this configuration, unless an
    /// option overrides them
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
}

/// `gaiter measure`
#[derive(Debug, clap::Args)]
pub struct MeasureArgs {
    /// The scan's hash
    pub hash: String,
}

/// `gaiter check`
#[derive(Debug, clap::Args)]
pub struct CheckArgs {
    /// The configuration to check
    #[arg(long, value_name = "FILE", default_value = DEFAULT_CONFIG)]
    pub config: PathBuf,
    /// Print the result as JSON, for programs
    #[arg(long)]
    pub json: bool,
}

/// Parses a height in cm and returns it in mm.
fn height_mm(text: &str) -> Result<f64, String> {
    let Range { start, end } = HEIGHTS_CM;
    words::height_mm(text)
        .ok_or_else(|| format!("a height in cm is more than {start} and less than {end}"))
}

/// A parser for the words of a table that the configuration uses too.
fn of_words<T: Copy + Send + Sync + 'static>(table: Words<T>) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(table.iter().map(|(word, _)| *word))
        .try_map(move |text| words::meaning(table, &text).ok_or("no such word"))
}

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};

    use super::{Args, ExtractArgs, FILES, Verb, words};
    use crate::leg::method::{Axis, FacingChoice, Unit, UnitChoice, Up};

    fn extract(words: &[&str]) -> ExtractArgs {
        let line = ["gaiter", "extract"].iter().chain(words);
        match Args::try_parse_from(line).unwrap().verb {
            Verb::Extract(args) => args,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_command_line_is_consistent() {
        Args::command().debug_assert();
    }

    #[test]
    fn a_negative_facing_is_a_value_and_not_an_option() {
        for words in [["a.obj", "--facing", "-x"], ["--facing", "-x", "a.obj"]] {
            let args = extract(&words);
            assert_eq!(args.facing, Some(FacingChoice::Declared(Axis::MinusX)));
            assert_eq!(args.scans.len(), 1);
        }
        let args = extract(&["a.obj", "--facing=+z"]);
        assert_eq!(args.facing, Some(FacingChoice::Declared(Axis::PlusZ)));
    }

    #[test]
    fn a_choice_that_was_not_made_is_left_open() {
        let args = extract(&["a.obj", "b.obj", "--json"]);
        assert_eq!((args.unit, args.up, args.facing), (None, None, None));
        assert_eq!(args.scans.len(), 2);
        assert!(args.json);
        let args = extract(&["a.obj", "--unit", "in", "--up", "z"]);
        assert_eq!(args.unit, Some(UnitChoice::Declared(Unit::In)));
        assert_eq!(args.up, Some(Up::Z));
    }

    #[test]
    fn heights_are_centimetres_with_or_without_decimals() {
        assert_eq!(extract(&["a.obj"]).at, None);
        for words in [["a.obj", "--at", "10,20,30.5"], ["--json", "--at=10,20,30.5", "a.obj"]] {
            let args = extract(&words);
            assert_eq!(args.at, Some(vec![100.0, 200.0, 305.0]));
            assert_eq!(args.scans.len(), 1);
        }
    }

    #[test]
    fn files_are_words_with_commas_between_and_need_a_place() {
        assert_eq!(extract(&["a.obj"]).files, None);
        let args = extract(&["a.obj", "--out", "d", "--files", "step,stl-solid"]);
        let kinds = ["step", "stl-solid"].map(|word| words::meaning(FILES, word).unwrap());
        assert_eq!(args.files.as_deref(), Some(kinds.as_slice()));
        let none = ["gaiter", "extract", "a.obj", "--files", "step"];
        assert!(Args::try_parse_from(none).is_err(), "there is no folder to put them into");
    }

    #[test]
    fn a_word_that_is_not_known_is_refused() {
        for words in
            [["--unit", "ft"], ["--up", "-y"], ["--facing", "x"], ["--at", "10,"], ["--at", "0"]]
                .into_iter()
                .chain(["step,dxf", "STEP", "step,", ""].map(|kinds| ["--files", kinds]))
                .chain(["200", "-5", "nan", "inf", "ten", "10;20", ""].map(|cm| ["--at", cm]))
        {
            let line = ["gaiter", "extract", "a.obj", "--out", "d"].iter().chain(&words);
            assert!(Args::try_parse_from(line).is_err(), "{words:?}");
        }
    }
}
