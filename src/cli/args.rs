//! The command line as types, with the help texts a technician reads.

mod asking;
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
    self, FACINGS, FIGURES, FILES, HEIGHTS_CM, LANGUAGES, SCOPES, UNITS, UPS, Words,
};
use crate::language::Language;
use crate::leg::method::{FacingChoice, Scope, UnitChoice, Up};
use crate::record::FigureFormat;
use crate::station::measure::VERB;
pub use asking::{AskArgs, ExplainArgs, Named, OneArgs, OrderArgs, ScansArgs, StatusArgs};
pub use reextract::ReextractArgs;
pub use report::ReportArgs;

/// The configuration file that `run` and `check` read if no file is named.
pub const DEFAULT_CONFIG: &str = "/etc/gaiter/station.toml";

/// Measures both legs from a body scan.
///
/// gaiter stands beside a body scanner. It takes every scan the scanner exports and puts girths and
/// heights at B, B1, C and D, a surface and a report of both legs into the patient's folder.
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
    /// Show the whole station at work with a simulated scanner; needs nothing
    ///
    /// Starts a real station in the new folder ./demo, lets a simulated scanner export a few scans
    /// into it, and shows the measures and where the records lie. Takes less than a minute.
    Demo(DemoArgs),
    /// Run the station: wait for scans and put records into the store
    ///
    /// Runs until it is stopped (Ctrl-C or SIGTERM). It is usually started by the system; check the
    /// configuration with `gaiter check` first.
    Run(RunArgs),
    /// Measure scan files now, without a station
    ///
    /// Prints a table of both legs for every scan, and for several scans a summary with a row for
    /// each. For a folder, measures all scans in it in the order of their names, without hidden
    /// files.
    Extract(ExtractArgs),
    /// Measure the scans of a record store again, with today's method
    ///
    /// If the result differs from the record, writes a new revision next to it, in a folder of the
    /// same name with _r2, _r3 …; never touches the old one. Prints at the end what changed and by
    /// how much. A station may run at the same time. A second run adds nothing.
    Reextract(ReextractArgs),
    /// Write the report of a record again, in either language
    ///
    /// Uses record.json alone; the scan is not needed, and nothing is measured. The record is not
    /// changed, because its folder's SHA256SUMS would then be wrong.
    Report(ReportArgs),
    /// Measure one scan on standard input; the station runs this itself
    #[command(name = VERB, hide = true)]
    Measure(MeasureArgs),
    /// Check the configuration and the folders it names
    ///
    /// Names every fault in the configuration file at once, with its line and a hint. When the
    /// file has none, tries the folders: that exports can be read and that records can be written.
    Check(CheckArgs),
    /// Show the state of the running station: ready, or what is wrong and what to do
    ///
    /// Ends with 0 when the station is ready and with 74 when it is not. Names no patient and no
    /// file. Run it as root or as the station's user.
    Status(StatusArgs),
    /// List the station's scans, the newest first
    ///
    /// Names no patient and no file; `gaiter show ID` does.
    Scans(ScansArgs),
    /// Show one scan with its deliveries, the patient's id included
    ///
    /// Shows the patient's id and the record's folder, which are needed to decide about a scan:
    /// make sure that nobody else can see the screen.
    Show(OneArgs),
    /// Explain in one sentence why a file or a scan is where it is
    Explain(ExplainArgs),
    /// Try a refused scan again, or a waiting one at once
    ///
    /// For a scan in quarantine, once the cause is fixed: for example after a change of the
    /// configuration or with a new version of gaiter.
    Retry(OneArgs),
    /// Deliver a held scan to the patient it arrived for
    ///
    /// A scan is held if the same bytes arrived for a second patient. Look at it first, with
    /// `gaiter show ID`: one of the two patients has the wrong legs.
    Release(OneArgs),
    /// Assign a scan that came in without a patient to a patient
    ///
    /// Asks for the patient's id, or reads it from standard input. It is never an argument, because
    /// every user of the machine can read those.
    Assign(OneArgs),
    /// Take a scan back from its patient: its record goes to _unassigned and leaves the patient's folder
    Unassign(OneArgs),
    /// Mark a refused scan, or a held one that somebody already has, as needing no further decision
    ///
    /// The station no longer asks about it. The configuration sets how long its bytes are kept;
    /// until then it can still be tried again or assigned.
    GiveUp(OneArgs),
    /// Set, clear or show the patient of the next scan
    #[command(subcommand)]
    Patient(PatientVerb),
    /// Hand an order of the practice software (GDT 6302) to the running station
    ///
    /// For practice software that starts a program with the order's file. The order names the patient
    /// of the next scan. The file is only read: the practice software removes it.
    GdtOrder(OrderArgs),
    /// Print the link to the operator's page, with the token; without the token the page is
    /// read-only
    ///
    /// People with the link can decide about scans: open it on the machine itself, and do not send
    /// it. The browser keeps the token.
    Page(AskArgs),
    /// Take and deliver no scans until `gaiter resume`; also after a restart
    Pause(AskArgs),
    /// Go on after `gaiter pause`
    Resume(AskArgs),
    /// Print the JSON Schema of record.json
    Schema,
    /// Print the completions for a shell
    Completions(CompletionsArgs),
    /// Print the manual page, or write a page for every verb into a folder
    Man(ManArgs),
}

/// `gaiter patient …`
#[derive(Debug, clap::Subcommand)]
pub enum PatientVerb {
    /// Name the patient of the next scan
    ///
    /// Asks for the patient's id, or reads it from standard input. It is never an argument, because
    /// every user of the machine can read those. It waits for the next press of the button, or
    /// without a button for the next export; it is used once.
    Set(AskArgs),
    /// Clear the named patient and the presses that still await their export
    Clear(AskArgs),
    /// Show the patient of the next scan
    Show(AskArgs),
}

/// `gaiter demo`
#[derive(Debug, clap::Args)]
pub struct DemoArgs {
    /// Print the records as one JSON object at the end, for programs, and nothing else
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
    /// Look for scans in the folders within folders, too
    #[arg(long)]
    pub recursive: bool,
    /// Number of scans measured at a time [default: number of processors]
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
    /// The language of the report, with --out [default: en]
    #[arg(long, value_parser = of_words(LANGUAGES), requires = "out")]
    pub language: Option<Language>,
    /// What the scan contains: a whole body, or one leg with its foot, whose side the scan does not
    /// show
    #[arg(long, value_parser = of_words(SCOPES))]
    pub scope: Option<Scope>,
    /// The unit of the scan's coordinates; auto finds it from the height of the body
    #[arg(long, value_parser = of_words(UNITS))]
    pub unit: Option<UnitChoice>,
    /// The axis of the scan that points up [default: y]
    #[arg(long, value_parser = of_words(UPS))]
    pub up: Option<Up>,
    /// The axis of the scan the toes point along; auto finds it from the feet
    #[arg(long, value_parser = of_words(FACINGS), allow_hyphen_values = true)]
    pub facing: Option<FacingChoice>,
    /// Heights above the floor at which girths are also measured, in cm: --at 10,20,30.5
    #[arg(long, value_name = "CM,…", value_delimiter = ',', value_parser = height_mm)]
    pub at: Option<Vec<f64>>,
    /// Take unit, up, facing, method and output from this configuration, unless an option overrides
    /// them
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
